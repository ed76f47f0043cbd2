#include "cases/assembly/start.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kStill = 1e-6;  // [m/s]

/// What the prestretched start looks ahead by, at most (fem::start_state()) [s].
constexpr double kAhead = 2e-4;

/// How a mechanism starts that is to start steady: in equilibrium under the inertia forces of the
/// motion that drives determine (rigid where only plates that bend can follow them), or at rest in
/// equilibrium where nothing moves.
/// @throws Error (input) where it moves and drives do not determine how.
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

/// How a mechanism starts prestretched: at rest near equilibrium where its drives do not determine
/// it all.
/// @throws Error (input) where it does not rest.
fem::Start prestretched_start(const Scene& scene, fem::RigidMotion& rigid) {
  if (rigid.degrees_of_freedom() == 0)
    return rigid.reaches(kAhead) ? fem::Start::prestretched : fem::Start::rigid;
  if (rigid.is_indeterminate())
    throw Error::input(
        "time.start: \"prestretched\" needs a motion of the rigid mechanism, but its joints hold "
        "more than it has freedoms: start = \"rigid\"");
  // What is left of it is the start of a swing; the equilibrium of the plates ends it.
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

/// A start and why it was chosen.
struct Choice {
  fem::Start kind;
  std::string words;
};

/// The start of a mechanism that the case leaves to the program.
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

/// The same of bodies in hubs.
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
