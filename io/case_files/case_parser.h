#pragma once

#include <string>

#include "io/case_files/case_document.h"

namespace flexmorph::io {

/// The whole file. @throws Error (input) for a missing file, a directory, an unreadable file.
std::string read_text(const std::string& path);

/// TOML text as a tree; keys stay in the order of the file.
/// @throws Error (input) "<file>:<line>:<column>: not TOML: <reason>"
CaseNode parse_case(const std::string& text, const std::string& file);

/// VALUE of a command line option: TOML, or a bare word, which is a string.
/// @throws Error (input) naming the option.
CaseNode parse_option(const std::string& value, const std::string& option);

/// A TOML string in quotes.
std::string in_quotes(const std::string& text);

}  // namespace flexmorph::io
