#include "cases/results/mechanism_columns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/assembly/joints.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/starts/driven_frame.h"
#include "fem/dynamics/total_momentum.h"
#include "fem/model/workspace_wrench.h"

namespace flexmorph::cases {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Returns the angle, plus a multiple of 2π, that is nearest to `near` [rad].
double unwrapped(double angle, double near) { return near + std::remainder(angle - near, kTurn); }

size_t index_of(const fem::Model& model, const std::string& joint) {
  const auto& all = model.joints();
  return static_cast<size_t>(std::find_if(all.begin(), all.end(),
                                          [&](const auto& each) { return each->name() == joint; }) -
                             all.begin());
}

/// Returns the body whose force is a column: body b, or body a if b is the ground.
const std::string& loaded_body(const Anchor& a, const Anchor& b) {
  return b.on_ground() ? a.body : b.body;
}

/// Returns the power λ · ∂Φ/∂t of a drive [W].
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
  if (is_free_)
    describe("momentum",
             {{"x", "kg m/s", "linear momentum of all bodies along x"},
              {"y", "kg m/s", "linear momentum of all bodies along y"},
              {"angular", "kg m^2/s", "angular momentum of all bodies about the origin"}});
  describe_bodies();
  describe_joints();
  describe_hubs();
  describe_springs();
}

void MechanismColumns::describe(const std::string& of,
                                std::initializer_list<std::array<const char*, 3>> quantities) {
  for (const auto& [quantity, unit, meaning] : quantities)
    columns_.push_back({of + "." + quantity, unit, meaning, ColumnGroup::mechanism});
}

void MechanismColumns::describe_wrench(const std::string& of, const std::string& kind,
                                       const std::string& body) {
  const std::string force = " component of the force of the " + kind + " on '" + body + "'",
                    x = "x" + force, y = "y" + force,
                    moment = "moment of the " + kind + " on '" + body +
                             "' about the point of the " + kind;
  describe(of, {{"force_x", "N", x.c_str()},
                {"force_y", "N", y.c_str()},
                {"moment", "N m", moment.c_str()}});
}

void MechanismColumns::describe_bodies() {
  for (const RigidBody& body : scene_.rigid_bodies) {
    describe(body.name, {{"x", "m", "x coordinate of the origin of the body's frame"},
                         {"y", "m", "y coordinate of the origin of the body's frame"},
                         {"angle", "rad", "angle of the first axis of the body's frame"}});
    frames_.emplace_back().angle = body.angle;
  }
  if (!scene_.trajectory) return;
  const TargetTrajectory& t = *scene_.trajectory;
  describe(t.body,
           {{"delta_x", "m", "x coordinate of the body minus x coordinate of the trajectory"},
            {"delta_y", "m", "y coordinate of the body minus y coordinate of the trajectory"},
            {"delta_angle", "rad", "angle of the body minus angle of the trajectory"}});
  path_ = {scene_.motion_of(t.x), scene_.motion_of(t.y), scene_.motion_of(t.angle)};
}

void MechanismColumns::describe_joints() {
  for (const Joint& joint : scene_.joints) {
    if (!joint.named) continue;
    const bool driven = std::any_of(joint.laws.begin(), joint.laws.end(),
                                    [](const Law& law) { return !law.drive.empty(); });
    const Anchor about = joint.row->on_one_body ? joint.a : completed(scene_, joint.b, joint.a);
    joints_.push_back({&joint, about, driven});
    describe_wrench(joint.name, "joint", loaded_body(joint.a, joint.b));
    if (driven && !scene_.statics)
      describe(joint.name, {{"power", "W", "power of the drive that enters the mechanism"}});
  }
}

void MechanismColumns::describe_hubs() {
  for (const Hub& hub : scene_.hubs) {
    WatchedHub& watched = hubs_.emplace_back();
    for (const Joint& joint : scene_.joints)
      if (joint.holds_frame() && joint.to == hub.name) watched.joints.push_back(&joint);
    if (!watched.joints.empty()) watched.drive = hub_drive(scene_, *watched.joints[0]);
    describe(hub.name,
             {{"force_x", "N", "x component of the force of the hub on its bodies"},
              {"force_y", "N", "y component of the force of the hub on its bodies"},
              {"moment", "N m", "moment of the hub on its bodies about the origin of the hub"}});
    if (!scene_.statics)
      describe(hub.name, {{"power", "W", "power of the hub's drive that enters the mechanism"}});
    if (scene_.in_space())
      describe(hub.name,
               {{"force_z", "N", "z component of the force of the hub on its bodies"},
                {"moment_x", "N m", "x component of the moment of the hub on its bodies"},
                {"moment_y", "N m", "y component of the moment of the hub on its bodies"}});
  }
}

