#pragma once

#include <functional>
#include <string>

#include "optim/search.h"

namespace flexmorph::optim {

/// A function that runs an optimization library once within lower <= x <= upper, from a start
/// design inside these bounds.
/// @returns one sentence that says why the library stopped
using BoxRun =
    std::function<std::string(const Point& start, const VectorXd& lower, const VectorXd& upper)>;

/// Calls a library that has no move limit of its own, again and again, until the search stops. Each
/// run starts at the best design and stays within best ± box and within the bounds. A run that
/// finds nothing better halves the box, because the next run would otherwise repeat it. A run that
/// moves the best design to the boundary of a reduced box doubles the box, up to its first size.
///
/// Without the box, the first steps of NLopt go half-way to the bounds and disconnect the
/// structure.
/// @param box  half width of the box, absolute in x; 0: the runs use the bounds alone, and the
///             search stops after the first run that finds nothing better
void search_in_boxes(Search& search, double box, const BoxRun& run);

}  // namespace flexmorph::optim
