#pragma once

#include <vector>

#include "geometry/grid.h"

namespace flexmorph::fem {

/// All nodes of a grid by nested dissection: a line of nodes halves the longer side of a rectangle
/// and comes behind both halves, and so on down to rectangles of few nodes. For n nodes of a square
/// the Cholesky factor has O(n log n) entries, as few as any order can bring it to.
///
/// Source: George (1973), SIAM J. Numer. Anal. 10, 345-363.
std::vector<int> dissection_order(const Grid& grid);

}  // namespace flexmorph::fem
