#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/static_solver.h"
#include "optim/mmc/loads/static_loads.h"
#include "optim/mmc/problem/plate.h"

namespace flexmorph::mmc {

/// What acts on a plate at rest at the same time: nodal forces, and heat.
struct LoadCase {
  std::string name;
  double weight = 1;
  std::vector<fem::NodalForce> forces;
  /// a = α ΔT of the whole plate: free, it is 1 + a times as large [-]
  double thermal_stretch = 0;
};

/// Mean compliance of one plate under many loads, and its gradient with respect to the stiffness
/// and mass scale factors of every design cell:
///
///   f(b) = Σ w_l C_l,   C_l = F_l(b) . u_l(b),   K(b) u_l = F_l(b)
///
///   inertia    F_l = -M(b) a_l + f_l          df = Σ w_l (2 u_lᵀ dF_l - u_lᵀ dK u_l)
///   frozen     F_l = -M(b₀) a_l + f_l         df = -Σ w_l u_lᵀ dK u_l
///   stiffness  F_l = K(b₀) u_l of the motion  df = -Σ w_l u_lᵀ dK u_l
///   at rest    F_l given                      df = -Σ w_l u_lᵀ dK u_l
///              F_l + weight(b)                df = Σ w_l (2 u_lᵀ dF - u_lᵀ dK u_l)
///
/// Factors are per cell: stiffness (n_cells, 0..1), mass (n_cells, 0..1, 0 in the void).
///
/// Links between two pins (EslSets::pins) are balanced: F_l and u_l are those of LinkBalance. With
/// support `pins` reactions replace the joint forces in f_l at the first pin and across the line of
/// the pins at the second one; with `floating` all joint forces are as they were, and the link as a
/// whole accelerates.
///
/// Hot plates: C_l is u_lᵀ K u_l of the elastic displacements u, twice the elastic energy, counted
/// from the plate grown freely by EslSet::thermal_stretch or LoadCase::thermal_stretch = a.
/// Supports that do not grow with the plate prescribe u there, and their thermal stress counts:
/// root lines (EslSet::held_stretch; with support `far_end` the clamp at the far end), the other
/// end (EslSet::held_end_stretch), supports of a plate at rest. See RestrainedExpansion.
///
/// Source: P (33)-(35); optim/README.md, Responses and Links between two pins.
class ComplianceEvaluator {
 public:
  /// Load sets of a motion.
  /// @param stiffness0, mass0  factors of the design the motion was computed with; not read by
  ///        `inertia`, stiffness0 not by links.
  /// @throws Error (input) for `inertia` or a held far edge with `far_end`, no loads, loads that do
  ///         not fit the grid; of links without pins, with root columns, heat or definition
  ///         `stiffness`; for pins with a support that is none of a link.
  ComplianceEvaluator(const fem::EslSets& loads, const fem::PlaneSection& section,
                      const ComplianceSettings& settings, const VectorXd& stiffness0,
                      const VectorXd& mass0);
  /// A plate at rest, held at these displacements under all loads. A hot plate is held where it was
  /// while cold: supports prescribe what a rigid motion leaves of its growth, so that supports that
  /// let the plate grow cost nothing.
  /// @param gravity  of the plate's own weight, which acts with every load [m/s^2]
  /// @param compress  f depends on Σ w F Fᵀ only: evaluate() solves as many right-hand sides as
  /// that
  ///        has directions (optim/README.md, Compression)
  /// @throws Error (input) for no loads, loads that are zero or act where nothing can move, heat
  ///         alone on a plate that its supports let grow, weights that are not positive.
  ComplianceEvaluator(const Plate& plate, std::span<const fem::HeldUnknown> held,
                      std::span<const LoadCase> loads, bool compress,
                      const Vec2& gravity = Vec2::Zero());
  ~ComplianceEvaluator();
  ComplianceEvaluator(ComplianceEvaluator&&) noexcept;

  /// The weighted sum f.
  struct Value {
    double f = 0;
    VectorXd d_stiffness, d_mass;  ///< (n_cells); 0 in cells that no load moves
    /// The part of d_stiffness that heat adds where supports hold its growth back (n_cells), or
    /// empty: its sign is that of an energy, while the rest has the other one.
    VectorXd d_held;
  };
  /// One factorization, one block solve, one energy pass.
  /// @throws Error (numerical) when K cannot be factored or f is not finite.
  void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value);

  /// f alone. Where a clamp holds the plate, F_l . K_l⁻¹ F_l = |L_l⁻¹ F_l|², L_l a leading block of
  /// L: forward substitutions only.
  /// @throws Error (numerical) as evaluate().
  double sum(const VectorXd& stiffness, const VectorXd& mass);

  /// Every load by itself, without weights: what a worst case needs.
  struct Each {
    VectorXd f;                    ///< C_l (n_loads)
    MatrixXd d_stiffness, d_mass;  ///< (n_loads x n_cells); d_mass is empty for fixed loads
  };
  /// The same solves as evaluate(), never compressed, with one row of energies per load.
  /// @throws Error (numerical) as evaluate().
  void evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each);

  /// Are there second derivatives? Of cold plates at rest without weight there are.
  bool has_curvature() const;
  /// Second derivatives along directions of the stiffness factors.
  /// The first one along direction i is -u · K_i u, K_i = Σ_c D_ci K_c, and from K u_i = -K_i u
  ///
  ///   C_ij = 2 (L⁻¹ K_i u) · (L⁻¹ K_j u),   K = L Lᵀ
  ///
  /// @param directions  D (n_cells x n)
  /// @param weights  of every load (n_loads); empty: of the weighted sum
  /// @return Σ w_l C_l,ij (n x n)
  /// @throws Error (input) where there are none.
  MatrixXd curvature(const VectorXd& stiffness, const Eigen::SparseMatrix<double>& directions,
                     const VectorXd& weights);

  /// C_l of every load at the given factors (n_loads).
  VectorXd individual(const VectorXd& stiffness, const VectorXd& mass);

  /// Displacements of one load, node by node (2 n_nodes), at the given factors: of a hot plate all
  /// of it, thermal growth included, so that it is zero where held. In front of a clamp only,
  /// growth counted from the clamp at Y = 0.
  /// @throws Error (input) for a load that there is not.
  VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load);

  int n_loads() const;
  int n_right_hand_sides() const;  ///< after compression
  int factorizations() const;      ///< since construction
  /// Estimated condition of K of the last factorization, see fem::condition_estimate().
  double condition() const;
  struct Seconds {  ///< CPU seconds of the last evaluation
    double factor = 0, solve = 0, sensitivity = 0;
  };
  Seconds seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::mmc
