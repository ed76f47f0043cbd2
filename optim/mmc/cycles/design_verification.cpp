#include "optim/mmc/cycles/design_verification.h"

#include <algorithm>
#include <map>

#include "optim/mmc/loads/restrained_expansion.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::mmc {

double point_reach(const BodyProblem& problem) {
  return std::max(problem.grid.dx(), problem.grid.dy());
}

std::string reason_not_verifiable(const BodyProblem& problem) {
  if (problem.compliance.loads != LoadDefinition::inertia)
    return "its loads are forces at the nodes of the design mesh, which cannot be transferred to "
           "an outline; set esl.definition = \"inertia\"";
  return "";
}

namespace {

/// Adds the pins of a link as locations and returns the balance of the link.
verification::Balance balance_of(const BodyProblem& problem, const fem::EslSets& loads,
                                 verification::Loads& out, std::map<int, int>& location_of_node) {
  verification::Balance balance;
  balance.floating = problem.compliance.support == Support::floating;
  const Grid& g = loads.grid;
  for (std::size_t k = 0; k < 2; ++k) {
    const int node = (*loads.pins)[k];
    verification::Pin& pin = balance.pins[k];
    pin.center = g.node_position(node / (g.ny + 1), node % (g.ny + 1));
    const auto bore = std::find_if(problem.domain.holes.begin(), problem.domain.holes.end(),
                                   [&](const std::vector<Vec2>& ring) {
                                     return contains({ring, {}}, pin.center);
                                   });
    pin.bearing = bore != problem.domain.holes.end();
    pin.location = out.add(pin.bearing ? verification::border_location(*bore)
                                       : verification::point_location(
                                             pin.center, domain_of(problem), point_reach(problem)));
    location_of_node.emplace(node, pin.location);
  }
  return balance;
}

/// Tells whether a location is the rim of a bore that a pin presses on.
bool is_bearing(const verification::Loads& loads, int location) {
  return loads.balance && std::any_of(loads.balance->pins.begin(), loads.balance->pins.end(),
                                      [&](const verification::Pin& pin) {
                                        return pin.bearing && pin.location == location;
                                      });
}

}  // namespace

verification::Loads loads_by_position(const BodyProblem& problem, const fem::EslSets& loads) {
  const Region border = domain_of(problem);
  const Grid& g = loads.grid;
  verification::Loads out;
  out.grid = g;
  out.worst = compliance_row(problem.goal).per_load;
  if (const double edge = edge_stiffness(loads, problem.section); edge > 0)
    out.held_edge = {g.x0 + g.width, edge * g.dy()};
  std::map<int, int> location_of_node;
  const bool link = is_of_link(problem.compliance.support);
  if (link) out.balance = balance_of(problem, loads, out, location_of_node);
  for (std::size_t l = 0; l < loads.sets.size(); ++l) {
    const fem::EslSet& set = loads.sets[l];
    verification::Load& load = out.loads.emplace_back();
    load.name = "load_" + std::to_string(l + 1);
    load.weight = set.weight;
    if (!link) load.clamp = g.node_position(set.root_column, 0).x();
    load.acceleration = &set.acceleration;
    load.held_stretch = set.held_stretch;
    load.held_end_stretch = set.held_end_stretch;
    for (const fem::NodalForce& f : set.forces) {
      const int i = f.node / (g.ny + 1), j = f.node % (g.ny + 1);
      if (!link && i <= set.root_column)
        continue;  // forces at or behind the root act on the hub directly
      const auto [at, fresh] =
          location_of_node.try_emplace(f.node, static_cast<int>(out.locations.size()));
      if (fresh)
        out.add(verification::point_location(g.node_position(i, j), border, point_reach(problem)));
      load.forces.push_back(
          {at->second, f.force, 0, is_bearing(out, at->second), g.node_position(i, j)});
    }
  }
  return out;
}

std::vector<Region> exported_regions(const BodyProblem& problem) {
  // The exported curves deviate from these polygons by the same amount; both together meet the
  // tolerance.
  const double fine = kOutlineTolerance * problem.grid.dx(), half = 0.5 * problem.export_tolerance;
  return part_of(problem, problem.design.components(), half > 0 ? std::min(fine, half) : fine);
}

verification::OutlineVerification verify_design(const BodyProblem& problem,
                                                std::span<const Region> regions,
                                                const verification::Loads& loads,
                                                const std::function<bool()>& keep_running) {
  constexpr double kFirst = 2;  // cells; this is the width of the thinnest bars
  verification::VerificationSettings settings;
  settings.size = kFirst * point_reach(problem);
  settings.reach = point_reach(problem);
  settings.keep_running = keep_running;
  return verification::verify_outline(regions, problem.section, loads, settings);
}

}  // namespace flexmorph::mmc
