#include "cases/run/motion_run.h"

#include <cmath>

#include "cases/output/motion_checkpoint.h"
#include "cases/output/motion_table.h"
#include "cases/results/body_measures.h"
#include "cases/results/failure.h"
#include "cases/results/mechanism_columns.h"
#include "cases/results/quantities.h"
#include "cases/results/warnings.h"
#include "cases/run/motion_run_memory.h"
#include "cases/run/start_remarks.h"
#include "cases/scene/elements/row.h"
#include "io/files.h"

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

/// What the columns of terms say of a step.
struct WrittenBy {
  const char* column;
  double fem::MotionStep::*value;
};
constexpr WrittenBy kWritten[] = {{"energy.dissipated", &fem::MotionStep::dissipated}};

/// Fills the record and the loads as the motion goes on.
class Recorder {
 public:
  Recorder(const Scene& scene, const MotionWishes& wishes, Mechanism& mechanism, RunFolder& folder,
           MotionOutcome& out)
      : scene_(scene),
        wishes_(wishes),
        mechanism_(mechanism),
        folder_(folder),
        out_(out),
        columns_(scene),
        table_(folder.file(wishes.table), scene) {
    MotionRecord& r = out.record;
    for (const fem::Growth& growth : mechanism.growths) {
      const Body& body = scene.body(growth.body);
      const bool deflects = !body.in_space() && growth.line == 0;
      if (deflects) tracked_.push_back(&growth);
      if (deflects) r.bodies.push_back(growth.body);
      // A free root says where it is in a column of its own.
      if ((deflects || body.flow) && !body.has_free_lines()) r.growing.push_back(growth.body);
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
    if (scene.is_mechanism() && wishes.balance)
      r.powers = {{"power.drive", {}}, {"power.feed", {}}, {"power.inflow", {}}};
    if (!r.powers.empty() && scene.has_heat()) r.powers.push_back({"power.heat", {}});
    if (wishes.balance)
      for (const std::string& name : columns_of_terms(scene)) r.written.push_back({name, {}});
    if (!scene.measures.empty())
      undeformed_ = fem::start_state(mechanism.model, mechanism.growths, 0, fem::Start::rigid,
                                     mechanism.motion.placement);
    if (wishes.loads)
      for (const BodyDesign& d : scene.designs) {
        fem::EslSets& loads = out.loads.emplace_back(fem::EslSets{d.grid, {}, 0});
        if (d.link)
          loads.pins = {fem::node_at(d.grid, d.link->pins[0]),
                        fem::node_at(d.grid, d.link->pins[1])};
      }
  }

  void operator()(const fem::MotionStep& step) {
    MotionRecord& r = out_.record;
    remark(step);
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
    if (!scene_.measures.empty()) measure(step);
    columns_.add(step.model, step.x);
    for (Column& column : r.written)
      for (const WrittenBy& known : kWritten)
        if (column.name == known.column) column.values.push_back(step.*known.value);
    if (!r.powers.empty()) {
      r.powers[0].values.push_back(step.powers.drive);
      r.powers[1].values.push_back(step.powers.feed);
      r.powers[2].values.push_back(step.powers.inflow);
      if (scene_.has_heat()) r.powers[3].values.push_back(step.powers.heat);
    }
    // The step that reaches a moment shows it: no step is cut for a picture.
    const auto shown = static_cast<double>(r.moments.size());
    if (shown < wishes_.moments &&
        step.x.t >= shown / (wishes_.moments - 1) * scene_.time.end - 1e-9)
      add_moment(step);
    table_.add(r, measured(), columns_.columns());
    if (step.stop || step.x.t == 0) at_stop(step);
    if (wishes_.way) wishes_.way(step.x.t);
  }

  /// All that was recorded so far, between two steps. Put back, the table is written anew.
  void remember(Memory& memory) {
    memory(out_.record, out_.loads, said_alternation_, said_cut_, columns_, start_);
    if (memory.puts_back() && !scene_.measures.empty()) {
      mechanism_.model.prepare(start_);
      measures_.emplace(scene_, mechanism_.model, undeformed_);
    }
    if (measures_) memory(*measures_);
    if (wishes_.frames_every > 0) folder_.remember_frames(memory);
    if (memory.puts_back()) table_.add_all(out_.record, measured(), columns_.columns());
  }

  double time() const { return out_.record.time.empty() ? 0 : out_.record.time.back(); }

  /// What comes after the last step, or after the one that failed.
  void finish() {
    out_.record.mechanism = columns_.take();
    if (measures_) out_.record.measured = measures_->take();
  }

 private:
  /// What is not as the case says at the start, and what goes wrong on the way, once each.
  void remark(const fem::MotionStep& step) {
    const auto say = [&](const std::string& words) {
      if (wishes_.say) wishes_.say(words);
    };
    if (out_.record.time.empty()) {
      out_.record.remarks = start_remarks(scene_, step.model, step.x, step.so_far.start_change);
      for (const std::string& each : out_.record.remarks) say(each);
      if (damps_no_multipliers(scene_)) say(undamped_words(scene_));
    }
    const fem::MotionResult& found = step.so_far;
    if (found.alternation && !said_alternation_) say(alternation_words(*found.alternation));
    said_alternation_ = found.alternation.has_value();
    if (found.cut.number > 0 && !said_cut_)
      say("t = " + io::to_text(step.x.t, 4) + " s: Newton's method did not solve a step of " +
          io::to_text(scene_.time.step, 3) + " s, steps are cut");
    said_cut_ = found.cut.number > 0;
  }

  const std::vector<Column>& measured() const {
    static const std::vector<Column> kNothing;
    return measures_ ? measures_->columns() : kNothing;
  }

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

  void measure(const fem::MotionStep& step) {
    if (!measures_) {
      measures_.emplace(scene_, step.model, undeformed_);
      start_ = step.x;
    }
    measures_->add(step.model, step.x);
  }

  void at_stop(const fem::MotionStep& step) {
    const double t = step.x.t;
    if (wishes_.loads && t > 0 && is_multiple(t, scene_.esl->every))
      for (size_t d = 0; d < scene_.designs.size(); ++d) add_load(step, d);
    if (is_multiple(t, wishes_.frames_every)) add_frame(step);
  }

  void add_load(const fem::MotionStep& step, size_t d) {
    const BodyDesign& design = scene_.designs[d];
    const fem::Body& body = step.model.body(design.body);
    std::vector<fem::AttachedForce> forces =
        fem::joint_forces(step.model, step.x, body, attached_joints(scene_, design.body));
    for (const fem::AttachedForce& f : applied_forces(scene_, design.body, step.x.t))
      forces.push_back(f);
    const std::vector<fem::AttachedMass> masses = attached_masses(scene_, design.body);
    const VectorXd gravity = scene_.gravity_law().at(step.x.t);
    fem::EslSet set = design.link
                          ? fem::equivalent_static_load(step.model, step.x, body, design.link->pins,
                                                        design.grid, masses, forces, gravity)
                          : fem::equivalent_static_load(step.model, step.x, growth_of(design.body),
                                                        design.grid, masses, forces, gravity);
    set.weight = 1.0 / scene_.esl->count(scene_.time.end);
    out_.loads[d].sets.push_back(std::move(set));
  }

  /// Of a designed body that a hub or a rigid body carries.
  const fem::Growth& growth_of(const std::string& body) const {
    return *std::find_if(mechanism_.growths.begin(), mechanism_.growths.end(),
                         [&](const fem::Growth& g) { return g.body == body; });
  }

  /// All plates, all rigid bodies that have a size, hubs, point masses; their numbers are those of
  /// the scene.
  void add_frame(const fem::MotionStep& step) {
    const double t = step.x.t;
    int part = 0;
    for (const Body& body : scene_.bodies) {
      const auto i = static_cast<size_t>(part);
      if (design_of(scene_, body.name) < scene_.designs.size())
        folder_.add_motion_frame(body.name, designed(step, body), t, part);
      else
        folder_.add_surface_frame(step.model.body(body.name), step.x, poses_[i], t, part);
      ++part;
    }
    for (const RigidBody& body : scene_.rigid_bodies) {
      const std::vector<Vec2> corners = drawn_corners(body, step.model, step.x);
      if (!corners.empty()) folder_.add_rigid_frame(body.name, rectangle(corners), t, part);
      ++part;
    }
    for (const Hub& hub : scene_.hubs) {
      Joint held;  // as one that is welded to the hub
      held.to = hub.name;
      const fem::FrameMotion frame = hub_drive(scene_, held)(t);
      if (const double radius = drawn_radius(scene_, hub); radius > 0)
        folder_.add_rigid_frame(hub.name, disc_mesh(frame, radius, true), t, part);
      ++part;
    }
    for (const PointMass& mass : scene_.point_masses) add_mass(step, mass, part++);
  }

  void add_mass(const fem::MotionStep& step, const PointMass& mass, int part) {
    const Body& body = scene_.body(mass.body);
    if (body.in_space()) return;
    fem::FrameMotion frame;
    frame.origin = fem::point_motion(step.model.body(mass.body), step.x, mass.point).position;
    folder_.add_rigid_frame(mass.body + "_mass",
                            disc_mesh(frame, drawn_radius(scene_, mass), false), step.x.t, part);
  }

  static io::QuadMesh rectangle(std::span<const Vec2> corners) {
    io::QuadMesh mesh;
    for (const Vec2& corner : corners)
      mesh.points.insert(mesh.points.end(), {corner[0], corner[1]});
    mesh.quads.push_back({0, 1, 2, 3});
    return mesh;
  }

  DesignedSurface designed(const fem::MotionStep& step, const Body& body) const {
    const size_t d = design_of(scene_, body.name);
    const Grid& grid = scene_.designs[d].grid;
    const VectorXd density =
        wishes_.factors.empty() ? VectorXd::Ones(grid.n_cells()) : wishes_.factors[d].mass;
    const fem::ReferencePose& pose = poses_[static_cast<size_t>(&body - scene_.bodies.data())];
    return designed_surface(step.model.body(body.name), step.x, pose, grid, density);
  }

  /// The mechanism as it is now, for a picture.
  void add_moment(const fem::MotionStep& step) {
    io::PlaneFrame frame;
    frame.title = "t = " + io::to_text(step.x.t, 4) + " s";
    for (size_t i = 0; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      if (const size_t d = design_of(scene_, body.name); d < scene_.designs.size()) {
        DesignedSurface s = designed(step, body);
        frame.plates.push_back(
            {scene_.designs[d].grid.ny, std::move(s.mesh.points), std::move(s.density)});
      } else {
        Surface s = deformed_surface(*body.row, step.model.body(body.name), step.x, poses_[i]);
        const std::vector<double> full(s.mesh.quads.size(), 1.0);
        frame.plates.push_back({s.across, std::move(s.mesh.points), full});
      }
    }
    for (const RigidBody& body : scene_.rigid_bodies)
      if (auto corners = drawn_corners(body, step.model, step.x); !corners.empty())
        frame.outlines.push_back(std::move(corners));
    out_.record.moments.push_back(std::move(frame));
  }

  const Scene& scene_;
  const MotionWishes& wishes_;
  Mechanism& mechanism_;
  RunFolder& folder_;
  MotionOutcome& out_;
  std::vector<const fem::Growth*> tracked_;  // whose tip deflections are in the table
  std::vector<fem::ReferencePose> poses_;    // of the bodies at the start
  MechanismColumns columns_;
  MotionTable table_;
  fem::State undeformed_, start_;  // as the motion starts, where something is measured
  std::optional<BodyMeasures> measures_;
  bool said_alternation_ = false, said_cut_ = false;
};

/// A motion that could not go on after what its record holds.
Failure failure_in(const MotionWishes& wishes, const MotionRecord& record) {
  Failure out;
  out.phase = wishes.phase;
  out.time = record.time.empty() ? 0 : record.time.back();
  out.step = std::max(0, static_cast<int>(record.time.size()) - 1);  // the start is none
  return out;
}

/// The design and the mesh that a motion is one of, besides the case.
std::string words_of(const MotionWishes& wishes) {
  Memory m;
  MeshChoice mesh = wishes.mesh;
  bool loads = wishes.loads, balance = wishes.balance, condition = wishes.condition;
  double every = wishes.frames_every;
  int moments = wishes.moments;
  m(mesh.elements, mesh.refine, mesh.step, loads, balance, condition, every, moments);
  for (fem::Factors factors : wishes.factors) m(factors.stiffness, factors.mass);
  return m.bytes();
}

/// Begins, or goes on, and keeps what it needs for that.
class Keeper {
 public:
  Keeper(const MotionWishes& wishes, Recorder& record, RunFolder& folder,
         fem::MotionSettings& motion)
      : wishes_(wishes), record_(record), folder_(folder) {
    if (!wishes.checkpoint.empty())
      checkpoint_.emplace(folder, wishes.checkpoint, words_of(wishes), wishes.checkpoint_every);
    if (checkpoint_ && wishes.resume) resume(motion);
    motion.between_steps = [this](const fem::TakeDown& take_down) { between_steps(take_down); };
  }

