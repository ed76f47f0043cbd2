#include <cmath>

#include "cases/scene/body_keys.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/heat/heat.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/mesh_rule.h"
#include "cases/scene/read.h"
#include "cases/scene/tables.h"
#include "fem/dynamics/integrators/step_control.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using namespace body_keys;
using io::any_number;
using io::between;
using io::Key;
using io::positive;
using io::Table;
using io::to_text;

const io::Key& kEnd = io::key("time", "end")
                          .number(positive("an end time", "s"))
                          .description("End time of the run, which begins at 0.");
const io::Key& kIntegrator =
    io::key("time", "integrator")
        .word("an integrator", {"generalized_alpha", "energy_momentum", "minimal_coordinates"})
        .otherwise("generalized_alpha")
        .description(
            "Time integrator; an explicit one is `minimal_coordinates`, for rigid scenes or low "
            "stiffness.");
const io::Key& kStep =
    io::key("time", "step")
        .number(positive("a time step", "s"))
        .word("a time step in words", {"adaptive"})
        .otherwise_as("0.001, or `end` if `end` is smaller")
        .description(
            "Time step; `adaptive` chooses every step from an estimate of the local error.");
const io::Key& kTolerance =
    io::key("time", "tolerance")
        .number({.noun = "a tolerance", .lower = 0, .upper = 0.1, .lower_open = true})
        .otherwise(fem::AdaptiveStep{}.tolerance)
        .when("`step = \"adaptive\"`")
        .description(
            "Approximate error per radian of the motion, relative to the size of the model.");
const io::Key& kExplicitTolerance =
    io::key("time", "tolerance")
        .number(between("a tolerance", "", 1e-13, 0.1))
        .otherwise(TimeSpan().explicit_tolerance)
        .when("`integrator = \"minimal_coordinates\"`")
        .description("Tolerance of the local errors of the integrator `minimal_coordinates`.");
const io::Key& kLargestStep = io::key("time", "largest_step")
                                  .number(positive("a time step", "s"))
                                  .otherwise_as("`end` / 50")
                                  .when("`step = \"adaptive\"`")
                                  .description("Largest adaptive time step.");
const io::Key& kRhoInf = io::key("time", "rho_inf")
                             .number(between("a spectral radius", "", 0, 1))
                             .otherwise(0.8)
                             .description(
                                 "Spectral radius of generalized-alpha at infinite frequency; 1 "
                                 "has no numerical damping.");
const io::Choice<Start> kStart(
    io::key("time", "start")
        .otherwise_as(
            "`automatic`; `rigid` without flexible bodies, or without a mechanism where no "
            "hub carries the body or a line is free")
        .description("Initial state; `automatic`: static equilibrium if all start velocities are "
                     "0, else `steady`."),
    "an initial state",
    {{"automatic", Start::automatic},
     {"prestretched", Start::prestretched},
     {"steady", Start::steady},
     {"rigid", Start::rigid},
     {"hub_at_rest", Start::hub_at_rest}});
const io::Key& kSpinUp = io::key("time", "spin_up")
                             .number(positive("a spin-up", "s"))
                             .otherwise_as("`end` / 5")
                             .when("`start = \"hub_at_rest\"`")
                             .description("Time in which hubs reach their angular velocity.");

