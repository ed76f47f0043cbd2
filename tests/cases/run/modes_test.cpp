// Shows that the command `modes` writes its tables and shapes, refuses what it cannot use, and that
// its frequencies are those of motions of the program itself with locked drives.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <numbers>

#include "cases/assembly/operating_point.h"
#include "cases/check/check_modes.h"
#include "cases/check/ready.h"
#include "fem/dynamics/integrators/integrator.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/cases/scenes.h"
#include "tests/support/errors.h"
#include "tests/support/locked_model.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

TEST(ModesCommand, WritesTablesAndShapes) {
  const Scratch scratch;
  const std::string folder = scratch / "modes";
  const test::Ended ended = test::flexmorph(
      scratch, {"modes", "four_bar", "--time", "0.5", "--count", "4", "-o", folder});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable table = io::read_csv(folder + "/modes.csv");
  ASSERT_EQ(table.n_rows(), 4u);
  const std::vector<double> frequency = table.numbers("frequency");
  EXPECT_TRUE(std::is_sorted(frequency.begin(), frequency.end()));
  EXPECT_GT(frequency[0], 0);
  for (size_t k = 0; k < 4; ++k) {
    double sum = 0;
    for (const std::string& column : table.columns)
      if (column.ends_with(".kinetic_share")) sum += table.numbers(column)[k];
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  const nlohmann::json json = test::json::parse(contents_of(folder + "/modes.json"));
  EXPECT_EQ(json.at("time"), 0.5);
  EXPECT_EQ(json.at("rigid_modes"), 0);
  EXPECT_EQ(json.at("complex"), true);
  ASSERT_EQ(json.at("modes").size(), 4u);
  EXPECT_EQ(json.at("modes")[0].at("frequency"), frequency[0]);
  for (const char* name : {"report.html", "case.toml", "modes/modes.pvd",
                           "modes/mode_rocker_00001.vtu", "modes/mode_crank_00004.vtu"})
    EXPECT_TRUE(fs::exists(folder + "/" + name)) << name;
}

/// A lever with two flexible arms of different length, tip masses, and a spring with a damper.
constexpr const char* kLever = R"TOML(
gravity = [0.0, -9.81]
[time]
end = 0.5
step = 1e-3
[[drive]]
name = "turn"
formula = "piecewise(pi/3*(t/0.4 - sin(2*pi*t/0.4)/(2*pi)), 0.4, pi/3)"
[[rigid_body]]
name = "shaft"
mass = 0.8
size = [0.08, 0.08]
[[body]]
name = "arm"
element = "ancf_plate"
terms = ["inertia", "membrane"]
length = 0.5
width = 0.06
thickness = 0.004
material = "aluminium"
elements = [10, 2]
[[body]]
name = "counter"
element = "ancf_plate"
terms = ["inertia", "membrane_assumed"]
length = 0.25
width = 0.06
thickness = 0.004
material = "aluminium"
elements = [5, 2]
[[joint]]
type = "revolute"
name = "bearing"
b = "shaft"
[[joint]]
type = "angle_drive"
b = "shaft"
angle = "turn"
[[joint]]
type = "weld"
body = "arm"
edge = "root"
to = "shaft"
point = [0.04, 0.0]
[[joint]]
type = "weld"
body = "counter"
edge = "root"
to = "shaft"
point = [-0.04, 0.0]
angle = "180 deg"
[[point_mass]]
body = "arm"
at = "free_end"
mass = 0.3
[[point_mass]]
body = "counter"
at = "free_end"
mass = 0.6
[[spring]]
type = "torsion"
b = "shaft"
stiffness = 2.0
damping = 0.05
)TOML";

