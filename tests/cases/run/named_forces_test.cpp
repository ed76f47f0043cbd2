// Shows that the columns of hubs and named springs are correct: a hub that swings a stiff plate
// against rigid-body mechanics, static weight in a hub, springs against their laws, and powers
// against energies.
#include <gtest/gtest.h>

#include <cmath>

#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

/// Returns a plate of 0.4 x 0.1 x 0.01 m^3 (3.12 kg) in a hub 0.2 m above the origin.
std::string plate(const std::string& time, const std::string& hub, const std::string& more = "") {
  return "title = \"A plate in a hub\"\n" + time + R"toml(
[[hub]]
name = "shaft"
position = [0.0, 0.2]
)toml" + hub +
         R"toml(
[[body]]
name = "arm"
element = "ancf_plate"
space = "plane"
terms = ["inertia", "membrane"]
length = 0.4
width = 0.1
thickness = 0.01
elements = [4, 2]
youngs_modulus = 2e11
poisson_ratio = 0.3
density = 7800.0
[[joint]]
type = "weld"
body = "arm"
edge = "root"
to = "shaft"
)toml" + more;
}

constexpr double kMass = 7800 * 0.4 * 0.1 * 0.01, kGravity = 9.81;

// In the static state the hub carries the weight, whose lever is 0.2 m; the plate deflects by less
// than 1e-5 m.
TEST(HubColumns, CarryTheWeight) {
  const Scratch scratch;
  const io::CsvTable motion =
      motion_of(scratch, "gravity = [0.0, -9.81]\n" + plate("[time]\nstep = 1e-3\nend = 0.02\n",
                                                            "angular_velocity = 0.0\n"));
  const auto x = motion.numbers("shaft.force_x"), y = motion.numbers("shaft.force_y"),
             moment = motion.numbers("shaft.moment"), power = motion.numbers("shaft.power");
  for (size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(x[i], 0, 1e-4 * kMass * kGravity);
    EXPECT_NEAR(y[i], kMass * kGravity, 1e-4 * kMass * kGravity);
    EXPECT_NEAR(moment[i], 0.2 * kMass * kGravity, 1e-4 * kMass * kGravity);
    EXPECT_EQ(power[i], 0);
  }
}

// The hub turns by θ(t). Reference: forces and moment of a rigid plate; bending changes them by
// (ω_drive/ω_bending)², less than 1e-3. The power is moment times rate, and its integral is the
// change of the plate's energy.
TEST(HubColumns, TurnThePlate) {
  const Scratch scratch;
  const io::CsvTable motion = motion_of(
      scratch,
      plate("[time]\nstep = 1e-3\nend = 1.0\nrho_inf = 0.5\n", "angle = \"turn\"\n", R"toml(
[[drive]]
name = "turn"
formula = "0.4*(3*t - sin(3*t))"
)toml"));
  const auto t = motion.numbers("time"), x = motion.numbers("shaft.force_x"),
             y = motion.numbers("shaft.force_y"), moment = motion.numbers("shaft.moment"),
             power = motion.numbers("shaft.power"), kinetic = motion.numbers("energy.kinetic"),
             strain = motion.numbers("energy.strain");
  const double inertia = kMass * (0.4 * 0.4 / 3 + 0.1 * 0.1 / 12);
  double work = 0;
  for (size_t i = 30; i < t.size(); ++i) {
    const double theta = 0.4 * (3 * t[i] - std::sin(3 * t[i])),
                 rate = 1.2 * (1 - std::cos(3 * t[i])), acceleration = 3.6 * std::sin(3 * t[i]),
                 c = std::cos(theta), s = std::sin(theta);
    EXPECT_NEAR(moment[i], inertia * acceleration, 0.01 * inertia * 3.6) << t[i];
    EXPECT_NEAR(x[i], -0.2 * kMass * (s * acceleration + c * rate * rate), 0.01 * kMass) << t[i];
    EXPECT_NEAR(y[i], 0.2 * kMass * (c * acceleration - s * rate * rate), 0.01 * kMass) << t[i];
    EXPECT_NEAR(power[i], moment[i] * rate, 1e-8);
    if (i == 30) work = kinetic[i] + strain[i];
    EXPECT_NEAR(kinetic[i] + strain[i], work, 2e-3 * inertia * 2.88) << t[i];
    if (i + 1 < t.size()) work += 0.5 * (power[i] + power[i + 1]) * (t[i + 1] - t[i]);
  }
}

// A mass on a spring and a damper. Reference: their laws, evaluated with the positions of the
// table.
TEST(SpringColumns, FollowTheirLaws) {
  const Scratch scratch;
  const io::CsvTable motion = motion_of(scratch, R"toml(
title = "A mass"
[time]
start = "rigid"
step = 1e-3
end = 0.5
[[rigid_body]]
name = "mass"
mass = 2.0
inertia = 0.1
position = [0.3, 0.0]
velocity = [0.0, 0.4]
angular_velocity = 0.0
[[spring]]
type = "bushing"
name = "mount"
b = "mass"
point_a = [0.1, 0.0]
stiffness = [50.0, 80.0]
damping = [0.0, 3.0]
torsion_stiffness = 1.0
)toml");
  const auto t = motion.numbers("time"), x = motion.numbers("mass.x"), y = motion.numbers("mass.y"),
             fx = motion.numbers("mount.force_x"), fy = motion.numbers("mount.force_y"),
             moment = motion.numbers("mount.moment"), energy = motion.numbers("mount.energy"),
             power = motion.numbers("mount.power");
  for (size_t i = 1; i + 1 < t.size(); ++i) {
    const double rate = (y[i + 1] - y[i - 1]) / 2e-3;  // error: h²/6 y''' = 3e-6
    EXPECT_NEAR(fx[i], -50 * (x[i] - 0.1), 1e-10);
    EXPECT_NEAR(fy[i], -80 * y[i] - 3 * rate, 2e-4);
    EXPECT_NEAR(moment[i], 0, 1e-10);
    EXPECT_NEAR(energy[i], 25 * (x[i] - 0.1) * (x[i] - 0.1) + 40 * y[i] * y[i], 1e-10);
    EXPECT_NEAR(power[i], -3 * rate * rate, 2e-4);
  }
}

}  // namespace
}  // namespace flexmorph::test
