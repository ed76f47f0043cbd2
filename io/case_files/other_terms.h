#pragma once

#include <span>
#include <string>

/// Answers to words and keys that other programs use.
namespace flexmorph::io {

/// Returns the word among `known` that means what other programs call `word` ("prismatic":
/// "slider"); empty if there is none.
std::string word_for_term(const std::string& word, std::span<const std::string> known);

/// Returns a sentence on a key that case files do not have ("friction", "material", "angle_deg"),
/// for the end of a message; empty for other keys.
std::string answer_to_key(const std::string& key);

}  // namespace flexmorph::io
