#pragma once

#include "cases/scene/scene.h"
#include "fem/body_joints.h"
#include "fem/link.h"

namespace flexmorph::cases {

/// Where an anchor is in the model at hand: in the flexible one plates have material points, in the
/// rigid kinematic model they have places on a rigid body.
using FindPlace = std::function<fem::MarkerPlace(const Anchor&)>;

/// The joint of the model; nothing where the model at hand does not need it, and of edges, which
/// are not made one by one: see JointRow::make.
/// @param rigid  is it the rigid kinematic model?
std::unique_ptr<fem::Joint> make_joint(const Scene& scene, const Joint& joint,
                                       const FindPlace& place, bool rigid);

std::unique_ptr<fem::Link> make_link(const Scene& scene, const Spring& spring,
                                     const FindPlace& place);

/// Position of an anchor at the start, as far as the case says [m]; of a joint's other anchor where
/// it is not given itself.
Vec2 start_place(const Scene& scene, const Anchor& anchor);
Anchor completed(const Scene& scene, const Anchor& anchor, const Anchor& other);

}  // namespace flexmorph::cases
