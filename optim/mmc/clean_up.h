#pragma once

#include <functional>
#include <optional>

#include "optim/mmc/body_problem.h"

namespace flexmorph::mmc {

/// What it took to mend a design, and what it cost.
struct CleanUp {
  Widths wanted;
  Features before = {0, 0}, after = {0, 0};            ///< smallest widths [m]
  int pieces_before = 1, pieces_after = 1;             ///< of the union
  double compliance_before = 0, compliance_after = 0;  ///< of the sharp design
  double volume_before = 0, volume_after = 0;          ///< likewise
  int rounds = 0, patches = 0, dropped = 0;
  int idle = 0;    ///< components that carried nothing, and went
  int stubs = 0;   ///< ends of components likewise
  int joined = 0;  ///< components that went because others took their place, end to end
  int born = 0;    ///< bars across the void that came
  int torn = 0;  ///< gaps that only cells bridge, or that part it from what holds it, and are left
  bool given_up = false;  ///< it would have cost too much: the design is as it was
  bool changed() const { return rounds + idle + stubs > 0; }
  void add(const CleanUp& later);     ///< its rounds, patches and losses
  void end_as(const CleanUp& other);  ///< takes over what is after it
  bool reached() const;
  /// The least width as a part of what is wanted.
  double part_reached() const;
};

struct RepairWishes {
  std::optional<double> max_volume = {};  ///< volume fraction it may take; absent: as the goal says
  bool trims = true;                      ///< do idle ends of components go? It is half of the work
  /// Asked on the way; when false comes the design is left where it was, as given up. Empty: it
  /// does.
  std::function<bool()> go_on = {};
};

/// Makes the union of a design's components, and the void between, as wide as wanted everywhere.
///
/// Bounds on thicknesses do not do that: where components touch by their tips, overlap a little or
/// are cut by the border, the union is thinner than each of them. First components go that carry
/// less than a thousandth of the strain energy. Narrow places of the union (see narrow_places()),
/// gaps and slits that part pieces of the design, which its cells do not see, are then repaired one
/// by one, by whichever costs less in compliance times volume: a short component over the place, or
/// none of one of those that meet there. Volume beyond what is allowed is taken from what is
/// thicker than needed, in equal parts; and so on, until no place is left. Sharp volume that is
/// left over is given back to all components in equal parts where that narrows no gap.
///
/// The design of `problem` is left at the result, or where it was when that costs more than a
/// quarter of the compliance.
/// @throws Error (numerical) from statics.
CleanUp clean_up(BodyProblem& problem, ComplianceEvaluator& loads, const Widths& wanted,
                 const RepairWishes& wishes = {});

/// What a clean-up would find: `after` as `before`, and as many rounds as there are places to
/// repair.
CleanUp look_over(const BodyProblem& problem, ComplianceEvaluator& loads, const Widths& wanted);

/// Smallest half-thickness of components whose own middle is as thick as wanted, with room for
/// their round ends and the tolerance of outlines.
double half_thickness_for(double min_feature);

}  // namespace flexmorph::mmc
