#pragma once

#include "fem/element.h"
#include "fem/load_law.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// What a planar rigid body is made of.
struct RigidSection {
  double mass = 0;     ///< [kg], to be positive
  Vec2 center{0, 0};   ///< (X, Y) of the centre of mass in the body's axes [m]
  double inertia = 0;  ///< about the centre of mass [kg m²], to be positive
};

/// What terms that vary in time ask the elements of a rigid body.
class RigidClock {
 public:
  virtual double time() const = 0;  ///< of the last Element::move_to() [s]

 protected:
  ~RigidClock() = default;
};

/// Makes the element of a planar rigid body (elements/rigid_body.h).
/// @param length  makes the axis a displacement: a size of the body [m]
/// @param moves   does its mass change in time, with material that it stores (fem/stored.h)?
/// @throws Error (input) unless the length is positive.
std::unique_ptr<Element> make_rigid_body(double length, bool moves = false);

/// Inertia of a planar rigid body (elements/rigid_body.h): a constant mass matrix.
/// @throws Error (input) unless mass and inertia are positive and all numbers finite; at prepare()
/// for a body that is not rigid.
std::unique_ptr<Term> make_rigid_inertia(const RigidSection& section);
/// Its weight; gravity (2) [m/s²].
/// @throws Error (input) as above, and for gravity of another size.
std::unique_ptr<Term> make_rigid_gravity(const RigidSection& section, const LoadLaw& gravity);

}  // namespace flexmorph::fem
