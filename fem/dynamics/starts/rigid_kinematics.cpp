#include "fem/dynamics/starts/rigid_kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/body_joints.h"
#include "fem/dynamics/starts/other_start.h"
#include "fem/solve/assembly.h"
#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

/// The first axis of a frame, with its first and second time derivative.
struct Axis {
  explicit Axis(const FrameMotion& f)
      : e(std::cos(f.angle), std::sin(f.angle)),
        rate(f.angle_rate * Vec2(-e.y(), e.x())),
        acceleration(f.angle_acceleration * Vec2(-e.y(), e.x()) - f.angle_rate * f.angle_rate * e) {
  }
  Vec2 e, rate, acceleration;
};

}  // namespace

Motion angle_between(const FrameMotion& a, const FrameMotion& b) {
  return {std::remainder(b.angle - a.angle, 2 * std::numbers::pi), b.angle_rate - a.angle_rate,
          b.angle_acceleration - a.angle_acceleration};
}

Motion distance_between(const FrameMotion& a, const FrameMotion& b) {
  const Vec2 d = b.origin - a.origin, d_t = b.origin_rate - a.origin_rate,
             d_tt = b.origin_acceleration - a.origin_acceleration;
  const double l = d.norm(), rate = d.dot(d_t) / l;
  return {l, rate, (d_t.squaredNorm() + d.dot(d_tt) - rate * rate) / l};
}

Motion distance_along(const FrameMotion& a, const FrameMotion& b) {
  const Axis u(a);
  const Vec2 d = a.origin - b.origin, d_t = a.origin_rate - b.origin_rate,
             d_tt = a.origin_acceleration - b.origin_acceleration;
  return {u.e.dot(d), u.rate.dot(d) + u.e.dot(d_t),
          u.acceleration.dot(d) + 2 * u.rate.dot(d_t) + u.e.dot(d_tt)};
}

void add_rigid_body(Model& model, const MechanismBody& body, const LoadLaw& gravity,
                    std::span<const MaterialReservoir> reservoirs) {
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_rigid_inertia(body.section));
  if (gravity.size() > 0) terms.push_back(make_rigid_gravity(body.section, gravity));
  for (const MaterialReservoir& each : reservoirs) {
    terms.push_back(make_reservoir_inertia(each));
    if (gravity.size() > 0) terms.push_back(make_reservoir_weight(each, gravity));
  }
  model.add_body(body.name, make_rigid_body(body.size, !reservoirs.empty()), {}, std::move(terms));
  model.add_joint(make_unit_axis("axis of " + body.name, body.name));
}

RigidKinematics::RigidKinematics(RigidMechanism mechanism) : mechanism_(std::move(mechanism)) {
  for (const MechanismBody& body : mechanism_.bodies)
    add_rigid_body(model_, body, mechanism_.gravity);
  for (const auto& force_element : mechanism_.force_elements)
    model_.add_force_element(force_element->clone());
  for (const MechanismJoint& each : mechanism_.joints) {
    if (!each.joint && each.is_driven)
      throw Error::input("rigid kinematics: the drive '" + each.drive +
                         "' has no prescribed motion");
    if (each.joint) model_.add_joint(each.joint->clone());
  }
}

State RigidKinematics::guess() const {
  State x = model_.reference();
  for (const MechanismBody& b : mechanism_.bodies)
    x.q.segment<4>(model_.body(b.name).first_dof) << b.position, std::cos(b.angle),
        std::sin(b.angle);
  return x;
}

Error RigidKinematics::refusal(const Diagnosis& diagnosis) const {
  // Only large groups get a line with their drives, and only a limited number of lines is useful.
  constexpr size_t kManyJoints = 5;
  constexpr int kMaxLines = 8;
  std::string words = describe(diagnosis);
  int said = 0;
  for (const DependentGroup& group : diagnosis.groups) {
    std::vector<std::string> drives;
    for (const std::string& name : group.joints)
      if (std::any_of(mechanism_.joints.begin(), mechanism_.joints.end(),
                      [&](const MechanismJoint& j) {
                        return j.prescribes && j.joint && j.joint->name() == name;
                      }))
        drives.push_back(name);
    if (group.joints.size() > kManyJoints && !drives.empty() && said++ < kMaxLines)
      words += "\nThe drives of this group are: " + list_joints(drives);
  }
  return Error::input(words);
}

