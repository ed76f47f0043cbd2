// Shows that the program keeps closed loops on their branch at any time step, finds positions where
// the given ones lead to none, and computes redundant joints and says that their forces are not
// unique: a crank-rocker against Freudenstein's equation, and coupled wheels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "geometry/text.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

/// A case file of rigid rods that is written line by line.
class CaseText {
 public:
  CaseText(double end, double step, const std::string& turn) {
    text_ = formatted("[time]\nend = %.17g\nstep = %.17g\n", end, step) +
            "[output]\nvtk = false\n[[drive]]\nname = \"turn\"\nformula = \"" + turn + "\"\n";
  }
  /// Adds a rod that extends from its origin along its first axis.
  void rod(const std::string& name, double length, const Vec2& at, double angle) {
    text_ += "[[rigid_body]]\nname = \"" + name + "\"\n" +
             formatted(
                 "mass = 1.0\nsize = [%.17g, 0.05]\ncenter = [%.17g, 0.0]\n"
                 "position = [%.17g, %.17g]\nangle = %.17g\n",
                 length, length / 2, at.x(), at.y(), angle);
  }
  /// Adds a joint of two points; the body of the ground is "".
  void joint(const std::string& type, const std::string& name, const std::string& a,
             const Vec2& at_a, const std::string& b, const Vec2& at_b = {0, 0},
             const std::string& more = "") {
    text_ += "[[joint]]\ntype = \"" + type + "\"\nname = \"" + name + "\"\n";
    if (!a.empty()) text_ += "a = \"" + a + "\"\n";
    text_ += formatted("point_a = [%.17g, %.17g]\nb = \"%s\"\npoint_b = [%.17g, %.17g]\n", at_a.x(),
                       at_a.y(), b.c_str(), at_b.x(), at_b.y()) +
             more;
  }
  void pin(const std::string& name, const std::string& a, const Vec2& at_a, const std::string& b,
           const Vec2& at_b = {0, 0}) {
    joint("revolute", name, a, at_a, b, at_b);
  }
  void motor(const std::string& body, const std::string& name = "motor") {
    text_ += "[[joint]]\ntype = \"angle_drive\"\nname = \"" + name + "\"\nb = \"" + body +
             "\"\nangle = \"turn\"\n";
  }
  /// Runs the case with changes.
  Ended run(const Scratch& scratch, Words changes = {}) const {
    const std::string file = scratch / "scene.toml";
    std::ofstream(file) << text_;
    Words words = {"run", file, "-o", scratch / "out"};
    for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
    return flexmorph(scratch, words);
  }
  Ended check(const Scratch& scratch) const {
    const std::string file = scratch / "scene.toml";
    std::ofstream(file) << text_;
    return flexmorph(scratch, {"check", file});
  }

 private:
  std::string text_;
};

io::CsvTable motion(const Scratch& scratch) { return io::read_csv(scratch / "out/motion.csv"); }

Vec2 polar(double length, double angle) { return length * Vec2(std::cos(angle), std::sin(angle)); }

// The crank-rocker with links 1 (ground), 0.5, 1.2 and 0.8 m.

/// Returns the angle of the rocker on the open branch from Freudenstein's equation,
/// k1 cos ψ - k2 cos φ + k3 = cos (φ - ψ).
double rocker_angle(double crank) {
  const double d = 1, a = 0.5, b = 1.2, c = 0.8;
  const double k1 = d / a, k2 = d / c, k3 = (a * a - b * b + c * c + d * d) / (2 * a * c);
  // With u = tan (ψ / 2): A u² + B u + C = 0.
  const double A = std::cos(crank) - k1 - k2 * std::cos(crank) + k3, B = -2 * std::sin(crank),
               C = k1 - (k2 + 1) * std::cos(crank) + k3;
  return 2 * std::atan2(-B - std::sqrt(B * B - 4 * A * C), 2 * A);
}

