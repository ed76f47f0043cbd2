#pragma once

#include "fem/marker.h"
#include "fem/shapes/plane_curve.h"

/// Joints between places on planar rigid bodies, on plates and on the ground (fem/marker.h).
///
/// Every Φ but those of gears and paths is of degree 2 at most in the unknowns. Rows are lengths
/// [m] with multipliers in N, or numbers of the size of an angle with multipliers in N m.
///
/// Rows that say "axes are parallel" (n_a · e_b = 0 with n_a = e_a turned by +90 degrees) are also
/// fulfilled by axes that point against each other. The motion cannot reach that root, for the two
/// are half a turn apart; which one is meant is decided by the state it starts from, so whoever
/// assembles the start has to begin near the right one.
///
/// All makers: @throws Error (input) at Joint::bind() for bodies, points and axes that do not
/// exist, see Marker::bind(); for a motion that is missing, at once.
namespace flexmorph::fem {

/// |u|² = 1 of a rigid body: Φ = (u·u - 1)/2, 1 row. Every rigid body needs it once.
std::unique_ptr<Joint> make_unit_axis(std::string name, std::string body);

/// The two points are one: Φ = p_b - p_a, 2 rows. Its multiplier is the force [N] that a exerts on
/// b, with the sign turned.
std::unique_ptr<Joint> make_revolute(std::string name, MarkerPlace a, MarkerPlace b);

/// Points and axes agree: Φ = (p_b - p_a, n_a · e_b), 3 rows.
std::unique_ptr<Joint> make_rigid_weld(std::string name, MarkerPlace a, MarkerPlace b);

/// The point of b lies on axis 1 of a, axes are parallel: Φ = (n_a · (p_b - p_a), n_a · e_b), 2
/// rows. Free to slide.
std::unique_ptr<Joint> make_slider(std::string name, MarkerPlace a, MarkerPlace b);

/// Axis 1 of b stands at the angle motion(t) [rad] to axis 1 of a, counter-clockwise: with α the
/// angle, Φ = n_b · R(α) e_a = -sin(θ_b - θ_a - α), 1 row. Its multiplier is the moment [N m] that
/// the drive exerts on b.
std::unique_ptr<Joint> make_angle_drive(std::string name, MarkerPlace a, MarkerPlace b,
                                        std::function<Motion(double t)> motion);

/// The points are motion(t) [m] apart: Φ = (|p_b - p_a|² - L(t)²) / (2 L(0)), 1 row; a massless rod
/// where L is constant, and its multiplier is then the tension in it [N].
/// @throws Error (input) unless L(0) > 0; at evaluation unless L(t) > 0.
std::unique_ptr<Joint> make_distance(std::string name, MarkerPlace a, MarkerPlace b,
                                     std::function<Motion(double t)> motion);

/// Two wheels that roll on each other without slip.
struct GearData {
  int teeth_a = 1, teeth_b = 1;
  bool inner = false;  ///< does one of them have its teeth inside, so that both turn one way?
  double angle_a = 0, angle_b = 0;  ///< of axes 1 where these teeth are in mesh [rad]
};
/// The wheels of a and b turn as their numbers of teeth n_a, n_b say: with p/q = n_a/n_b in lowest
/// terms and s = 1 for outer, -1 for inner gearing,
///
///   Φ = [s p (θ_a - θ_a0) + q (θ_b - θ_b0)] / q, 1 row [rad]
///
/// Its multiplier is the moment [N m] on b, with the sign turned. Other roots, 2 π/q away, are
/// other teeth in mesh: a motion cannot reach them.
/// @throws Error (input) for a number of teeth that is not positive.
std::unique_ptr<Joint> make_gear(std::string name, MarkerPlace a, MarkerPlace b,
                                 const GearData& wheels);

/// The point of b runs along a curve in the axes of a: Φ is its signed distance from the curve, 1
/// row [m]. The multiplier is the force [N] across the curve on b, with the sign turned: there is
/// no friction.
/// @throws Error (numerical) at evaluation where the point leaves an open curve at one of its ends.
std::unique_ptr<Joint> make_path(std::string name, MarkerPlace a, MarkerPlace b, PlaneCurve curve);

/// Those components (0, 1; both when empty) of the point follow a path in the world: a row each.
std::unique_ptr<Joint> make_point_drive(std::string name, MarkerPlace a, PointDrive point,
                                        std::vector<int> components);

/// Plate edge welded to a frame on a rigid body or on the ground: make_weld() with a hub that is a
/// body. For every node of the edge, y its coordinate across, P and e₁, e₂ point and axes of the
/// frame,
///
///   r = P + y e₂,   r_n = e₂                                                (edge)
///   and r_m · e₂ = 0, r_mn · e₂ = 0                                         (direction)
///   or r_m = e₁, r_mn = 0                                                   (full)
///
/// with the rates along lines that move or are free, as there; z entries of a plate in space are
/// zero.
/// @throws Error (input) at bind() for an edge that is no m-line ("side_low", "side_high"), too.
std::unique_ptr<Joint> make_edge_weld(std::string name, std::string plate, std::string edge,
                                      MarkerPlace frame, WeldMode mode);

}  // namespace flexmorph::fem
