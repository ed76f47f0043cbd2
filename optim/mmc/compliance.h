#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "fem/solve/static_solver.h"
#include "optim/mmc/load_response.h"

namespace flexmorph::mmc {

/// How the equivalent static loads meet a changing design (optim/README.md, Load definitions).
enum class LoadDefinition { inertia, frozen, stiffness };
/// Where the plate is held: at its root, or, as a link between two pins, see LinkCompliance.
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

/// f(b) = Σ w_i F_i(b)ᵀ u_i(b),  K(b) u_i = F_i(b): the compliance of many loads, and its
/// derivative by the factors of every design cell.
///
///   inertia    F_i = -M(b) a_i + f_i          df = Σ w_i (2 u_iᵀ dF_i - u_iᵀ dK u_i)
///   frozen     F_i = -M(b₀) a_i + f_i         df = -Σ w_i u_iᵀ dK u_i
///   stiffness  F_i = K(b₀) u_i of the motion  likewise
///
/// Factors are per cell: stiffness (n_cells, 0..1), mass (n_cells, 0..1, 0 in the void).
///
/// Hot plates (EslSet::thermal_stretch = a): u is the elastic displacement, counted from the plate
/// grown freely about its root, and f = Σ w_i u_iᵀ K u_i. Root lines that cannot grow with the
/// plate prescribe u = -g (0, Y) there, g = EslSet::held_stretch, and their thermal stress counts:
/// see HeldExpansion. With support `far_end` that is the clamp at the far end. Where a load is held
/// at the other end too (EslSet::held_end_stretch), springs keep that edge straight and as wide as
/// it is under all loads; their energy, next to nothing, belongs to f.
///
/// Source: P (33)-(35); optim/README.md, Responses.
class Compliance final : public LoadResponse {
 public:
  /// @param stiffness0, mass0  factors of the design the motion was computed with; not read by
  ///        `inertia`.
  /// @throws Error (input) for `inertia` or a held far edge with `far_end`, supports of a link, no
  ///         loads, or loads that do not fit the grid.
  Compliance(const fem::EslSets& loads, const fem::PlaneSection& section,
             const ComplianceSettings& settings, const VectorXd& stiffness0, const VectorXd& mass0);
  ~Compliance() override;

  /// Cells inside the hub of every load get derivative 0.
  void evaluate(const VectorXd& stiffness, const VectorXd& mass, Value& value) override;
  /// F_i . K_i⁻¹ F_i = |L_i⁻¹ F_i|², where L_i, of the plate clamped as load i has it, is a leading
  /// block of L: forward substitutions only.
  double sum(const VectorXd& stiffness, const VectorXd& mass) override;
  /// Never compressed.
  void evaluate_each(const VectorXd& stiffness, const VectorXd& mass, Each& each) override;
  VectorXd individual(const VectorXd& stiffness, const VectorXd& mass) override;
  /// In front of the clamp; growth is counted from the clamp at Y = 0.
  VectorXd displacement(const VectorXd& stiffness, const VectorXd& mass, int load) override;

  int n_loads() const override;
  int n_right_hand_sides() const override;
  int factorizations() const override;
  double condition() const override;
  Seconds seconds() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flexmorph::mmc
