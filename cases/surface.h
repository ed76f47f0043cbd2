#pragma once

#include "cases/build.h"
#include "io/vtk.h"

namespace flexmorph::cases {

/// The deformed mid-surface of a body, fine enough to look curved: 4 x 4 quads per element.
struct Surface {
  io::QuadMesh mesh;                 ///< dimension: that of the body
  std::vector<double> displacement;  ///< per point, (dimension), see deformed_surface() [m]
  std::vector<double> energy;  ///< per quad, strain energy per reference area [J/m^2]: the mean of
                               ///< its element
};

/// @param pose  the displacement is counted from the undeformed body as it lies at the start;
///              material that is not out of its hub then lies behind it
/// @param x     the model of the body is prepared for it
Surface deformed_surface(const fem::Body& body, const fem::State& x, const Pose& pose);

}  // namespace flexmorph::cases