/// Returns the lowest frequency of a clamped beam with a mass at its tip [Hz]: Rayleigh's quotient
/// of the static deflection, with 33/140 of the mass of the beam, and Timoshenko's shear deflection
/// (coefficient 5/6) in plane stress.
double clamped_beam_with_mass(double length, double mass) {
  constexpr double kYoung = 70e9, kPoisson = 0.3, kDensity = 2700, kWidth = 0.06,
                   kThickness = 0.004;
  const double inertia = kThickness * std::pow(kWidth, 3) / 12, area = kThickness * kWidth;
  const double bending = std::pow(length, 3) / (3 * kYoung * inertia),
               shear = length / (5.0 / 6 * kYoung / (2 * (1 + kPoisson)) * area);
  const double moved = mass + 33.0 / 140 * kDensity * area * length;
  return std::sqrt(1 / ((bending + shear) * moved)) / (2 * std::numbers::pi);
}

// The iteration converges for every number of modes, also where the last mode that is asked for is
// followed by one of nearly equal size. With the drive locked, the two lowest modes are those of
// clamped beams with masses at their tips.
TEST(ModesCommand, EveryNumberOfModesConverges) {
  const Scratch scratch;
  const std::string file = scratch.write("lever.toml", kLever), folder = scratch / "modes";
  std::vector<double> all;
  for (const int count : {8, 1, 3, 5, 6}) {
    const test::Ended ended = test::flexmorph(
        scratch, {"modes", file, "--time", "0.25", "--count", std::to_string(count), "-o", folder});
    ASSERT_EQ(ended.code, 0) << count << ended.err;
    const std::vector<double> found = io::read_csv(folder + "/modes.csv").numbers("frequency");
    ASSERT_EQ(found.size(), static_cast<size_t>(count));
    if (all.empty()) all = found;
    // The iteration ends at a relative error of 1e-11, which round-off of the factorization
    // exceeds.
    for (size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], all[k], 1e-7 * all[k]) << count;
  }
  // Rayleigh's quotient is too large by less than 1 %, and the plate is clamped on a whole edge.
  EXPECT_NEAR(all[0] / clamped_beam_with_mass(0.5, 0.3), 1, 0.01);
  EXPECT_NEAR(all[1] / clamped_beam_with_mass(0.25, 0.6), 1, 0.01);
}

// Every refusal names the value and leaves no folder behind.
TEST(ModesCommand, RefusesWhatItCannotUse) {
  const Scratch scratch;
  const std::string folder = scratch / "modes";
  for (const auto& [arguments, named] : std::vector<std::pair<test::Words, std::string>>{
           {{"four_bar", "--time", "99"}, "99"},
           {{"four_bar", "--time", "-1"}, "-1"},
           {{"lee_frame", "--time", "1e9"}, "load factor"},
           {{"four_bar", "--count", "0"}, "--count"},
           {{"short_beam"}, "domain.density"}}) {
    test::Words all = {"modes"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"-o", folder});
    const test::Ended ended = test::flexmorph(scratch, all);
    EXPECT_EQ(ended.code, 2) << named;
    EXPECT_NE((ended.out + ended.err).find(named), std::string::npos) << ended.err;
    EXPECT_FALSE(fs::exists(folder)) << named;
  }
}

// A plate with [domain] needs a density; frequencies are proportional to 1/√density.
TEST(ModesCommand, OfAStaticPlateFollowItsDensity) {
  const auto lowest = [](const std::string& density) {
    const PreparedCase prepared(read("short_beam", {"domain.density=" + density}));
    OperatingPoint point = operating_point(prepared, 0, false);
    const fem::NaturalModes found = fem::natural_modes(point.model, point.x, point.turning, 3);
    EXPECT_EQ(found.n_rigid(), 0);
    return found.modes.at(0).frequency();
  };
  const double light = lowest("1000"), heavy = lowest("4000");
  EXPECT_GT(heavy, 0);
  EXPECT_NEAR(light / heavy, 2, 1e-8);
}

// Without gravity nothing restores the free bodies of satellite_booms: three rigid modes.
TEST(ModesCommand, RigidModesOfASatelliteAreThree) {
  const PreparedCase prepared(read("satellite_booms"));
  for (const bool stopped : {false, true}) {
    OperatingPoint point = operating_point(prepared, 1, stopped);
    const fem::NaturalModes found = fem::natural_modes(point.model, point.x, point.turning, 6);
    EXPECT_EQ(found.n_rigid(), 3) << stopped;
    EXPECT_GT(found.modes.at(3).frequency(), 0.1);
  }
}

