#pragma once

#include <map>
#include <string>
#include <vector>

/// Formulas as texts: what io/formula.cpp looks at before GiNaC does.
namespace flexmorph::io {

using FormulaFunction = double (*)(double);
/// Functions of one argument that a formula knows, by name.
const std::map<std::string, FormulaFunction>& formula_functions();

/// @throws Error (input): "formula '<text>': <why>".
[[noreturn]] void refuse_formula(const std::string& text, const std::string& why);
/// @param position  of the offending character, counted from 0
[[noreturn]] void refuse_formula(const std::string& text, size_t position, const std::string& why);

/// Refuses what GiNaC would read in another way than a person means it, or say without a place:
/// strange characters, numbers, unknown names, among them GiNaC's own I, Pi, Euler.
void check_formula_words(const std::string& text, const std::map<std::string, double>& constants);

/// The text as GiNaC gets it, and where its characters come from. Whole numbers are exact to
/// GiNaC, and 9^(9^9) would be written out: bases of powers and large numbers become decimal.
struct DecimalFormula {
  explicit DecimalFormula(const std::string& formula);

  std::string text;
  std::vector<size_t> origin;  ///< of every character, and of the end
};

}  // namespace flexmorph::io
