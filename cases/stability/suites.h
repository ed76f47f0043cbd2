#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/results/quantities.h"
#include "cases/scene/scene.h"

/// The suites of stability: how a case is made stiff, extreme or empty (cases/README.md,
/// Stability).
namespace flexmorph::cases {

/// A number that is known however extreme a row is: exactly (a law of nature), or as a range beyond
/// which a result is no longer sane.
struct Invariance {
  std::string quantity;         ///< see quantity_in()
  std::optional<double> value;  ///< absent: `factor` times that of the unperturbed run
  double factor = 1;
  double relative = 0, absolute = 0;  ///< tolerance: the larger one counts
  bool exact = true;                  ///< missing it is WRONG, else degraded
  std::string why;                    ///< "compliance is proportional to 1/E"
};

/// What must become of a row whatever its numbers are.
enum class Demand {
  none,    ///< it runs, or is refused with the reason
  runs,    ///< a valid scene: it is not refused
  refused  ///< no scene: it is not run
};

/// One row of a suite.
struct Perturbation {
  std::string parameter;               ///< "E = 2e+11 Pa"
  std::vector<std::string> overrides;  ///< KEY=VALUE, after those that make runs short
  Part part = Part::motion;            ///< designs are taken away, or analysed as they start
  std::string appended = {};           ///< TOML after the end of the case
  /// Text of a file of components, the start of the first design.
  std::optional<std::string> components = {};
  Demand demand = Demand::none;
  std::vector<Invariance> invariances = {};
};

/// A row of the table of suites. A new one is a row there, nothing else.
struct Suite {
  std::string name, about;
  bool on_request = false;  ///< runs only by name, because of its cost
  Part part =
      Part::motion;  ///< which scene `rows` are for: the case, or its short form with designs
  /// Its rows for a scene; none: it does not apply.
  std::vector<Perturbation> (*rows)(const Scene& scene);
};

const std::vector<Suite>& suites();
/// The rows of the table that are about designs.
std::vector<Suite> design_suites();
std::vector<std::string> suite_names();
/// The row of that name. @throws Error (input).
const Suite& suite(const std::string& name);

/// What all rows of a case have in common: no files nobody asked for, and a short end.
std::vector<std::string> short_overrides(const Scene& scene, Part part);

/// So many steps, or to the end of the case: "time.end=0.06".
std::string end_after(const Scene& scene, double step, int steps);

}  // namespace flexmorph::cases
