#pragma once

#include "cases/scene/scene.h"
#include "io/case_files/case_file.h"

namespace flexmorph::cases {

/// Settles how the mesh of a body follows its length, and its number of elements. Where the case
/// does not say it, the mesh is even where the length changes by less than a factor of four,
/// elements keep to min_length, and nothing acts on places of the body that its lines would pass;
/// else lines come and go.
/// @param body_table  [[body]], with a [body.flow]
/// @param scene       all of it read
/// @throws Error (input) for limits that the mesh cannot keep.
void settle_mesh(const io::Table& body_table, const Scene& scene, Body& body);

}  // namespace flexmorph::cases
