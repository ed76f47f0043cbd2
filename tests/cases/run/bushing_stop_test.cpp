// Shows that bushings and stops of case files follow closed forms: a body on a bushing is three
// damped oscillators, a ball rebounds from a stop, a rope and an angle stop turn a motion back; and
// that wrong input is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

/// Returns a case with a body of 2 kg and 0.3 kg m^2 attached to the ground.
std::string body(const std::string& words, double step, double end, const std::string& more) {
  return R"toml(
title = "A body and the ground"
[time]
start = "rigid"
step = )toml" +
         std::to_string(step) + "\nend = " + std::to_string(end) +
         "\n[[rigid_body]]\nname = \"ball\"\nmass = 2.0\ninertia = 0.3\n" + words + more;
}

/// Returns x(t) of x'' + 2 ζ ω x' + ω² x = 0 with x(0) = 1, x'(0) = 0.
double swing(double mass, double stiffness, double damping, double t) {
  const double w = std::sqrt(stiffness / mass), z = damping / (2 * mass * w),
               wd = w * std::sqrt(1 - z * z);
  return std::exp(-z * w * t) * (std::cos(wd * t) + z * w / wd * std::sin(wd * t));
}

// The axis of a has the angle 0.4 rad. Along this axis, across it and about it there are three
// independent oscillators.
TEST(Bushing, HoldsABodyAsThreeOscillators) {
  const Scratch scratch;
  const double c = std::cos(0.4), s = std::sin(0.4);
  const io::CsvTable motion =
      motion_of(scratch, body("position = [0.3, -0.1]\nangle = 0.9\nvelocity = [0.0, 0.0]\n"
                              "angular_velocity = 0.0\n",
                              1e-3, 2, R"toml(
[[spring]]
type = "bushing"
name = "mount"
b = "ball"
point_a = [0.0, 0.0]
angle_a = 0.4
stiffness = [50.0, 400.0]
damping = [3.0, 0.0]
torsion_stiffness = 8.0
torsion_damping = 0.2
rest_angle = 0.1
)toml"));
  const auto t = motion.numbers("time"), x = motion.numbers("ball.x"), y = motion.numbers("ball.y"),
             angle = motion.numbers("ball.angle");
  // The integrator is of order 2: the error of the phase ω t is (ω h)² / 12, and the numerical
  // damping doubles it.
  for (size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(c * x[i] + s * y[i], (c * 0.3 - s * 0.1) * swing(2, 50, 3, t[i]), 2e-4) << t[i];
    EXPECT_NEAR(c * y[i] - s * x[i], (-c * 0.1 - s * 0.3) * swing(2, 400, 0, t[i]), 5e-4) << t[i];
    EXPECT_NEAR(angle[i] - 0.5, 0.4 * swing(0.3, 8, 0.2, t[i]), 2e-4) << t[i];
  }
}

/// Returns a ball that flies with 1.5 m/s to a stop 0.1 m ahead.
std::string thrown(const std::string& stop) {
  return body("velocity = [1.5, 0.2]\nangular_velocity = 0.0\n", 2e-4, 0.3, R"toml(
[[spring]]
type = "stop"
name = "wall"
b = "ball"
point_a = [0.0, 0.0]
most = 0.1
stiffness = 8000.0
)toml" + stop);
}

double last_rate(const std::vector<double>& t, const std::vector<double>& x) {
  const size_t n = t.size();
  return (x[n - 1] - x[n - 11]) / (t[n - 1] - t[n - 11]);
}

struct Rebound {
  const char* name;
  const char* stop;
  double speed;  // rebound speed divided by the impact speed
};

// The contact ends when k δ + c δ' = 0. With ζ = c/(2 m ω): tan(ω_d t) = -2 ζ sqrt(1 - ζ²)/(1 - 2
// ζ²), and the speed is multiplied by exp(-ζ ω t).
double damped_rebound(double zeta) {
  const double root = std::sqrt(1 - zeta * zeta);
  const double phase = std::numbers::pi - std::atan(2 * zeta * root / (1 - 2 * zeta * zeta));
  return std::exp(-zeta / root * phase);
}

class EveryRebound : public ::testing::TestWithParam<Rebound> {};

// ω = sqrt(8000/2) = 63.2/s; c = 50.6 N s/m is ζ = 0.2. The time step resolves the beginning of the
// contact up to h ω = 1.3 % of its force, which is the fraction (h ω)² of the energy.
TEST_P(EveryRebound, IsWhatTheContactLeaves) {
  const Scratch scratch;
  const io::CsvTable motion = motion_of(scratch, thrown(GetParam().stop));
  const auto t = motion.numbers("time"), x = motion.numbers("ball.x"), y = motion.numbers("ball.y");
  EXPECT_NEAR(last_rate(t, x), -1.5 * GetParam().speed, 1.5 * 4e-3);
  EXPECT_NEAR(y.back(), 0.2 * t.back(), 1e-9);  // there is no friction
  // Without damping and with a short onset, 1/2 m v² = 1/2 k δ² gives the largest depth δ.
  const double deepest = *std::max_element(x.begin(), x.end()) - 0.1;
  if (GetParam().speed == 1) {
    EXPECT_NEAR(deepest, 1.5 / std::sqrt(4000), 3e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Walls, EveryRebound,
    ::testing::Values(Rebound{"elastic", "", 1}, Rebound{"onset", "onset = 2e-4", 1},
                      Rebound{"damped", "damping = 50.59644256269407", damped_rebound(0.2)}),
    [](const auto& c) { return c.param.name; });

// A rope of 0.25 m: the ball leaves in the opposite direction with equal speed. An axle with a stop
// at 0.5 rad turns back with equal rate.
TEST(Stop, RopesAndAnglesTurnBack) {
  const Scratch scratch;
  const io::CsvTable rope = motion_of(
      scratch, body("position = [0.1, 0.0]\nvelocity = [1.5, 0.0]\nangular_velocity = 0.0\n", 2e-4,
                    0.3, R"toml(
[[spring]]
type = "distance_stop"
b = "ball"
point_a = [0.0, 0.0]
most = 0.25
stiffness = 8000.0
)toml"));
  EXPECT_NEAR(last_rate(rope.numbers("time"), rope.numbers("ball.x")), -1.5, 6e-3);
  const io::CsvTable axle =
      motion_of(scratch, body("velocity = [0.0, 0.0]\nangular_velocity = 3.0\n", 2e-4, 0.3, R"toml(
[[spring]]
type = "angle_stop"
b = "ball"
most = 0.5
least = -0.2
stiffness = 3000.0
)toml"));
  EXPECT_NEAR(last_rate(axle.numbers("time"), axle.numbers("ball.angle")), -3, 12e-3);
}

TEST(Stop, IsRefusedWhereItMakesNoSense) {
  const Scratch scratch;
  const std::string file = scratch.write("case.toml", thrown(""));
  const auto refused = [&](const std::string& path, const std::string& change,
                           const std::vector<std::string>& parts) {
    const Ended ended = flexmorph(scratch, {"check", path, "--set", change});
    EXPECT_EQ(ended.code, 2) << change;
    const std::string option = "flexmorph: --set " + change + ": ";
    EXPECT_TRUE(testing::mentions_all(
        ended.err, parts, ended.err.starts_with(option) ? option : "flexmorph: " + path + ":"));
  };
  refused(file, "spring.wall.least=0.2", {"spring.most = 0.1", "least"});
  refused(file, "spring.wall.stiffness=0", {"positive", "[N/m]"});
  refused(file, "spring.wall.damping=-1", {"negative", "[N s/m]"});
  refused(file, "spring.wall.onset=-1", {"negative", "[m]"});
  refused(file, "spring.wall.free_length=1", {"least, most, name, onset"});
  refused(file, "spring.wall.b=ground", {"spring", "`a`", "`b`", "ground"});
  const std::string bushing = scratch.write(
      "bushing.toml",
      body("", 1e-3, 1, "[[spring]]\ntype = \"bushing\"\nname = \"m\"\nb = \"ball\""));
  refused(bushing, "title=x",
          {"spring", "stiffness", "damping", "torsion_stiffness", "torsion_damping"});
  refused(bushing, "spring.m.stiffness=[1]", {"list of 2", "[N/m]"});
  refused(bushing, "spring.m.stiffness=[1, -1]", {"negative", "[N/m]"});
  refused(bushing, "spring.m.torsion_damping=-1", {"negative", "[N m s/rad]"});
}

}  // namespace
}  // namespace flexmorph::test
