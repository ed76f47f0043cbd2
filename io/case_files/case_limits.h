#pragma once

#include <string>

namespace flexmorph::io {

/// Rejects a text on which the recursion of the parser toml++ would become too deep: keys of more
/// than 100 parts or more than 2000 characters, and lists and tables that are nested more than 100
/// deep. Strings and comments may have any contents. The time is linear in the length of the text.
///
/// @param name  file, or option of the command line
/// @throws Error (input) "<name>:<line>: ..." with the limit.
void check_case_limits(const std::string& text, const std::string& name);

}  // namespace flexmorph::io
