#pragma once

#include <vector>

#include "optim/mma_subproblem.h"

namespace flexmorph::optim {

/// Mehrotra's predictor-corrector method for MMA subproblems with many constraints.
///
/// Each step solves two systems with the normal matrix
///
///   N = E + Wᵀ W + a aᵀ z/ζ,    W = D^-½ G (n x m),    E = S/Λ + (d + μ/y)^-1 (m, diagonal)
///
/// G holds the gradients of the constraints, D the second derivatives in x including the barrier of
/// the bounds. Typically a hundred constraints contain only few that are close to being active; in
/// the rows of all other constraints E is much larger than the rest of N. Therefore N is never
/// formed. Conjugate gradients solve the systems, preconditioned by the exact block of the close
/// constraints (a symmetric rank-n product of BLAS, factored) and by the diagonal of the remaining
/// ones. If all constraints are close, the block is N itself.
///
/// Sources: Mehrotra (1992), SIAM J. Optim. 2, 575-601. The conditions and the elimination of
/// variables: Svanberg (2007), "MMA and GCMMA, versions September 2007". Omitting constraints from
/// the normal matrix: Tits, Absil & Woessner (2006), SIAM J. Optim. 17, 119-146 (they use the
/// reduced matrix without a correction, this class uses it as a preconditioner).
class PredictorCorrector {
 public:
  /// Creates a solver for subproblems with n variables and m constraints.
  PredictorCorrector(int n, int m);

  /// Computes a point strictly within the bounds that solves the subproblem, or the point at which
  /// the method stopped before convergence. The caller checks the KKT conditions.
  /// @param at  vectors of the right lengths (n), (m) with any values; on return the point
  /// @return number of steps
  int solve(const MmaSubproblem& p, MmaVariables& at);

 private:
  /// Residuals of the linearised complementarity products: target minus present product.
  struct Products {
    Eigen::ArrayXd xi, eta, mu, s;
    double zeta = 0;
  };

  void begin(const MmaSubproblem& p, double product, MmaVariables& at);
  bool attempt(const MmaSubproblem& p, MmaVariables& at, int& steps);
  void functions(const MmaSubproblem& p, const MmaVariables& at);
  void residuals(const MmaSubproblem& p, const MmaVariables& at);
  double infeasibility() const;
  void predict(const MmaVariables& at);
  void correct(double target);
  double largest_product() const;
  double mean_product(const MmaVariables& at, double t) const;

  void normal_matrix(const MmaSubproblem& p, const MmaVariables& at);
  void factor_close(const MmaSubproblem& p, double closeness);
  void precondition();
  bool solve_normal(const MmaSubproblem& p, double tolerance);
  void direction(const MmaSubproblem& p, const MmaVariables& at, double tolerance);
  double longest_step(const MmaVariables& at) const;

  int n_, m_;
  Eigen::ArrayXd to_upp_, to_low_, gap_alpha_, gap_beta_;  // 1/(U-x), 1/(x-L), x-α, β-x
  Eigen::ArrayXd plam_, qlam_, up_, down_;                 // p0 + P λ, q0 + Q λ, work (n)
  Eigen::ArrayXd root_, h_;                                // D^-½, right-hand side in x (n)
  Eigen::ArrayXd in_x_, in_y_, in_g_;  // residuals of the conditions other than products
  double in_z_ = 0;
  Products lacking_;
  VectorXd values_, work_;  // constraint values (m), work (n)
  MmaVariables step_, from_;

  MatrixXd W_;
  VectorXd own_, coupling_;  // E and the diagonal of N - E (m)
  Eigen::ArrayXd inverse_y_;
  double z_over_zeta_ = 1;
  std::vector<int> close_;    // constraints whose block is factored
  MatrixXd W_close_, block_;  // columns of W_ of close_, factor of the block
  VectorXd rhs_, residual_, preconditioned_, conjugate_, image_, part_;  // (m)
};

}  // namespace flexmorph::optim
