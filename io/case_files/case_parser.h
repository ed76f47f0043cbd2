#pragma once

#include <string>

#include "io/case_files/case_document.h"

namespace flexmorph::io {

/// Returns the contents of a case file.
/// @throws Error (input) for a missing file, a directory, or a file that cannot be read or is
///         larger than 100 MB.
std::string read_text(const std::string& path);

/// Parses TOML text into a tree; keys keep the order of the file.
/// @throws Error (input) "<file>:<line>:<column>: not TOML: <reason>"
CaseNode parse_case(const std::string& text, const std::string& file);

/// Parses the VALUE of a command line option: TOML, or a bare word with or without dots, which is a
/// string.
/// @throws Error (input) naming the option.
CaseNode parse_option(const std::string& value, const std::string& option);

/// Returns a text as a TOML string in quotes.
std::string in_quotes(const std::string& text);

}  // namespace flexmorph::io
