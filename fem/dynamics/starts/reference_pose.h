#pragma once

#include <optional>
#include <span>
#include <string>

#include "geometry/base.h"

namespace flexmorph::fem {

/// Place of an undeformed plate or beam at the start: its m-line at the material coordinate `line`
/// goes through `origin`, where its axis along m is turned by `angle` about z.
struct ReferencePose {
  Vec2 origin{0, 0};     ///< [m]
  double angle = 0;      ///< [rad]
  double line = 0;       ///< material coordinate of the m-line at the origin [m]
  double curvature = 0;  ///< of the axis of a beam that is an arc of a circle [1/m]

  /// Returns the position of a material point in the world, z = 0 [m].
  Vec3 place(const Vec2& material) const;
};

/// Returns a material point of a strip in the axes of its root, where the strip begins along the
/// first axis and bends with a constant curvature [1/m].
Vec2 place_on_arc(double curvature, const Vec2& material);

/// A plate or beam whose reference pose is asked for.
struct UndeformedBody {
  std::string name;
  double line = 0;                      ///< see ReferencePose; of a pose that follows from welds
  double curvature = 0;                 ///< likewise [1/m]
  std::optional<ReferencePose> pose{};  ///< where it is known; absent: it follows from welds
};

/// A weld between points of two plates or beams: there body b continues body a.
struct ReferenceWeld {
  struct End {
    std::string body;
    Vec2 point{0, 0};  ///< material [m]
    double angle = 0;  ///< of an axis in those of the undeformed body; both axes are one [rad]
  } a, b;
};

/// Returns the reference pose of a body: its own where it is known, else the one that the first
/// chain of welds to a body with a known pose gives it, else that of the world's axes.
/// @throws Error (input) for a body that is not listed.
ReferencePose reference_pose(std::span<const UndeformedBody> bodies,
                             std::span<const ReferenceWeld> welds, const std::string& body);

}  // namespace flexmorph::fem
