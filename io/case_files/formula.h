#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flexmorph::io {

/// The value of a function of time and its first two derivatives at one time.
struct Jet {
  double value = 0, rate = 0, acceleration = 0;  ///< Value, first and second time derivative.
};

/// Functions of time that formulas can use by their names.
struct NamedFunctions {
  /// Value and derivatives of a function at a time [s].
  using Function = std::function<Jet(double)>;

  std::map<std::string, std::string> formulas;  ///< Texts of formulas.

  /// Other functions, such as tables.
  std::map<std::string, std::shared_ptr<const Function>> functions;
};

/// A function of the time t that is given as text, such as "0.5 + 0.1*sin(2*pi*t)^2".
///
/// A formula may contain + - * / ^, parentheses, numbers, the time t, pi, the given constants, and
/// functions of time with names, and
/// the functions sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt. -t^2 means -(t^2); a
/// sign after * / ^ applies only to the next operand (t^-2*3 is (t^-2)*3); a^b^c needs parentheses.
/// The following functions have discontinuities of the value or of a derivative:
///
///   abs(x)  min(x, y)  max(x, y)   step(x)  0 for x < 0, else 1
///   smoothstep(x)                  0 for x < 0, 1 for x > 1, 3 x² - 2 x³ between
///   piecewise(x0, t1, x1, t2, x2)  x0 until the time t1, x1 from there, x2 from t2 on, ...
///
/// At a discontinuity each function has the value that holds after it.
///
/// Rate and acceleration are exact derivatives. The expression graph is differentiated, and value
/// and derivatives become one list of operations on doubles, in which common subexpressions are
/// computed once. Several threads may create and evaluate formulas. Copies are cheap.
class Formula {
 public:
  /// Parses and differentiates a formula.
  /// @param constants  values by name; a name is a word without a meaning in formulas
  /// @param functions  functions of time; rate and acceleration follow from the chain rule. A
  /// formula
  ///                   among them becomes a part of this formula, with its discontinuities
  /// @throws Error (input) with the formula, the position in it if known, and the error: syntax,
  ///         unknown names, formulas that use each other, or values that are no real numbers.
  explicit Formula(std::string text, const std::map<std::string, double>& constants = {},
                   const NamedFunctions& functions = {});

  /// Returns value, rate and acceleration at the time t [s]. It allocates no memory. The results
  /// may be infinite or NaN.
  Jet operator()(double t) const;

  /// Returns the text of the formula.
  const std::string& text() const { return text_; }
  /// Returns the number of operations for value, rate and acceleration together.
  int n_operations() const;

  /// Checks that the formula can prescribe a motion in [0, end] [s].
  /// @throws Error (input) with formula and time when value, rate or acceleration is not finite at
  ///         one of `samples` + 1 equally spaced times or at a discontinuity [s], or when value or
  ///         rate jumps between two of these times (a pole, or the cut of atan2). Jumps at
  ///         discontinuities from discontinuities() are allowed.
  void check(double end, int samples = 1000) const;

  /// Returns the times in (0, end], in ascending order, at which one of the functions with
  /// discontinuities changes its branch. Each is the first double of the new branch [s].
  ///
  /// The argument of each function is sampled at 2001 equally spaced times. Single sign changes
  /// between two samples are found, and pairs of sign changes around one extremum of the argument
  /// near zero. All other pairs of sign changes between two samples are not found.
  /// @throws Error (input) when the search takes more than 1e8 operations.
  std::vector<double> discontinuities(double end) const;

  /// A jump of the value or of the rate at a discontinuity.
  struct Jump {
    double time = 0;               ///< Time of the jump [s].
    bool of_rate = false;          ///< True if the rate jumps, false if the value does.
    double before = 0, after = 0;  ///< Value or rate before and after the jump.
  };
  /// Returns the first jump of value or rate in (0, end]; nothing if the formula and its rate are
  /// continuous.
  std::optional<Jump> first_jump(double end) const;

  /// Returns why a constant cannot have a name; empty if it can.
  static std::string refusal_of_name(const std::string& name);

  /// The list of operations that evaluates a formula, see formula_graph.h.
  struct Program;

 private:
  std::string text_;
  std::shared_ptr<const Program> program_;
};

/// Returns the value of a formula of constants, which does not contain the time.
/// @throws Error (input) as the constructor of Formula does, and for a formula of the time.
double constant_value(const std::string& text, const std::map<std::string, double>& constants);

}  // namespace flexmorph::io
