// Plates that grow out of free bodies which store their material: what momentum says of the motion,
// and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

constexpr double kCarrier = 4, kLine = 1;  // mass [kg]; of the boom per length, 1000 · 0.1 · 0.01
constexpr double kOutlet = 0.3, kStart = 0.3, kEnd = 0.62;  // place, lengths of the boom [m]

/// A carrier out of which a boom of 0.3 m grows along x, or where `weld` and `flow` say.
std::string carrier(const std::string& flow, const std::string& weld, const std::string& spin,
                    const std::string& out = "0.3 + 2*t^2") {
  return R"toml(
title = "Carrier"
[time]
end = 0.4
step = 2e-3
start = "rigid"
[[drive]]
name = "out"
formula = ")toml" +
         out + R"toml("
[[rigid_body]]
name = "carrier"
mass = 4.0
inertia = 0.3
velocity = [0.0, 0.0]
angular_velocity = )toml" +
         spin + R"toml(
[[body]]
name = "boom"
element = "ale_ancf_plate"
terms = ["inertia", "membrane"]
width = 0.1
thickness = 0.01
density = 1000.0
youngs_modulus = 1e5
poisson_ratio = 0.3
elements = [2, 1]
[body.flow]
length = "out"
mesh = "even"
)toml" + flow +
         R"toml(
[[joint]]
type = "weld"
body = "boom"
edge = "root"
to = "carrier"
point = [0.3, 0.0]
)toml" + weld;
}

io::CsvTable motion_of(const std::string& text, const Words& changes = {}) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, scratch.write("carrier.toml", text), folder, changes);
  EXPECT_EQ(ended.code, 0) << ended.err;
  return io::read_csv(folder + "/motion.csv");
}

double largest_change(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

/// Of linear and angular momentum along a motion, in parts of 1 kg m/s and 1 kg m²/s.
double lost_momentum(const io::CsvTable& motion) {
  double out = 0;
  for (const char* name : {"momentum.x", "momentum.y", "momentum.angular"})
    out = std::max(out, largest_change(motion.numbers(name)));
  return out;
}

const char* const kFar = "stored_at = [0.1, 0.2]\n";

// The integrator is exact to its tolerance, and the equations keep momentum: spinning, out of an
// outlet askew, from a store elsewhere. Without a store it is lost.
TEST(StoredCases, KeepMomentumWithAnExactIntegrator) {
  const Words exact = {"time.integrator=\"minimal_coordinates\"", "time.tolerance=1e-12",
                       "time.end=0.05"};
  for (const std::string stored : {"coil", "rod"}) {
    const io::CsvTable motion =
        motion_of(carrier("stored = \"" + stored + "\"\n" + kFar, "angle = 0.5", "1.5"), exact);
    EXPECT_LT(lost_momentum(motion), 1e-10) << stored;
    EXPECT_LT(largest_change(motion.numbers("energy.defect")), 1e-8) << stored;
  }
  EXPECT_GT(lost_momentum(motion_of(carrier("", "angle = 0.5", "1.5"), exact)), 1e-3);
}

// Generalized-alpha keeps it with order two, growing and drawn in.
TEST(StoredCases, KeepMomentumWithOrderTwo) {
  for (const std::string out : {"0.3 + 2*t^2", "0.62 - 2*t^2"})
    for (const std::string stored : {"coil", "rod"}) {
      const std::string text =
          carrier("stored = \"" + stored + "\"\n" + kFar, "angle = 0.5", "1.5", out);
      const double coarse = lost_momentum(motion_of(text, {"time.step=2e-3"})),
                   fine = lost_momentum(motion_of(text, {"time.step=1e-3"}));
      EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2) << stored << " " << out;
    }
}

