#pragma once

#include <optional>
#include <string>
#include <vector>

#include "optim/mmc/problem/responses/rows.h"

namespace flexmorph::mmc {

/// A bound on a response; of one with a value per load, on each of them.
struct Limit {
  const ResponseRow* row = nullptr;
  double value = 0;  ///< in the unit of the row
  bool at_least = false;
  /// The volume fraction it stands for, where every piece of material counts alike.
  std::optional<double> volume;
  std::string key_path = {};  ///< of the bound in its case file, for messages; empty: there is none

  Limit(const ResponseRow& response, double bound, bool from_below, const Plate& plate)
      : row(&response), value(bound), at_least(from_below) {
    if (response.even) volume = bound / response.full(plate);
  }
  /// How far a value of the response is beyond the bound, as a part of it: <= 0 when it is allowed.
  double excess(double found) const { return at_least ? 1 - found / value : found / value - 1; }
  /// Tells whether more material always brings the response closer to the bound, and loads decide
  /// how close: the full design may miss such a bound.
  bool wants_material() const { return !at_least && row->needs_state() && !row->of_motion; }
};

/// A number of the motion that is minimized besides another one.
struct Addend {
  const ResponseRow* row = nullptr;
  double weight = 1;  ///< > 0, one per unit of the row
};

/// What a design is to be good at, and what it must keep to: rows of the table of responses.
struct Goal {
  const ResponseRow* objective = &kComplianceSum;
  std::vector<Limit> limits = {};
  std::vector<Addend> addends = {};  ///< of a number of the motion: added to it
};

/// The rows of a goal in the order they are evaluated, each once.
std::vector<const ResponseRow*> rows_of(const Goal& goal);

/// The row whose compliance stands for the design in tables: the first one that needs a state, or
/// the sum.
const ResponseRow& compliance_row(const Goal& goal);

/// Rows that tables have no columns for: all but the volume and compliance_row().
std::vector<const ResponseRow*> further_rows(const Goal& goal);

/// The largest volume fraction that the limits leave; nothing when none speaks of it.
std::optional<double> allowed_volume(const Goal& goal);

/// Tells whether it asks for responses of the loads.
bool asks_state(const Goal& goal);
/// Does it ask for numbers of the motion?
bool has_motion(const Goal& goal);
/// What equivalent static loads make of a goal: for numbers of the motion the compliance stands,
/// and nothing for limits on them.
Goal goal_of_loads(Goal goal);
/// What the motion itself makes of it: the strain energy stands for the compliance, its largest
/// value for the largest compliance, and nothing for limits on that.
Goal goal_of_motion(Goal goal);
/// With one number to minimize: the power mean stands for the largest compliance.
Goal smooth(Goal goal);
/// "strain energy in motion", "weighted sum of ..."
std::string objective_words(const Goal& goal);

/// Is there a limit that keeps the objective from being best in a full plate, or an empty one?
bool is_held_back(const Goal& goal);

}  // namespace flexmorph::mmc
