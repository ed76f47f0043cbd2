#pragma once

#include "cases/scene/scene.h"
#include "fem/body_joints.h"
#include "fem/force_element.h"

namespace flexmorph::cases {

/// A function that returns the location of an anchor in a model. In the flexible model it is a
/// material point of a plate, in the rigid kinematic model a point of a rigid body.
using FindLocation = std::function<fem::MarkerLocation(const Anchor&)>;

/// Creates a joint of a model. The result is null where the model does not need the joint, and for
/// joints that hold edges, which are created elsewhere (see JointRow::make).
/// @param location  returns the location of an anchor in the model
/// @param rigid  true for the rigid kinematic model
std::unique_ptr<fem::Joint> make_joint(const Scene& scene, const Joint& joint,
                                       const FindLocation& location, bool rigid);

/// Creates the force element of a spring.
/// @param location  returns the location of an anchor in the model
std::unique_ptr<fem::ForceElement> make_force_element(const Scene& scene, const Spring& spring,
                                                      const FindLocation& location);

/// Returns the position of an anchor at the start, from the positions and angles of the case [m].
Vec2 start_location(const Scene& scene, const Anchor& anchor);
/// Returns an anchor with its point. A point that the case does not give is the position of the
/// second anchor of the joint at the start.
/// @param other  second anchor of the joint
Anchor completed(const Scene& scene, const Anchor& anchor, const Anchor& other);

}  // namespace flexmorph::cases
