#pragma once

#include "cases/scene/scene.h"
#include "fem/stored.h"

namespace flexmorph::cases {

/// What a rigid body stores of plates that grow out of it, one after the other.
std::vector<fem::StoredMaterial> stored_in(const Scene& scene, const std::string& rigid_body);

/// What brings stored material into plates.
void add_outlets(const Scene& scene, fem::Model& model);

}  // namespace flexmorph::cases
