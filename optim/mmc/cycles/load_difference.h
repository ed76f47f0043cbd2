#pragma once

#include <span>
#include <string>

#include "fem/esl_set.h"
#include "optim/mmc/problem/body_problem.h"

namespace flexmorph::mmc {

/// Difference between the loads that a design was made for and the loads of its own motion.
///
/// Let U_s be the static energies of the design under the loads that it was made for, U_o those
/// under the loads of its own motion, U the strain energies of that motion, and w the weights of
/// the loads. Then
///
///   loads     = Σ w |U_s U / U_o - U| / Σ w U
///   geometric = Σ w |U_o - U| / Σ w U
///
/// U_o / U is the ratio of the secant stiffness of the deformed body to its stiffness at small
/// displacements.
///
/// Source: optim/README.md, Cycles.
struct LoadDifference {
  /// Value of `loads` from which on the loads do not represent the motion.
  static constexpr double kLargest = 0.2;
  /// Fraction of the largest energy below which a load keeps the stiffness at small displacements,
  /// because the motion passes through the undeformed state there.
  static constexpr double kMinimum = 0.01;

  std::string body;  ///< Name of the body.
  double loads = 0;  ///< Fraction of the energy by which the loads differ [-].

  /// Fraction by which the energies at small displacements differ from those of the motion [-].
  /// Causes are large deflections, or elements of the motion that bridge gaps and thin bars.
  double geometric = 0;
};

/// Compares the energies load by load, see LoadDifference.
/// @param made_for  F . u of the design under the loads that it was made for [J] (n)
/// @param own       F . u of the design under the loads of its own motion [J] (n)
/// @param motion    loads of its own motion at the same times, with strain energies (n)
/// @throws Error (numerical) if the two motions have different numbers of loads.
LoadDifference load_difference(std::span<const double> made_for, std::span<const double> own,
                               std::span<const fem::EslSet> motion);

/// Compares the energies of the crisp design that a problem holds; its energies under its own loads
/// are computed here.
/// @param made_for  F . u of the design under the loads that it was made for [J] (n)
/// @param motion    loads of its own motion (n)
/// @throws Error (numerical) from statics, or if the two motions have different numbers of loads.
LoadDifference load_difference(const BodyProblem& problem, std::span<const double> made_for,
                               const fem::EslSets& motion);

}  // namespace flexmorph::mmc
