#include "io/case_files/case_limits.h"

#include <algorithm>
#include <string_view>

#include "geometry/base.h"

namespace flexmorph::io {
namespace {

constexpr int kMaxKeyParts = 100;     // largest number of parts in a dotted key
constexpr size_t kLongestKey = 2000;  // largest number of characters in a key
constexpr int kMaxNesting = 100;      // largest depth of nested lists and tables in braces

/// Returns the end of the string that begins at `start`. Three quotes open a string of several
/// lines.
size_t end_of_string(std::string_view text, size_t start) {
  const char quote = text[start];
  const std::string three(3, quote);
  const bool is_long = text.substr(start).starts_with(three);
  size_t i = start + (is_long ? 3 : 1);
  while (i < text.size()) {
    if (quote == '"' && text[i] == '\\') {
      i += 2;
    } else if (is_long ? text.substr(i).starts_with(three) : text[i] == quote) {
      return i + (is_long ? 3 : 1);
    } else if (!is_long && text[i] == '\n') {
      return i;  // toml++ reports this error
    } else {
      ++i;
    }
  }
  return text.size();
}

}  // namespace

void check_case_limits(const std::string& text, const std::string& name) {
  int line = 1, depth = 0, dots = 0;
  size_t key_start = 0;
  const auto fail = [&](const std::string& what, size_t most, const char* noun) {
    throw Error::input(name + ":" + std::to_string(line) + ": " + what + " at most " +
                       std::to_string(most) + noun);
  };
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    size_t next = i + 1;
    if (c == '"' || c == '\'') {
      next = end_of_string(text, i);
      line += static_cast<int>(std::count(text.data() + i, text.data() + next, '\n'));
    } else if (c == '#') {
      next = std::min(text.find('\n', i), text.size());
    } else if (c == '.') {
      if (++dots >= kMaxKeyParts)
        fail("a key or a number has", kMaxKeyParts, " parts between dots");
    } else if (std::string_view("[{").find(c) != std::string_view::npos) {
      if (++depth > kMaxNesting) fail("lists and tables are nested", kMaxNesting, " levels deep");
    } else if (std::string_view("]}").find(c) != std::string_view::npos) {
      depth = std::max(0, depth - 1);
    }
    if (std::string_view("=,[]{}\n#").find(c) != std::string_view::npos) {
      if (c == '=' && i - key_start > kLongestKey) fail("a key has", kLongestKey, " characters");
      dots = 0;
      key_start = next;
    }
    if (c == '\n') ++line;
    i = next;
  }
}

}  // namespace flexmorph::io
