#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/accuracy/parameters.h"
#include "cases/study/study.h"

/// The refinement series of one case as data: what was measured, and what follows from it.
namespace flexmorph::cases {

/// A level of a series, and the result of its run.
struct LevelRun {
  Level level;
  std::string status = "open";         ///< "measured", "cut", "refused", "failed"
  std::string message;                 ///< why refused or failed
  double seconds_cpu = 0, memory = 0;  ///< [s], [bytes]
  int unknowns = 0;
  std::vector<double> values;  ///< of all quantities; NaN of the other part, or not measured
  /// Of all quantities, relative to their scales, against the limit of the group: the largest error
  /// of this level and all finer ones.
  std::vector<double> errors;

  bool measured() const { return status == "measured"; }
  bool is_case() const { return level.overrides.empty(); }
};

/// The levels of a parameter in one part, and their limits.
struct RefinementSeries {
  const Parameter* parameter = nullptr;
  Part part = Part::motion;
  double first_guess = 0;  ///< run time at h = 1 where no level was measured [s]
  double cost_factor = 1;  ///< of the cost exponent of the parameter
  std::vector<std::optional<Theory>> theories;  ///< of all quantities
  std::vector<LevelRun> levels;                 ///< coarse to fine
  std::vector<Limit> limits;                    ///< of all quantities; NaN of the other part

  bool leads() const { return parameter->name == parameter->group; }
  size_t count(const std::string& status) const;
  /// Returns the run time of a level [s]: measured, or by the power law through its two nearest
  /// measured levels, its exponent within a factor 2 of the one of the parameter.
  double seconds(size_t level) const;
};

/// What all series together say of a quantity.
struct Estimate {
  double own = 0;          ///< value of the case as it is
  double scale = 1;        ///< of its errors
  double value = 0;        ///< own + Σ over groups of what is missing to their limits
  double uncertainty = 0;  ///< Σ, relative to the scale; infinite where a limit is not bounded
  std::string unbounded;   ///< parameters without a bounded limit
  bool has_limit = true;   ///< false: theory knows of no limit, and no recommendation covers it
};

/// The cheapest settings for an error.
struct Recommendation {
  double target = 0;                          ///< largest error [-]
  std::vector<std::string> overrides, names;  ///< of the levels; empty: none reaches the target
  double error = 0, seconds = 0;              ///< predicted, of the worst quantity [-], [s]
  bool verified = false, withdrawn = false;
  std::vector<bool> covers;                    ///< of all quantities: is it about them?
  double measured_error = 0, seconds_cpu = 0;  ///< of the run that verified it [-], [s]
  std::string sentence, file;
};

struct AccuracyStudy {
  std::string title;
  std::vector<Interest> interests;
  std::vector<std::optional<double>> references;  ///< of each quantity
  std::vector<Part> parts;                        ///< of each quantity
  std::vector<RefinementSeries> series;
  std::vector<std::pair<std::string, std::string>> absent;  ///< parameters, and why
  std::map<Part, LevelRun> own;                             ///< the case as it is, in each part
  std::vector<Estimate> estimates;                          ///< of each quantity
  std::vector<Recommendation> recommendations;
};

/// Returns the series that has the limit of a group in a part; null: there is none.
const RefinementSeries* leader_of(const AccuracyStudy& study, const std::string& group, Part part);

/// Series with so many measured levels wait for those with fewer.
inline constexpr size_t kEnoughLevels = 5;

/// Returns the next level to measure, as series and level: of the coarsest open levels of all
/// series the one with the shortest run time; it counts four times as long in a series that does
/// not lead its group, and twice as long for each level beyond kEnoughLevels. Levels that would
/// take longer than `left` [s] are cut, with all finer ones. Nothing: no level is open.
std::optional<std::pair<size_t, size_t>> next_level(std::vector<RefinementSeries>& series,
                                                    double left);

/// Fills limits, errors of levels, and estimates from the measured values.
/// @throws Error (input) for a quantity that is 0 and has no scale.
void evaluate(AccuracyStudy& study);

}  // namespace flexmorph::cases
