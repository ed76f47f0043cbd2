#pragma once

#include "geometry/vector_level.h"

namespace flexmorph {

/// Makes kernels use the vectors of this level at most, whatever the processor has. A program calls
/// it before the first kernel runs.
void limit_vector_level(VectorLevel most);

}  // namespace flexmorph
