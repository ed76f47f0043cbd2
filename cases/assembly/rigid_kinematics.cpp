#include "cases/assembly/rigid_kinematics.h"

#include <algorithm>
#include <cmath>

#include "cases/assembly/build.h"
#include "cases/assembly/joints.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/starts/inverse_kinematics.h"

namespace flexmorph::cases {
namespace {

double curvature_of(const Body& body) { return body.arc == 0 ? 0 : body.arc / body.length; }

/// Returns the material coordinate of the root at the start [m]. Material with a smaller coordinate
/// is still inside the hub.
double root_line(const Scene& scene, const Body& body) {
  return body.longest(scene.time.end) - body.length;
}

/// Returns the pose of a body if a hub, a rigid body or the case gives it; nothing if welds give
/// it.
std::optional<fem::ReferencePose> own_pose(const Scene& scene, const Body& body) {
  const double root = root_line(scene, body), curvature = curvature_of(body);
  for (const Joint& joint : scene.joints) {
    if (joint.body != body.name || !joint.holds_frame() || joint.edge == "free_end") continue;
    const double line = body.start_lines(root, body.elements[0])[static_cast<size_t>(joint.line)];
    if (joint.to.empty()) return fem::ReferencePose{joint.position, joint.angle, line, curvature};
    if (joint.on_rigid_body())
      for (const RigidBody& b : scene.rigid_bodies)
        if (b.name == joint.b.body)
          return fem::ReferencePose{start_location(scene, joint.b), b.angle + joint.b.angle, line,
                                    curvature};
    const Hub& hub = hub_of(scene, joint);
    return fem::ReferencePose{hub.position, hub.angle + joint.angle, line, curvature};
  }
  if (!body.position) return {};
  return fem::ReferencePose{*body.position, body.angle, root, curvature};
}

}  // namespace

fem::ReferencePose start_pose(const Scene& scene, const Body& body) {
  std::vector<fem::UndeformedBody> bodies;
  for (const Body& b : scene.bodies)
    bodies.push_back({b.name, root_line(scene, b), curvature_of(b), own_pose(scene, b)});
  std::vector<fem::ReferenceWeld> welds;
  for (const Joint& j : scene.joints)
    if (j.joins_edges())
      welds.push_back({{j.a.body, j.a.point, j.a.angle}, {j.b.body, j.b.point, j.b.angle}});
  return fem::reference_pose(bodies, welds, body.name);
}

Vec2 undeformed_location(const Body& body, const Vec2& material) {
  return body.arc == 0 ? material : fem::location_on_arc(body.arc / body.length, material);
}

namespace {

/// Returns the mass, the centre of mass and the moment of inertia about it of a rigid body, point
/// masses included.
fem::RigidSection section_of(const RigidBody& body) {
  if (body.masses.empty()) return {body.mass, body.center, body.inertia};
  fem::RigidSection out{body.mass, body.mass * body.center, body.inertia};
  for (const RigidBody::AddedMass& m : body.masses) {
    out.mass += m.mass;
    out.center += m.mass * m.point;
  }
  out.center /= out.mass;
  out.inertia += body.mass * (body.center - out.center).squaredNorm();
  for (const RigidBody::AddedMass& m : body.masses)
    out.inertia += m.mass * (m.point - out.center).squaredNorm();
  return out;
}

}  // namespace

fem::MechanismBody mechanism_body(const RigidBody& body) {
  return {.name = body.name,
          .section = section_of(body),
          .size = std::sqrt(body.inertia / body.mass),
          .position = body.position,
          .angle = body.angle,
          .velocity = body.velocity,
          .angular_velocity = body.angular_velocity,
          .source = body.location + ": rigid_body."};
}

std::vector<std::unique_ptr<fem::ForceElement>> rigid_loads(const Scene& scene) {
  std::vector<std::unique_ptr<fem::ForceElement>> out;
  for (const size_t i : ordered_loads(scene)) {
    const BodyLoad& load = scene.loads[i];
    const auto is_loaded = [&](const RigidBody& body) { return body.name == load.body; };
    if (std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(), is_loaded))
      out.push_back(load.row->on_rigid(load, "load " + std::to_string(i + 1)));
  }
  return out;
}

