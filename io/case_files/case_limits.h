#pragma once

#include <string>

namespace flexmorph::io {

/// Refuses what toml++ would follow call by call into the ground, before it sees it: keys of more
/// than 100 parts, or of more than 2000 characters, and lists and tables in each other more than
/// 100 deep. Strings and comments may hold what they like. Linear in the text, whatever it is.
///
/// @param name  file, or option of the command line
/// @throws Error (input) "<name>:<line>: ..." with the limit.
void check_case_limits(const std::string& text, const std::string& name);

}  // namespace flexmorph::io
