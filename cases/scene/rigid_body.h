#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/base.h"

/// [[rigid_body]], and places on bodies.
namespace flexmorph::cases {

/// A place on a body, or on the ground.
struct Anchor {
  std::string body;   ///< empty: the ground
  Vec2 point{0, 0};   ///< in the axes of a rigid body or the ground; material point of a plate [m]
  double angle = 0;   ///< of its first axis in those axes [rad]
  bool given = true;  ///< false: where the other anchor of the joint is at the start

  bool on_ground() const { return body.empty(); }
};

/// A rigid body in the plane; its axes lie at `position`, turned by `angle`, at the start.
struct RigidBody {
  std::string name;
  double mass = 0;                         ///< [kg]
  double inertia = 0;                      ///< about the centre of mass [kg m^2]
  Vec2 center{0, 0};                       ///< of mass, in the axes of the body [m]
  Vec2 size{0, 0};                         ///< of the rectangle around it that is drawn [m]
  Vec2 position{0, 0};                     ///< of the axes; a guess where joints say more [m]
  double angle = 0;                        ///< likewise [rad]
  std::optional<Vec2> velocity;            ///< of the axes at the start, where given [m/s]
  std::optional<double> angular_velocity;  ///< likewise [rad/s]
  bool is_placed = false;                  ///< is `position` or `angle` in the case?
  std::string place;                       ///< in the case: "cases/four_bar.toml:14"
  struct AddedMass {
    double mass = 0;   ///< [kg]
    Vec2 point{0, 0};  ///< in the axes of the body [m]
  };
  std::vector<AddedMass> masses;  ///< [[point_mass]] on it, no part of the others
};

}  // namespace flexmorph::cases
