#pragma once

#include "optim/mmc/problem/body_problem.h"
#include "optim/mmc/problem/shape_limits.h"

namespace flexmorph::mmc {

/// The area of a union of components, and its narrow places as constraints of them:
///
///   g_k = 0.003 (1 - w_k / w) <= 0      the narrowest places, w_k the width of the k-th
///
/// w is 1.002 times the wanted width.
///
/// w_k is the distance of two contacts of an inscribed disc (narrow_places()). A contact on the
/// outline of one component moves with it along its normal n, one where two outlines cross moves
/// with both, and what is fixed (borders, passive regions) stands:
///
///   dw = e · (v_a - v_b),   n_i · v = -dφ_i / |∇φ_i|   for every outline i through the contact,
///
/// e from b to a. That is exact at necks, where the width is stationary along the medial axis. The
/// last disc of an end moves along the end with the components (NarrowPlace::Kind::bar): they carry
/// it by the mean of their affine motions at the contacts, and what the width changes on that way
/// is taken off. A Newton step from the sides of polygons to the true outlines is part of w_k.
///
/// Which places there are changes from design to design: the rows are those of the narrowest ones,
/// in no lasting order. Places without a width (pinches, blades) are violated, and have no
/// gradient. (Their neighbours widen them.)
class OutlineLimits final : public ShapeLimits {
 public:
  /// @param problem  its design does not matter; rings of its domain and of its regions have only
  /// the sides here that keep to kOutlineTolerance, because every side costs in each iteration
  /// @param wanted   widths; without any there are no constraints
  OutlineLimits(const BodyProblem& problem, const Widths& wanted);

  int count() const override { return wanted_.any() ? kPlaces : 0; }
  void evaluate(std::span<const Component> components, Values& out) override;

 private:
  static constexpr int kPlaces = 24;

  BodyProblem problem_;
  Widths wanted_;
  double domain_area_;
};

/// Returns the smallest half-thickness [m] of components whose union may be as thick as wanted:
/// half the feature and an allowance for round ends and the tolerance of outlines.
double half_thickness_for(double min_feature);

/// A width and how it changes with the parameters of components.
struct WidthSlope {
  double width = 0;  ///< of the true outlines [m]
  VectorXd slope;    ///< (7 N)
};
/// Of a narrow place of the union of these components.
WidthSlope width_slope(const BodyProblem& problem, std::span<const Component> components,
                       const NarrowPlace& place);

}  // namespace flexmorph::mmc
