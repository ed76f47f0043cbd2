#pragma once

#include "cases/assembly/build.h"
#include "io/vtk.h"

namespace flexmorph::cases {

/// The deformed mid-surface of a body, fine enough to look curved.
struct Surface {
  io::QuadMesh mesh;                 ///< dimension: that of the body; points across, then along
  int across = 0;                    ///< quads across
  std::vector<double> displacement;  ///< per point, (dimension), see deformed_surface() [m]
  std::vector<double> energy;  ///< per quad, strain energy per reference area [J/m^2]: the mean of
                               ///< its element
  std::vector<double> strain;  ///< per quad of a beam, elastic Green strain 11, 22, 12 [-] in its
                               ///< middle: of F/s, s = 1 + α ΔT; none of plates
};

/// @param row   how finely its elements are drawn, and whether with their strain
/// @param pose  the displacement is counted from the undeformed body as it lies at the start;
///              material that is not out of its hub then lies behind it
/// @param x     the model of the body is prepared for it
/// @param heating  what its temperature is multiplied by, in a [static] analysis
Surface deformed_surface(const ElementRow& row, const fem::Body& body, const fem::State& x,
                         const fem::ReferencePose& pose, double heating = 1);

/// A deformed body in the plane, cell by cell of its design; what is still in the hub is left out.
/// Points and quads across, then along, as in a Surface.
struct DesignedSurface {
  io::QuadMesh mesh;
  std::vector<double> density;       ///< per quad [-]
  std::vector<double> displacement;  ///< per point (2), as in a Surface [m]
  std::vector<double> energy;        ///< per quad, as in a Surface [J/m^2]
};
/// @param pose     as of deformed_surface()
/// @param density  of the cells of the grid
DesignedSurface designed_surface(const fem::Body& body, const fem::State& x,
                                 const fem::ReferencePose& pose, const Grid& grid,
                                 const VectorXd& density);

/// A disc at a frame's origin; without the part around its -x, which shows how far it has turned,
/// where it is notched.
io::QuadMesh disc_mesh(const fem::FrameMotion& frame, double radius, bool notched);
/// How large hubs and point masses, which have no size, are drawn: a part of the width of what they
/// carry, or of its length where that has none [m].
double drawn_radius(const Scene& scene, const Hub& hub);
double drawn_radius(const Scene& scene, const PointMass& mass);

/// Corners of the rectangle that a rigid body is drawn as, counterclockwise; none without a size.
std::vector<Vec2> drawn_corners(const RigidBody& body, const fem::Model& model,
                                const fem::State& x);

}  // namespace flexmorph::cases
