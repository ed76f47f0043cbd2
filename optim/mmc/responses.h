#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/static_solver.h"

namespace flexmorph::mmc {

/// How the equivalent static loads meet a changing design (design.md section 8).
enum class LoadDefinition { inertia, frozen, stiffness };
/// Where the plate is held.
enum class Support { moving_root, far_end };

struct ComplianceSettings {
  LoadDefinition loads = LoadDefinition::inertia;
  Support support = Support::moving_root;
  bool compress = true;  ///< replace the loads by their leading singular vectors where it pays
  /// Part of the energy that may be left out where all loads share one support; with a moving root,
  /// where what is left out counts in first order, of its square root.
  double compression_tolerance = 1e-10;
};

/// f(b) = Σ w_i F_i(b)ᵀ u_i(b),  K(b) u_i = F_i(b): the compliance of many loads, and its
/// derivative by the factors of every design cell.
///
///   inertia    F_i = -M(b) a_i + f_i          df = Σ w_i (2 u_iᵀ dF_i - u_iᵀ dK u_i)
///   frozen     F_i = -M(b₀) a_i + f_i         df = -Σ w_i u_iᵀ dK u_i
///   stiffness  F_i = K(b₀) u_i of the motion  likewise
///
/// Factors are per cell: stiffness (n_cells, 0..1), mass (n_cells, 0..1, 0 in the void).
///
/// Source: P (33)-(35), design.md sections 8 and 9.
class Compliance {
 public:
  /// @param stiffness0, mass0  factors of the design the motion was computed with; not read by
  ///        `inertia`.
  /// @throws Error (input) for `inertia` with `far_end`, no loads, or loads that do not fit the
  ///         grid.
  Compliance(const fem::EslSets& loads, const fem::PlaneSection& section,
             const ComplianceSettings& settings, const VectorXd& stiffness0, const VectorXd& mass0);
  ~Compliance();

  struct Value {
    double f = 0;
    VectorXd d_stiffness, d_mass;  ///< (n_cells)
  };
  /// One factorization, one block solve, one energy pass. Cells inside the hub of every load get
  /// derivative 0.
  /// @throws Error (numerical) when K cannot be factored or f is not finite.
  void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value);

  /// Compliances F_i . u_i, without weights and uncompressed, of every load at the given factors
  /// (n_loads).
  VectorXd individual(const VectorXd& stiffness, const VectorXd& mass);

  /// Displacements of one load, node by node (2 n_nodes), at the given factors.
  VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load);

  int n_loads() const;
  int n_right_hand_sides() const;  ///< after compression
  struct Seconds {                 ///< CPU seconds of the last evaluate()
    double factor = 0, solve = 0, sensitivity = 0;
  };
  Seconds seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::mmc
