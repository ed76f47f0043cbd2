#pragma once

#include <optional>
#include <span>
#include <string>

#include "geometry/base.h"

namespace flexmorph::fem {

/// Position and angle of an undeformed plate or beam at the start.
struct ReferencePose {
  /// Position in the world of the material point (line, 0) [m].
  Vec2 origin{0, 0};
  /// Angle about z of the axis along m, at the origin [rad].
  double angle = 0;
  /// Material coordinate of the m-line through the origin [m].
  double line = 0;
  /// Curvature of the axis of a beam that is an arc of a circle [1/m].
  double curvature = 0;

  /// Returns the position of a material point in the world, z = 0 [m].
  Vec3 location(const Vec2& material) const;
};

/// Returns the position of a material point of a strip in the axes of its root [m]. The strip
/// begins along the first axis and has a constant curvature [1/m].
Vec2 location_on_arc(double curvature, const Vec2& material);

/// A plate or beam as input of reference_pose().
struct UndeformedBody {
  /// Name of the body.
  std::string name;
  /// ReferencePose::line of a pose that follows from welds [m].
  double line = 0;
  /// ReferencePose::curvature of a pose that follows from welds [1/m].
  double curvature = 0;
  /// Known pose of the body; absent: the pose follows from welds.
  std::optional<ReferencePose> pose{};
};

/// A weld between points of two plates or beams, at which body b continues body a.
struct ReferenceWeld {
  /// One side of the weld.
  struct End {
    /// Name of the body.
    std::string body;
    /// Material point of the weld [m].
    Vec2 point{0, 0};
    /// Angle of the axis of the weld in the axes of the undeformed body [rad]. The axes of both
    /// sides coincide.
    double angle = 0;
  } a, b;  ///< The two sides of the weld.
};

/// Returns the reference pose of a body: its known pose; otherwise the pose that follows from the
/// first chain of welds to a body with a known pose; otherwise a pose with the axes of the world.
/// @throws Error (input) if a body is not listed.
ReferencePose reference_pose(std::span<const UndeformedBody> bodies,
                             std::span<const ReferenceWeld> welds, const std::string& body);

}  // namespace flexmorph::fem
