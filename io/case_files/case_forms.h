#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/case_files/case_document.h"
#include "io/case_files/key.h"

/// Checks of the values in a case file against the declared forms of their keys.
namespace flexmorph::io {

/// Returns the number of a node, or nothing if it is not a number that the quantity allows, or has
/// a unit that does not fit.
std::optional<double> read_number(const CaseNode& node, const Quantity& quantity);
/// Returns the integer of a node, or nothing if it is not an integer within the limits of the form.
std::optional<int> read_integer(const CaseNode& node, const Form& form);
/// Returns the text of a node, or nothing if it is not a text.
std::optional<std::string> read_text(const CaseNode& node);

/// Returns the beginning of a message about a list, with its number of entries: "a list of 3: ".
std::string list_of(const Form& form);
/// Returns the allowed values at the end of a message: "a length is positive [m], or the name of
/// ...".
std::string number_or_name(const Form& form);
/// Returns the allowed values of an integer: "a count is a whole number between 1 and 9".
std::string whole_number(const Form& form);
/// Returns the allowed words: "a term is one of 'inertia', 'membrane'".
std::string one_of(const std::string& noun, std::span<const std::string> allowed);
/// Returns the allowed words, and the one that is most similar to `found`.
std::string one_of(const std::string& noun, std::span<const std::string> allowed,
                   const std::string& found);
/// Returns the end of a message about a text, or the first such entry of a list, that gives no
/// number: the reason, and what is allowed. The result is empty if there is no such text.
std::string refusal_of_number(const CaseNode& node, const Quantity& quantity);

/// A complaint about a case file.
struct Complaint {
  unsigned line;  ///< Line in the file.

  /// Location and value, such as "cases/four_bar.toml:14:13: body.thickness = -0.002".
  std::string subject;
  std::string words;  ///< Reason, such as ": a thickness is positive [m]".
};
/// Returns the text of complaints in the order of the file, at most twenty lines.
std::string complaints_text(std::vector<Complaint> complaints, const std::string& file);

/// Errors in a case that can be found without interpreting it. Tables for which the program
/// declares no keys are not checked.
struct BookCheck {
  /// Values that fit no declared form, keys that are not declared, and missing required keys.
  std::vector<Complaint> values, unknown, missing;
};
/// Returns the errors in a case with respect to the declarations of all keys (all_keys()).
BookCheck check_by_book(const CaseNode& root);

}  // namespace flexmorph::io
