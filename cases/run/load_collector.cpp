#include "cases/run/load_collector.h"

#include <algorithm>
#include <cmath>

namespace flexmorph {

namespace fem {

void archive(Archive& memory, NodalForce& f) { memory(f.node, f.force); }

void archive(Archive& memory, EslSet& s) {
  memory(s.time, s.weight, s.root_column, s.deformation, s.acceleration, s.forces, s.strain_energy,
         s.thermal_stretch, s.held_stretch, s.held_end_stretch);
}

/// Saves or restores the load sets. The grid and the pins are not saved, because the case defines
/// them.
void archive(Archive& memory, EslSets& loads) { memory(loads.sets); }

}  // namespace fem

namespace cases {

LoadCollector::LoadCollector(const Scene& scene, std::span<const fem::MovingRoot> moving_roots,
                             std::vector<fem::EslSets>& loads)
    : scene_(scene), moving_roots_(moving_roots), loads_(loads) {
  for (const BodyDesign& d : scene.designs) {
    fem::EslSets& sets = loads_.emplace_back(fem::EslSets{d.grid, {}});
    if (d.link)
      sets.pins = {fem::node_at(d.grid, d.link->pins[0]), fem::node_at(d.grid, d.link->pins[1])};
  }
}

void LoadCollector::add(const StepRecord& step) {
  const double t = step.abscissa, at = t / scene_.esl->every;
  if (!step.stop || t <= 0 || std::abs(at - std::round(at)) >= 1e-6) return;
  for (size_t d = 0; d < loads_.size(); ++d)
    loads_[d].sets.push_back(load_of(step, scene_.designs[d]));
}

fem::EslSet LoadCollector::load_of(const StepRecord& step, const BodyDesign& design) const {
  const fem::Body& body = step.model.body(design.body);
  std::vector<fem::AttachedForce> forces =
      fem::joint_forces(step.model, step.x, body, attached_joints(scene_, design.body));
  for (const fem::AttachedForce& f : applied_forces(scene_, design.body, step.x.t))
    forces.push_back(f);
  const std::vector<fem::AttachedMass> masses = attached_masses(scene_, design.body);
  const VectorXd gravity = scene_.gravity_law().at(step.x.t);
  fem::EslSet set;
  if (design.link) {
    set = fem::equivalent_static_load(step.model, step.x, body, design.link->pins, design.grid,
                                      masses, forces, gravity);
  } else {
    // The root of the body moves with a hub (a rigid frame with prescribed motion) or a rigid body.
    const auto growth = std::find_if(moving_roots_.begin(), moving_roots_.end(),
                                     [&](const auto& g) { return g.body == design.body; });
    set = fem::equivalent_static_load(step.model, step.x, *growth, design.grid, masses, forces,
                                      gravity);
  }
  set.weight = 1.0 / scene_.esl->count(scene_.time.end);
  return set;
}

void LoadCollector::archive(Archive& memory) { memory(loads_); }

}  // namespace cases

}  // namespace flexmorph