 private:
  void resume(fem::MotionSettings& motion) {
    std::string why;
    const std::optional<std::string> kept = checkpoint_->read(why);
    const auto say = [&](const std::string& words) {
      if (wishes_.resumed) wishes_.resumed(wishes_.phase + words);
    };
    if (!kept) {
      say(": begins anew" +
          (why.empty() ? std::string() : ", " + wishes_.checkpoint + " cannot be used: " + why));
      return;
    }
    Memory memory(*kept);
    record_.remember(memory);
    memory(motion.memory);
    say(": goes on at t = " + io::to_text(record_.time(), 6) + " s");
  }

  void between_steps(const fem::TakeDown& take_down) {
    const bool ends = wishes_.go_on && !wishes_.go_on();
    if (checkpoint_ && (ends || checkpoint_->is_due())) {
      Memory memory;
      record_.remember(memory);
      std::string motion = take_down();
      memory(motion);
      checkpoint_->write(memory.bytes(),
                         wishes_.frames_every > 0 ? folder_.frames() : std::vector<std::string>());
    }
    if (ends) throw Interrupted();
  }

  const MotionWishes& wishes_;
  Recorder& record_;
  RunFolder& folder_;
  std::optional<MotionCheckpoint> checkpoint_;
};

}  // namespace

MotionOutcome run_motion(const Scene& scene, const MotionWishes& wishes, RunFolder& folder) {
  Mechanism mechanism = build_mechanism(scene, wishes.mesh);
  for (size_t i = 0; i < wishes.factors.size(); ++i)
    for (fem::Body& body : mechanism.model.bodies())
      if (body.name == scene.designs[i].body) mechanism.model.set_factors(body, wishes.factors[i]);
  mechanism.motion.balance = wishes.balance;
  mechanism.motion.condition = wishes.condition;
  if (wishes.loads)
    for (const double t : load_times(scene)) mechanism.motion.stops.push_back(t);
  if (wishes.frames_every > 0)
    for (int k = 1; k * wishes.frames_every < scene.time.end + 1e-9; ++k)
      mechanism.motion.stops.push_back(k * wishes.frames_every);

  MotionOutcome out;
  Recorder record(scene, wishes, mechanism, folder, out);
  try {
    const Keeper keeper(wishes, record, folder, mechanism.motion);
    out.record.result = fem::integrate(mechanism.model, mechanism.growths, mechanism.motion,
                                       [&](const fem::MotionStep& step) { record(step); });
  } catch (const Error& error) {
    record.finish();
    throw FailedRun(error, failure_in(wishes, out.record));
  } catch (...) {
    record.finish();
    throw;
  }
  record.finish();
  for (fem::EslSets& sets : out.loads) sets.strain_energy_integral = out.record.strain_integral;
  return out;
}

}  // namespace flexmorph::cases
