#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/static_solver.h"
#include "optim/mmc/loads/compliance_evaluator.h"

namespace flexmorph::mmc {

/// Restrained thermal expansion: what heat does to a plate whose supports do not grow with it,
/// beside its other loads.
///
/// Elastic displacements w are counted from the plate as it would be had it grown freely, so that
/// supports that stay as they are prescribe w_c = g τ_c at the held nodes, and K_ff w_f = F_f -
/// K_fc w_c. Let
///
///   w = μ + g τ:   K_ff μ_f = F_f, μ_c = 0   and   K_ff τ_f = -K_fc τ_c
///
/// μ is the answer to the loads without heat, τ that to one unit of growth without loads, which
/// the loads have no part in. Neither does work on the other, μᵀ K τ = μ_fᵀ (K τ)_f = 0, so that
///
///   wᵀ K w = F_f . μ_f + g² τᵀ K τ,    d(τᵀ K τ) = τᵀ dK τ
///
/// (τ_f makes τᵀ K τ least: dτ adds nothing). The first term is the compliance without heat,
/// whatever way it is found; this class adds the second one. Its derivative has the sign that
/// K has: taking material off a plate that is only hot relieves it. The sum of both derivatives is
/// dU/db = wᵀ K_b w / 2 - μᵀ K_b w + μ_fᵀ dF_f/db of optim/README.md, Hot plates, U = wᵀ K w / 2.
///
/// The far edge may be held too, straight and as wide as it is, wherever it goes: by springs that
/// do not grow with the plate, of elongations B w (StaticSolver's edge_stiffness κ). Counted like w
/// those across start too long by d = g_e dy each, K above is everywhere K + κ BᵀB, but
///
///   (K + κ BᵀB)_ff τ_f = -K_fc τ_c - κ Bᵀd
///
/// with τᵀ K τ + κ |B τ + d|² in place of τᵀ K τ: τ makes this least, too, and its work with μ is
/// zero as before. See edge_stiffness().
///
/// Loads that hold the same lines in the same ratio share τ: however many there are, that is one
/// right-hand side.
class RestrainedExpansion {
 public:
  /// The held lines (n of them), and what every load has of them.
  struct Lines {
    MatrixXd held = {};                  ///< τ_c of each line, 0 elsewhere (n x 2 n_nodes) [m]
    std::vector<int> root_columns = {};  ///< clamp of each line, ascending (n); empty: supports
    VectorXd end_stretch = {};           ///< d / dy of each line (n); empty: the far edge is free
    std::vector<int> of_load = {};       ///< line of each load; -1 for loads with g = 0
    VectorXd growth = {};                ///< g of each load [-]
  };
  /// @param solver  must live longer   @param weights  w of each load
  RestrainedExpansion(const fem::StaticSolver& solver, Lines lines, const VectorXd& weights);

  /// τ and its energies at these stiffness factors (n_cells), which the solver was factored for;
  /// nothing to do when they are those of the last call.
  void update(const VectorXd& stiffness);

  // All of the following speak of the last update().
  void add_to(ComplianceEvaluator::Value& value) const;  ///< Σ w g² τᵀ K τ and its derivative
  void add_to(ComplianceEvaluator::Each& each) const;
  void add_to(VectorXd& compliances) const;  ///< (n_loads)
  /// g τ of one load, node by node (2 n_nodes).
  VectorXd displacement(int load) const;

  void take_from(MatrixXd& u) const;  ///< u - g τ (n_loads x n_unknowns)

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
  std::vector<int> touched_;          // cells with held nodes that move
  VectorXd stiffness_;                // of the last update
  VectorXd compliances_;              // τᵀ K τ of each line
  MatrixXd forces_, tau_, energies_;  // (n x n_unknowns), (n x 2 n_nodes), (n x n_cells)
};

/// κ = 1e3 E c H / dy, which holds the far edge of length H of a plate, nodes dy apart [N/m]; 0
/// where no load has EslSet::held_end_stretch.
///
/// What the plate has against it is a strip across about as wide as a third of H, so that an edge
/// of full material gives way by 3e-4 of what is held back, on every grid.
/// Energies of heat alone come out short of those of a rigid edge by 1e-4, less where the edge is
/// soft. Round-off of displacements under loads grows with κ: on 400 x 40 cells 2e-7 (two flanges
/// without a web: 7e-6), which enters compliances squared; a hundred times κ makes that 1e-4
/// (4e-3).
double edge_stiffness(const fem::EslSets& sets, const fem::PlaneSection& section);

/// Returns the edges that hold back the growth of a hot plate: EslSet::held_stretch = g, τ_c =
/// -(0, Y) on the root column of each load, and EslSet::held_end_stretch = g_e at the far end.
/// Nothing where no load has any.
std::optional<RestrainedExpansion> restrained_edges(const fem::EslSets& sets,
                                                    const fem::StaticSolver& solver,
                                                    std::span<const int> columns,
                                                    const VectorXd& weights);

/// Returns e + ρ of one unit of growth of a plate at rest (2 n_nodes) [m]: free growth about the
/// middle of the plate, turned and shifted so that it leaves the held displacements as near to zero
/// as it can; zero where no cell of the domain is.
VectorXd growth_on_supports(const fem::StaticSolver& solver,
                            std::span<const fem::HeldUnknown> held);

/// Returns the supports that take off growth_on_supports() at held displacements, times the thermal
/// stretch of each load; nothing where they let the plate grow.
std::optional<RestrainedExpansion> restrained_supports(const fem::StaticSolver& solver,
                                                       const VectorXd& growth,
                                                       const VectorXd& stretch,
                                                       const VectorXd& weights);

}  // namespace flexmorph::mmc