/// Reads the time step: a number, or "adaptive" with its tolerance and its largest step. The
/// integrator must be read before.
void read_step(const Table& t, TimeSpan& time) {
  time.step = std::min(1e-3, time.end);
  if (t.is_string(kStep)) {
    t.choice(kStep);
    if (time.integrator != "generalized_alpha")
      t.fail(kStep,
             "adaptive steps need integrator = \"generalized_alpha\", because only it estimates "
             "its local error");
    time.tolerance = t.number(kTolerance);
    if (!t.has(kLargestStep)) return;
    time.largest_step = t.number(kLargestStep);
    if (time.largest_step > time.end) t.fail(kLargestStep, "a time step is at most time.end [s]");
    return;
  }
  if (t.has(kLargestStep)) t.fail(kLargestStep, "this key needs step = \"adaptive\"");
  if (time.integrator == "minimal_coordinates")
    time.explicit_tolerance = t.number(kExplicitTolerance);
  else if (t.has(kTolerance))
    t.fail(kTolerance,
           "this key needs step = \"adaptive\" or integrator = \"minimal_coordinates\"");
  time.step = t.number(kStep, time.step);
  if (time.step > time.end) t.fail(kStep, "a time step is at most time.end [s]");
  // Checked here and not with the resource estimate, because drives are evaluated over the whole
  // time span before.
  if (const double steps = time.end / time.step; steps > kMaxSteps)
    t.fail(t.has(kStep) ? kStep : kEnd, io::to_text(steps, 3) +
                                            " steps are needed; the largest number of steps is " +
                                            io::to_text(kMaxSteps, 3));
}

TimeSpan read_time(const Table& t) {
  TimeSpan time;
  time.end = t.number(kEnd);
  time.integrator = t.choice(kIntegrator);
  read_step(t, time);
  time.rho_inf = t.number(kRhoInf);
  time.start = t.choice(kStart, std::optional(Start::automatic));
  if (time.start == Start::hub_at_rest)
    time.spin_up = t.number(kSpinUp.within(0, time.end), 0.2 * time.end);
  else if (t.has(kSpinUp))
    t.fail(kSpinUp, "this key needs start = \"hub_at_rest\"");
  return time;
}

const io::Key& kHubName =
    io::key("hub", "name").text("the name of a hub").description("Name of the hub in joints.");
const io::Key& kHubPosition =
    io::key("hub", "position")
        .numbers(any_number("a position", "m"), 2, 2)
        .names_of("a drive", 2, 2)
        .otherwise(std::vector<double>{0, 0})
        .description("Position of the hub: x and y, or the names of the drives of both.");
const io::Key& kHubAngle =
    io::key("hub", "angle")
        .number(any_number("an angle", "rad"))
        .name_of("a drive")
        .otherwise(0.0)
        .description("Angle of the hub at the start, or the drive of its angle.");
const io::Key& kAngularVelocity =
    io::key("hub", "angular_velocity")
        .number(any_number("an angular velocity", "rad/s"))
        .otherwise_as("required, except with a drive `angle` or a [static] analysis")
        .description("Constant angular velocity of the hub.");

/// Throws if a hub is driven and spun up at the same time, because a drive prescribes the start.
void refuse_spin_up(const Table& t, const Key& key, const Scene& scene) {
  if (scene.time.start == Start::hub_at_rest)
    t.fail(key,
           "a driven hub cannot be used with time.start = \"hub_at_rest\", which spins up hubs of "
           "constant angular velocity");
}

/// Reads the position of a hub: two numbers, or the names of two drives.
void read_position(const Table& t, const Scene& scene, Hub& hub) {
  if (t.is_list_of_strings(kHubPosition)) {
    refuse_spin_up(t, kHubPosition, scene);
    const std::vector<std::string> names = t.choices(kHubPosition, names_of(scene.drives));
    for (size_t c = 0; c < 2; ++c) {
      refuse_jumps(t, kHubPosition, scene, names[c]);
      hub.path[c].drive = names[c];
      hub.position[static_cast<int>(c)] = scene.motion_of(hub.path[c])(0).value;
    }
    return;
  }
  const std::vector<double> position = t.numbers(kHubPosition);
  hub.position = {position[0], position[1]};
}

Hub read_hub(const Table& t, const Scene& scene) {
  Hub hub;
  hub.name = read_name(t, kHubName, scene);
  read_position(t, scene, hub);
  if (t.is_string(kHubAngle)) {
    refuse_spin_up(t, kHubAngle, scene);
    hub.turn = read_law(t, kHubAngle, scene);
    hub.angle = scene.motion_of(hub.turn)(0).value;
    if (t.has(kAngularVelocity))
      t.fail(kAngularVelocity, "the drive of `angle` determines the angular velocity of the hub");
    return hub;
  }
  hub.angle = t.number(kHubAngle);
  const std::optional<double> rest = scene.statics ? std::optional<double>(0) : std::nullopt;
  hub.angular_velocity = t.number(kAngularVelocity, rest);
  if (scene.statics && hub.angular_velocity != 0)
    t.fail(kAngularVelocity, "in a [static] analysis the angular velocity of a hub is 0");
  return hub;
}

