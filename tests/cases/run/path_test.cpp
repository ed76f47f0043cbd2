// Shows that the path joint is correct: a bead on a wire against a pendulum, a cam and its follower
// against closed forms; and that wrong input is refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "geometry/base.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

constexpr double kG = 9.81;
const char* const kCircle = R"toml(
[[drive]]
name = "x"
until = 6.283185307179586
formula = "1.5*cos(t)"
[[drive]]
name = "y"
until = 6.283185307179586
formula = "1.5*sin(t)"
)toml";

/// Returns a bead on a wire that starts at the point `at` of the wire.
std::string bead(const std::string& wire, const Vec2& at, double step, double end) {
  return R"toml(
title = "A bead on a wire"
gravity = [0.0, -9.81]
[time]
start = "rigid"
step = )toml" +
         std::to_string(step) + "\nend = " + std::to_string(end) + wire + R"toml(
[[rigid_body]]
name = "bead"
mass = 0.3
inertia = 1e-3
velocity = [0.0, 0.0]
angular_velocity = 0.0
position = [)toml" +
         std::to_string(at.x()) + ", " + std::to_string(at.y()) + R"toml(]
[[joint]]
type = "path"
name = "wire"
b = "bead"
x = "x"
y = "y"
)toml";
}

/// Returns the angle from the x axis of a pendulum of length 1.5 m that is released at 0.3 rad
/// (Runge-Kutta).
double pendulum(double end) {
  std::array<double, 2> x{0.3, 0};
  const auto rate = [](const std::array<double, 2>& x) {
    return std::array<double, 2>{x[1], -kG / 1.5 * std::cos(x[0])};
  };
  const auto plus = [](const std::array<double, 2>& x, double h, const std::array<double, 2>& k) {
    return std::array<double, 2>{x[0] + h * k[0], x[1] + h * k[1]};
  };
  constexpr int kSteps = 4000;
  const double h = end / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const auto k1 = rate(x), k2 = rate(plus(x, h / 2, k1)), k3 = rate(plus(x, h / 2, k2)),
               k4 = rate(plus(x, h, k3));
    for (size_t c = 0; c < 2; ++c) x[c] += h / 6 * (k1[c] + 2 * k2[c] + 2 * k3[c] + k4[c]);
  }
  return x[0];
}

// The curve is closed, and the bead passes the point where its parameter begins. The error is of
// order 2 in the step.
TEST(Path, BeadOnACircleIsAPendulum) {
  const Scratch scratch;
  const double end = 1.2, exact = pendulum(end);
  const Vec2 at(1.5 * std::cos(0.3), 1.5 * std::sin(0.3)),
      expected(1.5 * std::cos(exact), 1.5 * std::sin(exact));
  std::vector<double> errors;
  for (const double step : {0.01, 0.005, 0.0025}) {
    const io::CsvTable motion = motion_of(scratch, bead(kCircle, at, step, end));
    const auto x = motion.numbers("bead.x"), y = motion.numbers("bead.y");
    for (size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(std::hypot(x[i], y[i]), 1.5, 1e-10);
    errors.push_back((Vec2(x.back(), y.back()) - expected).norm());
  }
  EXPECT_LT(errors[2], 1e-3);
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.15);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.15);
}

// y = x²/2: the energy g y + (1 + x²) ẋ²/2 is constant; ẋ is computed from differences of
// positions.
TEST(Path, BeadOnAParabolaKeepsItsEnergy) {
  const Scratch scratch;
  const io::CsvTable motion = motion_of(scratch, bead(R"toml(
[[drive]]
name = "x"
until = 4.0
formula = "t - 2"
[[drive]]
name = "y"
until = 4.0
formula = "(t - 2)^2/2"
)toml",
                                                      {1, 0.5}, 1e-3, 2));
  const auto x = motion.numbers("bead.x"), y = motion.numbers("bead.y");
  double low = 1;
  for (size_t i = 1; i + 1 < x.size(); ++i) {
    EXPECT_NEAR(y[i], 0.5 * x[i] * x[i], 1e-10);
    const double rate = (x[i + 1] - x[i - 1]) / 2e-3;
    EXPECT_NEAR(kG * y[i] + 0.5 * (1 + x[i] * x[i]) * rate * rate, 0.5 * kG, 2e-4) << i;
    low = std::min(low, x[i]);
  }
  EXPECT_NEAR(low, -1, 1e-4);
}

