#pragma once

#include <optional>

#include "optim/mmc/body_problem.h"

namespace flexmorph::mmc {

/// What it took to make a design nowhere thinner than wanted, and what it cost.
struct CleanUp {
  double wanted = 0;                                   ///< smallest solid feature [m]
  double before = 0, after = 0;                        ///< smallest solid features [m]
  double compliance_before = 0, compliance_after = 0;  ///< of the sharp design
  int rounds = 0, patches = 0, dropped = 0;
  bool reached() const { return after >= wanted; }
};

/// Makes the union of a design's components as thick as wanted, everywhere.
///
/// Bounds on thicknesses do not do that: where components touch by their tips, overlap a little or
/// are cut by the border, the union is thinner than each of them. Narrow places of the union (see
/// narrow_places()) are repaired one by one, by whichever costs less in compliance times volume: a
/// short component over the place, or none of one of those that meet there. Slits that part pieces
/// of the design, which its cells do not see, are bridged likewise. Volume beyond what is allowed
/// is then taken from what is thicker than needed, in equal parts; and so on, until no place is
/// left.
///
/// The design of `problem` is left at the result, or where it was when that is thicker.
/// @param wanted  smallest solid feature [m]
/// @param max_volume  volume fraction it may take; absent: as its goal says
/// @throws Error (numerical) from statics.
CleanUp clean_up(BodyProblem& problem, LoadResponse& loads, double wanted,
                 std::optional<double> max_volume = {});

/// Smallest half-thickness of components whose own middle is as thick as wanted, with room for
/// their round ends and the tolerance of outlines.
double half_thickness_for(double min_feature);

}  // namespace flexmorph::mmc
