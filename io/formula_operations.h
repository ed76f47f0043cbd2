#pragma once

#include <array>
#include <string>
#include <vector>

#include "io/formula.h"
#include "io/formula_words.h"

namespace flexmorph::io {

constexpr size_t kMostOperations = 8192;  // of value, rate and acceleration together

/// What one step of a formula does.
enum class Op { constant, time, add, multiply, whole_power, power, call, atan2, choose };

/// One step; results have the numbers of the steps.
struct Operation {
  Op op;
  int a = 0, b = 0;  // operations whose results it takes; choose: b where a >= 0, else c
  int c = 0;
  double number = 0;  // constant
  int exponent = 0;   // whole_power
  FormulaFunction call = nullptr;
};

/// Operations in the order of evaluation; the result of each has its number.
struct Formula::Program {
  std::vector<Operation> operations;
  std::array<int, 3> results{};  // value, rate, acceleration

  /// @param x  results of all operations at t; room for them
  void run(double t, double* x) const;
};

/// Appends the first two time derivatives of the operation `value`, by the chain rule from one
/// operation to the next (automatic differentiation, forward): a bounded number of operations for
/// each that `value` needs, also where the derivatives as expressions would be far longer.
/// @returns value, rate and acceleration. @throws Error (input) naming the formula: too long.
std::array<int, 3> append_derivatives(const std::string& text, int value,
                                      std::vector<Operation>& operations);

/// @throws Error (input) naming the formula: more than kMostOperations.
[[noreturn]] void refuse_as_too_long(const std::string& text);

}  // namespace flexmorph::io
