#pragma once

#include <string>
#include <vector>

#include "cases/results/quantities.h"
#include "cases/scene/scene.h"

/// The suites of stability: how a case is made stiff or extreme (cases/README.md, Stability).
namespace flexmorph::cases {

/// One changed run of a case.
struct Perturbation {
  std::string parameter;               ///< "E = 2e+11 Pa"
  std::vector<std::string> overrides;  ///< KEY=VALUE, after those of short_overrides()
  Part part = Part::motion;            ///< the motion without designs, or the designs as they start
};

/// A row of the table of suites.
struct Suite {
  std::string name;
  bool on_request = false;  ///< the suite runs only by name, because of its cost
  /// Returns the perturbations of a scene; none: the suite does not apply to it.
  std::vector<Perturbation> (*rows)(const Scene& scene);
};

const std::vector<Suite>& suites();

/// Returns the suite of that name. @throws Error (input) for an unknown name.
const Suite& suite(const std::string& name);

/// Returns the overrides of all runs of a case: no pictures, no expectations, and a short motion.
std::vector<std::string> short_overrides(const Scene& scene, Part part);

}  // namespace flexmorph::cases
