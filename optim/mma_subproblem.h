#pragma once

#include <Eigen/Cholesky>
#include <memory>

#include "geometry/base.h"

namespace flexmorph::optim {

/// The convex, separable subproblem of the method of moving asymptotes:
///
///   min   Σ_j p0_j / (U_j - x_j) + q0_j / (x_j - L_j) + a0 z + Σ_i (c_i y_i + d_i y_i² / 2)
///   s.t.  Σ_j P_ji / (U_j - x_j) + Q_ji / (x_j - L_j) - a_i z - y_i <= b_i
///         alpha_j <= x_j <= beta_j,   y_i >= 0,   z >= 0
///
/// It has n variables x and m constraints; the artificial variables y and z keep it feasible. It
/// requires low < alpha < beta < upp entry by entry, p0, q0, P, Q >= 0, a0 > 0, c > 0, d >= 0.
///
/// Source: Svanberg (1987), IJNME 24, 359-373; (2007), "MMA and GCMMA, versions September 2007".
struct MmaSubproblem {
  VectorXd low, upp, alpha, beta;  ///< Asymptotes L and U, lower and upper bounds of x (n).
  VectorXd p0, q0;                 ///< Coefficients of the objective (n).
  MatrixXd P, Q;                   ///< Coefficients of the constraints (n x m), one column each.
  double a0 = 1;                   ///< Weight of z in the objective.
  VectorXd a, b, c, d;             ///< Coefficients of z, bounds, weights of y and of y²/2 (m).
};

/// The solution of a subproblem of the method of moving asymptotes.
struct MmaSolution {
  VectorXd x, y;         ///< Primal variables (n) and artificial variables (m).
  double z = 0;          ///< Artificial variable common to all constraints.
  VectorXd lambda;       ///< Multipliers of the constraints (m).
  double kkt = 0;        ///< Largest KKT residual of the subproblem.
  int newton_steps = 0;  ///< Number of steps of the interior point methods.
  bool solved = false;   ///< True if the largest KKT residual is at most 1e-6.
};

/// Primal and dual variables of the subproblem, or a step of them.
struct MmaVariables {
  VectorXd x, xi, eta;        ///< Variables x, multipliers ξ of alpha and η of beta (n).
  VectorXd y, mu, lambda, s;  ///< Variables y, multipliers μ of y >= 0 and λ, slacks s (m).
  double z = 1, zeta = 1;     ///< Variable z and the multiplier ζ of z >= 0.

  /// Sets the sizes for n variables and m constraints, and all vectors to zero.
  void resize(int n, int m);
  /// Sets the variables to from + t step.
  void set(const MmaVariables& from, double t, const MmaVariables& step);
};

class PredictorCorrector;

/// A primal-dual interior point solver of MMA subproblems. It owns all work arrays, so that one
/// solver serves all iterations of an optimizer.
///
/// With many constraints it uses Mehrotra's predictor-corrector method. With few constraints, or if
/// the predictor-corrector method stops before it has converged, it uses Newton's method on the KKT
/// conditions with the complementarity products relaxed to ε, for ε = 1, 0.1, ... 1e-9. The
/// variables x, the bound multipliers, y and z are eliminated; each step then solves one symmetric
/// positive definite system of m equations.
class MmaSolver {
 public:
  /// Creates a solver for subproblems with n variables and m constraints.
  MmaSolver(int n, int m);
  ~MmaSolver();

  /// Solves a subproblem and returns the solution, which stays valid until the next call. If the
  /// solver does not converge, it returns its last point, which lies strictly within the bounds.
  const MmaSolution& solve(const MmaSubproblem& subproblem);

 private:
  struct Residual {
    double norm = 0, largest = 0;
  };

  void begin(const MmaSubproblem& p);
  void follow_barrier(const MmaSubproblem& p);
  void measure_kkt(const MmaSubproblem& p);
  void refresh(const MmaSubproblem& p);
  Residual residual(const MmaSubproblem& p, double epsilon);
  void newton_direction(const MmaSubproblem& p, double epsilon);
  double longest_step() const;
  void stage(const MmaSubproblem& p, double epsilon);

  [[maybe_unused]] int n_;  // read by assertions only
  int m_;
  MmaVariables at_, from_, step_;
  Eigen::ArrayXd to_upp_, to_low_, to_beta_, to_alpha_;  // 1/(U-x), 1/(x-L), 1/(β-x), 1/(x-α)
  Eigen::ArrayXd plam_, qlam_, slope_;                   // p0 + P λ, q0 + Q λ, dψ/dx
  Eigen::ArrayXd dx_, diagonal_, work_;
  VectorXd values_, r_m_, inverse_y_;  // constraint values (m), work arrays (m)
  MatrixXd G_, weighted_, normal_;     // dg/dx (n x m), D^-1 G (n x m), system (m x m)
  Eigen::LLT<MatrixXd> factor_;
  std::unique_ptr<PredictorCorrector> predictor_corrector_;  // null if m is small
  MmaSolution solution_;
};

}  // namespace flexmorph::optim
