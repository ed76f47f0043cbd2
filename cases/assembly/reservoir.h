#pragma once

#include "cases/scene/scene.h"
#include "fem/material_reservoir.h"

namespace flexmorph::cases {

/// Returns the material reservoirs of a rigid body, one for each plate that is fed out of it.
std::vector<fem::MaterialReservoir> reservoirs_in(const Scene& scene,
                                                  const std::string& rigid_body);

/// Adds the outlets to a model: force elements that transfer material from reservoirs into plates.
void add_outlets(const Scene& scene, fem::Model& model);

}  // namespace flexmorph::cases
