#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

namespace flexmorph::io {

/// A function of time with its first two derivatives, at one time.
struct Jet {
  double value = 0, rate = 0, acceleration = 0;
};

/// A function of the time t as a person writes it, "0.5 + 0.1*sin(2*pi*t)^2".
///
/// Known are + - * / ^, parentheses, numbers, the time t, pi, the constants that are given, and sin
/// cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt abs. a^b^c needs parentheses.
///
/// Rate and acceleration are exact derivatives: GiNaC differentiates the expression, and value and
/// derivatives become one list of operations on doubles, in which whatever they share is computed
/// once. GiNaC is used by the constructor only, so formulas may be evaluated in several threads,
/// but not made in several at once. Copies are cheap.
class Formula {
 public:
  /// @param constants  by name; a name is a word, and none that the formula knows already
  /// @throws Error (input) naming the formula, the place in it where it is known, and what is wrong
  ///         with it: syntax, unknown names, values that are no real numbers.
  explicit Formula(std::string text, const std::map<std::string, double>& constants = {});

  /// Allocates nothing. Not finite where the formula is not.
  Jet operator()(double t) const;

  const std::string& text() const { return text_; }
  int n_operations() const;  ///< of value, rate and acceleration together

  /// Looks for times in [0, end] at which a motion cannot go on.
  /// @throws Error (input) naming formula and time when value, rate or acceleration is not finite
  ///         at one of `samples` + 1 equally spaced times [s], or when value or rate jumps between
  ///         two of them (a pole, a corner, the cut of atan2).
  void check(double end, int samples = 1000) const;

  /// Why a constant cannot have this name; empty when it can.
  static std::string refusal_of_name(const std::string& name);

 private:
  struct Program;
  std::string text_;
  std::shared_ptr<const Program> program_;
};

}  // namespace flexmorph::io
