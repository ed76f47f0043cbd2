#pragma once

#include <string>
#include <vector>

/// Templates of cases, from which a user begins. Each one is a file of the folder templates/ beside
/// the shipped cases, and its name is the kind of the mechanism.
namespace flexmorph::cases {

/// Returns the kinds of templates, sorted by name.
std::vector<std::string> template_kinds();
/// Returns a line with kind and title for each template.
std::string list_of_templates();
/// Returns the path of the template of a kind.
/// @throws Error (input) naming the kinds.
std::string find_template(const std::string& kind);

/// Writes NAME.toml in the current folder: the template of a kind below a comment that says how it
/// is checked and run.
/// @param name  letters, digits, _ and -, beginning with a letter or digit; NAME or NAME.toml
/// @throws Error (input) for another name, for the name of a shipped case, for a file that exists,
///         and for a kind that does not exist; Error (numerical) when the file cannot be written.
/// @return path of the file
std::string write_new_case(const std::string& name, const std::string& kind);

}  // namespace flexmorph::cases
