#pragma once

#include <span>
#include <vector>

#include "cases/scene/scene.h"
#include "optim/mmc/compliance_evaluator.h"
#include "optim/mmc/design.h"

namespace flexmorph::cases {

/// Supports and loads of a static scene, by the nodes of its design mesh.
struct StaticConditions {
  std::vector<fem::HeldUnknown> held;
  std::vector<mmc::LoadCase> loads;
};
/// @throws Error (input) for a place without a node of the domain.
StaticConditions static_conditions(const Scene& scene, const Grid& grid,
                                   std::span<const signed char> outside);
/// Gravity of a plate at rest; zero where the case gives none [m/s^2].
Vec2 weight_of(const Scene& scene);
/// The middle lines of a static scene's grid that its domain, regions, supports and loads are
/// symmetric to; a load case may be another one's image, or the image of its opposite. Nothing for
/// a scene that moves.
mmc::Symmetry symmetry_of(const Scene& scene, const BodyDesign& design,
                          std::span<const signed char> outside);
}  // namespace flexmorph::cases
