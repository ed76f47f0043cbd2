#pragma once

#include <string>
#include <vector>

#include "geometry/base.h"
#include "io/vtk.h"

/// Pictures of deformed plates in space.
namespace flexmorph::io {

/// Returns the position of a point in the view of pictures in space: coordinates to the right,
/// upwards, and towards the viewer, who looks from above.
Vec3 seen_from_above(const Vec3& point);

/// A snapshot of a plate.
struct SurfaceFrame {
  std::string title;           ///< Title above the snapshot.
  QuadMesh mesh;               ///< Deformed mesh of dimension 3.
  std::vector<double> values;  ///< Value of each quadrilateral, >= 0, shown as its colour.
};

/// Returns an SVG page with the snapshots side by side, `columns` in a row, in the same view from
/// above and with the same scale. Colours go from zero (dark) to the largest value of all snapshots
/// (light).
/// @throws Error (input) when there is no snapshot, or when one is not in space.
std::string surfaces_svg(const std::string& title, const std::vector<SurfaceFrame>& frames,
                         int columns = 4);

}  // namespace flexmorph::io
