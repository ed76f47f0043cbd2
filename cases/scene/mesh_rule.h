#pragma once

#include "cases/scene/scene.h"
#include "io/case_files/case_file.h"

namespace flexmorph::cases {

/// Determines how the mesh of a body follows its changing length, and its number of elements. If
/// the case does not give `mesh`, it is "uniform" where the length changes by
/// less than a factor of four, no element becomes shorter than min_length, and no load, spring,
/// joint or mass acts inside of the body, where moving lines would pass it; otherwise lines are
/// inserted and removed ("split").
/// @param body_table  [[body]], with a [body.flow]
/// @param scene       with all of the motion read
/// @throws Error (input) for limits that the mesh cannot keep.
void choose_mesh(const io::Table& body_table, const Scene& scene, Body& body);

}  // namespace flexmorph::cases