void MechanismColumns::describe_springs() {
  for (const Spring& spring : scene_.springs) {
    if (!spring.named) continue;
    describe_wrench(spring.name, "spring", loaded_body(spring.a, spring.b));
    describe(spring.name, {{"energy", "J", "energy stored in the spring"}});
    if (!scene_.statics)
      describe(spring.name,
               {{"power", "W",
                 "power of the spring that does not change its stored energy, such as damping"}});
  }
}

namespace {

void append_wrench(const fem::Wrench& wrench, std::vector<double>& row) {
  row.insert(row.end(), {wrench.force.x(), wrench.force.y(), wrench.moment.z()});
}

void append_spring(const Scene& scene, const Spring& spring, fem::Workspace& model,
                   const fem::State& x, std::vector<double>& row) {
  const auto& all = model.force_elements();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& link) { return link->name() == spring.name; });
  VectorXd force = VectorXd::Zero(model.n_dofs());
  (*found)->add_force(x, force);
  force = -force;  // force elements are on the left-hand side of the equations of motion
  const Anchor at = completed(scene, spring.b, spring.a);
  const Vec2 about = model.location_motion({at.body, at.point, 0, {}}, x).position;
  const std::string& body = loaded_body(spring.a, spring.b);
  append_wrench(fem::wrench_on(model.body(body), force, {about.x(), about.y(), 0}, x), row);
  row.push_back((*found)->energies(x).strain);
  if (!scene.statics) row.push_back((*found)->power(x));
}

}  // namespace

void MechanismColumns::append(fem::Workspace& model, const fem::State& x,
                              std::vector<double>& row) {
  const size_t first = row.size();
  if (is_free_) {
    const fem::TotalMomentum all = fem::total_momentum(model, x);
    row.insert(row.end(), {all.linear.x(), all.linear.y(), all.angular});
  }
  for (size_t i = 0; i < frames_.size(); ++i) {
    const double before = frames_[i].angle;
    frames_[i] = fem::frame_of(model.body(scene_.rigid_bodies[i].name), x);
    frames_[i].angle = unwrapped(frames_[i].angle, before);
    row.insert(row.end(), {frames_[i].origin.x(), frames_[i].origin.y(), frames_[i].angle});
  }
  if (scene_.trajectory) append_trajectory(x.t, row);
  for (const Watched& watched : joints_) {
    const Joint& joint = *watched.joint;
    const size_t index = index_of(model, joint.name);
    const Vec2 about =
        model.location_motion({watched.about.body, watched.about.point, 0, {}}, x).position;
    const std::string& body = loaded_body(joint.a, joint.b);
    append_wrench(model.joint_wrench(index, body, {about.x(), about.y(), 0}, x), row);
    if (watched.driven && !scene_.statics) row.push_back(drive_power(model, index, x));
  }
  for (const WatchedHub& hub : hubs_) append_hub(hub, model, x, row);
  for (const Spring& spring : scene_.springs)
    if (spring.named) append_spring(scene_, spring, model, x, row);
  for (size_t i = first; i < row.size(); ++i) row[i] += 0.0;  // converts -0 to 0
}

void MechanismColumns::archive(Archive& memory) {
  for (fem::FrameMotion& frame : frames_) memory(frame.angle);  // append() overwrites the rest
  memory(turns_);
}

void MechanismColumns::append_trajectory(double t, std::vector<double>& row) {
  size_t i = 0;
  while (scene_.rigid_bodies[i].name != scene_.trajectory->body) ++i;
  const fem::FrameMotion& frame = frames_[i];
  const double angle = path_[2](t).value;
  // The angles that the case gives for body and trajectory may differ by whole turns, which are
  // subtracted.
  if (!turns_) turns_ = kTurn * std::round((frame.angle - angle) / kTurn);
  row.insert(row.end(), {frame.origin.x() - path_[0](t).value, frame.origin.y() - path_[1](t).value,
                         frame.angle - angle - *turns_});
}

void MechanismColumns::append_hub(const WatchedHub& hub, fem::Workspace& model, const fem::State& x,
                                  std::vector<double>& row) const {
  fem::Wrench sum;
  double power = 0;
  for (const Joint* joint : hub.joints) {
    const Vec2 about = hub.drive(x.t).origin;
    const size_t index = index_of(model, joint->name);
    const fem::Wrench wrench = model.joint_wrench(index, joint->body, {about.x(), about.y(), 0}, x);
    sum.force += wrench.force;
    sum.moment += wrench.moment;
    if (!scene_.statics) power += drive_power(model, index, x);
  }
  append_wrench(sum, row);
  if (!scene_.statics) row.push_back(power);
  if (scene_.in_space()) row.insert(row.end(), {sum.force.z(), sum.moment.x(), sum.moment.y()});
}

}  // namespace flexmorph::cases
