#include "optim/mmc/cycles/design_verification.h"

#include <algorithm>
#include <map>

#include "optim/mmc/loads/restrained_expansion.h"

namespace flexmorph::mmc {

double point_reach(const BodyProblem& problem) {
  return std::max(problem.grid.dx(), problem.grid.dy());
}

std::string reason_not_verifiable(const BodyProblem& problem) {
  if (problem.compliance.loads != LoadDefinition::inertia)
    return "its loads are forces at the corners of cells: only esl.definition = \"inertia\" is "
           "carried over to an outline";
  if (is_of_link(problem.compliance.support))
    return "it is a link between two pins, which the supports of an outline do not know";
  return "";
}

verification::Loads loads_by_position(const BodyProblem& problem, const fem::EslSets& loads) {
  const Region border = domain_of(problem);
  const Grid& g = loads.grid;
  verification::Loads out;
  out.grid = g;
  out.worst = compliance_row(problem.goal).per_load;
  if (const double edge = edge_stiffness(loads, problem.section); edge > 0)
    out.held_edge = {g.x0 + g.width, edge * g.dy()};
  std::map<int, int> location_of_node;
  for (std::size_t l = 0; l < loads.sets.size(); ++l) {
    const fem::EslSet& set = loads.sets[l];
    verification::Load& load = out.loads.emplace_back();
    load.name = "load_" + std::to_string(l + 1);
    load.weight = set.weight;
    load.clamp = g.node_position(set.root_column, 0).x();
    load.acceleration = &set.acceleration;
    load.held_stretch = set.held_stretch;
    load.held_end_stretch = set.held_end_stretch;
    for (const fem::NodalForce& f : set.forces) {
      const int i = f.node / (g.ny + 1), j = f.node % (g.ny + 1);
      if (i <= set.root_column) continue;  // it goes straight into the hub
      const auto [at, fresh] =
          location_of_node.try_emplace(f.node, static_cast<int>(out.locations.size()));
      if (fresh)
        out.add(verification::point_location(g.node_position(i, j), border, point_reach(problem)));
      load.forces.push_back({at->second, f.force});
    }
  }
  return out;
}

std::vector<Region> exported_regions(const BodyProblem& problem) {
  return regions_of(problem, problem.design.components(), kOutlineTolerance * problem.grid.dx());
}

verification::OutlineVerification verify_design(const BodyProblem& problem,
                                                std::span<const Region> regions,
                                                const verification::Loads& loads,
                                                const std::function<bool()>& keep_running) {
  constexpr double kFirst = 2;  // cells: as wide as the thinnest bars
  verification::Settings settings;
  settings.size = kFirst * point_reach(problem);
  settings.reach = point_reach(problem);
  settings.keep_running = keep_running;
  return verification::verify_outline(regions, problem.section, loads, settings);
}

}  // namespace flexmorph::mmc
