#pragma once

#include <cstdio>
#include <string>

namespace flexmorph {

/// Returns numbers as text in a printf format, at most 511 characters.
std::string formatted(const char* format, auto... values) {
  char out[512];
  std::snprintf(out, sizeof out, format, values...);
  return out;
}

/// Returns the names of a range in one text, separated by `between`, each enclosed in `quote`.
std::string joined(const auto& names, const std::string& between = ", ",
                   const std::string& quote = "") {
  std::string out;
  for (const auto& name : names) out += (out.empty() ? "" : between) + quote + name + quote;
  return out;
}

}  // namespace flexmorph
