#pragma once

#include <span>
#include <vector>

#include "fem/esl_set.h"
#include "fem/section.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// The dependence of equivalent static loads on a changing design (optim/README.md, Load
/// definitions).
enum class LoadDefinition { inertia, frozen, stiffness };
/// The support of a plate under equivalent static loads: a clamp at the moving root or at the far
/// end, or, for a link (a body of a mechanism between two pins), the balance of LinkBalance.
enum class Support { moving_root, far_end, pins, floating };
/// Returns true if a support is one of links between two pins.
constexpr bool is_of_link(Support s) { return s == Support::pins || s == Support::floating; }

/// Settings of the compliance under equivalent static loads.
struct ComplianceSettings {
  LoadDefinition loads = LoadDefinition::inertia;  ///< Dependence of the loads on the design.
  Support support = Support::moving_root;          ///< Support of the plate.

  /// True to replace the loads by their leading singular vectors where this reduces the work.
  bool compress = true;
  /// Fraction of the energy that compression may neglect where all loads have one support [-]. With
  /// a moving root it bounds the square root of this fraction, because the error is then of first
  /// order in the neglected state.
  double compression_tolerance = 1e-10;
};

/// Several loads of one plate, which depend on the design by F(b) = -M(b) a + f or are fixed.
///
/// Rows are loads. Columns of F are the unknowns of a solver, or all displacements of a link (x and
/// y of a node next to each other), so that the values of all loads at one displacement are
/// contiguous.
struct StaticLoads {
  MatrixXd acceleration;   ///< Accelerations a (n x 2 n_nodes) [m/s^2]; empty for fixed loads.
  std::vector<int> slots;  ///< Columns of F with concentrated forces (n_slots).
  MatrixXd slot_forces;    ///< Concentrated forces f (n x n_slots) [N].
  MatrixXd fixed;  ///< Fixed loads F (n x n_rows) [N]; empty for loads that follow the design.

  /// Returns the number of loads n.
  Eigen::Index size() const { return follows_design() ? acceleration.rows() : fixed.rows(); }
  /// Returns true if the loads depend on the design.
  bool follows_design() const { return fixed.size() == 0; }
};

/// Returns the loads -M(b) a + f of all equivalent static loads of a body.
/// @param rows  index of every displacement in F (2 n_nodes); -1: it is held
StaticLoads inertia_loads(const fem::EslSets& sets, std::span<const int> rows);

/// Returns r linear combinations of n loads.
/// @param combination  coefficients (r x n)
StaticLoads combine(const MatrixXd& combination, const StaticLoads& loads);

/// The consistent mass matrix of a design, for inertia forces and their derivatives.
class InertiaOperator {
 public:
  /// Creates the operator of a plate.
  /// @param rows  index of every displacement in F and z (2 n_nodes), x and y of a node next to
  ///        each other; -1: it is held
  InertiaOperator(const Grid& grid, const fem::PlaneSection& section, std::vector<int> rows);

  /// Returns the index of every displacement in F (2 n_nodes); -1: it is held.
  std::span<const int> rows() const { return rows_; }
  /// Computes the forces F = -M(mass) a + f of loads that follow the design (n x n_rows) [N].
  /// @param mass  mass scale factors (n_cells)
  void forces(const StaticLoads& loads, const VectorXd& mass, MatrixXd& F) const;

  /// Computes Σ_l z_l . M_cell a_l with the mass matrix of a full cell for every cell (n_cells).
  /// @param z  vectors (n x n_rows)
  /// @param a  accelerations (n x 2 n_nodes)
  void products(const MatrixXd& z, const MatrixXd& a, VectorXd& product) const;
  /// Computes z_l . M_cell a_l with the mass matrix of a full cell for every load and cell
  /// (n x n_cells).
  void products(const MatrixXd& z, const MatrixXd& a, MatrixXd& product) const;

 private:
  int row(int node) const { return rows_[2 * static_cast<std::size_t>(node)]; }
  template <class Use>
  void each_product(const MatrixXd& z, const MatrixXd& a, Use use) const;

  Grid grid_;
  fem::PlaneSection section_;
  Eigen::Matrix4d cell_mass_;
  std::vector<int> rows_;
  int n_rows_ = 0;
  mutable VectorXd held_, product_of_load_;
};

/// Returns few orthonormal combinations of rows that approximate all rows: y ≈ U Uᵀ y.
///
/// @param y  weighted states L⁻¹ F sqrt(w) (n x n_unknowns), whose squares are energies
/// @param tolerance  fraction of Σ y² that may be neglected [-]
/// @returns U (n x r), the leading left singular vectors of y. They are computed by a QR
///          decomposition instead of the Gram matrix, whose eigenvalues would be noise below 1e-16
///          of the energy.
MatrixXd leading_combinations(const MatrixXd& y, double tolerance);

}  // namespace flexmorph::mmc
