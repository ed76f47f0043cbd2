#pragma once

#include "fem/model/workspace.h"
#include "fem/solve/factorization/klu_solver.h"
#include "fem/solve/scaled_constraints.h"

namespace flexmorph::fem {

/// Parts the unknowns into independent and dependent ones, q = (q_i, q_d), so that the constraints
/// determine the latter:
///
///   Φ_qd q̇_d = -Φ_qi q̇_i - Φ_t,   that is  q̇ = B_di q̇_i + b
///
/// The dependent unknowns are the first m pivots of the QR factorization of J (ScaledConstraints:
/// unknowns as displacements, rows of unit size) with column pivoting: those in which the
/// constraints are the best to solve, as far as a greedy choice goes. Unknowns that no constraint
/// acts on are independent always.
///
/// Source: Wehage & Haug (1982), J. Mech. Des. 104, 247-255, with QR in place of their LU.
class CoordinatePartition {
 public:
  /// Parts the unknowns anew at a state.
  /// @returns whether the parts differ from those before.
  /// @throws Error (numerical) when the constraints are dependent, with the joints.
  bool choose(Workspace& model, const State& x);

  const std::vector<int>& independent() const { return independent_; }  ///< (n - m), ascending
  const std::vector<int>& dependent() const { return dependent_; }      ///< (m), ascending

  /// Factors Φ_qd at the state of c; nothing is done where it is what it was.
  /// @throws Error (numerical) when it is singular or not finite.
  void factorize(const Constraints& c);
  /// out (m) = Φ_qd⁻¹ right (m) with the last factor, in the order of dependent().
  void solve(const VectorXd& right, VectorXd& out) const;
  /// Estimate of ‖Φ_qd⁻¹‖₁ of the last factorize(), scaled as J: about what errors of independent
  /// unknowns grow by in dependent ones. 1 at best; infinite where independent unknowns stop.
  double amplification() const;
  void remember(Memory& memory);

 private:
  void number(const Model& model, const Constraints& c);

  std::vector<int> independent_, dependent_;
  std::vector<int> places_;      // in the matrix, of the triplets of Φ_q; -1: independent unknown
  std::vector<double> weights_;  // scale of each triplet, and of rows and columns
  VectorXd row_scale_, column_scale_;
  SparseMatrix matrix_;
  VectorXd factored_;  // values of the matrix that the factor belongs to
  bool is_factored_ = false;
  ScaledConstraints rows_;
  KluSolver lu_;
};

}  // namespace flexmorph::fem
