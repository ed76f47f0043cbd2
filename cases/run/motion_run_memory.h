#pragma once

#include "cases/output/run_folder.h"
#include "geometry/memory.h"

/// What a motion that goes on remembers of what it came to (geometry/memory.h).
namespace flexmorph {

namespace fem {
void remember(Memory& memory, EslSets& loads);  ///< all but the grid, which is the case's
}  // namespace fem

namespace cases {
void remember(Memory& memory, MotionRecord& record);  ///< all but the result
}  // namespace cases

}  // namespace flexmorph
