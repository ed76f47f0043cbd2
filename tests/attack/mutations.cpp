#include "tests/attack/mutations.h"

#include <array>
#include <utility>

namespace flexmorph::testing {
namespace {

bool in_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '.';
}

/// Returns the indices of the first and one past the last character of the word at or after `at`;
/// equal if there is none.
std::pair<size_t, size_t> word_at(const std::string& text, size_t at) {
  while (at < text.size() && !in_word(text[at])) ++at;
  size_t first = at;
  while (first > 0 && in_word(text[first - 1])) --first;
  while (at < text.size() && in_word(text[at])) ++at;
  return {first, at};
}

/// Returns the indices of the first and one past the last character of the line at `at`, including
/// its end.
std::pair<size_t, size_t> line_at(const std::string& text, size_t at) {
  const size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const size_t end = text.find('\n', at);
  return {before == std::string::npos ? 0 : before + 1,
          end == std::string::npos ? text.size() : end + 1};
}

}  // namespace

/// SplitMix64 (Steele, Lea & Flood 2014).
size_t Mutations::below(size_t n) {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return static_cast<size_t>((z ^ (z >> 31U)) % n);
}

std::string Mutations::number() {
  constexpr std::array kNumbers = {
      "0",     "-1",   "1",     "2",          "3",    "-0.0", "0.5",    "1e-300",     "1e308",
      "1e15",  "nan",  "inf",   "-inf",       "1e-9", "7",    "100000", "2147483648", "-2147483649",
      "1e400", "0x10", "1_000", "9999999999", "0.1",  "1e3",  "true",   "[]",         "\"\""};
  return kNumbers[below(kNumbers.size())];
}

void Mutations::change_word(std::string& text, const std::string& other) {
  const auto [first, end] = word_at(text, below(text.size() + 1));
  if (below(2) == 0) {
    text.replace(first, end - first, number());
    return;
  }
  const auto [from, to] = word_at(other, below(other.size() + 1));
  text.replace(first, end - first, other.substr(from, to - from));
}

void Mutations::change_line(std::string& text, const std::string& other) {
  const auto [first, end] = line_at(text, below(text.size() + 1));
  const std::string line = text.substr(first, end - first);
  const auto [from, to] = line_at(other, below(other.size() + 1));
  switch (below(4)) {
    case 0:
      text.erase(first, end - first);
      break;
    case 1:
      text.insert(first, line);
      break;
    case 2:
      text.insert(first, other.substr(from, to - from));
      break;
    default:
      text.insert(line_at(text, below(text.size() + 1)).first, line);
  }
}

void Mutations::change(std::string& text, const std::string& other) {
  const size_t at = below(text.size() + 1);
  constexpr std::string_view kBytes = "=[]{}\"'#.,\n-+ e\\\0\xff\xc3";
  switch (below(8)) {
    case 0:
      text.insert(at, 1, kBytes[below(kBytes.size())]);
      break;
    case 1:
      if (at < text.size()) text[at] = static_cast<char>(below(256));
      break;
    case 2:
      text.erase(at, below(40));
      break;
    case 3:
    case 4:
    case 5:
      change_word(text, other);
      break;
    default:
      change_line(text, other);
  }
}

std::string Mutations::changed(const std::string& text, const std::string& other) {
  std::string out = text;
  for (size_t n = 1 + below(4); n > 0; --n) change(out, other);
  return out;
}

std::string Mutations::formula(int depth) {
  constexpr std::array kLeaves = {"t", "1", "2",  "pi",    "0.3",    "1e5", "7/3",
                                  "a", "0", "-1", "1e300", "999999", "t",   "t"};
  constexpr std::array kFunctions = {"sin",  "cos",  "tan",  "asin",      "acos", "atan",
                                     "sinh", "cosh", "tanh", "exp",       "log",  "sqrt",
                                     "abs",  "foo",  "step", "smoothstep"};
  constexpr std::array kPairs = {"atan2", "min", "max"};
  constexpr std::array kOperators = {"+", "-", "*", "/", "^", "*", "+", "", "--"};
  if (depth == 0) return kLeaves[below(kLeaves.size())];
  switch (below(6)) {
    case 0: {
      const std::string name = kFunctions[below(kFunctions.size())];
      return name + "(" + formula(depth - 1) + ")";
    }
    case 1: {
      const std::string y = formula(depth - 1);
      const std::string x = formula(depth - 1);
      const size_t which = below(kPairs.size() + 1);
      return which < kPairs.size() ? kPairs[which] + ("(" + y + ", " + x + ")")
                                   : "piecewise(" + y + ", 0.3, " + x + ")";
    }
    case 2:
      return "(" + formula(depth - 1) + ")";
    default: {
      const std::string left = formula(depth - 1), sign = kOperators[below(kOperators.size())];
      return "(" + left + ")" + sign + "(" + formula(depth - 1) + ")";
    }
  }
}

}  // namespace flexmorph::testing
