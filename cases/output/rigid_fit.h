#pragma once

#include <span>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::cases {

/// A rotation and a translation: r = rotation * X + translation.
struct RigidFit {
  Eigen::Matrix3d rotation =
      Eigen::Matrix3d::Identity();  ///< Rotation matrix; about the axis z in the plane.
  Vec3 translation{0, 0, 0};        ///< Translation [m].
};

/// Returns the rigid motion of points that has the least mean squared distance from their present
/// positions. In space the rotation follows from a singular value decomposition: Kabsch (1976),
/// Acta Crystallographica A 32, 922-923.
/// @param dim   number of coordinates of a point, 2 or 3
/// @param from  positions before the motion (dim n) [m]
/// @param to    present positions (dim n) [m]
RigidFit rigid_fit(int dim, std::span<const double> from, std::span<const double> to);

/// Displacements of points, split into those of a rigid motion and the rest.
struct SplitDisplacements {
  std::vector<double> motion;       ///< Displacement by the rigid motion (dim n) [m].
  std::vector<double> deformation;  ///< Displacement relative to the rigid motion (dim n) [m].
};
/// Splits the displacements of points by rigid_fit().
SplitDisplacements split_displacements(int dim, std::span<const double> from,
                                       std::span<const double> to);

}  // namespace flexmorph::cases
