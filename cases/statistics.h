#pragma once

#include <span>
#include <vector>

/// Figures that tell runs apart.
namespace flexmorph::cases {

/// Middle of the values (mean of the two middle ones of an even number).
/// @throws Error (input) for none.
double median(std::vector<double> values);

/// How often a history rises by more than `share` above what it had reached and falls again by as
/// much. Where the band of the design changes the count begins anew: a jump there is no peak.
/// @param values  positive, one per iteration
/// @param band    of the same iterations
int peaks(std::span<const double> values, std::span<const double> band, double share = 0.02);

/// What one solver made of one problem, for a data profile.
struct Progress {
  std::vector<double> solves, values;  ///< state solves and objective of its feasible iterates
};

/// Data profile of Moré and Wild (2009), SIAM J. Optim. 20, 172-191: share of the problems a solver
/// has brought within `tolerance` of the best value any solver found, after so many state solves.
///
/// @param runs  [solver][problem]
/// @return per solver the sorted numbers of solves at which a problem was solved; those it did not
///         solve are absent
std::vector<std::vector<double>> data_profile(std::span<const std::vector<Progress>> runs,
                                              double tolerance);

}  // namespace flexmorph::cases