/// Tries other starts than the guess. x is the best fit from the guess, and becomes the position
/// that is found.
/// @returns false if x meets the positions of all joints, or if no position is found
bool RigidKinematics::assemble_elsewhere(const State& guess, State& x) {
  constexpr double kMet = 1e-9;  // in sizes of the model
  constexpr size_t kMaxListed = 5;
  ScaledConstraints rows;
  rows.evaluate(model_, x);
  if (rows.misses().lpNorm<Eigen::Infinity>() <= kMet * model_size(rows.scales(), x.q))
    return false;
  const std::optional<OtherStart> found = other_start(model_, guess);
  if (!found) return false;
  x = found->x;
  remark_ =
      "The given initial positions of the bodies do not lead to a position that meets all joints. "
      "Of " +
      std::to_string(found->tried) + " other starts, " + std::to_string(found->assembled) +
      " lead to " +
      (found->assemblies == 1 ? std::string("one position")
                              : std::to_string(found->assemblies) +
                                    " different positions, of which the nearest is "
                                    "taken") +
      ": ";
  size_t listed = 0;
  for (const MechanismBody& b : mechanism_.bodies) {
    const FrameMotion f = frame(b.name, x);
    const double turn = std::remainder(f.angle - b.angle, 2 * std::numbers::pi);
    if ((f.origin - b.position).norm() <= kMet && std::abs(turn) <= kMet) continue;
    if (listed++ < kMaxListed)
      remark_ += (listed == 1 ? "" : ", ") + formatted("'%s' position [%.6g, %.6g] angle %.6g",
                                                       b.name.c_str(), f.origin.x(), f.origin.y(),
                                                       b.angle + turn);
  }
  if (listed > kMaxListed) remark_ += " and " + std::to_string(listed - kMaxListed) + " more";
  remark_ += ". To choose a position, give values near it in the case";
  return true;
}

bool RigidKinematics::assemble(State& x) {
  const State guess = x;
  try {
    fem::assemble(model_, x);
    return true;
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::input && assemble_elsewhere(guess, x)) return true;
    const Diagnosis anywhere = diagnose(model_, guess);
    if (error.kind() == Error::Kind::input || anywhere.is_independent()) throw;
    const Diagnosis nearest = diagnose(model_, x);  // x is the best fit
    if (!mechanism_.bends || nearest.misses_positions() || !nearest.is_contradictory())
      throw refusal(nearest.is_contradictory() ? nearest : anywhere);
    x.v.setZero();
    return false;
  }
}

FrameMotion RigidKinematics::frame(const std::string& body, const State& x) const {
  return frame_of(model_.body(body), x);
}

FrameMotion RigidKinematics::frame_at(const MarkerLocation& location, const State& x) const {
  if (!location.body.empty())
    return DrivenFrame(location.body, location.point, location.angle).at(model_, x);
  FrameMotion ground;
  ground.origin = location.point;
  ground.angle = location.angle;
  return ground;
}

Motion RigidKinematics::coordinate_of(const std::string& drive, const State& x) const {
  for (const MechanismJoint& each : mechanism_.joints)
    if (each.drive == drive && each.coordinate)
      return each.coordinate(frame_at(each.a, x), frame_at(each.b, x));
  throw Error::input(
      "drive '" + drive +
      "' follows from the trajectory, but it does not drive a flow, an angle or a distance");
}

RigidMechanism released(RigidMechanism mechanism,
                        const std::function<bool(const MechanismJoint&)>& chosen) {
  for (MechanismJoint& each : mechanism.joints) {
    if (!each.is_driven || !chosen(each)) continue;
    each.joint = each.released;
    each.is_driven = false;
  }
  return mechanism;
}

int undriven_degrees_of_freedom(const RigidKinematics& kinematics) {
  RigidKinematics free(
      released(kinematics.mechanism(), [](const MechanismJoint&) { return true; }));
  State x = free.guess();
  free.assemble(x);
  return degrees_of_freedom(free.model(), x);
}

}  // namespace flexmorph::fem