/// Returns a plate that hangs by the middle of its root from a fixed board. A joint keeps this
/// point at its initial distance of 1.3 m from (-1.2, 0.5).
std::string hanging_plate(const std::string& joint) {
  return R"toml(
title = "A plate on a wire"
gravity = [0.0, -9.81]
[time]
start = "rigid"
step = 2e-3
end = 0.4
[[rigid_body]]
name = "board"
mass = 1.0
inertia = 0.1
[[body]]
name = "strip"
element = "ancf_plate"
space = "plane"
terms = ["inertia", "membrane"]
length = 0.4
width = 0.1
thickness = 0.01
elements = [4, 2]
youngs_modulus = 1e8
poisson_ratio = 0.3
density = 7800.0
[[joint]]
type = "weld"
b = "board"
[[joint]]
name = "wire"
a = "board"
b = "strip"
point_b = [0.0, 0.0]
)toml" + joint +
         "\n[[observe]]\nname = \"root\"\nbody = \"strip\"\npoint = [0.0, 0.0]\n"
         "[[observe]]\nname = \"tip\"\nbody = \"strip\"\npoint = [0.4, 0.0]\n";
}

/// Returns 401 points of an arc of 5 rad as a CSV file and as rows of a table. Their smooth curve
/// deviates from the arc by h⁴/384 R = 1e-10 m inside and by less than 1e-6 m at its ends.
std::array<std::string, 2> arc_points() {
  std::array<std::string, 2> out = {"s,x\n", "["};
  char line[80];
  for (int i = 0; i <= 400; ++i) {
    const double s = 5.0 * i / 400;
    std::snprintf(line, sizeof line, "%.17g,%.17g\n", s, -1.2 + 1.3 * std::cos(s - 2.5));
    out[0] += line;
    std::snprintf(line, sizeof line, "%s[%.17g, %.17g]", i ? ", " : "", s,
                  0.5 + 1.3 * std::sin(s - 2.5));
    out[1] += line;
  }
  out[1] += "]";
  return out;
}

// A curve given by points (one coordinate from a CSV file, one from a table) guides a point of a
// plate. The arc of a circle must have the effect of a massless rod to its centre, including the
// forces.
TEST(Path, OfPointsLeadsAPlateAsARodDoes) {
  const Scratch scratch;
  const auto [csv, table] = arc_points();
  scratch.write("arc.csv", csv);
  const io::CsvTable rod = motion_of(scratch,
                                     hanging_plate("type = \"distance\"\npoint_a = [-1.2, 0.5]\n"
                                                   "distance = 1.3\n")),
                     wire = motion_of(
                         scratch,
                         hanging_plate("type = \"path\"\nx = \"x\"\ny = \"y\"\n"
                                       "[[drive]]\nname = \"x\"\nuntil = 5.0\ncsv = \"arc.csv\"\n"
                                       "time = \"s\"\ncolumn = \"x\"\n"
                                       "[[drive]]\nname = \"y\"\nuntil = 5.0\ntable = " +
                                       table));
  for (const std::string column : {"strip.root_x", "strip.root_y", "strip.tip_x", "strip.tip_y"}) {
    const auto a = rod.numbers(column), b = wire.numbers(column);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_GT(std::abs(a.back() - a.front()), 0.01) << column;
    for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-7) << column << i;
  }
  for (const std::string column : {"wire.force_x", "wire.force_y"}) {
    const auto a = rod.numbers(column), b = wire.numbers(column);
    for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-4) << column << i;
  }
}

