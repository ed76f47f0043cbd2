#pragma once

#include <string>
#include <vector>

#include "cases/results/quantities.h"
#include "cases/scene/scene.h"

/// Suites of changes that make a case stiff or extreme (cases/docs/studies.md).
namespace flexmorph::cases {

/// A change of a case for one run.
struct Perturbation {
  std::string parameter;               ///< Name of the change, as "E = 2e+11 Pa".
  std::vector<std::string> overrides;  ///< Overrides "KEY=VALUE", after short_overrides().
  Part part = Part::motion;            ///< Subproblem: motion without designs, or initial designs.
};

/// A row of the table of suites.
struct Suite {
  std::string name;         ///< Name of the suite.
  bool on_request = false;  ///< True if the suite runs only by name, because of its cost.

  /// Returns the changes of a scene; none if the suite does not apply to the scene.
  std::vector<Perturbation> (*rows)(const Scene& scene);
};

/// Returns the table of all suites.
const std::vector<Suite>& suites();

/// Returns the suite with the given name.
/// @throws Error (input) for an unknown name.
const Suite& suite(const std::string& name);

/// Returns the overrides of all runs of a case. They switch off pictures and expectations, and
/// shorten the motion.
std::vector<std::string> short_overrides(const Scene& scene, Part part);

}  // namespace flexmorph::cases
