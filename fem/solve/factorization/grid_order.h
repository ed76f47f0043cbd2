#pragma once

#include <vector>

#include "geometry/grid.h"

namespace flexmorph::fem {

/// Returns all nodes of a grid in the order of nested dissection: a line of nodes halves the longer
/// side of a rectangle and is ordered after both halves, recursively down to rectangles of few
/// nodes. For n nodes of a square the Cholesky factor has O(n log n) entries, which is optimal.
///
/// Source: George (1973), SIAM J. Numer. Anal. 10, 345-363.
std::vector<int> dissection_order(const Grid& grid);

}  // namespace flexmorph::fem