TEST(ModesCommand, CheckShowsFrequenciesAtThreeTimes) {
  const PreparedCase prepared(read("four_bar"));
  const std::string text = natural_frequencies_text(prepared);
  const double end = prepared.scene().time.end;
  for (const double time : {0.0, 0.5 * end, end})
    EXPECT_NE(text.find("at t = " + io::to_text(time, 4) + " s"), std::string::npos) << text;
  EXPECT_NE(text.find(" Hz"), std::string::npos) << text;
}

/// Frequency of a mode, and of the motion after a small push in its shape [Hz].
struct Pushed {
  double mode = 0, motion = 0;
};

/// Pushes a case with locked drives in the shape of its lowest mode that is not rigid, and
/// integrates its motion for 20 periods. Returns zeros if there is no such mode.
Pushed push(const PreparedCase& prepared, double time, int steps_per_period) {
  OperatingPoint point = operating_point(prepared, time, true);
  const fem::NaturalModes found = fem::natural_modes(point.model, point.x, point.turning, 8);
  const auto mode = std::find_if(found.modes.begin(), found.modes.end(),
                                 [](const fem::NaturalMode& m) { return m.frequency() > 0; });
  if (mode == found.modes.end()) return {};
  fem::Workspace model{testing::LockedModel(point.model, time)};
  const double period = 1 / mode->frequency();
  const VectorXd shape = mode->shape.real(),
                 scaled = shape.cwiseProduct(model.scales().cwiseAbs2());
  const double size = (point.x.q.cwiseProduct(model.scales())).lpNorm<Eigen::Infinity>();
  fem::State x = point.x;
  x.v = 1e-5 * size * 2 * std::numbers::pi / period * shape;
  fem::IntegratorSettings settings;
  settings.alpha.rho_inf = 0.9;
  const auto integrator = fem::make_integrator(model, settings);
  integrator->project_velocity(x);
  integrator->make_consistent(x);
  const double h = period / steps_per_period;
  integrator->begin_motion(x, h);
  std::vector<double> t, y;
  for (int step = 1; step <= 20 * steps_per_period + steps_per_period / 6; ++step)
    integrator->advance(x, time + step * h, [&](const fem::State& s) {
      t.push_back(s.t);
      y.push_back(scaled.dot(s.q - point.x.q));
    });
  return {mode->frequency(), testing::frequency_of_zeros(t, y)};
}

TEST(ModesCommand, FrequenciesAreThoseOfTheMotionAfterAPush) {
  const Pushed found = push(PreparedCase(read("four_bar")), 0.4, 50);
  EXPECT_NEAR(found.motion / found.mode, 1, 0.01);
}

class LongModes : public ::testing::TestWithParam<std::string> {};

// Every shipped case with a motion and an equilibrium, at three times; one period has 40 steps,
// whose error of the period is 0.2 %.
TEST_P(LongModes, AreThoseOfTheMotionAfterAPush) {
  const PreparedCase prepared(read(GetParam()));
  const Scene& scene = prepared.scene();
  if (scene.domain || scene.statics) return;
  for (const double part : {0.0, 0.5, 1.0}) {
    const double time = part * scene.time.end;
    Pushed found;
    try {
      found = push(prepared, time, 40);
    } catch (const Error& error) {
      // A free mechanism need not have an equilibrium at rest.
      std::cout << "  t = " << io::to_text(time, 4) << " s: " << error.what() << '\n';
      EXPECT_FALSE(drives_determine_motion(prepared, time)) << error.what();
      break;
    }
    std::cout << "  t = " << io::to_text(time, 4) << " s: mode " << io::to_text(found.mode, 6)
              << " Hz, motion " << io::to_text(found.motion, 6) << " Hz\n"
              << std::flush;
    if (found.mode > 0) {
      EXPECT_NEAR(found.motion / found.mode, 1, 0.01) << time;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Long, LongModes, ::testing::ValuesIn(shipped_cases()),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace flexmorph::cases
