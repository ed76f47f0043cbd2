#include "cases/results/mechanism_columns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/assembly/joints.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/carrier.h"
#include "fem/dynamics/whole_momentum.h"
#include "fem/workspace_wrench.h"

namespace flexmorph::cases {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The value nearest to another one that is the same angle.
double unwrapped(double angle, double near) { return near + std::remainder(angle - near, kTurn); }

size_t index_of(const fem::Model& model, const std::string& joint) {
  const auto& all = model.joints();
  return static_cast<size_t>(std::find_if(all.begin(), all.end(),
                                          [&](const auto& each) { return each->name() == joint; }) -
                             all.begin());
}

/// λ · ∂Φ/∂t.
double drive_power(const fem::Model& model, size_t joint, const fem::State& x) {
  fem::ConstraintRows rows;
  model.joints()[joint]->evaluate(x.t, x.q, x.v, rows);
  return x.lambda.segment(model.first_row(joint), model.joints()[joint]->size()).dot(rows.rate);
}

}  // namespace

bool MechanismColumns::is_free(const Scene& scene) {
  const auto holds = [](const Joint& j) {
    if (j.holds_frame()) return !j.on_rigid_body();
    if (j.drives_line) return false;
    return !j.between_bodies() || j.a.on_ground() || j.b.on_ground();
  };
  return !scene.statics && scene.hubs.empty() &&
         std::none_of(scene.bodies.begin(), scene.bodies.end(),
                      [](const Body& b) { return b.in_space(); }) &&
         std::none_of(scene.joints.begin(), scene.joints.end(), holds);
}

MechanismColumns::MechanismColumns(const Scene& scene) : scene_(scene), is_free_(is_free(scene)) {
  const auto name = [&](const std::string& of, std::initializer_list<const char*> quantities) {
    for (const char* quantity : quantities) columns_.push_back({of + "." + quantity, {}});
  };
  if (is_free_) name("momentum", {"x", "y", "angular"});
  for (const RigidBody& body : scene.rigid_bodies) {
    name(body.name, {"x", "y", "angle"});
    frames_.emplace_back().angle = body.angle;
  }
  if (scene.trajectory) {
    const Trajectory& t = *scene.trajectory;
    name(t.body, {"delta_x", "delta_y", "delta_angle"});
    path_ = {scene.motion_of(t.x), scene.motion_of(t.y), scene.motion_of(t.angle)};
  }
  for (const Joint& joint : scene.joints) {
    if (!joint.named) continue;
    const bool driven = std::any_of(joint.laws.begin(), joint.laws.end(),
                                    [](const Law& law) { return !law.drive.empty(); });
    const Anchor about = joint.row->on_one_body ? joint.a : completed(scene, joint.b, joint.a);
    joints_.push_back({&joint, about, driven});
    name(joint.name, {"force_x", "force_y", "moment"});
    if (driven) name(joint.name, {"power"});
  }
  for (const Hub& hub : scene.hubs) {
    WatchedHub& watched = hubs_.emplace_back();
    for (const Joint& joint : scene.joints)
      if (joint.holds_frame() && joint.to == hub.name) watched.joints.push_back(&joint);
    if (!watched.joints.empty()) watched.drive = hub_drive(scene, *watched.joints[0]);
    name(hub.name, {"force_x", "force_y", "moment", "power"});
    if (scene.in_space()) name(hub.name, {"force_z", "moment_x", "moment_y"});
  }
  for (const Spring& spring : scene.springs)
    if (spring.named) name(spring.name, {"force_x", "force_y", "moment", "energy", "power"});
}

void MechanismColumns::add(fem::Workspace& model, const fem::State& x) {
  next_ = 0;
  if (is_free_) {
    const fem::WholeMomentum all = fem::whole_momentum(model, x);
    for (const double value : {all.linear.x(), all.linear.y(), all.angular}) put(value);
  }
  for (size_t i = 0; i < frames_.size(); ++i) {
    const double before = frames_[i].angle;
    frames_[i] = fem::frame_of(model.body(scene_.rigid_bodies[i].name), x);
    frames_[i].angle = unwrapped(frames_[i].angle, before);
    put(frames_[i].origin.x());
    put(frames_[i].origin.y());
    put(frames_[i].angle);
  }
  if (scene_.trajectory) add_trajectory(x.t);
  for (const Watched& watched : joints_) add_joint(watched, model, x);
  for (const WatchedHub& hub : hubs_) add_hub(hub, model, x);
  for (const Spring& spring : scene_.springs)
    if (spring.named) add_spring(spring, model, x);
}

void MechanismColumns::remember(Memory& memory) {
  for (fem::FrameMotion& frame : frames_) memory(frame.angle);  // all else is overwritten
  memory(turns_, columns_);
}

void MechanismColumns::add_trajectory(double t) {
  size_t i = 0;
  while (scene_.rigid_bodies[i].name != scene_.trajectory->body) ++i;
  const fem::FrameMotion& frame = frames_[i];
  const double angle = path_[2](t).value;
  // Whole turns between the two are a matter of how the case counts them.
  if (!turns_) turns_ = kTurn * std::round((frame.angle - angle) / kTurn);
  put(frame.origin.x() - path_[0](t).value);
  put(frame.origin.y() - path_[1](t).value);
  put(frame.angle - angle - *turns_);
}

void MechanismColumns::add_joint(const Watched& watched, fem::Workspace& model,
                                 const fem::State& x) {
  const Joint& joint = *watched.joint;
  const size_t index = index_of(model, joint.name);
  const Vec2 about =
      model.place_motion({watched.about.body, watched.about.point, 0, {}}, x).position;
  const std::string& body = joint.b.on_ground() ? joint.a.body : joint.b.body;
  put(model.joint_wrench(index, body, {about.x(), about.y(), 0}, x));
  if (watched.driven) put(drive_power(model, index, x));
}

void MechanismColumns::add_hub(const WatchedHub& hub, fem::Workspace& model, const fem::State& x) {
  fem::Wrench sum;
  double power = 0;
  for (const Joint* joint : hub.joints) {
    const Vec2 about = hub.drive(x.t).origin;
    const size_t index = index_of(model, joint->name);
    const fem::Wrench wrench = model.joint_wrench(index, joint->body, {about.x(), about.y(), 0}, x);
    sum.force += wrench.force;
    sum.moment += wrench.moment;
    power += drive_power(model, index, x);
  }
  put(sum);
  put(power);
  if (!scene_.in_space()) return;
  for (const double value : {sum.force.z(), sum.moment.x(), sum.moment.y()}) put(value);
}

void MechanismColumns::add_spring(const Spring& spring, fem::Workspace& model,
                                  const fem::State& x) {
  const auto& all = model.links();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& link) { return link->name() == spring.name; });
  VectorXd force = VectorXd::Zero(model.n_dofs());
  (*found)->add_force(x, force);
  force = -force;  // links stand on the left side
  const Anchor at = completed(scene_, spring.b, spring.a);
  const Vec2 about = model.place_motion({at.body, at.point, 0, {}}, x).position;
  const std::string& body = spring.b.on_ground() ? spring.a.body : spring.b.body;
  put(fem::wrench_on(model.body(body), force, {about.x(), about.y(), 0}, x));
  put((*found)->strain_energy(x));
  put((*found)->power(x));
}

}  // namespace flexmorph::cases
