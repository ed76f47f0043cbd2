#include <cmath>

#include "cases/scene/joints/reading.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::positive;
using io::Table;

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

}  // namespace

void read_rigid_bodies(const Table& root, Scene& scene) {
  for (const Table& t : root.tables("rigid_body"))
    scene.rigid_bodies.push_back(read_rigid_body(t, scene));
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

void read_trajectory(const Table& root, const Follow& follow, Scene& scene) {
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
  draft.joints = read_joint_list(root, scene);
  try {
    follow(draft);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) t.fail(error.what());
    throw Error::numerical(std::string("trajectory: ") + error.what());
  }
  scene.drives = draft.drives;
}

}  // namespace flexmorph::cases
