#pragma once

#include "fem/element.h"
#include "fem/load_law.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// Mass properties of a planar rigid body.
struct RigidSection {
  double mass = 0;     ///< Mass [kg], positive.
  Vec2 center{0, 0};   ///< Coordinates (X, Y) of the centre of mass in the axes of the body [m].
  double inertia = 0;  ///< Moment of inertia about the centre of mass [kg m²], positive.
};

/// Interface through which time-dependent terms read the time of the elements of a rigid body.
class RigidClock {
 public:
  /// Returns the time of the last Element::move_to() [s].
  virtual double time() const = 0;

 protected:
  ~RigidClock() = default;
};

/// Creates the element of a planar rigid body (elements/rigid_body.h).
/// @param length  length that turns the axis into a displacement: a size of the body [m]
/// @param moves   true if the mass changes in time because of a material reservoir
/// (fem/material_reservoir.h)
/// @throws Error (input) unless the length is positive.
std::unique_ptr<Element> make_rigid_body(double length, bool moves = false);

/// Creates the inertia of a planar rigid body, a constant mass matrix (elements/rigid_body.h).
/// @throws Error (input) unless mass and inertia are positive and all numbers finite; at prepare()
/// for a body that is not rigid.
std::unique_ptr<Term> make_rigid_inertia(const RigidSection& section);
/// Creates the weight of a planar rigid body under gravity (2) [m/s²].
/// @throws Error (input) as make_rigid_inertia(), and for gravity with another number of
/// components.
std::unique_ptr<Term> make_rigid_gravity(const RigidSection& section, const LoadLaw& gravity);

}  // namespace flexmorph::fem
