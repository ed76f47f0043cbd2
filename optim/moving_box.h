#pragma once

#include <functional>
#include <string>

#include "optim/search.h"

namespace flexmorph::optim {

/// One run of a library within lower <= x <= upper, from a design inside.
/// @returns one sentence: why the library ended
using BoxRun =
    std::function<std::string(const Point& start, const VectorXd& lower, const VectorXd& upper)>;

/// Runs of a library that has no move limit of its own, each inside best ± box and the bounds,
/// until the search stops: a run that finds nothing better halves the box (its successor would
/// repeat it otherwise), one that reaches the wall of a box smaller than the first doubles it.
///
/// Without it the first steps of NLopt go half-way to the bounds and take a structure apart.
/// @param box  half its width, absolute in x; 0: runs within the bounds, until one finds nothing
void search_in_boxes(Search& search, double box, const BoxRun& run);

}  // namespace flexmorph::optim
