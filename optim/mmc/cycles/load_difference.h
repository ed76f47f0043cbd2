#pragma once

#include <span>
#include <string>

#include "fem/esl_set.h"
#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::mmc {

/// Says by how much the loads that a design was made for differ from those of its own motion.
///
/// With the static energies U_s of the design under the loads that it was made for, those under the
/// loads of its own motion U_o, the strain energies U of that motion and the weights w of the
/// loads,
///
///   loads     = Σ w |U_s U / U_o - U| / Σ w U
///   geometric = Σ w |U_o - U| / Σ w U
///
/// U_o / U is the secant stiffness of the deformed body over the one of small displacements.
///
/// Source: optim/README.md, Cycles.
struct LoadDifference {
  static constexpr double kLargest = 0.2;  ///< from here on loads are not those of the motion
  /// Loads of less than this part of the largest energy keep the stiffness of small displacements:
  /// the motion passes through rest there.
  static constexpr double kLeast = 0.01;

  std::string body;
  double loads = 0;  ///< part of the energy by which the loads differ [-]
  /// Part by which energies of small displacements differ from those of the motion: deflections are
  /// large, or elements of the motion bridge what is cut or thin [-].
  double geometric = 0;
};

/// Compares energies load by load, see LoadDifference.
/// @param made_for  F . u of the design under the loads that it was made for [J] (n)
/// @param own       F . u of the design under the loads of its own motion [J] (n)
/// @param motion    loads of its own motion at the same times, with strain energies (n)
/// @throws Error (numerical) where the two motions have different numbers of loads.
LoadDifference load_difference(std::span<const double> made_for, std::span<const double> own,
                               std::span<const fem::EslSet> motion);

/// The same of the crisp design that a problem holds, whose energies under its own loads are
/// solved.
/// @throws Error (numerical) from statics, and as above.
LoadDifference load_difference(const BodyProblem& problem, std::span<const double> made_for,
                               const fem::EslSets& motion);

}  // namespace flexmorph::mmc
