#pragma once

#include "geometry/base.h"

namespace flexmorph::optim {

/// Values and gradients at one design.
struct Response {
  double f = 0;  ///< objective
  VectorXd df;   ///< its gradient (n)
  VectorXd g;    ///< constraints g <= 0 (m)
  MatrixXd dg;   ///< their gradients, one row each (m x n)
  /// Rows of g that bound the objective by an auxiliary variable, as f_l - z <= 0 does of
  /// f = max f_l: they limit no design. The objective that a design has is f plus the largest of
  /// them (a constraint of the same scale).
  Eigen::Index first_bound = 0, n_bounds = 0;
};

/// Returns the objective that a design has, whatever its auxiliary variable is.
double attained_objective(const Response& response);
/// Returns the largest violation of a constraint that limits the design, at least 0.
double design_violation(const Response& response);

/// minimize f(x) subject to g(x) <= 0, lower <= x <= upper.
///
/// Variables and functions are expected scaled by their author: x of the order of 1 for a change
/// that matters, f and g likewise.
class Problem {
 public:
  virtual ~Problem() = default;

  virtual int n_variables() const = 0;
  virtual int n_constraints() const = 0;
  virtual VectorXd lower() const = 0;  ///< (n), finite
  virtual VectorXd upper() const = 0;  ///< (n), finite
  virtual VectorXd start() const = 0;  ///< (n), within the bounds

  /// f, g and both gradients together: one state solve serves all of them.
  /// @param x  design (n)
  /// @throws Error (numerical) when the state at x cannot be solved.
  virtual Response evaluate(const VectorXd& x) = 0;

  /// Does it have curvature()?
  virtual bool has_curvature() const { return false; }
  /// σ ∇²f + Σ λ_i ∇²g_i at x (n x n, symmetric).
  /// @throws Error (numerical) as evaluate(); Error (input) where there is none.
  virtual MatrixXd curvature(const VectorXd& /*x*/, double /*sigma*/, const VectorXd& /*lambda*/) {
    throw Error::input("optimizer: the problem has no second derivatives");
  }

  /// May this design be an iterate? (A structure that has come apart may not.) Asked after
  /// evaluate() at the same x; an optimizer that can step back does so when the answer is no.
  virtual bool acceptable(const VectorXd&) { return true; }
};

}  // namespace flexmorph::optim