const io::Key& kBodyPosition = io::key("body", "position")
                                   .numbers(any_number("a position", "m"), 2, 2)
                                   .otherwise_as("the position that joints determine")
                                   .description(
                                       "Position of the middle of the root at the start; an "
                                       "initial guess if joints determine it.");
const io::Key& kBodyAngle =
    io::key("body", "angle")
        .number(any_number("an angle", "rad"))
        .otherwise(0.0)
        .when("`position` is given")
        .description(
            "Angle of the body's axis at the start; an initial guess if joints determine it.");
const io::Key& kHeat = io::key("body", "heat")
                           .table()
                           .otherwise_as("no temperature rise")
                           .description("Temperature rise of the body.");

Body read_body(const Table& t, const Scene& scene, bool has_gravity) {
  Body body;
  body.name = read_name(t, kBodyName, scene);
  body.row = read_element(t);
  // In a static analysis only the weight needs the density.
  body.row->read(t, scene, !scene.statics || has_gravity, body);
  if (t.has(kBodyPosition)) {
    const auto at = t.numbers(kBodyPosition);
    body.position = Vec2(at[0], at[1]);
    body.angle = t.number(kBodyAngle);
  }
  if (t.has(kHeat)) body.heat = read_heat(t.table(kHeat), scene, body);
  return body;
}

const io::Key& kMassBody = io::key("point_mass", "body")
                               .name_of("a body")
                               .description("Body that carries the point mass.");
const io::Key& kMassAt =
    io::key("point_mass", "at")
        .word("the location of a point mass", {"free_end"})
        .otherwise_as("required unless `point` is given")
        .description("Location of the point mass: the middle of the free end.");
const io::Key& kMassPoint = io::key("point_mass", "point")
                                .numbers(any_number("a coordinate", "m"), 2, 2)
                                .otherwise_as("required unless `at` is given")
                                .description(
                                    "Location of the point mass: a material point, or a point in "
                                    "the axes of a rigid body.");
const io::Key& kMass = io::key("point_mass", "mass")
                           .number(io::not_negative("a mass", "kg"))
                           .description("Mass of the point mass; 0: there is no point mass.");

void read_point_mass(const Table& t, Scene& scene) {
  for (RigidBody& body : scene.rigid_bodies) {
    if (!t.says_one_of(kMassBody, std::vector{body.name})) continue;
    t.choice(kMassBody, names_of(scene.rigid_bodies));
    const RigidBody::AddedMass added{t.number(kMass), read_pair(t, kMassPoint)};
    if (added.mass > 0) body.masses.push_back(added);
    return;
  }
  PointMass mass;
  mass.body = read_flexible(t, kMassBody, scene);
  const Body& body = scene.body(mass.body);
  if (t.has(kMassAt) == t.has(kMassPoint))
    t.fail("a point mass needs either at = \"free_end\" or a `point`");
  mass.at_end = t.has(kMassAt);
  if (mass.at_end) {
    t.choice(kMassAt);
    mass.point = {body.longest(scene.time.end), body.low() + 0.5 * body.width};
  } else {
    mass.point = read_point(t, kMassPoint, body, scene.time.end);
  }
  mass.mass = t.number(kMass);
  if (mass.mass > 0) scene.point_masses.push_back(mass);
}

/// Reads [time], or [static] in its place.
void read_span(const Table& root, Scene& scene) {
  if (!root.has(tables::kStatic)) {
    scene.time = read_time(root.table(tables::kTime));
    return;
  }
  for (const Key* key :
       {&tables::kTime, &tables::kDrive, &tables::kConstants, &tables::kEsl, &tables::kDesign,
        &tables::kOptimizer, &tables::kCycle, &tables::kVerify, &tables::kCertificate})
    if (root.has(*key))
      root.fail(*key, "a scene with a [static] analysis has no '" + key->name + "'");
  scene.statics = read_analysis(root.table(tables::kStatic));
}

