#include "io/formula_words.h"

#include <charconv>
#include <cmath>

#include "geometry/base.h"
#include "io/formula.h"

namespace flexmorph::io {
namespace {

constexpr size_t kMostCharacters = 10'000;
constexpr int kDeepest = 100;   // parentheses
constexpr int kMostSigns = 10;  // in a row: each of them is one call of GiNaC's parser

bool is_function(const std::string& name) {
  for (const char* other : {"atan2", "abs", "min", "max", "step", "smoothstep", "piecewise"})
    if (name == other) return true;
  return formula_functions().contains(name);
}

std::string quoted(std::string word) { return word.insert(0, 1, '\'').append(1, '\''); }

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

size_t end_of_number(const std::string& text, size_t i) {
  while (i < text.size() && (is_digit(text[i]) || text[i] == '.')) ++i;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    size_t k = i + 1;
    if (k < text.size() && (text[k] == '+' || text[k] == '-')) ++k;
    if (k < text.size() && is_digit(text[k]))
      for (i = k; i < text.size() && is_digit(text[i]);) ++i;
  }
  return i;
}

}  // namespace

const std::map<std::string, FormulaFunction>& formula_functions() {
  static const std::map<std::string, FormulaFunction> kFunctions = {
      {"sin", std::sin},   {"cos", std::cos},   {"tan", std::tan},   {"asin", std::asin},
      {"acos", std::acos}, {"atan", std::atan}, {"sinh", std::sinh}, {"cosh", std::cosh},
      {"tanh", std::tanh}, {"exp", std::exp},   {"log", std::log},   {"sqrt", std::sqrt}};
  return kFunctions;
}

void refuse_formula(const std::string& text, const std::string& why) {
  throw Error::input("formula '" + text + "': " + why);
}

void refuse_formula(const std::string& text, size_t position, const std::string& why) {
  refuse_formula(text, "character " + std::to_string(position + 1) + ": " + why);
}

namespace {

/// Refuses a^b^c, which GiNaC refuses or accepts depending on its version.
void check_powers(const std::string& text) {
  std::vector<bool> has_power = {false};  // the product that is read, in each open parenthesis
  char last = ' ';
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (is_digit(c) || c == '.') {
      i = end_of_number(text, i);
      last = c;
      continue;
    }
    if (is_letter(c)) {
      while (i < text.size() && (is_letter(text[i]) || is_digit(text[i]))) ++i;
      last = c;
      continue;
    }
    ++i;
    if (c == ' ' || c == '\t' || c == '\n') continue;
    if (c == '(') has_power.push_back(false);
    if (c == ')' && has_power.size() > 1) has_power.pop_back();
    if (c == '*' || c == '/' || c == ',' || ((c == '+' || c == '-') && last != '^'))
      has_power.back() = false;
    if (c == '^') {
      if (has_power.back())
        refuse_formula(text, i - 1, "a^b^c needs parentheses: (a^b)^c or a^(b^c)");
      has_power.back() = true;
    }
    last = c;
  }
}

}  // namespace

void check_formula_words(const std::string& text, const std::map<std::string, double>& constants) {
  if (text.size() > kMostCharacters)
    throw Error::input("a formula has at most " + std::to_string(kMostCharacters) + " characters");
  int depth = 0, signs = 0;
  for (size_t i = 0; i < text.size();) {
    const size_t start = i;
    const char c = text[i];
    if (c == '+' || c == '-')
      ++signs;
    else if (c != ' ' && c != '\t' && c != '\n')
      signs = 0;
    if (signs > kMostSigns)
      refuse_formula(text, start, "more than " + std::to_string(kMostSigns) + " signs in a row");
    if (is_digit(text[i]) || text[i] == '.') {
      i = end_of_number(text, i);
      double value = 0;
      const auto [end, error] = std::from_chars(text.data() + start, text.data() + i, value);
      if (error != std::errc() || end != text.data() + i)
        refuse_formula(text, start, quoted(text.substr(start, i - start)) + " is no number");
    } else if (is_letter(text[i])) {
      while (i < text.size() && (is_letter(text[i]) || is_digit(text[i]))) ++i;
      const std::string name = text.substr(start, i - start);
      const size_t next = text.find_first_not_of(" \t\n", i);
      const bool called = next != std::string::npos && text[next] == '(';
      if (called && !is_function(name))
        refuse_formula(text, start, "there is no function '" + name + "'");
      if (!called && is_function(name))
        refuse_formula(text, start, "the function '" + name + "' has its argument in parentheses");
      if (!called && name != "t" && name != "pi" && !constants.contains(name))
        refuse_formula(
            text, start,
            quoted(name) + " is unknown: a formula knows the time t, pi and given constants");
    } else {
      if (static_cast<unsigned char>(text[i]) > 127)
        refuse_formula(text, start, "a formula has no letters beyond a to z, A to Z and _");
      if (std::string("+-*/^(), \t\n").find(text[i]) == std::string::npos)
        refuse_formula(text, start, "a formula has no '" + text.substr(start, 1) + "'");
      // GiNaC 1.8 crashes at "sqrt()".
      const size_t next = text.find_first_not_of(" \t\n", i + 1);
      if (text[i] == '(' && next != std::string::npos && text[next] == ')')
        refuse_formula(text, start, "nothing is in these parentheses");
      depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
      if (depth > kDeepest)
        refuse_formula(text, start,
                       "more than " + std::to_string(kDeepest) + " parentheses are open");
      ++i;
    }
  }
  check_powers(text);
}

DecimalFormula::DecimalFormula(const std::string& formula) {
  for (size_t i = 0; i < formula.size();) {
    const size_t start = i;
    if (is_letter(formula[i])) {
      while (i < formula.size() && (is_letter(formula[i]) || is_digit(formula[i]))) ++i;
    } else if (is_digit(formula[i]) || formula[i] == '.') {
      i = end_of_number(formula, i);
    } else {
      ++i;
    }
    const std::string word = formula.substr(start, i - start);
    const size_t next = formula.find_first_not_of(" \t\n", i);
    const bool whole = word.find_first_not_of("0123456789") == std::string::npos;
    const bool base = next != std::string::npos && formula[next] == '^';
    text += word;
    for (size_t k = start; k < i; ++k) origin.push_back(k);
    if (!whole || (!base && word.size() <= 6)) continue;
    text += ".0";
    origin.resize(text.size(), i - 1);
  }
  origin.push_back(formula.size());
}

std::string Formula::refusal_of_name(const std::string& name) {
  if (name.empty() || !is_letter(name[0]) || name[0] == '_')
    return "the name of a constant begins with a letter";
  for (const char c : name)
    if (!is_letter(c) && !is_digit(c)) return "letters, digits and _ make the name of a constant";
  if (name == "t") return "t is the time";
  if (is_function(name)) return "this is a function";
  for (const char* taken : {"pi", "I", "Pi", "Euler", "Catalan"})
    if (name == taken) return "this name has a meaning in formulas already";
  return "";
}

}  // namespace flexmorph::io
