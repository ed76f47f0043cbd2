#pragma once

#include "fem/load_law.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// What a planar rigid body is made of.
struct RigidSection {
  double mass = 1;     ///< [kg]
  Vec2 center{0, 0};   ///< (X, Y) of the centre of mass in the body's axes [m]
  double inertia = 1;  ///< about the centre of mass [kg m²]
};

/// What terms that vary in time ask the elements of a rigid body.
class RigidClock {
 public:
  virtual double time() const = 0;  ///< of the last Element::move_to() [s]

 protected:
  ~RigidClock() = default;
};

/// Inertia of a planar rigid body (elements/rigid_body.h): a constant mass matrix.
/// @throws Error (input) unless mass and inertia are positive and all numbers finite; at prepare()
/// for a body that is not rigid.
std::unique_ptr<Term> make_rigid_inertia(const RigidSection& section);
/// Its weight; gravity (2) [m/s²].
/// @throws Error (input) as above, and for gravity of another size.
std::unique_ptr<Term> make_rigid_gravity(const RigidSection& section, const LoadLaw& gravity);

}  // namespace flexmorph::fem
