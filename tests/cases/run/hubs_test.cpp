// Shows that edges in hubs at angles and at both ends of a body are correct: two plates in one hub
// against one plate, an angle of the weld against an angle of the hub, and a beam between two hubs
// against textbook values, static and driven.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/results/series.h"
#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

/// Returns a hub whose angle is driven from the given start angle.
std::string hub(double angle) {
  return R"toml(
title = "Plates in a hub"
[time]
step = 2e-3
end = 0.4
[[drive]]
name = "turn"
formula = ")toml" +
         exact_text(angle) + R"toml( + 0.4*(8*t - sin(8*t))"
[[hub]]
name = "shaft"
position = [0.1, 0.2]
angle = "turn"
)toml";
}

std::string plate(const std::string& name, double angle, const std::string& flow = "") {
  const std::string element = flow.empty() ? "ancf_plate" : "ale_ancf_plate";
  return "\n[[body]]\nname = \"" + name + "\"\nelement = \"" + element + R"toml("
space = "plane"
terms = ["inertia", "membrane"]
length = 0.4
width = 0.1
thickness = 0.01
elements = [4, 2]
youngs_modulus = 2e7
poisson_ratio = 0.3
density = 7800.0
)toml" + flow +
         "[[joint]]\ntype = \"weld\"\nbody = \"" + name +
         "\"\nedge = \"root\"\nto = \"shaft\"\nangle = " + exact_text(angle) + "\n";
}

const char* const kFlow = "[body.flow]\nspeed = 0.3\nmax_length = 0.15\nmin_length = 0.02\n";

class PlatesInAHub : public ::testing::TestWithParam<const char*> {};

// Two plates half a turn apart both move as a single plate; the hub has twice the moment and no
// force.
TEST_P(PlatesInAHub, HalfATurnApartMoveAsOne) {
  const Scratch scratch;
  const io::CsvTable one = motion_of(scratch, hub(0) + plate("arm", 0, GetParam()), "one"),
                     two = motion_of(scratch,
                                     hub(0) + plate("arm", 0, GetParam()) +
                                         plate("other", std::numbers::pi, GetParam()),
                                     "two");
  const auto tip = one.numbers("arm.tip_deflection"), same = two.numbers("arm.tip_deflection"),
             other = two.numbers("other.tip_deflection"), m = one.numbers("shaft.moment"),
             both = two.numbers("shaft.moment"), x = two.numbers("shaft.force_x"),
             y = two.numbers("shaft.force_y");
  const double bend = cases::largest_size(tip), most = cases::largest_size(m),
               force = std::max(cases::largest_size(one.numbers("shaft.force_x")), 1.0);
  EXPECT_GT(bend, 1e-3);
  ASSERT_EQ(tip.size(), other.size());
  for (size_t i = 0; i < tip.size(); ++i) {
    EXPECT_NEAR(same[i], tip[i], 1e-6 * bend) << i;  // tolerance of Newton's method
    EXPECT_NEAR(other[i], tip[i], 1e-6 * bend) << i;
    EXPECT_NEAR(both[i], 2 * m[i], 1e-5 * most) << i;
    EXPECT_NEAR(x[i], 0, 1e-5 * force) << i;
    EXPECT_NEAR(y[i], 0, 1e-5 * force) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(Flows, PlatesInAHub, ::testing::Values("", kFlow),
                         [](const auto& c) { return *c.param ? "growing" : "fixed"; });

TEST(HubAngle, IsThatOfTheHub) {
  const Scratch scratch;
  const io::CsvTable weld = motion_of(scratch, hub(0) + plate("arm", 0.7), "weld"),
                     turned = motion_of(scratch, hub(0.7) + plate("arm", 0), "hub");
  for (const char* column : {"arm.tip_deflection", "shaft.force_x", "shaft.moment"}) {
    const auto a = weld.numbers(column), b = turned.numbers(column);
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i)
      EXPECT_NEAR(a[i], b[i], 1e-6 * cases::largest_size(a)) << column;
  }
}

/// Returns a beam of 1 m between two hubs, with a square section of 0.02 m and 7800 kg/m^3.
std::string between(const std::string& gravity, const std::string& time, const std::string& right) {
  return "title = \"A beam between two hubs\"\n" + gravity + "[time]\n" + time + R"toml(
[[hub]]
name = "left"
position = [0.0, 0.0]
angular_velocity = 0.0
[[hub]]
name = "right"
position = [1.0, 0.0]
)toml" + right +
         R"toml(
[[body]]
name = "beam"
element = "ancf_beam"
terms = ["inertia", "gcm"]
length = 1.0
width = 0.02
height = 0.02
elements = 16
youngs_modulus = 2e11
poisson_ratio = 0.0
density = 7800.0
[[joint]]
type = "weld"
body = "beam"
edge = "root"
to = "left"
[[joint]]
type = "weld"
body = "beam"
edge = "free_end"
to = "right"
[[observe]]
name = "middle"
body = "beam"
point = [0.5, 0.0]
)toml";
}

// Reference, with the weight per length w = ρ g A: forces w L/2 and moments w L²/12 at both ends.
TEST(BeamBetweenHubs, CarriesItsWeight) {
  const Scratch scratch;
  const io::CsvTable motion = motion_of(
      scratch,
      between("gravity = [0.0, -9.81]\n", "step = 1e-3\nend = 0.02\n", "angular_velocity = 0.0\n"));
  const double w = 7800 * 9.81 * 0.02 * 0.02;
  for (const auto& [name, sign] : {std::pair{"left", 1.0}, {"right", -1.0}}) {
    const auto force = motion.numbers(std::string(name) + ".force_y"),
               moment = motion.numbers(std::string(name) + ".moment");
    EXPECT_NEAR(force.back(), 0.5 * w, 1e-3 * w) << name;
    EXPECT_NEAR(moment.back(), sign * w / 12, 2e-3 * w / 12) << name;
  }
}

// The right end turns slowly by φ = 1e-3. Reference: the moments are 4 E I φ/L at the right end and
// 2 E I φ/L at the left end.
TEST(BeamBetweenHubs, BendsAsItsEndIsTurned) {
  const Scratch scratch;
  const io::CsvTable motion =
      motion_of(scratch, between("", "step = 5e-3\nend = 2.0\nrho_inf = 0.5\n",
                                 "angle = \"turn\"\n[[drive]]\nname = \"turn\"\n"
                                 "formula = \"1e-3*(3*(t/2)^2 - 2*(t/2)^3)\"\n"));
  const double bending = 2e11 * std::pow(0.02, 4) / 12 * 1e-3;
  EXPECT_NEAR(motion.numbers("right.moment").back(), 4 * bending, 4e-3 * 4 * bending);
  EXPECT_NEAR(motion.numbers("left.moment").back(), 2 * bending, 8e-3 * 2 * bending);
  EXPECT_NEAR(motion.numbers("right.force_y").back(), -motion.numbers("left.force_y").back(),
              1e-3 * bending);
}

}  // namespace
}  // namespace flexmorph::test
