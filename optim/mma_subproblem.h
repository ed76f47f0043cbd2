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
/// n variables x, m constraints; y and z are artificial (they keep it feasible). Needs
/// low < alpha < beta < upp entry by entry, p0, q0, P, Q >= 0, a0 > 0, c > 0, d >= 0.
///
/// Source: Svanberg (1987), IJNME 24, 359-373; (2007), "MMA and GCMMA, versions September 2007".
struct MmaSubproblem {
  VectorXd low, upp, alpha, beta;  ///< (n) asymptotes L, U and bounds
  VectorXd p0, q0;                 ///< (n)
  MatrixXd P, Q;                   ///< (n x m): one column per constraint
  double a0 = 1;
  VectorXd a, b, c, d;  ///< (m)
};

struct MmaSolution {
  VectorXd x, y;  ///< (n), (m)
  double z = 0;
  VectorXd lambda;  ///< multipliers (m)
  double kkt = 0;   ///< largest KKT residual of the subproblem
  int newton_steps = 0;
  bool solved = false;  ///< the residual is below 1e-6
};

/// Primal and dual variables; ξ, η, μ, ζ belong to alpha, beta, y >= 0, z >= 0, s is the slack.
struct MmaVariables {
  VectorXd x, xi, eta;        // (n)
  VectorXd y, mu, lambda, s;  // (m)
  double z = 1, zeta = 1;

  void resize(int n, int m);
  void set(const MmaVariables& from, double t, const MmaVariables& step);  ///< from + t step
};

class PredictorCorrector;

/// Primal-dual interior point methods. Holds all work arrays: one solver serves all iterations.
///
/// Many constraints: Mehrotra's predictor-corrector method. Few of them, or when that one comes to
/// a halt: Newton's method on the KKT conditions with complementarity products relaxed to ε, for
/// ε = 1, 0.1, ... 1e-9; x, the bound multipliers, y and z are eliminated, which leaves one
/// symmetric positive definite system of m equations per step.
class MmaSolver {
 public:
  MmaSolver(int n, int m);
  ~MmaSolver();

  /// A subproblem that stays unsolved still returns its last point, strictly within its bounds.
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

  int n_, m_;
  MmaVariables at_, from_, step_;
  Eigen::ArrayXd to_upp_, to_low_, to_beta_, to_alpha_;  // 1/(U-x), 1/(x-L), 1/(β-x), 1/(x-α)
  Eigen::ArrayXd plam_, qlam_, slope_;                   // p0 + P λ, q0 + Q λ, dψ/dx
  Eigen::ArrayXd dx_, diagonal_, work_;
  VectorXd values_, r_m_, inverse_y_;  // constraint values; (m) work
  MatrixXd G_, weighted_, normal_;     // dg/dx (n x m), D^-1 G, the system of Newton's method
  Eigen::LLT<MatrixXd> factor_;
  std::unique_ptr<PredictorCorrector> predictor_corrector_;  // of many constraints
  MmaSolution solution_;
};

}  // namespace flexmorph::optim