/// Checks that the initial state suits the scene, and determines it where the case leaves it open.
void choose_start(const Table& root, Scene& scene) {
  const Table time = root.table(tables::kTime);
  if (scene.is_mechanism() && scene.time.start == Start::hub_at_rest)
    time.fail(kStart,
              "\"hub_at_rest\" spins up hubs; in a scene with rigid bodies, or with bodies welded "
              "to each other, the drives determine the start");
  if (scene.time.start == Start::steady && scene.has_eulerian_lines())
    time.fail(kStart, "\"steady\" cannot be used with free material lines; use start = \"rigid\"");
  if (scene.time.start == Start::prestretched && scene.bodies.empty())
    time.fail(
        kStart,
        "\"prestretched\" needs flexible bodies, and the scene has none; \"steady\" starts springs "
        "and rigid bodies in equilibrium, \"rigid\" starts them at the given positions");
  if (scene.time.integrator != "generalized_alpha" && scene.has_eulerian_lines())
    time.fail(kIntegrator,
              "free material lines ([[body.line]]) need integrator = \"generalized_alpha\"; \"" +
                  scene.time.integrator + "\" does not support them");
  // Without a hub no prescribed rotation stretches the bodies, and a free line starts at its given
  // location.
  const bool in_hubs = !scene.hubs.empty() && !scene.has_eulerian_lines();
  if (!scene.is_mechanism() && !in_hubs && scene.time.start == Start::prestretched)
    time.fail(kStart, "\"prestretched\" needs bodies in hubs, without free material lines");
  const bool unstrained = scene.bodies.empty() || (!scene.is_mechanism() && !in_hubs);
  if (unstrained && scene.time.start == Start::automatic) {
    scene.time.start = Start::rigid;
    time.record(kStart, "rigid");
  }
}

}  // namespace

void read_motion(const Table& root, const Follow& follow, Scene& scene) {
  read_span(root, scene);
  read_drives(root, scene);
  for (const Table& t : root.tables(tables::kHub)) scene.hubs.push_back(read_hub(t, scene));
  read_rigid_bodies(root, scene);
  const std::vector<Table> bodies = root.tables(tables::kBody);
  if (bodies.empty() && !scene.is_mechanism())
    root.fail(tables::kBody, "a scene needs one or more [[body]]");
  for (const Table& t : bodies)
    scene.bodies.push_back(read_body(t, scene, root.has(tables::kGravity)));
  if (root.has(tables::kGravity)) {
    scene.gravity_laws =
        read_load_laws(root, tables::kGravity.counted(scene.in_space() ? 3 : 2), scene);
    scene.gravity = scene.gravity_law().now();
    if (scene.gravity_law().varies() && scene.has_eulerian_lines())
      root.fail(tables::kGravity,
                "gravity that varies with time cannot be used with free material lines");
  }
  const auto follow_lengths = [&](bool trajectory) {
    for (size_t i = 0; i < bodies.size(); ++i)
      if (Body& b = scene.bodies[i];
          b.flow && scene.follows_trajectory(b.flow->length) == trajectory)
        follow_length(bodies[i], scene, b);
  };
  follow_lengths(false);
  if (root.has(tables::kTrajectory)) read_trajectory(root, follow, scene);
  follow_lengths(true);
  read_joints(root, scene);
  read_springs(root, scene);
  check_mechanism_parts(root, scene);
  for (const Table& t : root.tables(tables::kPointMass)) read_point_mass(t, scene);
  read_loads(root, scene);
  read_observed(root, scene);
  read_measures(root, scene);
  for (size_t i = 0; i < bodies.size(); ++i)
    if (scene.bodies[i].flow) choose_mesh(bodies[i], scene, scene.bodies[i]);
  if (scene.statics)
    read_growing(root, scene);
  else
    choose_start(root, scene);
}

}  // namespace flexmorph::cases