namespace {

/// Builds the rigid mechanism of a scene.
class MechanismOfScene {
 public:
  explicit MechanismOfScene(const Scene& scene) : scene_(scene) {
    out_.gravity = scene.gravity_law();
    out_.bends = !scene.bodies.empty();
    for (const RigidBody& b : scene.rigid_bodies) out_.bodies.push_back(mechanism_body(b));
    for (const Body& b : scene.bodies) out_.bodies.push_back(rigid_plate(b));
    const FindLocation location = [&](const Anchor& anchor) { return location_of(anchor); };
    for (const Spring& spring : scene.springs)
      out_.force_elements.push_back(make_force_element(scene, spring, location));
    for (auto& load : rigid_loads(scene)) out_.force_elements.push_back(std::move(load));
    for (const Joint& joint : scene.joints) {
      if (!joint.holds_frame())
        add_joint(joint, location);
      else if (joint.on_rigid_body())
        add_on_rigid_body(joint);
      else
        add_in_hub(joint);
    }
  }
  fem::RigidMechanism take() { return std::move(out_); }

 private:
  double longest(const Body& body) const { return body.longest(scene_.time.end); }

  /// Returns the position of the free end at the start; for an arc that of the end of its straight
  /// material axis.
  Vec2 origin_of(const Body& body, const fem::ReferencePose& pose) const {
    for (const Joint& j : scene_.joints)
      if (j.body == body.name && j.edge == "free_end" && body.flow)
        return j.on_rigid_body() ? start_location(scene_, j.b) : hub_drive(scene_, j)(0).origin;
    return pose.origin + fem::rotation(pose.angle) * Vec2(longest(body) - pose.line, 0);
  }

  fem::MechanismBody rigid_plate(const Body& body) const {
    RigidBody plate;
    plate.name = body.name;
    const double length =
        body.length > 0 ? body.length : body.width;  // a length not known yet has no influence
    plate.mass = body.density * body.thickness * body.width * length;
    plate.center = {-0.5 * length, 0};
    plate.inertia = plate.mass * (length * length + body.width * body.width) / 12;
    const Vec2 end(longest(body), 0);
    for (const PointMass& m : scene_.point_masses)
      if (m.body == body.name)
        plate.masses.push_back({m.mass, undeformed_location(body, m.point) - end});
    const fem::ReferencePose pose = start_pose(scene_, body);
    fem::MechanismBody out = mechanism_body(plate);
    out.position = origin_of(body, pose);
    out.angle = pose.angle;
    out.line = longest(body);
    const auto carries = [&](const Joint& j) {
      return j.body == body.name && j.holds_frame() && j.edge != "free_end";
    };
    out.is_placed =
        !body.row->lines || std::none_of(scene_.joints.begin(), scene_.joints.end(), carries);
    return out;
  }

  /// Returns the location of an anchor in the axes of its rigid body.
  fem::MarkerLocation location_of(const Anchor& anchor) const {
    Vec2 point = anchor.point;
    for (const Body& b : scene_.bodies)
      if (b.name == anchor.body) point = undeformed_location(b, point) - Vec2(longest(b), 0);
    return {anchor.body, point, anchor.angle, {}};
  }

  void add_joint(const Joint& joint, const FindLocation& location) {
    fem::MechanismJoint out;
    if (!joint.laws.empty()) {
      const Law& law = joint.laws[0];
      out.drive = law.drive;
      out.is_driven = !law.drive.empty();
      out.prescribes = true;
      if (joint.row->coordinate) {
        out.coordinate = joint.row->coordinate;
        out.a = location(completed(scene_, joint.a, joint.b));
        out.b = location(completed(scene_, joint.b, joint.a));
      }
    }
    const bool is_known = !out.is_driven || scene_.motion_of(joint.laws[0]);
    if (is_known) out.joint = make_joint(scene_, joint, location, true);
    if (out.joint || !is_known) out_.joints.push_back(std::move(out));
  }

  /// Returns the location of the held line in the axes of its rigid body.
  fem::MarkerLocation line_of(const Joint& joint, const Body& body) const {
    fem::MarkerLocation out{joint.body, {0, 0}, 0, {}};
    if (joint.edge == "root" && body.flow) return out;
    if (joint.edge == "free_end") {
      out.point = undeformed_location(body, {longest(body), 0}) - Vec2(longest(body), 0);
      out.angle = body.arc;
    } else {
      const std::vector<double> lines =
          body.start_lines(longest(body) - body.length, body.elements[0]);
      out.point.x() = lines[static_cast<size_t>(joint.line)] - longest(body);
    }
    return out;
  }

