#pragma once

#include "cases/scene/scene.h"
#include "fem/body_joints.h"
#include "fem/link.h"

namespace flexmorph::cases {

/// Where an anchor is in the model at hand: in the flexible one plates have material points, in the
/// rigid twin they have places on a rigid body.
using FindPlace = std::function<fem::MarkerPlace(const Anchor&)>;

/// A joint between bodies (revolute, slider, weld of two rigid bodies, drives).
std::unique_ptr<fem::Joint> make_body_joint(const Scene& scene, const Joint& joint,
                                            const FindPlace& place);

std::unique_ptr<fem::Link> make_link(const Spring& spring, const FindPlace& place);

/// Position of an anchor at the start, as far as the case says [m]; of a joint's other anchor where
/// it is not given itself.
Vec2 start_place(const Scene& scene, const Anchor& anchor);
Anchor completed(const Scene& scene, const Anchor& anchor, const Anchor& other);

}  // namespace flexmorph::cases
