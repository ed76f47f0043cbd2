#pragma once

#include "optim/mmc/problem/body_problem.h"
#include "optim/mmc/problem/shape_limits.h"

namespace flexmorph::mmc {

/// The area of a union of components, and its minimum length scale as constraints:
///
///   g_k = 0.003 (1 - w_k / w) <= 0      for the narrowest places, w_k the width of the k-th one
///
/// w is 1.002 times the required width.
///
/// w_k is the distance of two contacts of an inscribed disc (length_scale_violations()). A contact
/// on the outline of one component moves with this outline along its normal n. A contact at which
/// two outlines cross moves with both. Fixed outlines (borders, passive regions) do not move:
///
///   dw = e · (v_a - v_b),   n_i · v = -dφ_i / |∇φ_i|   for every outline i through the contact,
///
/// where e is the unit vector from b to a. This is exact at necks, where the width is stationary
/// along the medial axis, if the contacts are exact. They are contacts of polygons: at a corner of
/// a polygon beside a strongly curved end, the derivative of a slit is wrong by up to 12 % (115
/// random slits; median 2.1 %). Of three contacts that enclose a disc (LengthScaleViolation::
/// Kind::blob), only two count. The last disc of an end (Kind::bar) moves along the end together
/// with the components: its velocity is the mean of their affine motions at the contacts, and the
/// change of the width by this displacement is subtracted. w_k includes a Newton step from the
/// sides of the polygons to the true outlines.
///
/// The set of narrow places changes from design to design: the rows belong to the narrowest ones,
/// in no fixed order. A place of width 0 (regions that touch in a point, crisp tips) violates its
/// constraint but has no gradient; the places next to it widen it.
class OutlineLimits final : public ShapeLimits {
 public:
  /// Creates the constraints for a problem.
  /// @param problem  only its domain and regions matter, not its design. Their rings are simplified
  ///                 here within kOutlineTolerance, because every side costs time in each iteration
  /// @param wanted   required widths; without any of them there are no constraints
  OutlineLimits(const BodyProblem& problem, const MinimumWidths& wanted);

  int count() const override { return wanted_.any() ? kLocations : 0; }
  void evaluate(std::span<const Component> components, Values& out) override;

 private:
  static constexpr int kLocations = 24;

  BodyProblem problem_;
  MinimumWidths wanted_;
  double domain_area_;
};

/// Returns the smallest half-thickness of components [m] for which their union can reach a required
/// smallest feature: half the feature, enlarged for round ends and for the tolerance of outlines.
double half_thickness_for(double min_feature);

/// A width and its gradient by the parameters of components.
struct WidthGradient {
  double width = 0;  ///< Width between the true outlines [m].
  VectorXd slope;    ///< Gradient of the width by the parameters of N components (7 N).
};
/// Computes the width at a narrow place of the union of these components, and its gradient.
WidthGradient width_gradient(const BodyProblem& problem, std::span<const Component> components,
                             const LengthScaleViolation& location);

}  // namespace flexmorph::mmc
