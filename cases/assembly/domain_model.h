#pragma once

#include "cases/assembly/prepared_case.h"

namespace flexmorph::cases {

/// Returns a model of the plate of a static scene on its design mesh, with its supports and full
/// material, for natural modes. Node k of the mesh has the unknowns 2 k and 2 k + 1. Cells outside
/// of the domain have a negligible stiffness and mass, so that every node has both.
/// @throws Error (input) for a plate without a density
fem::Workspace domain_model(const PreparedCase& prepared);

}  // namespace flexmorph::cases
