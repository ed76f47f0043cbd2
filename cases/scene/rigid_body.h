#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/base.h"

/// The rigid bodies of a case, [[rigid_body]], and locations on bodies.
namespace flexmorph::cases {

/// A location on a body or on the ground, with the direction of an axis.
struct Anchor {
  std::string body;  ///< Name of the body; empty for the ground.

  /// Location in the axes of the rigid body or of the ground; of a plate or beam the material point
  /// [m].
  Vec2 point{0, 0};

  double angle = 0;  ///< Angle of the first axis of the anchor in the axes of the body [rad].

  /// True if the case gives the point; if false, it is where the other anchor of the joint is at
  /// the start.
  bool given = true;

  /// Returns true if the anchor is on the ground.
  bool on_ground() const { return body.empty(); }
};

/// A rigid body in the plane. At the start its axes have the origin `position` and the angle
/// `angle`.
struct RigidBody {
  std::string name;                        ///< Name by which joints and tables refer to the body.
  double mass = 0;                         ///< Mass without `masses` [kg].
  double inertia = 0;                      ///< Moment of inertia about `center` [kg m^2].
  Vec2 center{0, 0};                       ///< Centre of mass in the axes of the body [m].
  Vec2 size{0, 0};                         ///< Sides of the rectangle drawn around `center` [m].
  Vec2 position{0, 0};                     ///< Origin of the axes; a guess with joints [m].
  double angle = 0;                        ///< Angle of the axes; a guess with joints [rad].
  std::optional<Vec2> velocity;            ///< Velocity of the origin at the start, if given [m/s].
  std::optional<double> angular_velocity;  ///< Angular velocity at the start, if given [rad/s].
  bool is_placed = false;                  ///< True if the case gives `position` or `angle`.
  std::string location;                    ///< Place in the file: "cases/four_bar.toml:14".

  /// A point mass that is fixed to the rigid body.
  struct AddedMass {
    double mass = 0;   ///< Mass of the point mass [kg].
    Vec2 point{0, 0};  ///< Location in the axes of the body [m].
  };
  std::vector<AddedMass> masses;  ///< Point masses ([[point_mass]]), not included in `mass`.
};

}  // namespace flexmorph::cases
