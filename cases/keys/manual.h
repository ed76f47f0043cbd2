#pragma once

#include <string>

/// Manual pages for the program `man`, in the language of troff.
namespace flexmorph::cases {

/// Returns a text as one paragraph of a manual page: characters with a meaning for troff are
/// escaped.
std::string manual_text(const std::string& text);
/// Returns the first lines of a manual page.
/// @param section  "1" for commands, "5" for files
/// @param title    what the page explains, such as "optimizes mechanisms"
std::string manual_head(const std::string& section, const std::string& title);
/// Returns the manual page flexmorph(5): the keys of case files.
std::string keys_as_manual();

}  // namespace flexmorph::cases
