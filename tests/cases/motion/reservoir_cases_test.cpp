// Shows that plates which grow out of free rigid bodies with a material reservoir conserve
// momentum, and that reservoirs which cannot be computed are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

constexpr double kDrivenFrame = 4,
                 kLine = 1;  // mass [kg]; mass of the boom per length, 1000 · 0.1 · 0.01 [kg/m]
// position of the outlet, lengths of the boom [m]
constexpr double kOutlet = 0.3, kStart = 0.3, kEnd = 0.62;

/// Returns the scene of a driven frame out of which a boom of 0.3 m grows along x, unless `weld`
/// and `flow` say otherwise.
std::string driven_frame(const std::string& flow, const std::string& weld, const std::string& spin,
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
mesh = "uniform"
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

/// Returns the largest change of linear and angular momentum along a motion, as a fraction of 1 kg
/// m/s and 1 kg m²/s.
double lost_momentum(const io::CsvTable& motion) {
  double out = 0;
  for (const char* name : {"momentum.x", "momentum.y", "momentum.angular"})
    out = std::max(out, largest_change(motion.numbers(name)));
  return out;
}

const char* const kFar = "reservoir_at = [0.1, 0.2]\n";

// The integrator is exact to its tolerance, therefore momentum is conserved: for a spinning body
// with an oblique outlet and a distant reservoir. Without a reservoir momentum is not conserved.
TEST(ReservoirCases, KeepMomentumWithAnExactIntegrator) {
  const Words exact = {"time.integrator=\"minimal_coordinates\"", "time.tolerance=1e-12",
                       "time.end=0.05"};
  for (const std::string stored : {"coil", "rod"}) {
    const io::CsvTable motion = motion_of(
        driven_frame("reservoir = \"" + stored + "\"\n" + kFar, "angle = 0.5", "1.5"), exact);
    EXPECT_LT(lost_momentum(motion), 1e-10) << stored;
    EXPECT_LT(largest_change(motion.numbers("energy.error")), 1e-8) << stored;
  }
  EXPECT_GT(lost_momentum(motion_of(driven_frame("", "angle = 0.5", "1.5"), exact)), 1e-3);
}

// With generalized-alpha the change of momentum is of second order in the step, for a growing boom
// and for one that is drawn in.
TEST(ReservoirCases, KeepMomentumWithOrderTwo) {
  for (const std::string out : {"0.3 + 2*t^2", "0.62 - 2*t^2"})
    for (const std::string stored : {"coil", "rod"}) {
      const std::string text =
          driven_frame("reservoir = \"" + stored + "\"\n" + kFar, "angle = 0.5", "1.5", out);
      const double coarse = lost_momentum(motion_of(text, {"time.step=2e-3"})),
                   fine = lost_momentum(motion_of(text, {"time.step=1e-3"}));
      EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2) << stored << " " << out;
    }
}

// A boom leaves a static body, and the common centre of mass keeps its position: m x + ρA ∫ ξ dξ
// over all material is constant. A coil lies at the outlet; a rod ends at the outlet. The body
// moves by
//   coil  -ρA (L² - L₀²)/2M,    rod  -ρA ((L² - L₀²) - (ℓ² - ℓ₀²))/2M,    ℓ = L_end - L.
TEST(ReservoirCases, BoomPaidOutFromRest) {
  const double whole = kDrivenFrame + kLine * kEnd;
  for (const bool rod : {false, true}) {
    const io::CsvTable motion =
        motion_of(driven_frame(rod ? "reservoir = \"rod\"" : "reservoir = \"coil\"",
                               "mode = \"direction\"", "0.0"),
                  {"body.0.youngs_modulus=1e9"});
    const std::vector<double> x = motion.numbers("carrier.x"), t = motion.numbers("time");
    const auto location = [&](double time) {
      const double length = kStart + 2 * time * time, left = kEnd - length, all = kEnd - kStart;
      double moment = length * length - kStart * kStart;
      if (rod) moment -= left * left - all * all;
      return -0.5 * kLine * moment / whole;
    };
    for (size_t i = 0; i < x.size(); ++i)
      EXPECT_NEAR(x[i], location(t[i]), 1e-4 * std::abs(location(0.4)));
    // Speed of the body at the end: all material outside is faster than the body by s = 1.6 m/s. In
    // the case of a rod this also holds for the material inside, whose length is then zero. The
    // speed is -ρA L s/M for the coil and -ρA L_end s/M for the rod at all times.
    const size_t last = x.size() - 1;
    const double speed = (x[last] - x[last - 1]) / (t[last] - t[last - 1]),
                 s = 4 * 0.5 * (t[last] + t[last - 1]);
    EXPECT_NEAR(speed, -kLine * kEnd * s / whole, 0.02 * std::abs(speed));
    for (const double y : motion.numbers("carrier.y")) EXPECT_LT(std::abs(y), 1e-12);
  }
}

