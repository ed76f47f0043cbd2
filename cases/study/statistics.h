#pragma once

#include <span>
#include <vector>

/// Statistics that compare runs.
namespace flexmorph::cases {

/// Returns the median of the values (the mean of the two middle values of an even number).
/// @throws Error (input) if there are no values.
double median(std::vector<double> values);

/// Tells whether two sets of results differ by more than their spread: the median of each set lies
/// outside the range of the other set.
/// @throws Error (input) for an empty set.
bool distinguishable(const std::vector<double>& a, const std::vector<double>& b);

/// Counts the peaks of a history. A peak is a local maximum that exceeds the values on both sides
/// by more than `share` of the best (smallest) value so far. The comparison restarts at every
/// stage, because a new stage has another problem: neither the jump between stages nor the ends of
/// a stage are peaks.
/// @param values  one value per iteration; values that are not finite are skipped
/// @param stage   stage of every iteration
int peaks(std::span<const double> values, std::span<const int> stage, double share = 0.02);

/// Returns, for every row, the smallest value of the feasible rows so far in its stage; NaN before
/// the first feasible row.
/// @param violation  violation of the limits of every row; a row is feasible up to `feasibility`
/// @param stage      stage of every row
std::vector<double> best_so_far(std::span<const double> values, std::span<const double> violation,
                                std::span<const int> stage, double feasibility);

/// The history of one solver on one problem, for a data profile.
struct SolveHistory {
  std::vector<double> solves, values;  ///< State solves and objectives of feasible iterates.
};

/// Computes data profiles: the fraction of the problems that a solver has brought within
/// `tolerance` of the best value of all solvers, as a function of the number of state solves.
///
/// Source: Moré and Wild (2009), SIAM J. Optim. 20, 172-191.
/// @param runs  histories, [solver][problem]
/// @return for every solver the sorted numbers of solves at which a problem was solved; problems
///         that the solver did not solve are absent
std::vector<std::vector<double>> data_profile(std::span<const std::vector<SolveHistory>> runs,
                                              double tolerance);

}  // namespace flexmorph::cases
