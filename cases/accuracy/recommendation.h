#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cases/accuracy/study.h"

/// Which levels of all parameters together are the cheapest for an error.
namespace flexmorph::cases {

/// A level of a group of parameters that may be recommended.
struct Candidate {
  std::string name;
  std::vector<std::string> overrides;
  std::vector<double> errors;  ///< of each quantity, relative; 0 where the group does not touch it
  std::vector<double> costs;   ///< of each part, in run times of the case itself
};

/// Parameters of which one level is taken.
struct Group {
  std::string name;
  std::vector<Candidate> candidates;
};

/// A combination of levels, one of each group, with its errors and its cost.
struct Choice {
  std::vector<size_t> picked;  ///< a candidate of each group
  std::vector<double> errors;  ///< of each quantity: sum over groups and its uncertainty
  double cost = 0;             ///< [s]
};

/// Returns the cheapest choice with Σ errors + uncertainty <= target for each quantity, where the
/// cost is Σ over parts of base cost times the ratios of all groups. Candidates whose errors or
/// costs are not finite are ignored; of equal costs the smaller error wins.
std::optional<Choice> cheapest(const std::vector<Group>& groups, std::span<const double> base_costs,
                               std::span<const double> uncertainties, double target);

/// Levels of a series that is not converged count where its limit's uncertainty is at most the
/// target over this number.
inline constexpr double kClearance = 10;
/// The error of a verified recommendation over its target that still keeps it.
inline constexpr double kTargetFactor = 1.5;

/// Returns the groups that matter to what the target covers, with the levels that may be
/// recommended: measured ones, and those cut by the budget where the order predicts their errors. A
/// series that is not converged offers its finest level, and coarser measured ones by their
/// distance from it where the limit's uncertainty is at most target / kClearance.
std::vector<Group> groups_of(const AccuracyStudy& study, double target);

/// Returns the cheapest settings whose errors add up to `share` of the target at most. The target
/// is about the quantities whose limits are known to it.
Recommendation recommend(const AccuracyStudy& study, double target, double share = 1);

/// Compares a recommendation with the values of its run: errors up to kTargetFactor times the
/// target keep it, larger ones withdraw it.
void verify(const AccuracyStudy& study, const std::vector<double>& values, double seconds_cpu,
            Recommendation& out);

}  // namespace flexmorph::cases