// The stored material has weight: the whole system falls freely, as its common centre of mass does.
TEST(ReservoirCases, MaterialReservoirHasWeight) {
  for (const std::string stored : {"coil", "rod"}) {
    const io::CsvTable motion =
        motion_of(driven_frame("reservoir = \"" + stored + "\"\n" + kFar, "", "0.0"),
                  {"gravity=[0.0, -3.0]"});
    const double mass = kDrivenFrame + kLine * kEnd;
    EXPECT_NEAR(motion.numbers("momentum.y").back(), -3 * 0.4 * mass, 1e-5);
    EXPECT_NEAR(motion.numbers("momentum.x").back(), motion.numbers("momentum.x").front(), 1e-5);
    EXPECT_LT(largest_change(motion.numbers("energy.error")), 1e-4);
  }
}

struct Refused {
  std::string flow;
  std::vector<std::string> parts;  ///< Parts of the message.
  std::string out = "0.3 + 2*t^2";
};

TEST(ReservoirCases, RefuseWhatTheyCannotBe) {
  const Refused all[] = {{"reservoir = \"reel\"", {"body.flow.reservoir", "'none', 'coil', 'rod'"}},
                         {"reservoir = \"coil\"\nreservoir_length = 0.2",
                          {"body.flow.reservoir_length = 0.2", "0.32 m"}},
                         {"reservoir = \"coil\"\nreservoir_length = -1.0",
                          {"body.flow.reservoir_length = -1.0", "positive"}},
                         {"reservoir = \"rod\"\nreservoir_at = [0.1]",
                          {"body.flow.reservoir_at = [0.1]", "list of 2"}},
                         {"reservoir_at = [0.1, 0.2]", {"body.flow.reservoir_at", "coil", "rod"}},
                         {"reservoir_length = 1.0", {"body.flow.reservoir_length", "coil", "rod"}}};
  for (const Refused& each : all) {
    const Scratch scratch;
    const Ended ended = flexmorph(
        scratch,
        {"check", scratch.write("carrier.toml", driven_frame(each.flow, "", "0.0", each.out))});
    EXPECT_EQ(ended.code, 2) << each.flow;
    EXPECT_TRUE(testing::mentions_all(ended.err, each.parts));
  }
  // A designed body cannot be stored.
  const Scratch scratch;
  const Ended designed = flexmorph(
      scratch,
      {"check", scratch.write("design.toml", driven_frame("reservoir = \"coil\"", "", "0.0") +
                                                 "\n[[design]]\nbody = \"boom\"\n")});
  EXPECT_EQ(designed.code, 2);
  EXPECT_TRUE(testing::mentions_all(
      designed.err, {"design.body = \"boom\"", "[[design]]", "body.flow.reservoir"}));
  // A hub cannot store material.
  std::string text = driven_frame("reservoir = \"coil\"", "", "0.0");
  const size_t from = text.find("[[rigid_body]]"), to = text.find("[[body]]");
  text.replace(from, to - from, "[[hub]]\nname = \"carrier\"\nangular_velocity = 1.0\n");
  text.erase(text.find("point = [0.3"));
  const Ended ended = flexmorph(scratch, {"check", scratch.write("hub.toml", text)});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(testing::mentions_all(
      ended.err, {"body.flow.reservoir = \"coil\"", "rigid body", "'boom'", "'carrier'"}));
}

}  // namespace
}  // namespace flexmorph::test
