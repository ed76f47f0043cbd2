#pragma once

#include "fem/dynamics/motion.h"

/// Archive (checkpoint) of a motion from which it can be continued (geometry/archive.h).
namespace flexmorph::fem {

/// Saves or restores the result of a motion, without the trajectory and without the members that
/// are set only at the end (MotionResult::final, counts and condition).
void archive(Archive& memory, MotionResult& result);

/// Saves or restores the meshes of the bodies with moving-root mesh control, the constraint rows
/// that the model leaves out, and the time and the free lines for which all parts of the model were
/// last prepared together. After restoring, the
/// model is prepared for them.
/// @throws Error (input) if the archive does not fit the mesh of a body.
void archive_meshes(Archive& memory, Workspace& model, std::span<const MovingRoot> moving_roots);

}  // namespace flexmorph::fem
