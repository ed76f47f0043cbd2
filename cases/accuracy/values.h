#pragma once

#include <string>
#include <vector>

#include "cases/results/quantities.h"

/// Quantities of interest, and functions that read their values from run folders.
namespace flexmorph::cases {

/// Returns the subproblem to which a quantity belongs.
/// @throws Error (input), with the existing names, for an unknown name; for a time after the end of
///         the run; and for a time with a quantity that is not a column of a table
Part part_of(const PreparedCase& prepared, const Interest& interest);

/// Returns the value of a column that a quantity of interest selects. The value at a time is
/// interpolated by a cubic polynomial through four rows. The largest absolute value is the extremum
/// of a parabola through the largest row and its neighbours.
/// @param x  abscissa (n_rows), strictly increasing
/// @param y  values of the column (n_rows)
/// @return NaN for a time outside of x, and without rows
double value_at(const std::vector<double>& x, const std::vector<double>& y,
                const Interest& interest);

/// Returns the value of a quantity in a run folder.
/// @throws Error (numerical) if the folder has no such value, or if the value is not finite.
double value_in(const std::string& folder, const Interest& interest, Part part);

/// Returns the reference value of a quantity: the given number, or a number read from a file.
/// @throws Error (input) if the file does not contain the value.
double reference_of(const Interest& interest);

}  // namespace flexmorph::cases