CaseText crank_rocker(double step, double coupler, double rocker) {
  CaseText text(1, step, "2*pi*t");
  text.rod("crank", 0.5, {0, 0}, 0);
  text.rod("coupler", 1.2, {0.5, 0}, coupler);
  text.rod("rocker", 0.8, {1, 0}, rocker);
  text.pin("A0", "", {0, 0}, "crank");
  text.motor("crank");
  text.pin("A", "crank", {0.5, 0}, "coupler");
  text.pin("B", "coupler", {1.2, 0}, "rocker", {0.8, 0});
  text.pin("B0", "", {1, 0}, "rocker");
  return text;
}

class CrankRocker : public ::testing::TestWithParam<std::pair<double, std::string>> {};

TEST_P(CrankRocker, KeepsToItsBranch) {
  const auto& [step, integrator] = GetParam();
  const Scratch scratch;
  const Ended ended = crank_rocker(step, 0.5053609157141864, 0.8127561994224595)
                          .run(scratch, {"time.integrator=\"" + integrator + "\""});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable table = motion(scratch);
  const auto time = table.numbers("time"), angle = table.numbers("rocker.angle");
  ASSERT_NEAR(time.back(), 1, 1e-12);
  for (size_t k = 0; k < time.size(); ++k) {
    const double exact = rocker_angle(2 * std::numbers::pi * time[k]);
    EXPECT_NEAR(std::remainder(angle[k] - exact, 2 * std::numbers::pi), 0, 1e-9) << time[k];
    EXPECT_GT(angle[k] * 180 / std::numbers::pi, 38.62);
    EXPECT_LT(angle[k] * 180 / std::numbers::pi, 135.96);
    if (std::abs(time[k] - 0.75) < 1e-9) {
      EXPECT_NEAR(angle[k] * 180 / std::numbers::pi, 131.1348, 1e-4);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Steps, CrankRocker,
                         ::testing::Values(std::pair(1e-3, "generalized_alpha"),
                                           std::pair(0.1, "generalized_alpha"),
                                           std::pair(0.2, "generalized_alpha")),
                         [](const auto& test) {
                           return test.param.second +
                                  formatted("_%d_ms", int(std::lround(1e3 * test.param.first)));
                         });

// All rods lie on one line, from which no correction leads away.
TEST(WrongGuess, IsSaidAndAPositionIsFound) {
  const Scratch scratch;
  const CaseText text = crank_rocker(1e-2, 0, 0);
  const Ended ended = text.run(scratch);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_FALSE(testing::mentions(ended.out + ended.err, "contradict")) << ended.out << ended.err;
  const auto remarks = run_json(scratch / "out").dump();
  EXPECT_TRUE(testing::mentions(remarks, "initial positions")) << remarks;
  EXPECT_TRUE(testing::mentions(remarks, "0.505361") && testing::mentions(remarks, "0.812756"))
      << remarks;
  const io::CsvTable table = motion(scratch);
  const auto time = table.numbers("time"), angle = table.numbers("rocker.angle");
  for (size_t k = 0; k < time.size(); ++k)
    EXPECT_NEAR(std::remainder(angle[k] - rocker_angle(2 * std::numbers::pi * time[k]),
                               2 * std::numbers::pi),
                0, 1e-9);
  EXPECT_TRUE(testing::mentions(text.check(scratch).out, "0.812756"));
}

/// Wheels (cranks) at distances of 1 m that rods couple; each rod joins points of the wheels with
/// the same angle from the crank.
CaseText coupled_wheels(int wheels, const std::vector<double>& rods, double error = 0) {
  CaseText text(2, 1e-2, "0.5 + pi*t");
  const auto crank = [](int k) { return "crank" + std::to_string(k); };
  for (int k = 0; k < wheels; ++k) {
    text.rod(crank(k), 0.2, {k * 1.0, 0}, 0.5);
    text.pin("axle" + std::to_string(k), "", {k * 1.0, 0}, crank(k));
  }
  for (size_t i = 0; i < rods.size(); ++i) {
    const std::string rod = "rod" + std::to_string(i);
    text.rod(rod, wheels - 1.0, polar(0.2, 0.5 + rods[i]), 0);
    for (int k = 0; k < wheels; ++k)
      text.pin("pin" + std::to_string(i) + std::to_string(k), crank(k), polar(0.2, rods[i]), rod,
               {k * 1.0 + (k == wheels - 1 ? error : 0), 0});
  }
  text.motor("crank0");
  return text;
}

class CoupledWheels : public ::testing::TestWithParam<std::pair<int, std::vector<double>>> {};

// In the dead centres of one rod, the other wheel or rod determines the branch.
TEST_P(CoupledWheels, TurnTogether) {
  const auto& [wheels, rods] = GetParam();
  for (const char* integrator : {"generalized_alpha", "minimal_coordinates"}) {
    const Scratch scratch;
    const Ended ended = coupled_wheels(wheels, rods)
                            .run(scratch, {std::string("time.integrator=\"") + integrator + "\""});
    ASSERT_EQ(ended.code, 0) << integrator << ended.err;
    const io::CsvTable table = motion(scratch);
    const auto time = table.numbers("time");
    ASSERT_NEAR(time.back(), 2, 1e-12);
    for (int k = 0; k < wheels; ++k) {
      const auto angle = table.numbers("crank" + std::to_string(k) + ".angle");
      for (size_t i = 0; i < time.size(); ++i)
        EXPECT_NEAR(angle[i], 0.5 + std::numbers::pi * time[i], 1e-9) << integrator << " " << k;
    }
    const json written = run_json(scratch / "out");
    const std::string names = written["motion"]["not_unique_forces"];
    EXPECT_TRUE(testing::mentions_all(names, {"pin00", "pin01", "axle1"})) << names;
    EXPECT_TRUE(testing::mentions(written.dump(), "not unique"));
    EXPECT_TRUE(testing::mentions_all(contents_of(scratch / "out/plots/joint_forces.svg"),
                                      {"pin00, on", "not unique"}));
  }
}
INSTANTIATE_TEST_SUITE_P(Sets, CoupledWheels,
                         ::testing::Values(std::pair(3, std::vector{0.0}),
                                           std::pair(2, std::vector{0.0, std::numbers::pi / 2})),
                         [](const auto& test) {
                           return test.param.first == 3 ? "three" : "quartered";
                         });

// The last pin does not fit. Of the pins that contradict each other it is named first.
TEST(CoupledWheels, WrongRodIsRefused) {
  const Scratch scratch;
  const Ended ended = coupled_wheels(3, {0.0}, 1e-3).run(scratch);
  EXPECT_EQ(ended.code, 2) << ended.out << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.err, {"contradict", " m"})) << ended.err;
  const size_t motor = ended.err.find("'motor'"), pin = ended.err.find("'pin0");
  EXPECT_TRUE(motor < pin || ended.err.find("'pin02'") == pin) << ended.err;
}

