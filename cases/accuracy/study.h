#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/accuracy/parameters.h"
#include "cases/study/study.h"

/// The data of an accuracy study of one case: the measured refinement series, and the estimates and
/// recommendations computed from them.
namespace flexmorph::cases {

/// A level of a refinement series, and the result of its run.
struct LevelRun {
  Level level;                         ///< The setting.
  std::string status = "open";         ///< Status: "open", "measured", "cut", "refused", "failed",
                                       ///< "missing".
  std::string message;                 ///< Reason of a refusal or failure.
  double seconds_cpu = 0, memory = 0;  ///< CPU time [s] and peak memory [bytes].
  int unknowns = 0;                    ///< Number of unknowns of the discretized problem.

  /// Values of all quantities (n_quantities); NaN for quantities of another subproblem.
  std::vector<double> values;

  /// Errors of all quantities against the limit of the group, relative to their scales
  /// (n_quantities) [-]. If the parameter has a limit of its own, the error of a level is the
  /// largest error of this level and all finer ones.
  std::vector<double> errors;

  /// Tells whether the level was measured.
  bool measured() const { return status == "measured"; }
  /// Tells whether the level is the unchanged case.
  bool is_case() const { return level.overrides.empty(); }
};

/// The levels of a discretization parameter in one subproblem, and their limits.
struct RefinementSeries {
  const Parameter* parameter = nullptr;  ///< The discretization parameter.
  Part part = Part::motion;              ///< The subproblem.
  double first_guess = 0;                ///< Run time at h = 1 if no level was measured [s].
  double cost_factor = 1;                ///< Factor of the cost exponent of the parameter [-].
  std::vector<std::optional<Theory>> theories;  ///< Theories of all quantities (n_quantities).
  std::vector<LevelRun> levels;                 ///< Levels, coarse to fine.

  /// Limits of all quantities (n_quantities); NaN for quantities of another subproblem.
  std::vector<ExtrapolatedLimit> limits;

  /// Tells whether the parameter leads its group.
  bool leads() const { return parameter->name == parameter->group; }
  /// Returns the number of levels with the given status.
  size_t count(const std::string& status) const;
  /// Returns the run time of a level [s]. It is measured, or predicted by the power law through the
  /// two nearest measured levels. The exponent of the power law is limited to a factor of 2 from
  /// the estimated exponent of the parameter.
  double seconds(size_t level) const;
};

/// The estimated limit of a quantity for refinement of all parameters.
struct Estimate {
  double own = 0;    ///< Value of the unchanged case.
  double scale = 1;  ///< Scale of the errors, in the unit of the quantity.
  double value = 0;  ///< Estimated limit: own + Σ over groups of (limit of the group - own).

  /// Sum over groups of the uncertainties of the limits, relative to the scale [-]; infinite if the
  /// limit of a group is not bounded.
  double uncertainty = 0;

  std::string unbounded;  ///< Names of the parameters without a bounded limit.
  bool has_limit = true;  ///< True unless theory excludes a limit; else not covered by targets.
};

/// The cheapest settings for a target error.
struct Recommendation {
  double target = 0;  ///< Target error [-].

  /// Overrides and names of the levels; empty if no settings reach the target.
  std::vector<std::string> overrides, names;

  double error = 0, seconds = 0;  ///< Predicted largest error [-] and run time [s].

  /// True if a run has tested the settings, and true if the recommendation is withdrawn.
  bool verified = false, withdrawn = false;

  /// True for each quantity that the recommendation covers (n_quantities).
  std::vector<bool> covers;

  /// Largest error [-] and CPU time [s] of the run that verified the settings.
  double measured_error = 0, seconds_cpu = 0;

  std::string sentence, file;  ///< Verdict as text, and name of the written case file.
};

/// An accuracy study of one case: quantities, refinement series, estimates and recommendations.
struct AccuracyStudy {
  std::string title;                              ///< Title of the reports.
  std::vector<Interest> interests;                ///< Quantities of interest (n_quantities).
  std::vector<std::optional<double>> references;  ///< Reference values (n_quantities).
  std::vector<Part> parts;                        ///< Subproblems of the quantities (n_quantities).
  std::vector<RefinementSeries> series;           ///< Refinement series.
  std::vector<std::pair<std::string, std::string>> absent;  ///< Absent parameters, with reasons.
  std::map<Part, LevelRun> own;                 ///< Runs of the unchanged case, by subproblem.
  std::vector<Estimate> estimates;              ///< Estimated limits (n_quantities).
  std::vector<Recommendation> recommendations;  ///< Recommended settings, one per target.
};

/// Returns the series that defines the limit of a group in a subproblem; null if there is none.
const RefinementSeries* leader_of(const AccuracyStudy& study, const std::string& group, Part part);

/// Number of measured levels from which on a series has a lower priority than series with fewer.
inline constexpr size_t kEnoughLevels = 5;

/// Returns the indices of the series and of the level to measure next; nothing if no level is open.
/// It is the level with the shortest run time among the coarsest open levels of all series. For
/// this comparison, the run time is multiplied by 4 in a series that does not lead its group, and
/// by 2 for each level from number kEnoughLevels + 1 on. A level that would take longer than `left`
/// is cut, together with all finer levels of its series.
/// @param left  remaining CPU time [s]
std::optional<std::pair<size_t, size_t>> next_level(std::vector<RefinementSeries>& series,
                                                    double left);

/// Computes the limits, the errors of levels, and the estimates from the measured values.
/// @throws Error (input) for a quantity that is 0 and has no scale.
void evaluate(AccuracyStudy& study);

}  // namespace flexmorph::cases
