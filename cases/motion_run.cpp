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
    MotionRecord& r = out.record;
    for (const fem::Growth& growth : mechanism.growths) {
      const Body& body = scene.body(growth.body);
      const bool deflects = !body.in_space() && growth.line == 0;
      if (deflects) tracked_.push_back(&growth);
      if (deflects) r.bodies.push_back(growth.body);
      if (deflects || body.flow) r.growing.push_back(growth.body);
    }
    r.deflection.resize(tracked_.size());
    r.amplitude.assign(tracked_.size(), 0);
    static const char* const kAxes[] = {"_x", "_y", "_z"};
    for (const Observe& o : scene.observed)
      for (int c = 0; c < scene.body(o.body).dim(); ++c)
        r.observed.push_back({o.body + "." + o.name + kAxes[c], {}});
    for (const Body& body : scene.bodies)
      for (const BodyLine& line : body.lines)
        if (line.free)
          r.observed.push_back({body.name + ".line_" + std::to_string(line.index), {}});
    for (const Body& body : scene.bodies) poses_.push_back(start_pose(scene, body));
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
    for (size_t i = 0; i < tracked_.size(); ++i) {
      const double d = tip_deflection(step.model, *tracked_[i], step.x);
      r.deflection[i].push_back(d);
      r.amplitude[i] = std::max(r.amplitude[i], std::abs(d));
    }
    observe(step);
    if (step.stop || step.x.t == 0) at_stop(step);
    if (wishes_.go_on && !wishes_.go_on()) throw Interrupted();
  }

 private:
  void observe(const fem::MotionStep& step) {
    size_t column = 0;
    const auto add = [&](double value) { out_.record.observed[column++].values.push_back(value); };
    for (const Observe& o : scene_.observed) {
      const Vec3 r = fem::point_position(step.model.body(o.body), step.x, o.point);
      for (int c = 0; c < scene_.body(o.body).dim(); ++c) add(r[c]);
    }
    for (const fem::Body& body : step.model.bodies())
      for (int k = 0; k < body.element->n_scalars(); ++k) add(step.x.q[body.first_scalar() + k]);
  }

  void at_stop(const fem::MotionStep& step) {
    const double t = step.x.t;
    if (scene_.designs.empty()) {
      if (is_multiple(t, wishes_.frames_every))
        for (size_t i = 0; i < scene_.bodies.size(); ++i)
          folder_.add_surface_frame(step.model.body(scene_.bodies[i].name), step.x, poses_[i], t,
                                    static_cast<int>(i));
      return;
    }
    for (size_t i = 0; i < mechanism_.growths.size(); ++i) {
      const fem::Growth& growth = mechanism_.growths[i];
      const size_t d = design_of(scene_, growth.body);
      if (d == scene_.designs.size()) continue;
      if (wishes_.loads && t > 0 && is_multiple(t, scene_.esl->every)) {
        std::vector<fem::AttachedForce> forces = fem::joint_forces(
            step.model, step.x, step.model.body(growth.body), attached_joints(scene_, growth.body));
        for (const fem::AttachedForce& f : applied_forces(scene_, growth.body)) forces.push_back(f);
        fem::EslSet set = fem::equivalent_static_load(
            step.model, step.x, growth, scene_.designs[d].grid,
            attached_masses(scene_, growth.body), forces, mechanism_.motion.gravity);
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
  std::vector<const fem::Growth*> tracked_;  // whose tip deflections are in the table
  std::vector<Pose> poses_;                  // of the bodies at the start
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
