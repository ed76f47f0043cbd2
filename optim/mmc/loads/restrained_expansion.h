#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/static_solver.h"
#include "optim/mmc/loads/compliance_evaluator.h"

namespace flexmorph::mmc {

/// The restrained thermal expansion of a plate whose supports do not expand with it, in addition to
/// its other loads.
///
/// Elastic displacements w are measured from the freely expanded plate. Rigid supports therefore
/// prescribe w_c = g τ_c at the held nodes, and K_ff w_f = F_f - K_fc w_c. Let
///
///   w = μ + g τ:   K_ff μ_f = F_f, μ_c = 0   and   K_ff τ_f = -K_fc τ_c
///
/// μ is the response to the loads without heat, and τ is the response to one unit of thermal
/// expansion without loads. Their mutual work is zero, μᵀ K τ = μ_fᵀ (K τ)_f = 0, so that
///
///   wᵀ K w = F_f . μ_f + g² τᵀ K τ,    d(τᵀ K τ) = τᵀ dK τ
///
/// (dτ does not contribute, because τ_f minimizes τᵀ K τ). The first term is the compliance without
/// heat, by whatever method it is computed; this class adds the second term. Its derivative by a
/// stiffness factor is positive: a plate under heat alone is relieved when material is removed. The
/// sum of both derivatives is dU/db = wᵀ K_b w / 2 - μᵀ K_b w + μ_fᵀ dF_f/db of optim/README.md,
/// Hot plates, with U = wᵀ K w / 2.
///
/// The far edge can be restrained as well: it stays straight and keeps its width, but can move as a
/// whole. Springs that do not expand with the plate and have the elongations B w act there
/// (edge_stiffness κ of StaticSolver). Measured like w, each spring across starts with the
/// elongation d = g_e dy. K above is then replaced by K + κ BᵀB, and
///
///   (K + κ BᵀB)_ff τ_f = -K_fc τ_c - κ Bᵀd
///
/// with τᵀ K τ + κ |B τ + d|² instead of τᵀ K τ. τ minimizes this expression, too, and the mutual
/// work of τ and μ is zero. See edge_stiffness().
///
/// Loads whose restrained lines and ratios of restraint are equal share one τ, and therefore one
/// right-hand side.
class RestrainedExpansion {
 public:
  /// The restrained lines (n), and the line and the expansion of every load.
  struct Lines {
    MatrixXd held = {};  ///< τ_c of each line, 0 elsewhere (n x 2 n_nodes) [m].

    /// Clamped column of each line, ascending (n); empty if the plate is held by supports.
    std::vector<int> root_columns = {};
    VectorXd end_stretch = {};      ///< Ratio d / dy of each line (n) [-]; empty: free far edge.
    std::vector<int> of_load = {};  ///< Line of each load (n_loads); -1 for loads with g = 0.
    VectorXd growth = {};           ///< Restrained expansion g of each load (n_loads) [-].
  };
  /// Creates the restrained expansion of a plate.
  /// @param solver   solver of the plate; it must live longer
  /// @param weights  weights w of the loads (n_loads)
  RestrainedExpansion(const fem::StaticSolver& solver, Lines lines, const VectorXd& weights);

  /// Computes τ and its energies, unless the stiffness factors are those of the last call.
  /// @param stiffness  stiffness scale factors (n_cells) for which the solver is factored
  void update(const VectorXd& stiffness);

  // All functions below refer to the last update().

  /// Adds Σ w g² τᵀ K τ and its derivative to a weighted sum of compliances.
  void add_to(ComplianceEvaluator::Value& value) const;
  /// Adds g² τᵀ K τ and its derivative to the compliance of every load.
  void add_to(ComplianceEvaluator::Each& each) const;
  /// Adds g² τᵀ K τ to the compliance of every load (n_loads).
  void add_to(VectorXd& compliances) const;
  /// Returns the nodal displacements g τ of one load (2 n_nodes) [m].
  VectorXd displacement(int load) const;

  /// Subtracts g τ from the displacements u of every load (n_loads x n_unknowns).
  void take_from(MatrixXd& u) const;

  /// Returns the number of restrained lines n.
  int n_lines() const { return static_cast<int>(lines_.held.rows()); }

 private:
  int line_of(Eigen::Index load) const { return lines_.of_load[static_cast<std::size_t>(load)]; }
  bool holds_end() const { return lines_.end_stretch.size() > 0; }
  void forces(const VectorXd& stiffness);
  void add_edge_energies();
  void line_energies();

  const fem::StaticSolver* solver_;
  Lines lines_;
  VectorXd line_weights_;
  std::vector<int> touched_;          // cells with nodes whose τ_c is not zero
  VectorXd stiffness_;                // stiffness factors of the last update (n_cells)
  VectorXd compliances_;              // τᵀ K τ of each line
  MatrixXd forces_, tau_, energies_;  // (n x n_unknowns), (n x 2 n_nodes), (n x n_cells)
};

/// Returns the stiffness κ = 1e3 E c H / dy of the springs that restrain the far edge of a plate,
/// with the length H of the edge and the distance dy of its nodes [N/m]; 0 where no load has
/// EslSet::held_end_stretch.
///
/// The plate acts against the springs like a strip across it with a width of about H / 3, so that
/// an edge of full material yields by 3e-4 of the restrained expansion on every grid. Energies of
/// heat alone are smaller than for a rigid edge by 1e-4, or less where the edge is soft. Round-off
/// errors of displacements under loads grow with κ: on 400 x 40 cells they are 2e-7 (7e-6 for two
/// flanges without a web), and compliances contain their squares. With 100 κ they would be 1e-4
/// (4e-3).
double edge_stiffness(const fem::EslSets& sets, const fem::PlaneSection& section);

/// Returns the expansion of a heated plate that is restrained at its edges: EslSet::held_stretch =
/// g with τ_c = -(0, Y) on the root column of each load, and EslSet::held_end_stretch = g_e at the
/// far edge. The result is empty where both are zero for all loads.
std::optional<RestrainedExpansion> restrained_edges(const fem::EslSets& sets,
                                                    const fem::StaticSolver& solver,
                                                    std::span<const int> columns,
                                                    const VectorXd& weights);

/// Returns e + ρ for one unit of thermal expansion of a static plate (2 n_nodes) [m]: the free
/// expansion about the middle of the plate plus the rigid motion that minimizes the held
/// displacements in the least-squares sense. The result is zero at nodes without a cell of the
/// domain.
VectorXd growth_on_supports(const fem::StaticSolver& solver,
                            std::span<const fem::HeldUnknown> held);

/// Returns the expansion of a heated plate that is restrained by its supports, which prescribe
/// -growth_on_supports() at held displacements times the thermal stretch of each load. The result
/// is empty where the supports permit the free expansion.
/// @param moving_root   growth_on_supports() (2 n_nodes) [m]
/// @param stretch  thermal stretch of each load (n_loads) [-]
/// @param weights  weights of the loads (n_loads)
std::optional<RestrainedExpansion> restrained_supports(const fem::StaticSolver& solver,
                                                       const VectorXd& growth,
                                                       const VectorXd& stretch,
                                                       const VectorXd& weights);

}  // namespace flexmorph::mmc
