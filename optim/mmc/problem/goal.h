#pragma once

#include <optional>
#include <string>
#include <vector>

#include "optim/mmc/problem/responses/rows.h"

namespace flexmorph::mmc {

/// A bound on a response of a design. For a response with one value per load it bounds every value.
struct Limit {
  const ResponseRow* row = nullptr;  ///< The bounded response.
  double value = 0;                  ///< The bound, in the unit of the response.
  bool at_least = false;             ///< True if the bound is a lower bound, not an upper one.

  /// The equivalent volume fraction [-]; absent if the response depends on more than the amount of
  /// material (ResponseRow::even).
  std::optional<double> volume;
  std::string key_path = {};  ///< Path of the bound in its case file, for messages; may be empty.

  /// Creates a bound on a response of a plate.
  Limit(const ResponseRow& response, double bound, bool from_below, const Plate& plate)
      : row(&response), value(bound), at_least(from_below) {
    if (response.even) volume = bound / response.full(plate);
  }
  /// Returns the relative violation of the bound by a value of the response [-]; it is <= 0 when
  /// the value is allowed.
  double excess(double found) const { return at_least ? 1 - found / value : found / value - 1; }
  /// Returns true if more material always brings the response closer to the bound. Even the full
  /// design can violate such a bound, because its value then depends on the loads.
  bool wants_material() const { return !at_least && row->needs_state() && !row->of_motion; }
};

/// A response of the motion that is added to the objective with a weight.
struct Addend {
  const ResponseRow* row = nullptr;  ///< The added response.
  double weight = 1;                 ///< Weight > 0, in one per unit of the response.
};

/// The objective and the constraints of a design, as rows of the table of responses.
struct Goal {
  const ResponseRow* objective = &kComplianceSum;  ///< The response that is minimized.
  std::vector<Limit> limits = {};                  ///< Bounds on responses.

  /// Responses that are added to the objective if the objective is a response of the motion.
  std::vector<Addend> addends = {};
};

/// Returns the responses of the objective and of the limits in the order of their evaluation, each
/// once.
std::vector<const ResponseRow*> rows_of(const Goal& goal);

/// Returns the compliance that represents the design in tables: the first response of rows_of()
/// that needs the state, or kComplianceSum if none does.
const ResponseRow& compliance_row(const Goal& goal);

/// Returns the responses of rows_of() that tables have no columns for: all except the volume and
/// compliance_row().
std::vector<const ResponseRow*> further_rows(const Goal& goal);

/// Returns the largest volume fraction that the limits allow [-]; nothing when no limit bounds it.
std::optional<double> allowed_volume(const Goal& goal);

/// Returns true if the objective or a limit needs the state under the loads.
bool asks_state(const Goal& goal);
/// Returns true if the objective or a limit is a response of the motion.
bool has_motion(const Goal& goal);
/// Returns the goal of the design problem under equivalent static loads. A compliance replaces an
/// objective that is a response of the motion (the largest compliance replaces kPeakStrainEnergy);
/// added responses and limits on responses of the motion are dropped.
Goal goal_of_loads(Goal goal);
/// Returns the goal of a design problem on the motion itself. The strain energy in motion replaces
/// a compliance as the objective (its largest value replaces the largest compliance); limits on
/// compliances are dropped.
Goal goal_of_motion(Goal goal);
/// Returns the goal with a single differentiable objective: the power mean of the compliances
/// replaces the largest compliance.
Goal smooth(Goal goal);
/// Returns the text that names the objective: "strain energy in motion", "weighted sum of ...".
std::string objective_text(const Goal& goal);

/// Returns true if a limit prevents the full plate (or the empty plate, where the objective rises
/// with the amount of material) from being the optimum.
bool is_held_back(const Goal& goal);

}  // namespace flexmorph::mmc
