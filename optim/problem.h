#pragma once

#include "geometry/base.h"

namespace flexmorph::optim {

/// Values and gradients of the functions of a problem at one design.
struct ProblemValues {
  double f = 0;  ///< Objective.
  VectorXd df;   ///< Gradient of the objective (n).
  VectorXd g;    ///< Constraints g <= 0 (m).
  MatrixXd dg;   ///< Gradients of the constraints, one row each (m x n).

  /// First row and number of the constraints that bound the objective by an auxiliary variable,
  /// as f_l - z <= 0 does for f = max f_l. They do not limit the design. The objective that a
  /// design attains is f plus the largest of them (they have the scale of f).
  Eigen::Index first_bound = 0, n_bounds = 0;
};

/// Returns the objective that a design attains, whatever value its auxiliary variable has.
double attained_objective(const ProblemValues& response);
/// Returns the largest violation of a constraint that limits the design, at least 0. Constraints
/// that bound an auxiliary variable do not count.
double design_violation(const ProblemValues& response);

/// The problem: minimize f(x) subject to g(x) <= 0 and lower <= x <= upper.
///
/// The derived class scales variables and functions: a significant change of x, f or g is of the
/// order of 1.
class Problem {
 public:
  virtual ~Problem() = default;

  /// Returns the number of variables n.
  virtual int n_variables() const = 0;
  /// Returns the number of constraints m.
  virtual int n_constraints() const = 0;
  /// Returns the lower bounds of the variables (n), which are finite.
  virtual VectorXd lower() const = 0;
  /// Returns the upper bounds of the variables (n), which are finite.
  virtual VectorXd upper() const = 0;
  /// Returns the start design (n), which lies within the bounds.
  virtual VectorXd start() const = 0;

  /// Computes f, g and their gradients together, because one state solve serves all of them.
  /// @param x  design (n)
  /// @throws Error (numerical) if the state at x cannot be solved.
  virtual ProblemValues evaluate(const VectorXd& x) = 0;

  /// Returns true if the problem has curvature().
  virtual bool has_curvature() const { return false; }
  /// Returns σ ∇²f + Σ λ_i ∇²g_i at x (n x n, symmetric).
  /// @throws Error (numerical) if the state at x cannot be solved; Error (input) if the problem has
  ///         no second derivatives.
  virtual MatrixXd curvature(const VectorXd& /*x*/, double /*sigma*/, const VectorXd& /*lambda*/) {
    throw Error::input("optimizer: the problem has no second derivatives");
  }

  /// Returns true if this design may become an iterate (a disconnected structure may not). It is
  /// called after evaluate() at the same x. If it returns false, an optimizer that can step back
  /// does so.
  virtual bool acceptable(const VectorXd&) { return true; }
};

}  // namespace flexmorph::optim
