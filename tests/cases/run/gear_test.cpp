// Shows that the planar gear keeps the ratio of angles over many turns, transmits the power of a
// driven train, and that a train on a spring oscillates with the analytic frequency.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kInertiaA = 0.02, kInertiaB = 0.3;  // [kg m^2]

/// Returns a case with two wheels on separate axles, at 0.3 and -1.1 rad at the start.
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

struct Train {
  std::string teeth, inner;
  double ratio;  // turns of the wheel per turn of the pinion
};

class GearTrain : public ::testing::TestWithParam<Train> {};

// Reference values, with J = J_a + r² J_b and the damper's c: the motor power is (J α + r² c ω) ω,
// the teeth transmit (r J_b α + r c ω) r ω. The accelerations of generalized-alpha in natural
// coordinates have an error of the size h² ω⁴ after the first steps, where ω is the largest rate of
// the wheel in question.
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
    EXPECT_NEAR(turned_b, r * turned_a, 1e-11) << t[i];  // tolerance of Newton's method
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

// Reference: a spring k on the pinion gives J θ'' = -k θ with J = J_a + r² J_b.
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
  const double angular_frequency = std::sqrt(3.0 / (kInertiaA + 0.25 * kInertiaB));
  for (size_t i = 0; i < t.size(); ++i)
    EXPECT_NEAR(a[i], 0.1 + 0.2 * std::cos(angular_frequency * t[i]), 1e-5) << t[i];
}

TEST(Gear, IsRefusedWhereItMakesNoSense) {
  const Scratch scratch;
  const auto complaint = [&](const std::string& change) {
    const Ended ended = flexmorph(
        scratch, {"check", scratch.write("w.toml", wheels("[14, 35]", 1, "")), "--set", change});
    EXPECT_EQ(ended.code, 2) << change;
    return ended.err;
  };
  EXPECT_TRUE(testing::mentions_all(complaint("joint.mesh.a=ground"),
                                    {"w.toml:", "joint.mesh", "rigid bodies", "`a`", "`b`"}));
  for (const std::string teeth : {"joint.mesh.teeth=[0, 3]", "joint.mesh.teeth=[3.5, 3]"})
    EXPECT_TRUE(testing::mentions_all(complaint(teeth), {"whole number", "10000"},
                                      "flexmorph: --set " + teeth + ": "));
  EXPECT_TRUE(testing::mentions_all(complaint("joint.mesh.point_a=[0, 0]"), {"points"},
                                    "flexmorph: --set joint.mesh.point_a=[0, 0]: "));
}

}  // namespace
}  // namespace flexmorph::test
