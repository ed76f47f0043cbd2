#include "optim/mmc/loads/load_checks.h"

#include <algorithm>
#include <cmath>

#include "geometry/text.h"

namespace flexmorph::mmc {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error::input("equivalent static loads: " + what);
}

void check_set(const fem::EslSet& set, const Grid& g, bool needs_deformation, int number) {
  const std::string where = "load " + std::to_string(number) + ": ";
  if (set.root_column < 0 || set.root_column >= g.nx) {
    refuse(where + "root column " + std::to_string(set.root_column) + " is not in [0, " +
           std::to_string(g.nx) + ")");
  }
  if (!std::isfinite(set.weight) || set.weight < 0) refuse(where + "a weight is at least 0");
  if (!std::isfinite(set.thermal_stretch) || !(set.thermal_stretch > -1) ||
      !std::isfinite(set.held_stretch) || !std::isfinite(set.held_end_stretch)) {
    refuse(where + "a thermal stretch is a number above -1");
  }
  const VectorXd& field = needs_deformation ? set.deformation : set.acceleration;
  if (field.size() != 2 * g.n_nodes() || !field.allFinite()) {
    refuse(where + (needs_deformation ? "the deformation" : "the acceleration") +
           " is not a finite vector at each of " + std::to_string(g.n_nodes()) + " nodes");
  }
  for (const fem::NodalForce& f : set.forces) {
    if (f.node < 0 || f.node >= g.n_nodes() || !f.force.allFinite()) {
      refuse(where + "a force at node " + std::to_string(f.node) +
             " is not finite, or its node does not exist");
    }
  }
}

void check_link(const fem::EslSets& loads, const ComplianceSettings& settings) {
  if (!loads.pins) refuse("a link has two pins, but these loads have no pins");
  if (!is_of_link(settings.support))
    refuse(
        "a link has no root, which 'moving_root' and 'far_end' need; the support of a link is "
        "'pins' or 'floating'");
  if (settings.loads == LoadDefinition::stiffness)
    refuse(
        "definition 'stiffness' is only available for plates with a root; the definition of a link "
        "is 'inertia' or 'frozen'");
  for (const fem::EslSet& set : loads.sets)
    if (set.root_column != 0 || set.thermal_stretch != 0)
      refuse("a load has a root column or heat, which links do not have");
  for (const int pin : *loads.pins)
    if (pin < 0 || pin >= loads.grid.n_nodes()) refuse("a pin is not at a node of the grid");
}

}  // namespace

void refuse(const LoadCase& load, const std::string& what) {
  throw Error::input("load '" + load.name + "': " + what);
}

void check_load(const LoadCase& load, const Grid& grid) {
  if (!(load.weight > 0) || !std::isfinite(load.weight))
    refuse(load, formatted("weight = %g: a weight is positive", load.weight));
  for (const fem::NodalForce& f : load.forces)
    if (f.node < 0 || f.node >= grid.n_nodes() || !f.force.allFinite())
      refuse(load, formatted("force (%g, %g) N at node %d: forces are finite, and nodes are 0 "
                             "to %d",
                             f.force.x(), f.force.y(), f.node, grid.n_nodes() - 1));
  if (!(load.thermal_stretch > -1) || !std::isfinite(load.thermal_stretch))
    refuse(load, formatted("thermal stretch = %g: it is above -1", load.thermal_stretch));
}

void check_loads(const fem::EslSets& loads, const ComplianceSettings& settings,
                 const VectorXd& stiffness0, const VectorXd& mass0) {
  if (loads.sets.empty()) refuse("there are no loads");
  if (settings.loads == LoadDefinition::inertia && settings.support == Support::far_end) {
    refuse(
        "definition 'inertia' is not available with support 'far_end': loads that follow the "
        "design need a reaction on the root line that also follows it. Use support 'moving_root', "
        "or definition 'frozen' or 'stiffness'");
  }
  if (settings.support == Support::far_end &&
      std::any_of(loads.sets.begin(), loads.sets.end(),
                  [](const fem::EslSet& s) { return s.held_end_stretch != 0; })) {
    refuse(
        "support 'far_end' is not available for a hot plate whose far edge is fixed across by a "
        "joint: it clamps an edge of the grid that is not fixed in the motion. Use support "
        "'moving_root'");
  }
  double sum = 0;
  for (std::size_t l = 0; l < loads.sets.size(); ++l) {
    check_set(loads.sets[l], loads.grid, settings.loads == LoadDefinition::stiffness,
              static_cast<int>(l));
    sum += loads.sets[l].weight;
  }
  if (!(sum > 0)) refuse("all weights are 0");
  if (!(settings.compression_tolerance >= 0))
    refuse("the compression tolerance must not be negative");
  if (loads.pins || is_of_link(settings.support)) check_link(loads, settings);
  if (settings.loads == LoadDefinition::inertia) return;
  for (const VectorXd* factor : {&stiffness0, &mass0}) {
    if (factor->size() != loads.grid.n_cells() || !factor->allFinite()) {
      refuse("the design of the motion does not have finite scale factors for " +
             std::to_string(loads.grid.n_cells()) + " cells");
    }
  }
}

}  // namespace flexmorph::mmc
