#include "cases/assembly/start.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kSpeedAtRest = 1e-6;  // [m/s]

/// Largest time after the start at which fem::start_state() uses the rigid motion [s].
constexpr double kTimeIncrement = 2e-4;

std::string counted(int degrees_of_freedom) {
  return std::to_string(degrees_of_freedom) +
         (degrees_of_freedom == 1 ? " degree of freedom" : " degrees of freedom");
}

/// Returns the start of a mechanism with start = "steady": in equilibrium under the inertia forces
/// of the motion that drives determine (rigid if plates must bend to follow the drives), or in
/// equilibrium at rest if nothing moves.
/// @throws Error (input) where the mechanism moves and drives do not determine its motion.
fem::Start steady_start(const Scene& scene, fem::RigidMotion& rigid) {
  if (rigid.degrees_of_freedom() == 0)
    return scene.bodies.empty() || !rigid.reaches(kTimeIncrement) ? fem::Start::rigid
                                                                  : fem::Start::steady;
  if (!rigid.is_indeterminate() && rigid.start_speed() < kSpeedAtRest) return fem::Start::at_rest;
  scene.refuse(
      "time.start",
      rigid.is_indeterminate()
          ? "\"steady\" needs a motion of the rigid mechanism, but its joints constrain more "
            "than its degrees of freedom; set start = \"rigid\""
          : "\"steady\" needs drives that determine the whole motion, or a mechanism at "
            "rest; the drives leave " +
                counted(rigid.degrees_of_freedom()) +
                " undetermined, and the mechanism starts with a velocity of " +
                io::to_text(rigid.start_speed(), 3) + " m/s; set start = \"rigid\"");
}

/// Returns the start of a mechanism with start = "prestretched". It is at rest near equilibrium if
/// drives do not determine the motion.
/// @throws Error (input) where drives do not determine the motion and the mechanism is not at rest.
fem::Start prestretched_start(const Scene& scene, fem::RigidMotion& rigid) {
  if (rigid.degrees_of_freedom() == 0)
    return rigid.reaches(kTimeIncrement) ? fem::Start::prestretched : fem::Start::rigid;
  if (rigid.is_indeterminate())
    scene.refuse("time.start",
                 "\"prestretched\" needs a motion of the rigid mechanism, but its joints constrain "
                 "more than its degrees of freedom; set start = \"rigid\"");
  // With a larger acceleration, the mechanism begins to swing. A smaller one vanishes in the
  // equilibrium of the plates.
  const double nearly = 0.05 * std::max(1.0, scene.gravity ? scene.gravity->norm() : 0.0);
  const double speed = rigid.start_speed(), acceleration = rigid.start_acceleration();
  if (speed < kSpeedAtRest && acceleration < nearly) return fem::Start::settled;
  scene.refuse(
      "time.start",
      "\"prestretched\" needs a mechanism near its equilibrium at rest if drives leave degrees "
      "of freedom undetermined (" +
          std::to_string(rigid.degrees_of_freedom()) +
          " here), but this mechanism starts with a velocity of " + io::to_text(speed, 3) +
          " m/s and an acceleration of " + io::to_text(acceleration, 3) +
          " m/s²; place the bodies in their equilibrium and let the drives begin at rest, "
          "or set start = \"rigid\"");
}

/// A start and the text with the reason for its choice.
struct Choice {
  fem::Start kind;
  std::string words;
};

/// Returns the start of a mechanism if the program chooses it.
Choice automatic_start(const Scene& scene, fem::RigidMotion& rigid) {
  if (scene.bodies.empty()) return {fem::Start::rigid, ""};
  const bool still = rigid.start_speed() < kSpeedAtRest;
  if (rigid.degrees_of_freedom() == 0) {
    if (!rigid.reaches(kTimeIncrement))
      return {fem::Start::rigid, "\"rigid\", because bodies must bend to follow the drives"};
    if (still)
      return {fem::Start::at_rest,
              "equilibrium at rest under weight and given forces, because all prescribed "
              "velocities are zero"};
    return {fem::Start::steady, "\"steady\", because prescribed velocities are not zero"};
  }
  if (rigid.is_indeterminate())
    return {fem::Start::rigid,
            "\"rigid\", because the joints constrain more than the degrees of freedom of the rigid "
            "mechanism, so that none of its motions gives an equilibrium"};
  const double nearly = 0.05 * std::max(1.0, scene.gravity ? scene.gravity->norm() : 0.0);
  if (still && rigid.start_acceleration() < nearly)
    return {fem::Start::settled, "equilibrium at rest, because nothing moves at the start"};
  return {
      fem::Start::rigid,
      "\"rigid\", because drives leave degrees of freedom undetermined and the mechanism does not "
      "start near an equilibrium at rest"};
}

/// Returns the start of bodies in hubs if the program chooses it.
Choice automatic_start(const Scene& scene, Mechanism& mechanism) {
  if (scene.in_space())
    return {fem::Start::prestretched,
            "\"prestretched\", because it is the only start for bodies in space"};
  const fem::State x = fem::start_state(mechanism.model, mechanism.moving_roots, 0,
                                        fem::Start::rigid, mechanism.motion.body_poses);
  const double speed = mechanism.model.scales().cwiseProduct(x.v).lpNorm<Eigen::Infinity>();
  if (speed < kSpeedAtRest)
    return {fem::Start::at_rest,
            "equilibrium at rest under weight and given forces, because all prescribed velocities "
            "are zero"};
  return {fem::Start::steady, "\"steady\", because prescribed velocities are not zero"};
}

fem::Start named_start(const Scene& scene, fem::RigidMotion* rigid) {
  switch (scene.time.start) {
    case Start::prestretched:
      return rigid ? prestretched_start(scene, *rigid) : fem::Start::prestretched;
    case Start::steady:
      return rigid ? steady_start(scene, *rigid) : fem::Start::steady;
    default:
      return fem::Start::rigid;
  }
}

}  // namespace

void set_start(const Scene& scene, fem::RigidMotion* rigid, Mechanism& mechanism) {
  if (scene.statics) return;
  if (scene.time.start != Start::automatic) {
    mechanism.motion.start = named_start(scene, rigid);
    return;
  }
  Choice choice = rigid ? automatic_start(scene, *rigid) : automatic_start(scene, mechanism);
  mechanism.motion.start = choice.kind;
  mechanism.start_text = std::move(choice.words);
}

}  // namespace flexmorph::cases
