#pragma once

#include <span>
#include <vector>

#include "fem/esl_set.h"
#include "fem/section.h"
#include "geometry/grid.h"

namespace flexmorph::mmc {

/// How the equivalent static loads meet a changing design (optim/README.md, Load definitions).
enum class LoadDefinition { inertia, frozen, stiffness };
/// Where the plate is held: at its root, or, as a link between two pins, see LinkBalance.
enum class Support { moving_root, far_end, pins, floating };
constexpr bool is_of_link(Support s) { return s == Support::pins || s == Support::floating; }

struct ComplianceSettings {
  LoadDefinition loads = LoadDefinition::inertia;
  Support support = Support::moving_root;
  bool compress = true;  ///< replace the loads by their leading singular vectors where it pays
  /// Part of the energy that may be left out where all loads share one support; with a moving root,
  /// where what is left out counts in first order, of its square root.
  double compression_tolerance = 1e-10;
};

/// Several loads of one plate: F(b) = -M(b) a + f, or fixed ones.
///
/// Rows are loads. Columns of F are the unknowns of a solver, or all displacements of a link (x and
/// y of a node next to each other), so that the values of all loads at one of them are contiguous.
struct StaticLoads {
  MatrixXd acceleration;   ///< a (n x 2 n_nodes) [m/s^2]; empty when fixed
  std::vector<int> slots;  ///< columns of F that carry concentrated forces
  MatrixXd slot_forces;    ///< f at these (n x n_slots) [N]
  MatrixXd fixed;          ///< F (n x n_rows) [N]; empty when loads follow the design

  Eigen::Index size() const { return follows_design() ? acceleration.rows() : fixed.rows(); }
  bool follows_design() const { return fixed.size() == 0; }
};

/// a and f of all sets. @param rows  place of every displacement in F (2 n_nodes); -1: it is held
StaticLoads inertia_loads(const fem::EslSets& sets, std::span<const int> rows);

/// Every part of the loads combined: combination (r x n) times loads.
StaticLoads combine(const MatrixXd& combination, const StaticLoads& loads);

/// Consistent mass of a design: inertia forces and their derivatives.
class InertiaOperator {
 public:
  /// @param rows  place of every displacement in F and z (2 n_nodes), x and y of a node next to
  /// each
  ///        other; -1: it is held
  InertiaOperator(const Grid& grid, const fem::PlaneSection& section, std::vector<int> rows);

  std::span<const int> rows() const { return rows_; }
  /// F = -M(mass factors (n_cells)) a + f of loads that follow the design (n x n_rows).
  void forces(const StaticLoads& loads, const VectorXd& mass, MatrixXd& F) const;

  /// Σ_l z_l . M_cell a_l of full mass for every cell (n_cells).
  /// @param z  (n x n_rows), zero at held nodes   @param a  (n x 2 n_nodes)
  void products(const MatrixXd& z, const MatrixXd& a, VectorXd& product) const;
  /// z_l . M_cell a_l of full mass for every load and cell (n x n_cells).
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

/// Orthonormal combinations of few rows that hold all rows: y ≈ U Uᵀ y.
///
/// @param y  weighted states L⁻¹ F sqrt(w) (n x n_unknowns), whose squares are energies
/// @param tolerance  part of Σ y² that may be left out
/// @returns U (n x r), the leading left singular vectors of y. They come from a QR decomposition,
///          not from the Gram matrix, whose eigenvalues would be noise below 1e-16 of the energy.
MatrixXd leading_combinations(const MatrixXd& y, double tolerance);

}  // namespace flexmorph::mmc
