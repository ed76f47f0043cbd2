#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cases/accuracy/study.h"

/// Search of the cheapest combination of levels of all discretization parameters for a target
/// error.
namespace flexmorph::cases {

/// A level of a group of discretization parameters that may be recommended.
struct Candidate {
  std::string name;                    ///< Name of the parameter and of the level.
  std::vector<std::string> overrides;  ///< Overrides of the level, "KEY=VALUE".

  /// Relative error of each quantity (n_quantities) [-]; 0 if the group does not change a quantity.
  std::vector<double> errors;

  /// Run time in each subproblem, relative to the run time of the unchanged case (n_parts) [-].
  std::vector<double> costs;
};

/// A group of discretization parameters; one level of the group is chosen.
struct Group {
  std::string name;                   ///< Name of the group and of its leading parameter.
  std::vector<Candidate> candidates;  ///< Levels that may be chosen.
};

/// A combination of levels, one level of each group, with its errors and its cost.
struct LevelChoice {
  std::vector<size_t> picked;  ///< Index of the chosen candidate of each group (n_groups).
  std::vector<double> errors;  ///< Sum of errors and uncertainty of each quantity (n_quantities).
  double cost = 0;             ///< Predicted run time [s].
};

/// Returns the cheapest choice with Σ errors + uncertainty <= target for each quantity; nothing if
/// there is no such choice. The cost is the sum over subproblems of the base cost times the
/// relative costs of the candidates of all groups. Candidates whose errors or costs are not finite
/// are ignored. Among choices of equal cost, the one with the smallest largest error is returned.
/// @param base_costs     run time of the unchanged case in each subproblem (n_parts) [s]
/// @param uncertainties  relative uncertainty of the limit of each quantity (n_quantities) [-]
/// @param target         target error [-]
std::optional<LevelChoice> cheapest(const std::vector<Group>& groups,
                                    std::span<const double> base_costs,
                                    std::span<const double> uncertainties, double target);

/// Ratio of the target error to the uncertainty of the limit of a series that is not converged,
/// from which on its levels can be recommended.
inline constexpr double kClearance = 10;
/// Largest ratio of the measured error to the target error of a recommendation that is kept.
inline constexpr double kTargetFactor = 1.5;

/// Returns the groups that change the quantities covered by the target, with the levels that may be
/// recommended: measured levels, and levels that were cut by the budget if their errors are
/// predicted by the order. A series that is not converged contributes its finest level. Its coarser
/// measured levels are added if the uncertainty of its limit is at most target / kClearance; their
/// error is the difference from the finest level.
std::vector<Group> groups_of(const AccuracyStudy& study, double target);

/// Returns the cheapest settings whose sum of errors is at most `share` of the target. The target
/// covers the quantities whose limits have an uncertainty of at most the target.
/// @param share  fraction of the target, 0..1
Recommendation recommend(const AccuracyStudy& study, double target, double share = 1);

/// Verifies a recommendation with the values of its run. It is kept for errors up to kTargetFactor
/// times the target, and withdrawn for larger errors.
/// @param values  values of all quantities in the run of the recommendation (n_quantities)
void verify(const AccuracyStudy& study, const std::vector<double>& values, double seconds_cpu,
            Recommendation& out);

}  // namespace flexmorph::cases
