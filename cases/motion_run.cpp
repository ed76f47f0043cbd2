#include "cases/motion_run.h"

#include <cmath>

namespace flexmorph::cases {
namespace {

bool is_multiple(double t, double every) {
  return every > 0 && std::abs(t / every - std::round(t / every)) < 1e-6;
}

size_t design_of(const Scene& scene, const std::string& body) {
  size_t i = 0;
  while (i < scene.designs.size() && scene.designs[i].body != body) ++i;
  return i;
}

/// Fills the record and the loads as the motion goes on.
class Recorder {
 public:
  Recorder(const Scene& scene, const MotionWishes& wishes, const Mechanism& mechanism,
           RunFolder& folder, MotionOutcome& out)
      : scene_(scene), wishes_(wishes), mechanism_(mechanism), folder_(folder), out_(out) {
    for (const fem::Growth& growth : mechanism.growths) out.record.bodies.push_back(growth.body);
    out.record.deflection.resize(mechanism.growths.size());
    out.record.amplitude.assign(mechanism.growths.size(), 0);
    if (wishes.loads)
      for (const BodyDesign& d : scene.designs) out.loads.push_back({d.grid, {}, 0});
  }

  void operator()(const fem::MotionStep& step) {
    MotionRecord& r = out_.record;
    if (!r.time.empty())
      r.strain_integral +=
          0.5 * (step.x.t - r.time.back()) * (r.strain.back() + step.energies.strain);
    r.time.push_back(step.x.t);
    r.kinetic.push_back(step.energies.kinetic);
    r.strain.push_back(step.energies.strain);
    r.potential.push_back(step.energies.potential);
    r.defect.push_back(step.defect);
    for (size_t i = 0; i < mechanism_.growths.size(); ++i) {
      const double d = tip_deflection(step.model, mechanism_.growths[i], step.x);
      r.deflection[i].push_back(d);
      r.amplitude[i] = std::max(r.amplitude[i], std::abs(d));
    }
    if (step.stop || step.x.t == 0) at_stop(step);
    if (wishes_.go_on && !wishes_.go_on()) throw Interrupted();
  }

 private:
  void at_stop(const fem::MotionStep& step) {
    const double t = step.x.t;
    for (size_t i = 0; i < mechanism_.growths.size(); ++i) {
      const fem::Growth& growth = mechanism_.growths[i];
      const size_t d = design_of(scene_, growth.body);
      if (d == scene_.designs.size()) continue;
      if (wishes_.loads && t > 0 && is_multiple(t, scene_.esl->every)) {
        fem::EslSet set = fem::equivalent_static_load(
            step.model, step.x, growth, scene_.designs[d].grid,
            attached_masses(scene_, growth.body), mechanism_.motion.gravity);
        set.weight = 1.0 / scene_.esl->count(scene_.time.end);
        out_.loads[d].sets.push_back(std::move(set));
      }
      if (is_multiple(t, wishes_.frames_every))
        folder_.add_motion_frame(step.model, growth, step.x, scene_.designs[d].grid,
                                 wishes_.factors[d].mass, static_cast<int>(i));
    }
  }

  const Scene& scene_;
  const MotionWishes& wishes_;
  const Mechanism& mechanism_;
  RunFolder& folder_;
  MotionOutcome& out_;
};

}  // namespace

MotionOutcome run_motion(const Scene& scene, const MotionWishes& wishes, RunFolder& folder) {
  Mechanism mechanism = build_mechanism(scene, wishes.mesh);
  for (size_t i = 0; i < wishes.factors.size(); ++i)
    for (fem::Body& body : mechanism.model.bodies())
      if (body.name == scene.designs[i].body) mechanism.model.set_factors(body, wishes.factors[i]);
  mechanism.motion.balance = wishes.balance;
  if (wishes.loads) mechanism.motion.stops = load_times(scene);
  if (wishes.frames_every > 0)
    for (int k = 1; k * wishes.frames_every < scene.time.end + 1e-9; ++k)
      mechanism.motion.stops.push_back(k * wishes.frames_every);

  MotionOutcome out;
  Recorder record(scene, wishes, mechanism, folder, out);
  try {
    out.record.result = fem::integrate(mechanism.model, mechanism.growths, mechanism.motion,
                                       [&](const fem::MotionStep& step) { record(step); });
  } catch (...) {
    folder.write_motion(wishes.table, scene, out.record);
    throw;
  }
  folder.write_motion(wishes.table, scene, out.record);
  for (fem::EslSets& sets : out.loads) sets.strain_energy_integral = out.record.strain_integral;
  return out;
}

}  // namespace flexmorph::cases