// A boom paid out from rest: the common centre of mass stays. A coil is at the outlet, a rod ends
// there: m x + ρA ∫ ξ dξ over all material is what it was. The carrier moves by
//   coil  -ρA (L² - L₀²)/2M,    rod  -ρA ((L² - L₀²) - (ℓ² - ℓ₀²))/2M,    ℓ = L_end - L.
TEST(StoredCases, BoomPaidOutFromRest) {
  const double whole = kCarrier + kLine * kEnd;
  for (const bool rod : {false, true}) {
    const io::CsvTable motion = motion_of(
        carrier(rod ? "stored = \"rod\"" : "stored = \"coil\"", "mode = \"direction\"", "0.0"),
        {"body.0.youngs_modulus=1e9"});
    const std::vector<double> x = motion.numbers("carrier.x"), t = motion.numbers("time");
    const auto place = [&](double time) {
      const double length = kStart + 2 * time * time, left = kEnd - length, all = kEnd - kStart;
      double moment = length * length - kStart * kStart;
      if (rod) moment -= left * left - all * all;
      return -0.5 * kLine * moment / whole;
    };
    for (size_t i = 0; i < x.size(); ++i)
      EXPECT_NEAR(x[i], place(t[i]), 1e-4 * std::abs(place(0.4)));
    // Its speed in the end: all material that is out has s = 1.6 m/s more than the carrier, of a
    // rod the rest, too, which is nothing then: -ρA L s/M, and of a rod -ρA L_end s/M at all times.
    const size_t last = x.size() - 1;
    const double speed = (x[last] - x[last - 1]) / (t[last] - t[last - 1]),
                 s = 4 * 0.5 * (t[last] + t[last - 1]);
    EXPECT_NEAR(speed, -kLine * kEnd * s / whole, 0.02 * std::abs(speed));
    for (const double y : motion.numbers("carrier.y")) EXPECT_LT(std::abs(y), 1e-12);
  }
}

// What is stored has weight: all of it falls freely, as the common centre of mass does.
TEST(StoredCases, StoredMaterialHasWeight) {
  for (const std::string stored : {"coil", "rod"}) {
    const io::CsvTable motion = motion_of(
        carrier("stored = \"" + stored + "\"\n" + kFar, "", "0.0"), {"gravity=[0.0, -3.0]"});
    const double mass = kCarrier + kLine * kEnd;
    EXPECT_NEAR(motion.numbers("momentum.y").back(), -3 * 0.4 * mass, 1e-5);
    EXPECT_NEAR(motion.numbers("momentum.x").back(), motion.numbers("momentum.x").front(), 1e-5);
    EXPECT_LT(largest_change(motion.numbers("energy.defect")), 1e-4);
  }
}

struct Refused {
  std::string flow, says, out = "0.3 + 2*t^2";
};

TEST(StoredCases, RefuseWhatTheyCannotBe) {
  const Refused all[] = {
      {"stored = \"reel\"", "coil"},
      {"stored = \"coil\"\nstored_length = 0.2", "the material runs out: 0.32 m leave"},
      {"stored = \"coil\"\nstored_length = -1.0", "a length is positive"},
      {"stored = \"rod\"\nstored_at = [0.1]", "a list of 2"},
      {"stored_at = [0.1, 0.2]", "nothing is stored"},
      {"stored_length = 1.0", "nothing is stored"}};
  for (const Refused& each : all) {
    const Scratch scratch;
    const Ended ended = flexmorph(
        scratch, {"check", scratch.write("carrier.toml", carrier(each.flow, "", "0.0", each.out))});
    EXPECT_EQ(ended.code, 2) << each.flow;
    EXPECT_NE(ended.err.find(each.says), std::string::npos) << ended.err;
  }
  // With a design.
  const Scratch scratch;
  const Ended designed = flexmorph(
      scratch, {"check", scratch.write("design.toml", carrier("stored = \"coil\"", "", "0.0") +
                                                          "\n[[design]]\nbody = \"boom\"\n")});
  EXPECT_EQ(designed.code, 2);
  EXPECT_NE(designed.err.find("what a rigid body stores is full"), std::string::npos)
      << designed.err;
  // Out of a hub.
  std::string text = carrier("stored = \"coil\"", "", "0.0");
  const size_t from = text.find("[[rigid_body]]"), to = text.find("[[body]]");
  text.replace(from, to - from, "[[hub]]\nname = \"carrier\"\nangular_velocity = 1.0\n");
  text.erase(text.find("point = [0.3"));
  const Ended ended = flexmorph(scratch, {"check", scratch.write("hub.toml", text)});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("material is stored in a rigid body"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace flexmorph::test
