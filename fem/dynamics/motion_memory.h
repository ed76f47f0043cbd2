#pragma once

#include "fem/dynamics/motion.h"

/// What a motion that goes on remembers of its parts (geometry/memory.h).
namespace flexmorph::fem {

/// All but what belongs to the end (MotionResult::final, condition) and the trajectory.
void remember(Memory& memory, MotionResult& result);

/// Meshes of growing bodies, and where the model was prepared as a whole with them: put back, it
/// is.
void remember_meshes(Memory& memory, Workspace& model, std::span<const Growth> growths);

}  // namespace flexmorph::fem
