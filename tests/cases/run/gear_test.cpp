// The planar gear: the ratio of angles over many turns, the powers of a driven train, and the
// frequency of a train that swings on a spring.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kInertiaA = 0.02, kInertiaB = 0.3;  // [kg m^2]

/// Two wheels on axles of their own, turned by 0.3 and -1.1 rad at the start.
std::string wheels(const std::string& teeth, double end, const std::string& more) {
  return R"toml(
title = "Two wheels"
[time]
start = "rigid"
step = 1e-3
end = )toml" +
         std::to_string(end) + R"toml(
[[rigid_body]]
name = "pinion"
mass = 1.0
inertia = 0.02
angle = 0.3
[[rigid_body]]
name = "wheel"
mass = 4.0
inertia = 0.3
position = [0.7, 0.0]
angle = -1.1
[[joint]]
type = "revolute"
a = "pinion"
[[joint]]
type = "revolute"
a = "wheel"
point_b = [0.7, 0.0]
[[joint]]
type = "gear"
name = "mesh"
a = "pinion"
b = "wheel"
teeth = )toml" +
         teeth + more;
}

const char* const kMotor = R"toml(
[[drive]]
name = "turn"
formula = "0.3 + 9*t + 2*sin(3*t)"
[[joint]]
type = "angle_drive"
name = "motor"
b = "pinion"
angle = "turn"
[[spring]]
type = "torsion"
a = "wheel"
damping = 0.7
)toml";

io::CsvTable motion_of(const Scratch& scratch, const std::string& text) {
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, scratch.write("wheels.toml", text), folder);
  EXPECT_EQ(ended.code, 0) << ended.err;
  return io::read_csv(folder + "/motion.csv");
}

struct Train {
  std::string teeth, inner;
  double ratio;  // turns of the wheel per turn of the pinion
};

class GearTrain : public ::testing::TestWithParam<Train> {};

// Angles, and with J = J_a + r² J_b and the damper's c: the motor gives (J α + r² c ω) ω, the teeth
// (r J_b α + r c ω) r ω. Accelerations of generalized-alpha, in natural coordinates, have an error
// of the size of h² ω⁴, ω each wheel's own largest rate, once the first steps are over.
TEST_P(GearTrain, KeepsItsRatioAndPassesPowerOn) {
  const auto& [teeth, inner, r] = GetParam();
  const Scratch scratch;
  const io::CsvTable motion =
      motion_of(scratch, wheels(teeth, 3, "\ninner = " + inner + "\n" + kMotor));
  const auto t = motion.numbers("time"), a = motion.numbers("pinion.angle"),
             b = motion.numbers("wheel.angle"), power = motion.numbers("motor.power"),
             moment = motion.numbers("mesh.moment");
  ASSERT_EQ(t.size(), 3001u);
  const double error_a = 1e-6 * std::pow(15, 4), error_b = std::pow(r, 4) * error_a;
  EXPECT_GT(a.back() - a.front(), 4 * kTurn);
  for (size_t i = 0; i < t.size(); ++i) {
    const double turned_a = a[i] - 0.3, turned_b = b[i] + 1.1;
    EXPECT_NEAR(turned_b, r * turned_a, 1e-11) << t[i];  // what Newton's method leaves
    if (turned_a > kTurn) {
      EXPECT_NEAR(turned_b / turned_a, r, 1e-12) << t[i];
    }
    if (i < 60) continue;
    const double rate = 9 + 6 * std::cos(3 * t[i]), acceleration = -18 * std::sin(3 * t[i]);
    const double on_wheel = r * (kInertiaB * acceleration + 0.7 * rate);
    EXPECT_NEAR(moment[i], on_wheel, kInertiaB * error_b) << t[i];
    EXPECT_NEAR(power[i], (kInertiaA * acceleration + r * on_wheel) * rate,
                15 * (kInertiaA * error_a + std::abs(r) * kInertiaB * error_b))
        << t[i];
  }
}

INSTANTIATE_TEST_SUITE_P(Teeth, GearTrain,
                         ::testing::Values(Train{"[14, 35]", "false", -0.4},
                                           Train{"[17, 23]", "false", -17.0 / 23},
                                           Train{"[20, 50]", "true", 0.4},
                                           Train{"[30, 10]", "false", -3}));

// A spring k on the pinion: J θ'' = -k θ with J = J_a + r² J_b.
TEST(Gear, SwingsOnASpringAsOneInertia) {
  const Scratch scratch;
  const io::CsvTable motion = motion_of(scratch, wheels("[10, 20]", 2, R"toml(
[[spring]]
type = "torsion"
a = "pinion"
stiffness = 3.0
rest_angle = -0.1
)toml"));
  const auto t = motion.numbers("time"), a = motion.numbers("pinion.angle");
  const double pulsation = std::sqrt(3.0 / (kInertiaA + 0.25 * kInertiaB));
  for (size_t i = 0; i < t.size(); ++i)
    EXPECT_NEAR(a[i], 0.1 + 0.2 * std::cos(pulsation * t[i]), 1e-5) << t[i];
}

TEST(Gear, IsRefusedWhereItMakesNoSense) {
  const Scratch scratch;
  const auto complaint = [&](const std::string& change) {
    const Ended ended = flexmorph(
        scratch, {"check", scratch.write("w.toml", wheels("[14, 35]", 1, "")), "--set", change});
    EXPECT_EQ(ended.code, 2) << change;
    return ended.err;
  };
  EXPECT_TRUE(contains(complaint("joint.mesh.a=ground"), "a gear has two rigid bodies"));
  EXPECT_TRUE(contains(complaint("joint.mesh.teeth=[0, 3]"), "a number of teeth"));
  EXPECT_TRUE(contains(complaint("joint.mesh.teeth=[3.5, 3]"), "a number of teeth"));
  EXPECT_TRUE(contains(complaint("joint.mesh.point_a=[0, 0]"), "does not look at points"));
}

}  // namespace
}  // namespace flexmorph::test