/// Returns an eccentric disc that is turned by 3 t, with a follower guided along y.
std::string cam(const std::string& change = "") {
  return R"toml(
title = "A cam"
gravity = [0.0, -9.81]
[time]
start = "rigid"
step = 1e-3
end = 3.0
[[drive]]
name = "turn"
formula = "3*t"
[[drive]]
name = "x"
until = 6.283185307179586
formula = "0.2 + 0.5*cos(t)"
[[drive]]
name = "y"
until = 6.283185307179586
formula = "0.5*sin(t)"
[[rigid_body]]
name = "disc"
mass = 2.0
inertia = 0.3
[[rigid_body]]
name = "follower"
mass = 0.7
inertia = 0.01
position = [0.0, 0.46]
angle = 1.5707963267948966
[[joint]]
type = "revolute"
a = "disc"
[[joint]]
type = "slider"
b = "follower"
angle_a = 1.5707963267948966
point_a = [0.0, 0.0]
[[joint]]
type = "angle_drive"
name = "motor"
b = "disc"
angle = "turn"
[[joint]]
type = "path"
name = "flank"
a = "disc"
b = "follower"
x = "x"
y = "y"
)toml" + change;
}

// Reference: y = ε sin θ + sqrt(r² - ε² cos² θ); the motor lifts and accelerates the follower.
TEST(Path, CamLiftsItsFollower) {
  const Scratch scratch;
  const io::CsvTable motion = motion_of(scratch, cam());
  const auto t = motion.numbers("time"), y = motion.numbers("follower.y"),
             power = motion.numbers("motor.power"), force = motion.numbers("flank.force_y");
  const auto lift = [](double time) {
    const double theta = 3 * time;
    return 0.2 * std::sin(theta) + std::sqrt(0.25 - 0.04 * std::cos(theta) * std::cos(theta));
  };
  for (size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(y[i], lift(t[i]), 1e-9) << t[i];
    if (i < 60) continue;  // accelerations have a transient at the start
    const double rate = (lift(t[i] + 1e-4) - lift(t[i] - 1e-4)) / 2e-4,
                 acceleration = (lift(t[i] + 1e-4) - 2 * lift(t[i]) + lift(t[i] - 1e-4)) / 1e-8;
    EXPECT_NEAR(force[i], 0.7 * (kG + acceleration), 2e-3) << t[i];
    EXPECT_NEAR(power[i], 0.7 * (kG + acceleration) * rate - 2.0 * 0, 2e-3) << t[i];
  }
}

// The curve is open; the run ends where the bead reaches its end.
TEST(Path, EndsWhereItsCurveEnds) {
  const Scratch scratch;
  const std::string slope = R"toml(
[[drive]]
name = "x"
until = 1.0
formula = "t"
[[drive]]
name = "y"
until = 1.0
formula = "-t"
)toml";
  const Ended ended =
      run(scratch, scratch.write("s.toml", bead(slope, {0.1, -0.1}, 1e-2, 2)), scratch / "out");
  EXPECT_EQ(ended.code, 3);
  EXPECT_TRUE(testing::mentions_all(ended.err, {"'wire'", "t = ", "parameter", "curve"}));
}

TEST(Path, IsRefusedWhereItMakesNoSense) {
  const Scratch scratch;
  const auto complaint = [&](const std::string& change) {
    const Ended ended =
        flexmorph(scratch, {"check", scratch.write("c.toml", cam()), "--set", change});
    EXPECT_EQ(ended.code, 2) << change;
    return ended.err;
  };
  const auto refused = [&](const std::string& change, const std::vector<std::string>& parts) {
    const std::string said = complaint(change), option = "flexmorph: --set " + change + ": ";
    EXPECT_TRUE(testing::mentions_all(
        said, parts, said.starts_with(option) ? option : "flexmorph: " + scratch / "c.toml:"));
  };
  refused("joint.flank.x=turn", {"'turn'", "time", "`until`"});
  refused("joint.motor.angle=x", {"'x'", "time", "`until`"});
  refused("drive.x.until=6", {"joint.flank.y", "6.28", "6"});
  refused("joint.flank.b=disc", {"`a`", "`b`", "different"});
  refused("joint.flank.angle_b=1", {"axes"});
  refused("drive.x.until=-1", {"positive"});
  refused("drive.x.formula='0.3*sin(2*t)'", {"joint.flank.x", "crosses itself"});
  refused("drive.x.formula='0.5*sin(t)'", {"joint.flank.x", "tangent", "t = 1.571"});
  refused("drive.x.formula='cos(t)^3'", {"joint.flank.x", "tangent", "t = 1.571"});
}

}  // namespace
}  // namespace flexmorph::test
