#pragma once

#include "cases/assembly/build.h"
#include "io/vtk.h"

namespace flexmorph::cases {

/// The deformed mid-surface of a body, with several quads per element so that it looks curved.
struct Surface {
  io::QuadMesh mesh;  ///< Mesh with the dimension of the body; points across first, then along.
  int across = 0;     ///< Number of quads across.

  /// Displacement of every point by the rigid motion of the body (dimension n_points) [m], see
  /// rigid_fit().
  std::vector<double> motion;
  std::vector<double> displacement;  ///< Displacement relative to the rigid motion [m].
  std::vector<Vec2> middles;         ///< Material coordinates of the middle of every quad [m].
  /// Strain energy per reference area of every quad [J/m^2]; a quad has the mean of its element.
  std::vector<double> energy;
  /// Von Mises stress of the membrane forces of every quad of a plate [Pa]; empty if it was not
  /// computed, see membrane_stress().
  std::vector<double> stress;
  /// Elastic Green strain 11, 22, 12 in the middle of every quad of a beam [-], computed from F/s
  /// with s = 1 + α ΔT; empty for plates.
  std::vector<double> strain;
};

/// Returns the deformed mid-surface of a body.
/// @param row   row of its element: the number of quads, and whether strains are computed
/// @param body  body of a model that is prepared for x
/// @param x     state of the model
/// @param pose  pose of the undeformed body at the start, to which displacements refer; material
///              that is still inside the hub at the start then lies behind the hub
/// @param heating  factor of the temperature rise, in a [static] analysis
Surface deformed_surface(const ElementRow& row, const fem::Body& body, const fem::State& x,
                         const fem::ReferencePose& pose, double heating = 1);

/// A deformed body in the plane with one quad per cell of its design. Cells that are still inside
/// the hub are left out. Points and quads are numbered across first, then along.
struct DesignedSurface {
  io::QuadMesh mesh;                 ///< Mesh of the cells, in the plane.
  std::vector<double> density;       ///< Mass scale factor of every quad [-].
  std::vector<double> motion;        ///< Displacement by the rigid motion (2 n_points) [m].
  std::vector<double> displacement;  ///< Displacement relative to it (2 n_points) [m].
  std::vector<Vec2> middles;         ///< Material coordinates of the middle of every quad [m].
  std::vector<double> energy;        ///< Strain energy per area of every quad [J/m^2].

  /// Von Mises stress of every quad, times its mass scale factor [Pa]; empty if it was not
  /// computed, see membrane_stress().
  std::vector<double> stress;
};
/// Returns a deformed body with one quad per cell of its design.
/// @param body     body of a model that is prepared for x
/// @param x        state of the model
/// @param pose     pose of the undeformed body at the start, to which displacements refer
/// @param grid     grid of the design
/// @param density  mass scale factors of the cells of the grid (n_cells)
DesignedSurface designed_surface(const fem::Body& body, const fem::State& x,
                                 const fem::ReferencePose& pose, const Grid& grid,
                                 const VectorXd& density);

/// Returns a disc around the origin of a frame.
/// @param notched  true: the sector around the direction -x is left out, which shows the angle
io::QuadMesh disc_mesh(const fem::FrameMotion& frame, double radius, bool notched);
/// Returns the von Mises stress of the membrane forces of a plate at material points [Pa]. Its
/// second Piola-Kirchhoff stress is S = C (FᵀF/s² - 1)/2 with the plane-stress stiffness C;
/// stresses of bending are not contained.
/// @param body     plate of a model that is prepared for x
/// @param stretch  thermal stretch s = 1 + α ΔT
std::vector<double> membrane_stress(const fem::Body& body, const fem::State& x,
                                    std::span<const Vec2> materials, double youngs_modulus,
                                    double poisson_ratio, double stretch);
/// Returns the thermal stretch 1 + α ΔT of a body; 1 if it is not heated.
/// @param heating  factor of the temperature rise, in a [static] analysis
double thermal_stretch(const fem::Body& body, double t, double heating);

/// Returns the radius with which a hub is drawn [m]: a fraction of the width of the bodies that it
/// carries, or of their length if they have no width.
double drawn_radius(const Scene& scene, const Hub& hub);
/// Returns the radius with which a point mass is drawn [m]: a fraction of the width of its body, or
/// of its length if it has no width.
double drawn_radius(const Scene& scene, const PointMass& mass);

/// Returns the corners of the rectangle with which a rigid body is drawn, counterclockwise [m];
/// empty if it has no size.
std::vector<Vec2> drawn_corners(const RigidBody& body, const fem::Model& model,
                                const fem::State& x);

}  // namespace flexmorph::cases
