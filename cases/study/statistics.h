#pragma once

#include <span>
#include <vector>

/// Figures that tell runs apart.
namespace flexmorph::cases {

/// Middle of the values (mean of the two middle ones of an even number).
/// @throws Error (input) for none.
double median(std::vector<double> values);

/// Are two sets of results told apart by their spread? They are when the median of neither lies
/// within the range of the other.
/// @throws Error (input) for an empty one.
bool told_apart(const std::vector<double>& a, const std::vector<double>& b);

/// Peaks of a history: local maxima that stand out, on both sides, by more than `share` of the best
/// (smallest) value reached so far. A new stage has another problem: there the count begins anew,
/// and neither the jump between stages nor the ends of a stage are peaks.
/// @param values  one per iteration; those that are not finite are passed over
/// @param stage   of the same iterations
int peaks(std::span<const double> values, std::span<const int> stage, double share = 0.02);

/// Smallest value of the feasible rows so far, anew in every stage; NaN before the first one.
/// @param violation  of the same rows; feasible up to `feasibility`
std::vector<double> best_so_far(std::span<const double> values, std::span<const double> violation,
                                std::span<const int> stage, double feasibility);

/// What one solver made of one problem, for a data profile.
struct SolveHistory {
  std::vector<double> solves, values;  ///< state solves and objective of its feasible iterates
};

/// Data profile of Moré and Wild (2009), SIAM J. Optim. 20, 172-191: share of the problems a solver
/// has brought within `tolerance` of the best value any solver found, after so many state solves.
///
/// @param runs  [solver][problem]
/// @return per solver the sorted numbers of solves at which a problem was solved; those it did not
///         solve are absent
std::vector<std::vector<double>> data_profile(std::span<const std::vector<SolveHistory>> runs,
                                              double tolerance);

}  // namespace flexmorph::cases
