#pragma once

#include <string>
#include <vector>

#include "cases/results/quantities.h"

/// Quantities of interest and their values in run folders.
namespace flexmorph::cases {

/// Returns the part that a quantity belongs to.
/// @throws Error (input) with the candidates for a name that no part knows, for a time outside of
///         the run, and for a design's figure with a time.
Part part_of(const PreparedCase& prepared, const Interest& interest);

/// Returns the value of a column at a time, by cubic interpolation between four rows; its largest
/// size by a parabola through the largest row and its neighbours.
/// @param x  ascending, with y; at least one row
/// @return NaN outside of x
double value_at(const std::vector<double>& x, const std::vector<double>& y,
                const Interest& interest);

/// Returns the value of a quantity in a run folder.
/// @throws Error (numerical) when it is not there, or no number.
double value_in(const std::string& folder, const Interest& interest, Part part);

/// Returns the reference of a quantity. @throws Error (input) when its file does not hold it.
double reference_of(const Interest& interest);

}  // namespace flexmorph::cases
