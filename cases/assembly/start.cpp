#include "cases/assembly/start.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kStill = 1e-6;  // [m/s]

/// Largest time after the start at which fem::start_state() uses the rigid motion [s].
constexpr double kAhead = 2e-4;

/// Returns the start of a mechanism with start = "steady": in equilibrium under the inertia forces
/// of the motion that drives determine (rigid if plates must bend to follow the drives), or in
/// equilibrium at rest if nothing moves.
/// @throws Error (input) where the mechanism moves and drives do not determine its motion.
fem::Start steady_start(const Scene& scene, fem::RigidMotion& rigid) {
  if (rigid.degrees_of_freedom() == 0)
    return scene.bodies.empty() || !rigid.reaches(kAhead) ? fem::Start::rigid : fem::Start::steady;
  if (!rigid.is_indeterminate() && rigid.start_speed() < kStill) return fem::Start::at_rest;
  scene.refuse("time.start",
               rigid.is_indeterminate()
                   ? "\"steady\" needs a motion of the rigid mechanism, but its joints hold more "
                     "than it has freedoms: start = \"rigid\""
                   : "\"steady\" needs drives that determine all motion, or a mechanism at rest; "
                     "drives leave " +
                         std::to_string(rigid.degrees_of_freedom()) +
                         " freedoms of this one, which sets off with " +
                         io::to_text(rigid.start_speed(), 3) + " m/s: start = \"rigid\"");
}

/// Returns the start of a mechanism with start = "prestretched". It is at rest near equilibrium if
/// drives do not determine the motion.
/// @throws Error (input) where drives do not determine the motion and the mechanism is not at rest.
fem::Start prestretched_start(const Scene& scene, fem::RigidMotion& rigid) {
  if (rigid.degrees_of_freedom() == 0)
    return rigid.reaches(kAhead) ? fem::Start::prestretched : fem::Start::rigid;
  if (rigid.is_indeterminate())
    throw Error::input(
        "time.start: \"prestretched\" needs a motion of the rigid mechanism, but its joints hold "
        "more than it has freedoms: start = \"rigid\"");
  // A larger acceleration is the start of a swing. A smaller one vanishes in the equilibrium of the
  // plates.
  const double nearly = 0.05 * std::max(1.0, scene.gravity ? scene.gravity->norm() : 0.0);
  const double speed = rigid.start_speed(), acceleration = rigid.start_acceleration();
  if (speed < kStill && acceleration < nearly) return fem::Start::settled;
  scene.refuse("time.start",
               "\"prestretched\" puts a mechanism whose drives leave freedoms (" +
                   std::to_string(rigid.degrees_of_freedom()) +
                   " here) into its equilibrium at rest, but this one sets off with " +
                   io::to_text(speed, 3) + " m/s and " + io::to_text(acceleration, 3) +
                   " m/s²: bodies where they hang at rest and drives that begin at rest, or start "
                   "= \"rigid\"");
}

/// A start and the text with the reason for its choice.
struct Choice {
  fem::Start kind;
  std::string words;
};

/// Returns the start of a mechanism if the program chooses it.
Choice automatic_start(const Scene& scene, fem::RigidMotion& rigid) {
  if (scene.bodies.empty()) return {fem::Start::rigid, ""};
  const bool still = rigid.start_speed() < kStill;
  if (rigid.degrees_of_freedom() == 0) {
    if (!rigid.reaches(kAhead))
      return {fem::Start::rigid, "\"rigid\": bodies have to bend to follow the drives"};
    if (still)
      return {fem::Start::at_rest,
              "equilibrium at rest under weight and given forces: prescribed velocities are zero"};
    return {fem::Start::steady, "\"steady\": prescribed velocities are not zero"};
  }
  if (rigid.is_indeterminate())
    return {fem::Start::rigid,
            "\"rigid\": joints hold more than the mechanism has freedoms, so that no motion of the "
            "rigid mechanism gives an equilibrium"};
  const double nearly = 0.05 * std::max(1.0, scene.gravity ? scene.gravity->norm() : 0.0);
  if (still && rigid.start_acceleration() < nearly)
    return {fem::Start::settled, "equilibrium at rest: nothing moves at the start"};
  return {fem::Start::rigid,
          "\"rigid\": drives leave freedoms to the mechanism, and it sets off at the start"};
}

/// Returns the start of bodies in hubs if the program chooses it.
Choice automatic_start(const Scene& scene, Mechanism& mechanism) {
  if (scene.in_space())
    return {fem::Start::prestretched, "\"prestretched\": there is no other in space"};
  const fem::State x = fem::start_state(mechanism.model, mechanism.growths, 0, fem::Start::rigid,
                                        mechanism.motion.placement);
  const double speed = mechanism.model.scales().cwiseProduct(x.v).lpNorm<Eigen::Infinity>();
  if (speed < kStill)
    return {fem::Start::at_rest,
            "equilibrium at rest under weight and given forces: prescribed velocities are zero"};
  return {fem::Start::steady, "\"steady\": prescribed velocities are not zero"};
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
  mechanism.start_words = std::move(choice.words);
}

}  // namespace flexmorph::cases
