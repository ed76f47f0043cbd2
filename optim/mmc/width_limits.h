#pragma once

#include "optim/mmc/body_problem.h"
#include "optim/mmc/shape_limits.h"

namespace flexmorph::mmc {

/// The narrow places of a union of components as constraints of them:
///
///   g_k = (1 - w_k / wanted) / 100 <= 0      the narrowest places, w_k the width of the k-th
///
/// w is the distance of two contacts of an inscribed disc (narrow_places()). A contact on the
/// outline of one component moves with it along its normal n, one where two outlines cross moves
/// with both, and what is fixed (borders, passive regions) stands:
///
///   dw = e · (v_a - v_b),   n_i · v = -dφ_i / |∇φ_i|   for every outline i through the contact,
///
/// e from b to a. That is exact at necks, where the width is stationary along the medial axis. A
/// Newton step from the sides of polygons to the true outlines is part of w. The hundredth makes
/// one part in a thousand of a width what Settings::feasibility forgives.
///
/// Which places there are changes from design to design: the rows are those of the narrowest ones,
/// in no lasting order. Places without a width (pinches, blades) have no gradient and are left to
/// clean_up().
class WidthLimits final : public ShapeLimits {
 public:
  /// @param problem  lives longer; its design does not matter
  WidthLimits(const BodyProblem& problem, const Widths& wanted)
      : problem_(problem), wanted_(wanted) {}

  int count() const override { return kPlaces; }
  /// Outlines that cannot be united have no narrow places.
  void evaluate(std::span<const Component> components, VectorXd& g, MatrixXd& dg) override;

 private:
  static constexpr int kPlaces = 24;

  const BodyProblem& problem_;
  Widths wanted_;
};

/// A width and how it changes with the parameters of components.
struct WidthSlope {
  double width = 0;  ///< of the true outlines [m]
  VectorXd slope;    ///< (7 N)
};
/// Of a narrow place of the union of these components.
WidthSlope width_slope(const BodyProblem& problem, std::span<const Component> components,
                       const NarrowPlace& place);

}  // namespace flexmorph::mmc
