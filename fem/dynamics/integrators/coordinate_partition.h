#pragma once

#include "fem/model/workspace.h"
#include "fem/solve/factorization/klu_solver.h"
#include "fem/solve/scaled_constraints.h"

namespace flexmorph::fem {

/// A partition of the unknowns into independent and dependent ones, q = (q_i, q_d), such that the
/// constraints determine the dependent ones:
///
///   Φ_qd q̇_d = -Φ_qi q̇_i - Φ_t,   that is  q̇ = B_di q̇_i + b
///
/// The dependent unknowns are the first m pivots of a QR factorization of J with column pivoting
/// (ScaledConstraints: unknowns as displacements, rows of unit size). The constraints are best
/// conditioned for these unknowns, within the limits of a greedy choice. Unknowns that do not occur
/// in any constraint are always independent. Rows that the model leaves out (Model::leave_out())
/// take no part.
///
/// Source: Wehage & Haug (1982), J. Mech. Des. 104, 247-255, with QR in place of their LU.
class CoordinatePartition {
 public:
  /// Chooses a new partition at state x.
  /// @returns true if it differs from the previous partition.
  /// @throws Error (numerical) naming the joints if the constraints are dependent.
  bool choose(Workspace& model, const State& x);

  /// Returns the indices of the independent unknowns (n - m; m is the number of rows that are not
  /// left out), in ascending order.
  const std::vector<int>& independent() const { return independent_; }
  /// Returns the indices of the dependent unknowns (m), in ascending order.
  const std::vector<int>& dependent() const { return dependent_; }

  /// Factors Φ_qd at the state of c, unless it has not changed since the last factorization.
  /// @throws Error (numerical) if Φ_qd is singular or not finite.
  void factorize(const Constraints& c);
  /// Computes out (m) = Φ_qd⁻¹ right with the last factorization, in the order of dependent().
  /// @param right  Right side of all constraint rows (n_constraints); rows that are left out are
  ///               ignored.
  void solve(const VectorXd& right, VectorXd& out) const;
  /// Returns an estimate of ‖Φ_qd⁻¹‖₁ of the last factorize(), scaled like J. Errors of
  /// independent unknowns are amplified by about this factor in dependent ones. It is 1 at best,
  /// and infinite where independent unknowns reach a limit of their motion.
  double amplification() const;
  /// Saves or restores the partition and its factorization (geometry/archive.h).
  void archive(Archive& memory);

 private:
  void number(const Model& model, const Constraints& c);

  std::vector<int> independent_, dependent_, kept_rows_;
  std::vector<int> value_indices_;  // index of each triplet of Φ_q in the matrix; -1: independent
  std::vector<double> weights_;     // scale of each triplet
  VectorXd row_scale_, column_scale_;
  SparseMatrix matrix_;
  VectorXd factored_;  // values of the matrix at the last factorization
  bool is_factored_ = false;
  ScaledConstraints rows_;
  KluSolver lu_;
};

}  // namespace flexmorph::fem
