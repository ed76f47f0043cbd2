#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fem/solve/static_solver.h"
#include "optim/mmc/loads/link_balance.h"
#include "optim/mmc/loads/static_loads.h"
#include "optim/mmc/problem/self_weight.h"

namespace flexmorph::mmc {

/// Computes the forces F(b) of several loads on one plate and their displacements, K(b) u = F(b).
/// Loads are solved one by one or, where compression reduces the work, by fewer right-hand sides:
///
///   one support   f = Σ w F . u depends on Σ w F Fᵀ only; therefore the loads are replaced by
///                 their leading combinations `basis`
///   moving root   forward substitutions are applied to the combinations, loads = `mix` basis, and
///                 displacements are computed for every load
struct LoadSolver {
  fem::StaticSolver solver;  ///< Factorization and solution of the plate.
  InertiaOperator inertia;   ///< Inertia forces of a design.

  /// Balance of the loads of a link (a body of a mechanism between two pins); otherwise absent.
  std::optional<LinkBalance> balance = {};
  /// Weight in every load case of a static plate; absent without gravity.
  std::optional<SelfWeight> weight = {};
  StaticLoads loads = {};  ///< All n loads.

  /// Right-hand sides (r) that are solved instead of the loads; absent without compression.
  std::optional<StaticLoads> basis = {};
  /// Matrix `mix` (n x r) of the moving root, and mixᵀ diag(w) (r x n).
  MatrixXd mix = {}, weighted_mix = {};
  /// Weights w of the loads, and weights of the right-hand sides or loads that U belongs to.
  VectorXd weights = {}, solved_weights = {};
  /// Root columns of the loads, and of the right-hand sides or loads that U belongs to; empty where
  /// no clamp moves.
  std::vector<int> roots = {}, solved_roots = {};
  VectorXd factored = {};  ///< Stiffness scale factors of the current factorization (n_cells).
  int factorizations = 0;  ///< Number of factorizations, with those of the run that is continued.
  /// Checksum of the stiffness scale factors that the continued run has factored last; 0: none.
  /// Their factorization is counted already.
  std::uint64_t counted = 0;

  /// Forces, displacements, weighted displacements and work space that all evaluations use again.
  MatrixXd F = {}, U = {}, Z = {}, work = {};
  /// Displacements u [m] and accelerations a + R c [m/s^2] of a link at all nodes (n x 2 n_nodes).
  MatrixXd u_element = {}, a_link = {};

  /// Creates a solver without loads.
  LoadSolver(fem::StaticSolver of, bool is_link);

  /// Returns the right-hand sides that are solved: the basis, or without compression the loads.
  const StaticLoads& solved() const { return basis ? *basis : loads; }
  /// Factors K at stiffness scale factors (n_cells), unless it is already factored there.
  /// @throws Error (numerical) as StaticSolver::factorize().
  void factorize(const VectorXd& stiffness);
  /// Returns the checksum of the stiffness scale factors of the current factorization; 0: none.
  std::uint64_t factored_checksum() const;
  /// Computes the fixed loads of the definitions `frozen` and `stiffness`. With support `far_end`
  /// they include the nodal forces on the root line, because these forces hold the plate there in
  /// the motion.
  /// @param stiffness0, mass0  scale factors of the design that the motion was computed with
  void fix_loads(const fem::EslSets& sets, const ComplianceSettings& settings,
                 const VectorXd& stiffness0, const VectorXd& mass0);
  /// Selects the right-hand sides that are solved by energies of the uniform full plate,
  /// independently of the design, because combinations without energy there have none in any
  /// design.
  ///
  /// With one support the neglected energy is the error of f and of its gradient, because the
  /// combinations are orthogonal in energy. With a moving root the entries behind each clamp are
  /// cut off, which destroys the orthogonality, and the error is of first order in the neglected
  /// state: the square root of the energy must stay below the tolerance.
  /// @param tolerance  see ComplianceSettings::compression_tolerance
  void compress(double tolerance);

  /// Returns the forces F at mass scale factors (n_cells): (n x n_unknowns), for a link at all
  /// nodes (n x 2 n_nodes) [N].
  const MatrixXd& forces(const StaticLoads& of, const VectorXd& mass);
  /// Solves for U and returns the displacements on which the result of forces() does work: U, for a
  /// link u_element [m].
  const MatrixXd& solve(const MatrixXd& of, std::span<const int> root_columns);
  /// Solves for U of all right-hand sides, with a clamp also for Z with Σ w F . u = Σ F . Z, and
  /// returns Σ w F . u [J].
  double solve_sum(const MatrixXd& of);
  /// Returns Σ w F . u of a plate with a clamp, computed by forward substitutions only [J].
  double forward_sum(const VectorXd& mass);
  /// Copies the values x of the unknowns to all nodes, zero at held displacements (n x 2 n_nodes).
  void to_nodes(const MatrixXd& x, MatrixXd& at_nodes) const;

 private:
  /// Returns the first unknown of a column of nodes, or -1.
  int row_of_column(int i) const { return solver.row(solver.grid().node(i, 0), 0); }
  void to_unknowns(const MatrixXd& at_nodes, MatrixXd& x) const;
  void keep_outside(MatrixXd& field, std::span<const int> columns, bool keep_root_line) const;
  Eigen::Index rows_before(int column) const;
  double plain_sum() const;
  double mixed_sum() const;
};

/// Returns the root column of every load.
std::vector<int> root_columns_of(const fem::EslSets& loads);

}  // namespace flexmorph::mmc
