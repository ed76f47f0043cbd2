#pragma once

#include <span>

#include "fem/solve/eigenpairs.h"
#include "fem/solve/statics.h"

namespace flexmorph::fem {

/// A natural mode of a mechanism: δq(t) = Re(φ exp(s t)) in the axes of the turning bodies.
struct NaturalMode {
  std::complex<double> eigenvalue;  ///< Eigenvalue s; exactly 0 for a rigid mode [1/s].
  VectorXcd shape;  ///< Shape φ (n_dofs); its largest displacement is real and 1 m.
  /// Share of every body in the kinetic energy, mean over a period (n_bodies); the sum is 1.
  std::vector<double> kinetic_share;

  /// Returns the frequency |Im s| / 2π [Hz].
  double frequency() const;
  /// Returns the damping ratio -Re s / |s| [-]; negative if the mode grows, 0 for a rigid mode.
  double damping_ratio() const;
  /// Returns true if nothing restores the motion, so that the frequency is zero.
  bool is_rigid() const { return eigenvalue == 0.0; }
  /// Returns true if the mode grows in time with a damping ratio below -0.001: the state is
  /// unstable. Smaller growth means nothing where the arrangement of the bodies changes in time.
  bool grows() const;
};

/// The lowest natural modes of a mechanism about a state, see natural_modes().
struct NaturalModes {
  std::vector<NaturalMode> modes;  ///< Modes with ascending |s|, rigid modes first.
  int degrees_of_freedom =
      0;  ///< Number of degrees of freedom: unknowns minus independent constraints.
  /// True if the modes are those of the quadratic eigenvalue problem: with dampers, material flow,
  /// turning bodies or forces without a potential. Otherwise all modes are real and undamped.
  bool is_complex = false;

  /// Returns the number of rigid modes among the modes.
  int n_rigid() const;
};

/// Computes the lowest natural modes of a model about a state of equilibrium, with joints and
/// drives held:
///
///   M δq̈ + C δq̇ + K δq + Φ_qᵀ δλ = 0,   Φ_q δq = 0,
///   K = (F + Φ_qᵀ λ)_q + C₀ Ω + M (Ω' + Ω²),   C = C₀ + 2 M Ω,   C₀ = F_v
///
/// Ω = ω J rotates all vectors of a body by 90 degrees, times the angular velocity ω of its frame
/// (Ω' with its angular acceleration): coordinates are those of the frame of each body, in which
/// the shape of a turning body is constant. For bodies whose arrangement changes in time the modes
/// belong to the arrangement at time x.t. Redundant constraint rows are left out.
///
/// A mode is rigid if |s|² is zero up to round-off and 1e-6 of the lowest other |s|² (1e-8 in
/// complex problems, whose double zeros are less accurate).
///
/// @param x        state with λ, v and a of the equilibrium
/// @param turning  rotation of every body of the model
/// @param count    largest number of modes, rigid ones included
/// @throws Error (input) when no body has mass; Error (numerical) as eigenpairs(), or when the
///     lowest frequency cannot be separated from round-off.
NaturalModes natural_modes(Workspace& model, const State& x, std::span<const Turning> turning,
                           int count);

}  // namespace flexmorph::fem
