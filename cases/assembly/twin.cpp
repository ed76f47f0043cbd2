#include "cases/assembly/twin.h"

#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/assembly/given_velocities.h"
#include "cases/assembly/joints.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/integrator.h"
#include "fem/elements/rigid_body.h"
#include "fem/solve/assembly.h"

namespace flexmorph::cases {
namespace {

// Joints of the twin that lead a body along its trajectory.
const char* const kPath = "trajectory";
const char* const kPathAngle = "angle of the trajectory";

std::function<fem::Motion(double)> negative(std::function<fem::Motion(double)> motion) {
  return [motion = std::move(motion)](double t) {
    const fem::Motion m = motion(t);
    return fem::Motion{-m.value, -m.rate, -m.acceleration};
  };
}

/// First axis of a frame, with its rates.
struct Axis {
  explicit Axis(const fem::FrameMotion& f)
      : e(std::cos(f.angle), std::sin(f.angle)),
        rate(f.angle_rate * Vec2(-e.y(), e.x())),
        acceleration(f.angle_acceleration * Vec2(-e.y(), e.x()) - f.angle_rate * f.angle_rate * e) {
  }
  Vec2 e, rate, acceleration;
};

/// Coordinate along the axis of a frame of its origin, as seen from another point.
fem::Motion distance_along(const fem::FrameMotion& frame, const fem::FrameMotion& from) {
  const Axis u(frame);
  const Vec2 d = frame.origin - from.origin, d_t = frame.origin_rate - from.origin_rate,
             d_tt = frame.origin_acceleration - from.origin_acceleration;
  return {u.e.dot(d), u.rate.dot(d) + u.e.dot(d_t),
          u.acceleration.dot(d) + 2 * u.rate.dot(d_t) + u.e.dot(d_tt)};
}

/// What is wrong with the joints, and which drives of the case take part: of many joints they are
/// the ones to look at.
Error refusal(const Scene& scene, const fem::Diagnosis& diagnosis) {
  // A line to each group; the drives of the first groups are as many as one reads.
  constexpr int kMostDrives = 8;
  std::string words = fem::describe(diagnosis);
  int said = 0;
  for (const fem::DependentGroup& group : diagnosis.groups) {
    std::vector<std::string> drives;
    for (const std::string& name : group.joints)
      if (name == kPath || name == kPathAngle ||
          std::any_of(scene.joints.begin(), scene.joints.end(),
                      [&](const Joint& j) { return j.name == name && !j.laws.empty(); }))
        drives.push_back(name);
    if (group.joints.size() > 5 && !drives.empty() && said++ < kMostDrives)
      words += "\nof them drives: " + fem::list_joints(drives);
  }
  return Error::input(words);
}

/// Do rows miss each other in position?
bool misses_positions(const fem::Diagnosis& diagnosis) {
  return std::any_of(diagnosis.groups.begin(), diagnosis.groups.end(),
                     [](const fem::DependentGroup& group) { return group.miss > 0; });
}

/// Assembles; says which joints are to blame where there is no position or velocity because they
/// hold more than there is, wherever the bodies are. False where there are positions, but only
/// plates that bend have velocities: all are 0 then.
bool assemble_start(const Scene& scene, fem::Workspace& model, fem::State& x) {
  const fem::State guess = x;
  try {
    fem::assemble(model, x);
    return true;
  } catch (const Error& error) {
    const fem::Diagnosis anywhere = fem::diagnose(model, guess);
    if (error.kind() == Error::Kind::input || anywhere.is_independent()) throw;
    const fem::Diagnosis nearest = fem::diagnose(model, x);  // x is the best fit
    if (scene.bodies.empty() || misses_positions(nearest) || !nearest.is_contradictory())
      throw refusal(scene, nearest.is_contradictory() ? nearest : anywhere);
    x.v.setZero();
    return false;
  }
}

}  // namespace

Twin::Twin(const Scene& scene, Driven driven) : scene_(scene), driven_(driven) {
  for (const RigidBody& b : scene.rigid_bodies) add_rigid_body(b, model_, scene.gravity_law());
  for (const Body& b : scene.bodies) add_plate(b);
  const FindPlace place = [&](const Anchor& anchor) {
    Vec2 point = anchor.point;
    for (const Body& b : scene.bodies)
      if (b.name == anchor.body)
        point = undeformed_place(b, point) - Vec2(b.longest(scene.time.end), 0);
    return fem::MarkerPlace{anchor.body, point, anchor.angle, {}};
  };
  for (const Spring& spring : scene.springs) model_.add_link(make_link(scene, spring, place));
  add_rigid_loads(scene, model_);
  for (const Joint& joint : scene.joints) {
    if (joint.holds_frame()) {
      add_carried(joint);
    } else if (joint.laws.empty() || !let_go(joint.laws[0])) {
      if (auto made = make_joint(scene, joint, place, true)) model_.add_joint(std::move(made));
    }
  }
  if (driven != Driven::by_trajectory) return;
  const Trajectory& path = *scene.trajectory;
  const auto x = scene.motion_of(path.x), y = scene.motion_of(path.y);
  model_.add_joint(fem::make_point_drive(kPath, {path.body},
                                         [x, y](double t) {
                                           return std::vector{x(t), y(t)};
                                         },
                                         {}));
  model_.add_joint(fem::make_angle_drive(kPathAngle, {}, {path.body}, scene.motion_of(path.angle)));
}

bool Twin::let_go(const Law& law) const {
  if (driven_ == Driven::free) return !law.drive.empty();
  return driven_ == Driven::by_trajectory && scene_.follows_trajectory(law);
}

void Twin::add_plate(const Body& body) {
  RigidBody twin;
  twin.name = body.name;
  const double length = body.length > 0 ? body.length : body.width;  // not known yet: of no matter
  twin.mass = body.density * body.thickness * body.width * length;
  twin.center = {-0.5 * length, 0};
  twin.inertia = twin.mass * (length * length + body.width * body.width) / 12;
  const Vec2 end(body.longest(scene_.time.end), 0);
  for (const PointMass& m : scene_.point_masses)
    if (m.body == body.name) twin.masses.push_back({m.mass, undeformed_place(body, m.point) - end});
  add_rigid_body(twin, model_, scene_.gravity_law());
}

void Twin::add_carried(const Joint& joint) {
  const Body& body = scene_.body(joint.body);
  fem::MarkerPlace plate{joint.body, {0, 0}, 0, {}};
  bool free = false;
  if (joint.edge == "root" && body.flow) {
    // A constant speed is a drive, too; hubs keep theirs.
    free = driven_ == Driven::free ? joint.on_rigid_body() : let_go(body.flow->length);
    if (!free) plate.along = negative([&body](double t) { return body.length_motion(t); });
  } else if (joint.edge == "free_end") {
    plate.point = undeformed_place(body, {body.longest(scene_.time.end), 0}) -
                  Vec2(body.longest(scene_.time.end), 0);
    plate.angle = body.arc;
  } else {
    for (const BodyLine& line : body.lines) free = free || (line.free && line.index == joint.line);
    const double longest = body.longest(scene_.time.end);
    plate.point.x() =
        body.start_lines(longest - body.length, body.elements[0])[static_cast<size_t>(joint.line)] -
        longest;
  }
  if (joint.on_rigid_body()) {
    const fem::MarkerPlace frame{joint.b.body, joint.b.point, joint.b.angle, {}};
    model_.add_joint(free ? fem::make_slider(joint.name, plate, frame)
                          : fem::make_rigid_weld(joint.name, frame, plate));
    return;
  }
  if (free) throw Error::input("joint '" + joint.name + "': a line that slides in a driven hub");
  const fem::FrameDrive hub = hub_drive(scene_, joint);
  model_.add_joint(
      fem::make_point_drive(joint.name, plate,
                            [hub](double t) {
                              const fem::FrameMotion f = hub(t);
                              return std::vector<fem::Motion>{
                                  {f.origin.x(), f.origin_rate.x(), f.origin_acceleration.x()},
                                  {f.origin.y(), f.origin_rate.y(), f.origin_acceleration.y()}};
                            },
                            {}));
  model_.add_joint(
      fem::make_angle_drive(joint.name, {}, {joint.body, {0, 0}, plate.angle, {}}, [hub](double t) {
        const fem::FrameMotion f = hub(t);
        return fem::Motion{f.angle, f.angle_rate, f.angle_acceleration};
      }));
}

fem::State Twin::guess() const {
  fem::State x = model_.reference();
  const auto put = [&](const std::string& name, const Vec2& r, double angle) {
    x.q.segment<4>(model_.body(name).first_dof) << r, std::cos(angle), std::sin(angle);
  };
  for (const RigidBody& b : scene_.rigid_bodies) put(b.name, b.position, b.angle);
  for (const Body& b : scene_.bodies) {
    const Pose pose = start_pose(scene_, b);
    // The origin of the twin: the end of the straight axis, also of an arc.
    Vec2 end =
        pose.origin + fem::rotation(pose.angle) * Vec2(b.longest(scene_.time.end) - pose.line, 0);
    for (const Joint& j : scene_.joints)
      if (j.body == b.name && j.edge == "free_end" && b.flow)
        end = j.on_rigid_body() ? start_place(scene_, j.b) : hub_drive(scene_, j)(0).origin;
    put(b.name, end, pose.angle);
  }
  return x;
}

fem::FrameMotion Twin::frame(const std::string& body, const fem::State& x) const {
  return fem::frame_of(model_.body(body), x);
}

fem::Motion Twin::motion_of(const std::string& drive, const fem::State& x) const {
  const auto frame_at = [&](const Anchor& anchor) {
    if (anchor.on_ground()) {
      fem::FrameMotion ground;
      ground.origin = anchor.point;
      ground.angle = anchor.angle;
      return ground;
    }
    return fem::Carrier(anchor.body, anchor.point, anchor.angle).at(model_, x);
  };
  for (const Joint& joint : scene_.joints) {
    if (joint.on_rigid_body() && joint.edge == "root") {
      const Body& body = scene_.body(joint.body);
      if (body.flow && body.flow->length.drive == drive)
        return distance_along(frame(joint.body, x), frame_at(joint.b));
    }
    if (joint.laws.empty() || joint.laws[0].drive != drive) continue;
    const fem::FrameMotion a = frame_at(completed(scene_, joint.a, joint.b)),
                           b = frame_at(completed(scene_, joint.b, joint.a));
    if (joint.row->coordinate) return joint.row->coordinate(a, b);
  }
  throw Error::input("drive '" + drive +
                     "' follows from the trajectory, but drives no flow, angle or distance");
}

TwinMotion::TwinMotion(const Scene& scene) : twin_(scene), start_(twin_.guess()) {
  const bool moves = assemble_start(scene, twin_.model(), start_);
  const fem::Diagnosis diagnosis = fem::diagnose(twin_.model(), start_);
  indeterminate_ = !diagnosis.is_independent();
  if (indeterminate_ && (scene.bodies.empty() || misses_positions(diagnosis)))
    throw refusal(scene, diagnosis);
  if (moves) move_as_given(scene, twin_.model(), start_);
  freedoms_ = diagnosis.degrees_of_freedom();
  if (freedoms_ > 0 || (indeterminate_ && diagnosis.is_contradictory())) return;
  kinematics_ = std::make_unique<fem::Kinematics>(twin_.model(), start_);
}

bool TwinMotion::reaches(double t) {
  if (!indeterminate_) return true;
  if (!kinematics_) return false;
  try {
    kinematics_->at(t);
    return true;
  } catch (const Error&) {
    return false;
  }
}

int undriven_freedoms(const Scene& scene) {
  Twin twin(scene, Twin::Driven::free);
  fem::State x = twin.guess();
  fem::assemble(twin.model(), x);
  return fem::degrees_of_freedom(twin.model(), x);
}

const fem::State& TwinMotion::at(double t) { return kinematics_ ? kinematics_->at(t) : start_; }

bool TwinMotion::follow(double t, int most_steps) {
  return !kinematics_ || kinematics_->follow(t, most_steps);
}

double TwinMotion::start_speed() const {
  return twin_.model().scales().cwiseProduct(start_.v).lpNorm<Eigen::Infinity>();
}

double TwinMotion::start_acceleration() {
  fem::State x = start_;
  fem::make_integrator(twin_.model(), {})->make_consistent(x);
  return twin_.model().scales().cwiseProduct(x.a).lpNorm<Eigen::Infinity>();
}

void check_mechanism(const Scene& scene) {
  constexpr int kLooks = 200;
  TwinMotion motion(scene);
  // Plates that bend may go where the rigid twin cannot.
  if (motion.degrees_of_freedom() > 0 || motion.is_indeterminate()) return;
  // Of drives that turn ten thousand times the first turns are enough for a look.
  constexpr int kMostSteps = 4000;
  for (int k = 1; k <= kLooks; ++k)
    if (!motion.follow(scene.time.end * k / kLooks, kMostSteps)) return;
}

namespace {

/// Quintic between two samples: value, rate and acceleration of both (Hermite).
fem::Motion quintic(const fem::Motion& a, const fem::Motion& b, double h, double s) {
  const double d = b.value - a.value - h * a.rate - 0.5 * h * h * a.acceleration,
               d1 = h * (b.rate - a.rate - h * a.acceleration),
               d2 = h * h * (b.acceleration - a.acceleration);
  const double c3 = 10 * d - 4 * d1 + 0.5 * d2, c4 = -15 * d + 7 * d1 - d2,
               c5 = 6 * d - 3 * d1 + 0.5 * d2;
  const double t = s * h;
  return {a.value + t * (a.rate + 0.5 * t * a.acceleration) + s * s * s * (c3 + s * (c4 + s * c5)),
          a.rate + t * a.acceleration + s * s * (3 * c3 + s * (4 * c4 + s * 5 * c5)) / h,
          a.acceleration + s * (6 * c3 + s * (12 * c4 + s * 20 * c5)) / (h * h)};
}

constexpr int kSamples = 2000;

}  // namespace

void follow_trajectory(Scene& scene) {
  std::vector<Drive*> drives;
  for (Drive& d : scene.drives)
    if (d.from_trajectory) drives.push_back(&d);
  if (drives.empty()) throw Error::input("no [[drive]] has from = \"trajectory\"");
  Twin twin(scene, Twin::Driven::by_trajectory);
  fem::State start = twin.guess();
  assemble_start(scene, twin.model(), start);
  fem::KinematicsSettings settings;
  settings.most_steps = 5 * kSamples;
  fem::Kinematics kinematics(twin.model(), start, settings);
  std::vector<std::vector<fem::Motion>> samples(drives.size());
  const double h = scene.time.end / kSamples;
  for (int k = 0; k <= kSamples; ++k) {
    const fem::State& x = kinematics.at(k * h);
    for (size_t i = 0; i < drives.size(); ++i) {
      fem::Motion m = twin.motion_of(drives[i]->name, x);
      // Angles go on through half turns; lengths never jump by as much as half a turn's 3.14 m.
      if (k > 0) {
        const double turn = 2 * std::numbers::pi;
        const double jump = m.value - samples[i].back().value;
        m.value -= turn * std::round(jump / turn);
      }
      samples[i].push_back(m);
    }
  }
  for (size_t i = 0; i < drives.size(); ++i)
    drives[i]->motion = [h, sample = std::move(samples[i])](double t) {
      const auto k = static_cast<size_t>(std::clamp(std::floor(t / h), 0.0, kSamples - 1.0));
      return quintic(sample[k], sample[k + 1], h, t / h - static_cast<double>(k));
    };
}

}  // namespace flexmorph::cases
