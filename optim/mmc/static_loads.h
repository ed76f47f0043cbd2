#pragma once

#include <span>

#include "fem/esl_set.h"
#include "fem/solve/static_solver.h"

namespace flexmorph::mmc {

/// Several loads of one plate: F(b) = -M(b) a + f, or fixed ones.
///
/// Rows are loads, columns unknowns (x and y of a node next to each other), so that the values of
/// all loads at one unknown are contiguous.
struct StaticLoads {
  MatrixXd acceleration;   ///< a (n x 2 n_nodes) [m/s^2]; empty when fixed
  std::vector<int> slots;  ///< unknowns that carry concentrated forces
  MatrixXd slot_forces;    ///< f at these (n x n_slots) [N]
  MatrixXd fixed;          ///< F (n x n_unknowns) [N]; empty when loads follow the design

  Eigen::Index size() const { return follows_design() ? acceleration.rows() : fixed.rows(); }
  bool follows_design() const { return fixed.size() == 0; }
};

/// a and f of all sets, for an operator of consistent mass.
StaticLoads inertia_loads(const fem::EslSets& sets, const fem::StaticSolver& solver);

/// rows * loads: every part of the loads combined (combination (r x n)).
StaticLoads combine(const MatrixXd& combination, const StaticLoads& loads);

/// Consistent mass of the design between nodes of the grid and unknowns of the solver.
class InertiaOperator {
 public:
  InertiaOperator(const fem::StaticSolver& solver, const fem::PlaneSection& section);

  /// F = -M(mass factors (n_cells)) a + f, or the fixed loads (n x n_unknowns).
  void forces(const StaticLoads& loads, const VectorXd& mass, MatrixXd& F) const;

  /// Σ_l z_l . M_cell a_l of full mass for every cell (n_cells).
  /// @param z  (n x n_unknowns), zero at held nodes   @param a  (n x 2 n_nodes)
  void products(const MatrixXd& z, const MatrixXd& a, VectorXd& product) const;

 private:
  const fem::StaticSolver& solver_;
  fem::PlaneSection section_;
  Eigen::Matrix4d cell_mass_;
  mutable VectorXd held_, product_of_load_;
};

/// Orthonormal combinations of few rows that hold all rows: y ≈ U Uᵀ y.
///
/// @param y  weighted states L⁻¹ F sqrt(w) (n x n_unknowns), whose squares are energies
/// @param tolerance  part of Σ y² that may be left out
/// @returns U (n x r), the leading left singular vectors of y. They come from a QR decomposition,
///          not from the Gram matrix, whose eigenvalues would be noise below 1e-16 of the energy.
MatrixXd leading_combinations(const MatrixXd& y, double tolerance);

}  // namespace flexmorph::mmc
