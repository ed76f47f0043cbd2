#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fem/solve/static_solver.h"
#include "optim/mmc/loads/link_balance.h"
#include "optim/mmc/loads/static_loads.h"
#include "optim/mmc/problem/self_weight.h"

namespace flexmorph::mmc {

/// Forces F(b) of load sets on one plate and their displacements, K(b) u = F(b). Loads are solved
/// one by one, or, where compression pays, by fewer right-hand sides:
///
///   one support   f = Σ w F . u depends on Σ w F Fᵀ only: the leading combinations `basis` of the
///                 loads replace them
///   moving root   the combinations take the forward substitutions, loads = `mix` basis, and every
///                 load has its displacements
struct LoadSolver {
  fem::StaticSolver solver;
  InertiaOperator inertia;
  std::optional<LinkBalance> balance = {};     ///< of a link
  std::optional<SelfWeight> weight = {};       ///< acts in every load case of a plate at rest
  StaticLoads loads = {};                      ///< all of them
  std::optional<StaticLoads> basis = {};       ///< what is solved instead
  MatrixXd mix = {}, weighted_mix = {};        ///< (n x r), and mixᵀ diag(w) (r x n)
  VectorXd weights = {}, solved_weights = {};  ///< w of the loads; of those that U is of
  /// Root column of the loads, and of those that U is of; empty where no clamp moves.
  std::vector<int> roots = {}, solved_roots = {};
  VectorXd factored = {};  ///< stiffness scale factors the solver holds
  int factorizations = 0;
  MatrixXd F = {}, U = {}, Z = {}, work = {};  ///< reused by every evaluation
  MatrixXd u_link = {}, a_link = {};  ///< of a link at all nodes (n x 2 n_nodes): u, a + R c

  LoadSolver(fem::StaticSolver of, bool is_link);

  const StaticLoads& solved() const { return basis ? *basis : loads; }
  /// Factors K at these stiffness scale factors, unless the solver holds them.
  /// @throws Error (numerical) as StaticSolver::factorize().
  void factorize(const VectorXd& stiffness);
  /// Makes the loads of the definitions `frozen` and `stiffness`. With the far end held, the nodal
  /// forces on the root line belong to them: they are what holds the plate there in the motion.
  void fix_loads(const fem::EslSets& sets, const ComplianceSettings& settings,
                 const VectorXd& stiffness0, const VectorXd& mass0);
  /// Chooses what is solved by the energies of the uniform full plate, whatever the design: a mode
  /// that costs nothing there costs nothing in a part of it.
  ///
  /// With one support the left-out energy is the error of f and of its gradient, because the
  /// combinations are orthogonal in energy. With a moving root the parts cut off destroy that
  /// orthogonality and the error is of first order in the left-out state: the square root of the
  /// energy must stay below the tolerance.
  void compress(double tolerance);

  /// Returns F at these mass scale factors (n x n_unknowns); of a link all forces (n x 2 n_nodes).
  const MatrixXd& forces(const StaticLoads& of, const VectorXd& mass);
  /// Solves for U. Returns the displacements that forces() does work on, U or u_link.
  const MatrixXd& solve(const MatrixXd& of, std::span<const int> root_columns);
  /// Solves for U of all right-hand sides, and with a clamp Z, Σ w F . u = Σ F . Z.
  /// Returns Σ w F . u.
  double solve_sum(const MatrixXd& of);
  /// Returns Σ w F . u of a plate with a clamp by forward substitutions alone.
  double forward_sum(const VectorXd& mass);
  /// Displacements of the unknowns x at all nodes, zero where held (n x 2 n_nodes).
  void to_nodes(const MatrixXd& x, MatrixXd& at_nodes) const;

 private:
  /// First unknown of a column of nodes, or -1.
  int row_of_column(int i) const { return solver.row(solver.grid().node(i, 0), 0); }
  void to_unknowns(const MatrixXd& at_nodes, MatrixXd& x) const;
  void keep_outside(MatrixXd& field, std::span<const int> columns, bool keep_root_line) const;
  Eigen::Index rows_before(int column) const;
  double plain_sum() const;
  double mixed_sum() const;
};

/// Root column of every load set.
std::vector<int> root_columns_of(const fem::EslSets& loads);

}  // namespace flexmorph::mmc
