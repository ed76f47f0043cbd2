#pragma once

#include "fem/marker.h"
#include "fem/shapes/plane_curve.h"

/// Joints between locations on planar rigid bodies, on plates and on the ground (fem/marker.h).
///
/// Every Φ except those of gears and paths is a polynomial of degree 2 at most in the unknowns.
/// Rows are lengths [m] with multipliers in N, or dimensionless numbers of the size of an angle
/// with multipliers in N m.
///
/// Rows that state "axes are parallel" (n_a · e_b = 0 with n_a = e_a turned by +90 degrees) are
/// also fulfilled by axes that point in opposite directions. A motion cannot change between the two
/// solutions because they differ by 180 degrees; the initial state decides which one holds.
/// Therefore the caller that assembles the initial state has to start near the intended solution.
///
/// All functions of this header:
/// @throws Error (input) at Joint::bind() for bodies, points and axes that do not exist, see
/// Marker::bind(); Error (input) at once for a missing motion function.
namespace flexmorph::fem {

/// Creates the joint |u|² = 1 of a rigid body: Φ = (u·u - 1)/2, 1 row. Every rigid body needs it
/// exactly once.
std::unique_ptr<Joint> make_unit_axis(std::string name, std::string body);

/// Creates a revolute joint, in which the two points coincide: Φ = p_b - p_a, 2 rows. The
/// multiplier is the negative of the force [N] that a exerts on b.
std::unique_ptr<Joint> make_revolute(std::string name, MarkerLocation a, MarkerLocation b);

/// Creates a rigid connection, in which points and axes coincide: Φ = (p_b - p_a, n_a · e_b), 3
/// rows.
std::unique_ptr<Joint> make_rigid_weld(std::string name, MarkerLocation a, MarkerLocation b);

/// Creates a prismatic joint: the point of b slides freely along axis 1 of a, and the axes are
/// parallel: Φ = (n_a · (p_b - p_a), n_a · e_b), 2 rows.
std::unique_ptr<Joint> make_slider(std::string name, MarkerLocation a, MarkerLocation b);

/// Creates a rotational drive: the angle from axis 1 of a to axis 1 of b is motion(t) [rad],
/// counter-clockwise. With α that angle, Φ = n_b · R(α) e_a = -sin(θ_b - θ_a - α), 1 row. The
/// multiplier is the moment [N m] that the drive exerts on b.
std::unique_ptr<Joint> make_angle_drive(std::string name, MarkerLocation a, MarkerLocation b,
                                        std::function<Motion(double t)> motion);

/// Creates a joint that keeps the two points at the distance L(t) = motion(t) [m]: Φ = (|p_b -
/// p_a|² - L(t)²) / (2 L(0)), 1 row. Where L is constant the joint is a massless rod, and the
/// multiplier is the tension in it [N].
/// @throws Error (input) unless L(0) > 0; at evaluation unless L(t) > 0.
std::unique_ptr<Joint> make_distance(std::string name, MarkerLocation a, MarkerLocation b,
                                     std::function<Motion(double t)> motion);

/// Data of two gear wheels that roll on each other without slip.
struct GearData {
  /// Numbers of teeth of the wheels on a and on b, both positive.
  int teeth_a = 1, teeth_b = 1;
  /// True if one wheel has internal teeth, so that both wheels turn in the same direction.
  bool inner = false;
  /// Angles of axis 1 of a and of b in a position in which the teeth mesh [rad].
  double angle_a = 0, angle_b = 0;
};
/// Creates a gear pair: the wheels of a and b turn as their numbers of teeth n_a, n_b prescribe.
/// With p/q = n_a/n_b in lowest terms and s = 1 for outer, -1 for inner gearing,
///
///   Φ = [s p (θ_a - θ_a0) + q (θ_b - θ_b0)] / q, 1 row [rad]
///
/// The multiplier is the negative of the moment [N m] on b. Further solutions at distances of 2 π/q
/// correspond to other pairs of teeth in mesh; a motion cannot reach them.
/// @throws Error (input) for a number of teeth that is not positive.
std::unique_ptr<Joint> make_gear(std::string name, MarkerLocation a, MarkerLocation b,
                                 const GearData& wheels);

/// Creates a joint in which the point of b moves along a curve given in the axes of a: Φ is the
/// signed distance of the point from the curve, 1 row [m]. The multiplier is the negative of the
/// force [N] on b normal to the curve; there is no friction.
/// @throws Error (numerical) at evaluation where the point leaves an open curve at one of its ends.
std::unique_ptr<Joint> make_path(std::string name, MarkerLocation a, MarkerLocation b,
                                 PlaneCurve curve);

/// Creates a joint in which the given components (0, 1; both if empty) of the point of a follow a
/// path in the world frame, with one row per component.
std::unique_ptr<Joint> make_point_drive(std::string name, MarkerLocation a, PointDrive point,
                                        std::vector<int> components);

/// Creates a joint that welds a plate edge to a frame on a rigid body or on the ground, as
/// make_weld() does to a frame with prescribed motion. For every node of the edge, with y its
/// coordinate across the plate and P, e₁, e₂ the point and the axes of the frame,
///
///   r = P + y e₂,   r_n = e₂                                                (edge)
///   and r_m · e₂ = 0, r_mn · e₂ = 0                                         (direction)
///   or r_m = e₁, r_mn = 0                                                   (full)
///
/// On material lines that are driven or free the rates are total rates along the line, as in
/// make_weld(). The z entries of a plate in space are zero.
/// @throws Error (input) at bind() also for an edge that is no m-line ("side_low", "side_high").
std::unique_ptr<Joint> make_edge_weld(std::string name, std::string plate, std::string edge,
                                      MarkerLocation frame, WeldMode mode);

}  // namespace flexmorph::fem