  /// Returns true if the held line is a free line, whose material coordinate is an unknown.
  bool slides(const Joint& joint, const Body& body) const {
    if (joint.edge == "free_end" || flows(joint, body)) return false;
    return std::any_of(body.lines.begin(), body.lines.end(),
                       [&](const BodyLine& line) { return line.free && line.index == joint.line; });
  }
  static bool flows(const Joint& joint, const Body& body) {
    return joint.edge == "root" && body.flow;
  }
  bool is_known(const Flow& flow) const {
    return flow.motion || !scene_.follows_trajectory(flow.length);
  }

  /// Returns the root line of a body with material flow, which moves along the axis of the body.
  static fem::MarkerLocation fed(fem::MarkerLocation line, const Body& body) {
    line.along = [body](double t) {
      const fem::Motion m = body.length_motion(t);
      return fem::Motion{-m.value, -m.rate, -m.acceleration};
    };
    return line;
  }

  void add_on_rigid_body(const Joint& joint) {
    const Body& body = scene_.body(joint.body);
    fem::MechanismJoint out;
    out.a = line_of(joint, body);
    out.b = {joint.b.body, joint.b.point, joint.b.angle, {}};
    if (slides(joint, body)) {
      out.joint = fem::make_slider(joint.name, out.a, out.b);
    } else if (!flows(joint, body)) {
      out.joint = fem::make_rigid_weld(joint.name, out.b, out.a);
    } else {
      out.is_driven = true;  // also when the speed is constant
      out.drive = body.flow->length.drive;
      out.coordinate = fem::distance_along;
      out.released = fem::make_slider(joint.name, out.a, out.b);
      if (is_known(*body.flow))
        out.joint = fem::make_rigid_weld(joint.name, out.b, fed(out.a, body));
    }
    out_.joints.push_back(std::move(out));
  }

  /// Adds a frame with prescribed motion. It has no released joint, so that hubs keep their drives.
  void add_in_hub(const Joint& joint) {
    const Body& body = scene_.body(joint.body);
    if (slides(joint, body) || (flows(joint, body) && !is_known(*body.flow)))
      throw Error::input("joint '" + joint.name +
                         "': a hub cannot hold a line whose material coordinate is unknown; "
                         "hold the line by a rigid body");
    const fem::MarkerLocation line = line_of(joint, body);
    const fem::FrameDrive hub = hub_drive(scene_, joint);
    const auto point = [hub](double t) {
      const fem::FrameMotion f = hub(t);
      return std::vector<fem::Motion>{{f.origin.x(), f.origin_rate.x(), f.origin_acceleration.x()},
                                      {f.origin.y(), f.origin_rate.y(), f.origin_acceleration.y()}};
    };
    const auto angle = [hub](double t) {
      const fem::FrameMotion f = hub(t);
      return fem::Motion{f.angle, f.angle_rate, f.angle_acceleration};
    };
    out_.joints.push_back(
        {.joint = fem::make_point_drive(joint.name, flows(joint, body) ? fed(line, body) : line,
                                        point, {})});
    out_.joints.push_back({.joint = fem::make_angle_drive(
                               joint.name, {}, {joint.body, {0, 0}, line.angle, {}}, angle)});
  }

  const Scene& scene_;
  fem::RigidMechanism out_;
};

}  // namespace

fem::RigidMechanism rigid_mechanism(const Scene& scene) { return MechanismOfScene(scene).take(); }

fem::RigidKinematics rigid_kinematics(const Scene& scene) {
  return fem::RigidKinematics(rigid_mechanism(scene));
}

void follow_trajectory(Scene& scene) {
  std::vector<std::string> names;
  for (const Drive& d : scene.drives)
    if (d.from_trajectory) names.push_back(d.name);
  if (names.empty()) throw Error::input("at least one [[drive]] must have from = \"trajectory\"");
  const TargetTrajectory& path = *scene.trajectory;
  const fem::RigidTrajectory trajectory{path.body, scene.motion_of(path.x), scene.motion_of(path.y),
                                        scene.motion_of(path.angle), scene.time.end};
  auto motions = fem::inverse_kinematics(rigid_mechanism(scene), trajectory, names);
  size_t next = 0;
  for (Drive& d : scene.drives)
    if (d.from_trajectory) d.motion = std::move(motions[next++]);
}

}  // namespace flexmorph::cases
