#pragma once

#include "geometry/vector_level.h"

namespace flexmorph {

/// Limits the instruction set of kernels to a level, even if the processor has a higher one. A
/// program calls it before the first kernel runs.
void limit_vector_level(VectorLevel most);

}  // namespace flexmorph
