#include "cases/assembly/verified_loads.h"

#include "cases/assembly/static_conditions.h"

namespace flexmorph::cases {
namespace {

constexpr double kRoundness = 0.01;  ///< Tolerance of the polygon of a disc [cells].

verification::Location location_of(const Scene& scene, const NodeRegion& location,
                                   const mmc::BodyProblem& problem) {
  if (location.kind == NodeRegion::Kind::disc) {
    if (const std::vector<Vec2>* bore = bore_of(scene, location.disc, problem.grid))
      return verification::border_location(*bore);
    return {
        {},
        circle_within(location.disc.center, location.disc.radius, kRoundness * problem.grid.dx())};
  }
  if (location.kind != NodeRegion::Kind::point) return verification::box_location(location.box);
  return verification::point_location(location.box.lower, mmc::domain_of(problem),
                                      mmc::point_reach(problem));
}

}  // namespace

verification::Loads loads_by_position(const Scene& scene, const mmc::BodyProblem& problem) {
  verification::Loads out;
  out.worst = mmc::compliance_row(problem.goal).per_load;
  for (const PlaneSupport& s : scene.domain->supports)
    out.supports.push_back({out.add(location_of(scene, s.location, problem)), s.x, s.y});
  if (const Vec2 weight = weight_of(scene); weight != Vec2::Zero()) {
    out.grid = problem.grid;
    const VectorXd field = (-weight).replicate(problem.grid.n_nodes(), 1);
    out.uniform_acceleration = std::make_shared<const VectorXd>(field);
  }
  for (const StaticLoadCase& l : scene.domain->loads) {
    verification::Load& load = out.loads.emplace_back();
    load.acceleration = out.uniform_acceleration.get();
    load.name = l.name;
    load.weight = l.weight;
    for (const PlaneForce& f : l.forces)
      load.forces.push_back({out.add(location_of(scene, f.location, problem)), f.force, f.moment,
                             f.bearing, f.location.disc.center});
  }
  return out;
}

}  // namespace flexmorph::cases
