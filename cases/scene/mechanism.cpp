#include <cmath>

#include "cases/scene/body_keys.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/tables.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::Key;
using io::positive;
using io::Table;

const Key& kName = io::key("rigid_body", "name")
                       .text("the name of a rigid body")
                       .description("Name of the rigid body in joints and columns of tables.");
const Key& kMass = io::key("rigid_body", "mass")
                       .number(positive("a mass", "kg"))
                       .description("Mass of the rigid body.");
const Key& kCenter = io::key("rigid_body", "center")
                         .numbers(any_number("a location", "m"), 2, 2)
                         .otherwise(std::vector<double>{0, 0})
                         .description("Centre of mass in the axes of the body.");
const Key& kSize =
    io::key("rigid_body", "size")
        .numbers(positive("a size", "m"), 2, 2)
        .otherwise_as("no rectangle is drawn, and `inertia` is required")
        .description("Sides of the rectangle around the centre of mass that pictures show.");
const Key& kInertia = io::key("rigid_body", "inertia")
                          .number(positive("a mass moment of inertia", "kg m^2"))
                          .otherwise_as("the value of a uniform rectangle of `size`")
                          .description("Mass moment of inertia about the centre of mass.");
const Key& kPosition = io::key("rigid_body", "position")
                           .numbers(any_number("a position", "m"), 2, 2)
                           .otherwise(std::vector<double>{0, 0})
                           .description(
                               "Position of the origin of the body's axes at the start; an initial "
                               "guess if joints determine it.");
const Key& kVelocity =
    io::key("rigid_body", "velocity")
        .numbers(any_number("a velocity", "m/s"), 2, 2)
        .otherwise_as(
            "the motion of least kinetic energy that joints, drives and given velocities permit")
        .description("Prescribed velocity of the origin of the body's axes at the start.");
const Key& kAngle =
    io::key("rigid_body", "angle")
        .number(any_number("an angle", "rad"))
        .otherwise(0.0)
        .description(
            "Angle of the body's axes at the start; an initial guess if joints determine it.");
const Key& kAngularVelocity =
    io::key("rigid_body", "angular_velocity")
        .number(any_number("an angular velocity", "rad/s"))
        .otherwise_as(
            "the motion of least kinetic energy that joints, drives and given velocities permit")
        .description("Prescribed angular velocity of the body at the start.");

const Key& kFollower = io::key("trajectory", "body")
                           .name_of("a rigid body")
                           .description("Rigid body that follows the path.");
const Key& coordinate(const char* name) {
  return io::key("trajectory", name)
      .number(any_number("a coordinate", "m"))
      .name_of("a drive")
      .description(std::string("Coordinate ") + name + " of the origin of the body's axes.");
}
const Key &kPathX = coordinate("x"), &kPathY = coordinate("y");
const Key& kPathAngle = io::key("trajectory", "angle")
                            .number(any_number("an angle", "rad"))
                            .name_of("a drive")
                            .otherwise(0.0)
                            .description("Angle of the first axis of the body.");

/// Reads a [[rigid_body]]. If the inertia is not given, it follows from a uniform rectangle.
RigidBody read_rigid_body(const Table& t, const Scene& scene) {
  RigidBody body;
  body.name = read_name(t, kName, scene);
  body.mass = t.number(kMass);
  body.center = read_pair(t, kCenter);
  if (t.has(kSize)) body.size = read_pair(t, kSize);
  if (!t.has(kSize) && !t.has(kInertia))
    t.fail(
        "a rigid body needs an `inertia` [kg m^2], or a `size` [m] from which the inertia is "
        "computed");
  body.inertia =
      t.number(kInertia, t.has(kSize) ? std::optional(body.mass * body.size.squaredNorm() / 12)
                                      : std::nullopt);
  body.position = read_pair(t, kPosition);
  if (t.has(kVelocity)) body.velocity = read_pair(t, kVelocity);
  body.angle = t.number(kAngle);
  if (t.has(kAngularVelocity)) body.angular_velocity = t.number(kAngularVelocity);
  body.is_placed = t.has(kPosition) || t.has(kAngle);
  body.location = t.location();
  return body;
}

}  // namespace

void read_rigid_bodies(const Table& root, Scene& scene) {
  for (const Table& t : root.tables(tables::kRigidBody))
    scene.rigid_bodies.push_back(read_rigid_body(t, scene));
}

void check_mechanism_parts(const Table& root, const Scene& scene) {
  if (!scene.is_mechanism()) return;
  const auto check = [&](const Table& t, const Key& key, const std::string& name,
                         const std::string& or_else) {
    const auto here = [&](const Anchor& anchor) { return anchor.body == name; };
    const bool held =
        std::any_of(scene.joints.begin(), scene.joints.end(),
                    [&](const Joint& j) { return j.body == name || here(j.a) || here(j.b); }) ||
        std::any_of(scene.springs.begin(), scene.springs.end(),
                    [&](const Spring& s) { return here(s.a) || here(s.b); });
    if (!held)
      t.fail(key, "no joint and no spring acts on '" + name +
                      "': the case needs a [[joint]] or a [[spring]]" + or_else);
  };
  const std::vector<Table> rigid = root.tables(tables::kRigidBody),
                           bodies = root.tables(tables::kBody);
  for (size_t i = 0; i < rigid.size(); ++i) {
    const RigidBody& body = scene.rigid_bodies[i];
    const bool flies = body.velocity || body.angular_velocity;
    if (!flies)
      check(rigid[i], kName, body.name, ", or a velocity at the start if the body moves freely");
  }
  for (size_t i = 0; i < bodies.size(); ++i)
    check(bodies[i], body_keys::kBodyName, scene.bodies[i].name, "");
}

void read_trajectory(const Table& root, const Follow& follow, Scene& scene) {
  const Table t = root.table(tables::kTrajectory);
  TargetTrajectory path;
  path.body = t.choice(kFollower, names_of(scene.rigid_bodies));
  path.x = read_law(t, kPathX, scene);
  path.y = read_law(t, kPathY, scene);
  path.angle = read_law(t, kPathAngle, scene);
  for (const Law* law : {&path.x, &path.y, &path.angle})
    if (scene.follows_trajectory(*law))
      t.fail("a coordinate of the path cannot be a drive with from = \"trajectory\"");
  scene.trajectory = path;
  Scene draft = scene;  // the final joints are read when lengths are known
  draft.joints = read_joint_list(root, scene);
  try {
    follow(draft);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) t.fail(error.what());
    throw Error::numerical(t.location() + ": trajectory: " + error.what());
  }
  scene.drives = draft.drives;
}

}  // namespace flexmorph::cases
