#include <cmath>

#include "cases/scene/read.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::not_negative;
using io::positive;
using io::Table;
using io::to_text;

Vec2 read_pair(const Table& t, const std::string& key, const std::string& noun,
               const std::string& unit, const std::optional<Vec2>& fallback = {}) {
  std::optional<std::vector<double>> both;
  if (fallback) both = {fallback->x(), fallback->y()};
  const std::vector<double> v = t.numbers(key, any_number(noun, unit), 2, both);
  return {v[0], v[1]};
}

/// Mass, and the inertia that is given or that of a box of even material.
RigidBody read_rigid_body(const Table& t, const Scene& scene) {
  RigidBody body;
  body.name = read_name(t, "the name of a rigid body", scene);
  body.mass = t.number("mass", positive("a mass", "kg"));
  body.center = read_pair(t, "center", "a place", "m", Vec2(0, 0));
  if (t.has("size")) {
    const std::vector<double> size = t.numbers("size", positive("a size", "m"), 2);
    body.size = {size[0], size[1]};
  }
  if (!t.has("size") && !t.has("inertia"))
    t.fail("a rigid body has an `inertia` [kg m^2], or a `size` [m] that it follows from");
  body.inertia = t.number(
      "inertia", positive("an inertia", "kg m^2"),
      t.has("size") ? std::optional(body.mass * body.size.squaredNorm() / 12) : std::nullopt);
  body.position = read_pair(t, "position", "a position", "m", Vec2(0, 0));
  body.velocity = read_pair(t, "velocity", "a velocity", "m/s", Vec2(0, 0));
  body.angle = t.number("angle", any_number("an angle", "rad"), 0.0);
  body.angular_velocity =
      t.number("angular_velocity", any_number("an angular velocity", "rad/s"), 0.0);
  return body;
}

const Body* plate_named(const Scene& scene, const std::string& name) {
  for (const Body& b : scene.bodies)
    if (b.name == name) return &b;
  return nullptr;
}

/// Keys `a`, `point_a`, `angle_a` (or of b): a body and a place on it.
Anchor read_anchor(const Table& t, const std::string& which, const Scene& scene, bool with_point,
                   bool with_axis) {
  static const std::string kGround = "ground";
  std::vector<std::string> known = names_of(scene.rigid_bodies);
  if (!with_axis)
    for (const Body& b : scene.bodies) known.push_back(b.name);
  known.push_back(kGround);
  Anchor anchor;
  anchor.body = t.choice(which, "a body", known, kGround);
  if (anchor.body == kGround) anchor.body.clear();
  const std::string point = "point_" + which, angle = "angle_" + which;
  if (with_point) {
    const Body* plate = plate_named(scene, anchor.body);
    anchor.given = t.has(point) || !anchor.on_ground();
    if (plate)
      anchor.point = read_pair(t, point, "a material point", "m");
    else
      anchor.point = read_pair(t, point, "a place", "m", Vec2(0, 0));
  } else if (t.has(point)) {
    t.fail(point, "this joint does not look at points");
  }
  if (with_axis)
    anchor.angle = t.number(angle, any_number("an angle", "rad"), 0.0);
  else if (t.has(angle))
    t.fail(angle, "this joint does not look at axes");
  return anchor;
}

void read_anchors(const Table& t, const Scene& scene, bool points, bool axes, Anchor& a,
                  Anchor& b) {
  a = read_anchor(t, "a", scene, points, axes);
  b = read_anchor(t, "b", scene, points, axes);
  if (a.on_ground() && b.on_ground())
    t.fail("a body is missing: `a`, `b` or both name one; what is left out is the ground");
  if (a.body == b.body && !a.on_ground()) t.fail("b", "a joint is between two bodies");
}

std::string name_of_joint(const Table& t, const Joint& joint, const Scene& scene) {
  const auto body = [](const Anchor& a) { return a.on_ground() ? "ground" : a.body; };
  std::string name = joint.type + " of " + body(joint.a) + " and " + body(joint.b);
  if (t.has("name")) name = read_word(t, "the name of a joint");
  for (const Joint& other : scene.joints)
    if (!other.name.empty() && other.name == name) {
      if (t.has("name")) t.fail("name", "there is another joint '" + name + "'");
      name += ", " + std::to_string(scene.joints.size() + 1);
      break;
    }
  return name;
}

void read_point_drive(const Table& t, const Scene& scene, Joint& joint) {
  joint.a = read_anchor(t, "a", scene, true, false);
  if (joint.a.on_ground()) t.fail("a", "the ground is not driven");
  for (const auto& [key, component] : {std::pair{"x", 0}, std::pair{"y", 1}})
    if (t.has(key)) {
      joint.laws.push_back(read_law(t, key, any_number("a coordinate", "m"), scene));
      joint.components.push_back(component);
    }
  if (joint.laws.empty()) t.fail("a driven point has `x`, `y` or both");
}

