#pragma once

#include <string>
#include <vector>

#include "io/vtk.h"

/// Pictures of deformed plates in space.
namespace flexmorph::io {

/// A plate at one moment.
struct SurfaceFrame {
  std::string title;
  QuadMesh mesh;               ///< dimension 3
  std::vector<double> values;  ///< per quad, >= 0: its colour
};

/// The frames side by side, `columns` in a row, in the same view from above and to the same scale;
/// colours from the smallest value (dark) to the largest of all frames (light).
/// @throws Error (input) when there is no frame, or one that is not in space.
std::string surfaces_svg(const std::string& title, const std::vector<SurfaceFrame>& frames,
                         int columns = 4);

}  // namespace flexmorph::io
