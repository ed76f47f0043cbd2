#include "optim/mmc/judged_design.h"

#include <algorithm>
#include <map>

#include "optim/mmc/held_expansion.h"

namespace flexmorph::mmc {

double point_reach(const BodyProblem& problem) {
  return std::max(problem.grid.dx(), problem.grid.dy());
}

std::string cannot_judge(const BodyProblem& problem) {
  if (problem.compliance.loads != LoadDefinition::inertia)
    return "its loads are forces at the corners of cells: only esl.definition = \"inertia\" is "
           "carried over to an outline";
  if (is_of_link(problem.compliance.support))
    return "it is a link between two pins, which the supports of an outline do not know";
  return "";
}

judge::Loads loads_by_position(const BodyProblem& problem, const fem::EslSets& loads) {
  const Region border = domain_of(problem);
  const Grid& g = loads.grid;
  judge::Loads out;
  out.grid = g;
  out.worst = compliance_row(problem.goal).per_load;
  if (const double edge = edge_stiffness(loads, problem.section); edge > 0)
    out.held_edge = {g.x0 + g.width, edge * g.dy()};
  std::map<int, int> places;  // of nodes
  for (std::size_t l = 0; l < loads.sets.size(); ++l) {
    const fem::EslSet& set = loads.sets[l];
    judge::Load& load = out.loads.emplace_back();
    load.name = "load_" + std::to_string(l + 1);
    load.weight = set.weight;
    load.clamp = g.node_position(set.root_column, 0).x();
    load.acceleration = &set.acceleration;
    load.held_stretch = set.held_stretch;
    load.held_end_stretch = set.held_end_stretch;
    for (const fem::NodalForce& f : set.forces) {
      const int i = f.node / (g.ny + 1), j = f.node % (g.ny + 1);
      if (i <= set.root_column) continue;  // it goes straight into the hub
      const auto [at, fresh] = places.try_emplace(f.node, static_cast<int>(out.places.size()));
      if (fresh) out.add(judge::point_place(g.node_position(i, j), border, point_reach(problem)));
      load.forces.push_back({at->second, f.force});
    }
  }
  return out;
}

std::vector<Region> exported_regions(const BodyProblem& problem) {
  return regions_of(problem, problem.design.components(), kOutlineTolerance * problem.grid.dx());
}

judge::Judged judge_design(const BodyProblem& problem, std::span<const Region> regions,
                           const judge::Loads& loads, const std::function<bool()>& go_on) {
  constexpr double kFirst = 2;  // cells: as wide as the thinnest bars
  judge::Settings settings;
  settings.size = kFirst * point_reach(problem);
  settings.reach = point_reach(problem);
  settings.go_on = go_on;
  return judge::judge(regions, problem.section, loads, settings);
}

}  // namespace flexmorph::mmc
