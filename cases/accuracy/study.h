#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/accuracy/budget.h"
#include "cases/accuracy/choice.h"
#include "cases/accuracy/knobs.h"
#include "cases/study/study.h"

/// Ladders of one case as data: what was measured, and what follows from it.
namespace flexmorph::cases {

/// A level of a ladder, and what its run came to.
struct Rung {
  Level level;
  std::string status = "open";                           ///< "measured", "cut", "refused", "failed"
  std::string message;                                   ///< why refused or failed
  double seconds_cpu = 0, seconds_wall = 0, memory = 0;  ///< [s], [s], [bytes]
  int unknowns = 0;
  std::vector<double> values;  ///< of all quantities; NaN of the other part, or not measured
  /// Likewise, relative to their scales, against the limit of the group: the largest one of this
  /// level and all finer ones.
  std::vector<double> errors;
  double predicted_cpu = 0;  ///< [s], of levels that were cut

  bool measured() const { return status == "measured"; }
  bool is_own() const { return level.overrides.empty(); }  ///< the case as it is
};

/// The levels of a knob in one part, and their limits.
struct Ladder {
  const Knob* knob = nullptr;
  Part part = Part::motion;
  std::vector<std::optional<Theory>> theories;  ///< of all quantities
  std::vector<Rung> rungs;                      ///< coarse to fine
  std::vector<Limit> limits;  ///< of all quantities; those of the other part are empty
  bool leads() const { return knob->name == knob->group; }
  size_t count(const std::string& status) const;
};

/// What all ladders together say of a quantity.
struct Truth {
  double own = 0;          ///< value of the case as it is
  double scale = 1;        ///< of its errors
  double value = 0;        ///< own + Σ over knobs of what is missing to their limits
  double uncertainty = 0;  ///< Σ, relative to the scale; infinite where a limit is not bounded
  std::optional<double> reference;
  std::string unbounded;  ///< knobs without a bounded limit
  bool has_limit = true;  ///< false: theory knows of none, and no promise covers it
};

/// Settings for a promised error.
struct Recommendation {
  double promise = 0;
  std::optional<Choice> choice;
  std::vector<std::string> overrides, names;  ///< of the groups' levels
  bool verified = false;
  std::vector<bool> covers;   ///< of all quantities: is the promise about it?
  std::vector<double> found;  ///< measured errors, relative, against the truths
  double seconds_cpu = 0;     ///< measured
  bool withdrawn = false;
  std::string sentence, file;
};

struct AccuracyStudy {
  std::string case_name, title;
  std::vector<Interest> interests;
  std::vector<Part> parts;  ///< of each quantity
  std::vector<Ladder> ladders;
  std::vector<std::pair<std::string, std::string>> absent;  ///< knobs, and why
  std::map<Part, Rung> own;                                 ///< the case as it is, in each part
  std::vector<Truth> truths;
  std::vector<Recommendation> recommendations;
  double budget = 0;  ///< [s]

  bool has(Part part) const { return own.contains(part); }
};

/// Limits, errors of rungs, truths: all that follows from measured values.
/// @param references  of each quantity
void evaluate(AccuracyStudy& study, const std::vector<std::optional<double>>& references);

/// What a promise can be about: quantities whose limits are known to it.
std::vector<bool> covered(const AccuracyStudy& study, double promise);

/// Groups of knobs that matter to what is covered, with the levels that may be recommended:
/// measured ones, and those cut by the budget where the order predicts their errors. A ladder that
/// is not converged is not extrapolated: it offers its finest level, and coarser measured ones by
/// their distance from it where the limit's uncertainty is at most promise / kClearance.
inline constexpr double kClearance = 10;
std::vector<Group> groups_of(const AccuracyStudy& study, double promise);

/// The cheapest settings for a promise whose errors add up to `share` of it at most.
Recommendation recommend(const AccuracyStudy& study, double promise, double share = 1);

/// Judges a recommendation by what its run found: kept within kPromiseFactor, or withdrawn.
inline constexpr double kPromiseFactor = 1.5;
void judge(Recommendation& r, const AccuracyStudy& study, const std::vector<double>& values,
           double seconds_cpu);

}  // namespace flexmorph::cases
