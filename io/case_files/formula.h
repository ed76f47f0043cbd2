#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flexmorph::io {

/// A function of time with its first two derivatives, at one time.
struct Jet {
  double value = 0, rate = 0, acceleration = 0;
};

/// A function of the time t as a person writes it, "0.5 + 0.1*sin(2*pi*t)^2".
///
/// Known are + - * / ^, parentheses, numbers, the time t, pi, the constants that are given, and sin
/// cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt. -t^2 is -(t^2), a sign behind * / ^
/// belongs to the next operand only (t^-2*3 is (t^-2)*3), and a^b^c needs parentheses. With kinks:
///
///   abs(x)  min(x, y)  max(x, y)   step(x)  0 for x < 0, else 1
///   smoothstep(x)                  0 for x < 0, 1 for x > 1, 3 x² - 2 x³ between
///   piecewise(x0, t1, x1, t2, x2)  x0 until the time t1, x1 from there, x2 from t2 on, ...
///
/// At a kink all of them are what they are behind it.
///
/// Rate and acceleration are exact derivatives: the expression graph is differentiated, and value
/// and derivatives become one list of operations on doubles, in which whatever they share is
/// computed once. Formulas may be made and evaluated in several threads. Copies are cheap.
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
  ///         at one of `samples` + 1 equally spaced times or at a kink [s], or when value or rate
  ///         jumps between two of them (a pole, the cut of atan2): jumps at kinks are allowed.
  void check(double end, int samples = 1000) const;

  /// Times in (0, end], in order, at which one of the functions with kinks goes on with another
  /// branch: each the first double of the new branch [s]. Arguments change their sign between two
  /// of 2001 equally spaced times, or twice where they have one extreme next to zero between; two
  /// changes nearer to each other that have none are not found.
  /// @throws Error (input) where finding them takes more than 1e8 operations.
  std::vector<double> kinks(double end) const;

  /// A jump at a kink.
  struct Jump {
    double time = 0;  ///< [s]
    bool of_rate = false;
    double before = 0, after = 0;  ///< value, or rate
  };
  /// The first jump of value or rate; none where the formula is continuous with its rate.
  std::optional<Jump> first_jump(double end) const;

  /// Why a constant cannot have this name; empty when it can.
  static std::string refusal_of_name(const std::string& name);

  struct Program;  ///< the list of operations

 private:
  std::string text_;
  std::shared_ptr<const Program> program_;
};

}  // namespace flexmorph::io