Spring read_spring(const Table& t, const Scene& scene) {
  Spring spring;
  spring.torsion = t.choice<bool>("type", "a spring is", {{"linear", false}, {"torsion", true}},
                                  std::optional(false));
  read_anchors(t, scene, !spring.torsion, spring.torsion, spring.a, spring.b);
  const std::string per = spring.torsion ? "N m/rad" : "N/m";
  spring.stiffness = t.number("stiffness", not_negative("a stiffness", per), 0.0);
  spring.damping =
      t.number("damping", not_negative("a damping", spring.torsion ? "N m s/rad" : "N s/m"), 0.0);
  if (spring.stiffness == 0 && spring.damping == 0)
    t.fail("a spring has a `stiffness`, a `damping` or both");
  if (spring.torsion)
    spring.rest = t.number("rest_angle", any_number("an angle", "rad"), 0.0);
  else
    spring.rest = t.number("free_length", not_negative("a length", "m"), 0.0);
  spring.name = "spring " + std::to_string(scene.springs.size() + 1);
  if (t.has("name")) spring.name = read_word(t, "the name of a spring");
  for (const Spring& other : scene.springs)
    if (other.name == spring.name) t.fail("name", "there is another spring of this name");
  return spring;
}

}  // namespace

void read_rigid_bodies(const Table& root, Scene& scene) {
  for (const Table& t : root.tables("rigid_body"))
    scene.rigid_bodies.push_back(read_rigid_body(t, scene));
}

bool read_body_joint(const Table& t, const Scene& scene, Joint& joint) {
  if (joint.type == "revolute") {
    read_anchors(t, scene, true, false, joint.a, joint.b);
  } else if (joint.type == "slider" || joint.type == "weld") {
    read_anchors(t, scene, true, true, joint.a, joint.b);
  } else if (joint.type == "angle_drive") {
    read_anchors(t, scene, false, true, joint.a, joint.b);
    joint.laws = {read_law(t, "angle", any_number("an angle", "rad"), scene)};
  } else if (joint.type == "distance") {
    read_anchors(t, scene, true, false, joint.a, joint.b);
    joint.laws = {read_law(t, "distance", positive("a distance", "m"), scene)};
  } else if (joint.type == "point_drive") {
    read_point_drive(t, scene, joint);
  } else {
    return false;
  }
  joint.name = name_of_joint(t, joint, scene);
  joint.named = t.has("name");
  return true;
}

void read_carrier(const Table& t, Joint& joint) {
  joint.b.body = joint.to;
  joint.b.point = read_pair(t, "point", "a place", "m", Vec2(0, 0));
  joint.b.angle = t.number("angle", any_number("an angle", "rad"), 0.0);
}

void read_springs(const Table& root, Scene& scene) {
  for (const Table& t : root.tables("spring")) scene.springs.push_back(read_spring(t, scene));
}

void check_mechanism_parts(const Table& root, const Scene& scene) {
  if (!scene.is_mechanism()) return;
  const auto check = [&](const Table& t, const std::string& name) {
    const auto here = [&](const Anchor& anchor) { return anchor.body == name; };
    const bool held =
        std::any_of(scene.joints.begin(), scene.joints.end(),
                    [&](const Joint& j) { return j.body == name || here(j.a) || here(j.b); }) ||
        std::any_of(scene.springs.begin(), scene.springs.end(),
                    [&](const Spring& s) { return here(s.a) || here(s.b); });
    if (!held) t.fail("name", "nothing holds '" + name + "': a [[joint]] or [[spring]] is missing");
  };
  const std::vector<Table> rigid = root.tables("rigid_body"), bodies = root.tables("body");
  for (size_t i = 0; i < rigid.size(); ++i) check(rigid[i], scene.rigid_bodies[i].name);
  for (size_t i = 0; i < bodies.size(); ++i) check(bodies[i], scene.bodies[i].name);
  if (scene.time.start == Start::hub_at_rest)
    root.table("time").fail("start",
                            "\"hub_at_rest\" spins up hubs; the drives of a scene with rigid "
                            "bodies say themselves how they start");
}

void read_trajectory(const Table& root, const Vocabulary& words, const Follow& follow,
                     Scene& scene) {
  const Table t = root.table("trajectory");
  Trajectory path;
  path.body = t.choice("body", "a rigid body", names_of(scene.rigid_bodies));
  path.x = read_law(t, "x", any_number("a coordinate", "m"), scene);
  path.y = read_law(t, "y", any_number("a coordinate", "m"), scene);
  path.angle = read_law(t, "angle", any_number("an angle", "rad"), scene, 0.0);
  for (const Law* law : {&path.x, &path.y, &path.angle})
    if (scene.follows_trajectory(*law)) t.fail("the path itself cannot follow from the trajectory");
  scene.trajectory = path;
  Scene draft = scene;  // joints are read again once lengths are known
  draft.joints = read_joint_list(root, words, scene);
  try {
    follow(draft);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) t.fail(error.what());
    throw Error::numerical(std::string("trajectory: ") + error.what());
  }
  scene.drives = draft.drives;
}

}  // namespace flexmorph::cases