// A second joint or drive that agrees with another one is redundant. Each carries half of the
// force.
TEST(RedundantJoints, CarryEqualForces) {
  const Scratch alone, twice;
  CaseText text = crank_rocker(1e-2, 0.5053609157141864, 0.8127561994224595);
  ASSERT_EQ(text.run(alone).code, 0);
  text.pin("again", "", {1, 0}, "rocker");
  text.motor("crank", "second");
  const Ended ended = text.run(twice);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable one = motion(alone), two = motion(twice);
  const auto expect_half = [&](const std::string& whole, const std::string& half) {
    const auto all = one.numbers(whole), part = two.numbers(half);
    double largest = 0, difference = 0;
    for (size_t k = 0; k < all.size(); ++k) {
      largest = std::max(largest, std::abs(all[k]));
      difference = std::max(difference, std::abs(all[k] - 2 * part[k]));
    }
    EXPECT_LT(difference, 1e-7 * largest) << half;
  };
  for (const std::string end : {".force_x", ".force_y"})
    for (const std::string joint : {"B0", "again"}) expect_half("B0" + end, joint + end);
  for (const std::string joint : {"motor", "second"})
    expect_half("motor.moment", joint + ".moment");
  const std::string names = run_json(twice / "out")["motion"]["not_unique_forces"];
  EXPECT_EQ(names, "motor, B0, again, second");
  EXPECT_TRUE(testing::mentions_all(text.check(twice).out, {"redundant joints", "again"}));
}

}  // namespace
}  // namespace flexmorph::test
