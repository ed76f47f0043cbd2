#pragma once

#include <span>
#include <string>

/// Command lines as texts for a shell.
namespace flexmorph::io {

/// Returns a word as a shell reads it, in quotes if it has other characters than those of names.
std::string shell_word(const std::string& word);

/// Returns words as a command line for a shell.
std::string shell_line(std::span<const std::string> words);

}  // namespace flexmorph::io
