// Shows that hot beams of the shipped cases agree with closed forms: the free beam, the held beam
// that buckles, clamps that let the section expand or hold it, and hot beams under loads.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/results/series.h"
#include "cases/run/motion_run.h"
#include "cases/run/path_run.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"

namespace flexmorph::cases {
namespace {

MotionRecord motion_of(const std::string& name, const Changes& changes = {}) {
  return run_motion(PreparedCase(read(name, changes)), {}).record;
}

PathRecord path_of(const std::string& name, const Changes& changes = {}) {
  return run_path(PreparedCase(read(name, changes)), {});
}

/// Returns y, linearly interpolated where x first passes `value`.
double at(const std::vector<double>& x, const std::vector<double>& y, double value) {
  for (size_t k = 1; k < x.size(); ++k)
    if ((x[k - 1] - value) * (x[k] - value) <= 0)
      return y[k - 1] + (y[k] - y[k - 1]) * (value - x[k - 1]) / (x[k] - x[k - 1]);
  ADD_FAILURE() << value << " is not passed";
  return 0;
}

// T 11.1: the ends lie at α ΔT (X - X_c) at all times, there is no elastic strain, and the kinetic
// energy is ½ (α Ṫ)² m (l² + h²)/12. The thermal force is switched on.
TEST(FreeBeam, GrowsAsTheClosedFormSays) {
  for (const double rise : {50.0, 100.0, 200.0}) {
    const MotionRecord r =
        motion_of("free_beam_heated", {"body.heat.rise=" + std::to_string(rise)});
    const auto& end = r.table.at("beam.end_ux");
    double fastest = 0;
    for (size_t k = 0; k < r.time().size(); ++k) {
      const double u = std::min(1.0, r.time()[k] / 0.5), s = u * u * (6 - 8 * u + 3 * u * u),
                   s_t = 12 * u * (1 - u) * (1 - u) / 0.5;
      EXPECT_NEAR(end[k], 0.5e-4 * rise * s, 1e-6 * 1e-4 * rise) << r.time()[k];
      const double kinetic = 0.5 * std::pow(1e-4 * rise * s_t, 2) * 72 * 1.01 / 12;
      EXPECT_NEAR(r.table.at(kKineticColumn)[k], kinetic,
                  1e-4 * 3.03 * std::pow(1e-4 * rise * 32 / 9, 2));
      EXPECT_NEAR(r.table.at("beam.free_kinetic")[k], kinetic, 1e-12);
      fastest = std::max(fastest, r.table.at(kKineticColumn)[k]);
    }
    EXPECT_NEAR(end.back(), 0.5e-4 * rise, 1e-9);
    EXPECT_NEAR(r.table.at("beam.end_rx").back(), 1 + 1e-4 * rise, 1e-9);
    EXPECT_NEAR(r.table.at("beam.end_ry").back(), 1 + 1e-4 * rise, 1e-9);
    EXPECT_NEAR(fastest / (3.03 * std::pow(1e-4 * rise * 32 / 9, 2)), 1, 1e-4);
    EXPECT_LE(largest_size(r.table.at("beam.max_elastic_strain")), 1e-8);
  }
}

// Without the thermal force only elastic strains, of size ρ L²/8 · α T̈ / E, accelerate the ends.
TEST(FreeBeam, WithoutThermalForceStrainsAccelerateIt) {
  const MotionRecord r = motion_of("free_beam_heated", {"body.heat.force=false"});
  // quasi-static strain at the start
  const double alone = 7200 / 8.0 * 1e-4 * 200 * 12 / 0.25 / 7e8;
  const double strain = largest_size(r.table.at("beam.max_elastic_strain"));
  EXPECT_GT(strain, 0.5 * alone);
  // a factor of 2 for a sudden load; strains vary linearly across the element
  EXPECT_LT(strain, 3 * alone);
}

// A beam between two immovable pins buckles at α ΔT = π² h²/(12 L²). Beyond this temperature the
// middle moves by A = (2 L/π) √(α (ΔT - ΔT_cr)) (first mode, constant axial force).
TEST(HeldBeam, BucklesAndItsBranchIsFollowed) {
  const PathRecord r = path_of("beam_heated_held", {"load.force=[0, -0.05]"});
  EXPECT_TRUE(r.result.completed);
  const auto& T = r.table.at("beam.temperature");
  const auto& w = r.table.at("beam.midpoint_deflection");
  EXPECT_GT(r.table.n_rows(), 10u);
  const double critical = std::numbers::pi * std::numbers::pi * 0.05 * 0.05 / 12 / 80e-6;  // 25.7 K
  EXPECT_LT(std::abs(at(T, w, 0.9 * critical)), 2e-3);
  for (const double rise : {30.0, 40.0, 48.0}) {
    const double expected = 2 / std::numbers::pi * std::sqrt(80e-6 * (rise - critical));
    EXPECT_NEAR(-at(T, w, rise) / expected, 1, 0.03) << rise;
  }
  // The square of the deflection is linear in the temperature; it is extrapolated to zero.
  const double w1 = std::pow(at(T, w, 36), 2), w2 = std::pow(at(T, w, 48), 2);
  EXPECT_NEAR((36 * w2 - 48 * w1) / (w2 - w1), critical, 0.02 * critical);
}

// T Fig. 1. A partial clamp lets the section expand, therefore there is no stress. A full clamp
// keeps the size of the section; its effect decays along the beam as exp(-x/λ).
TEST(Clamp, PartialIsFreeOfStressAndFullTapers) {
  const PathRecord partial = path_of("clamped_expansion");
  EXPECT_NEAR(partial.table.at("beam.end_ux").back(), 0.01, 1e-11);
  EXPECT_NEAR(partial.table.at("beam.end_uy").back(), 0, 1e-11);
  EXPECT_LE(largest_size(partial.table.at("beam.max_elastic_strain")), 1e-12);
  // The held section is too small by e = (1 - s⁻²)/2, and Poisson's effect makes the beam longer by
  // s ν e λ, λ = h √(G/(12E)). In the mode "full" the axis may not stretch at the clamp, either,
  // which makes the beam shorter by less than the expansion of the first element.
  const double s = 1.02, e = 0.5 * (1 - 1 / (s * s)), lambda = 0.1 * std::sqrt(1 / (2.6 * 12));
  const PathRecord edge = path_of("clamped_expansion", {"joint.mode=edge"}),
                   full = path_of("clamped_expansion", {"joint.mode=full"});
  const double longer = edge.table.at("beam.end_ux").back() - 0.01;
  EXPECT_NEAR(longer / (s * 0.3 * e * lambda), 1, 0.05);
  const double less = edge.table.at("beam.end_ux").back() - full.table.at("beam.end_ux").back();
  EXPECT_GT(less, 0);
  EXPECT_LT(less, 0.02 * 0.01);  // α ΔT of an element
  for (const PathRecord* each : {&edge, &full}) {
    EXPECT_NEAR(each->table.at("beam.max_elastic_strain").back(), e, 0.05 * e);
    EXPECT_NEAR(each->table.at("beam.end_ry").back(), s, 1e-9);  // far from the clamp
  }
}

// A hot beam on pin and roller. Its small deflection divided by that of the cold beam is s^(2-p),
// where s is the thermal stretch and p depends on `volume`: "grown", "grown_plane" and "reference"
// give 1/s, 1 and s². This law is exact for small deflections.
TEST(HotBeam, SmallDeflectionGoesWithThePowerOfTheStretch) {
  const auto deflection = [](const char* rise, const char* volume) {
    return path_of(
               "beam_heated_static",
               {std::string("body.heat.rise=") + rise, std::string("body.heat.volume=") + volume,
                "load.force=[0, -1]", "static.steps=1", "body.elements=8"})
        .table.at("beam.midpoint_deflection")
        .back();
  };
  const double cold = deflection("0", "grown"), s = 1 + 80e-6 * 200;
  EXPECT_NEAR(deflection("200", "grown") / cold, 1 / s, 1e-5);
  EXPECT_NEAR(deflection("200", "grown_plane") / cold, 1, 1e-5);
  EXPECT_NEAR(deflection("200", "reference") / cold, s * s, 1e-5);
}

// The equilibrium does not depend on whether loads grow before temperatures, after them, or
// together with them.
TEST(HotBeam, OrderOfLoadAndTemperatureIsOfNoMatter) {
  const auto deflection = [](const char* grows) {
    return path_of("beam_heated_static",
                   {"body.heat.rise=100", std::string("static.grows=") + grows,
                    "load.force=[0, -300]", "static.steps=3", "body.elements=8"})
        .table.at("beam.midpoint_deflection")
        .back();
  };
  const double loads = deflection("loads");
  EXPECT_NEAR(deflection("temperatures") / loads, 1, 1e-9);
  EXPECT_NEAR(deflection("both") / loads, 1, 1e-9);
}

constexpr const char* kArm = R"toml(
[[body]]
name = "arm"
element = "ancf_beam"
terms = ["inertia", "ecm"]
length = 0.5
height = 0.02
width = 0.01
density = 1000.0
youngs_modulus = 1e8
poisson_ratio = 0.3
elements = 4
[body.heat]
expansion = 1e-4
rise = 100.0
duration = 0.1
[[measure]]
body = "arm"
quantities = ["end_displacements"]
[[joint]]
type = "weld"
body = "arm"
edge = "root"
)toml";

// A beam welded to a hub and a beam welded to a rigid body that is driven like the hub have the
// same motion.
TEST(HotBeam, RidesOnARigidBodyAsInAHub) {
  const auto end = [](const std::string& rest, const std::string& weld) {
    const Scratch scratch;
    const std::string time = "[time]\nend = 0.2\nstep = 1e-3\nstart = \"rigid\"\n";
    const Scene scene =
        read_scene(io::CaseFile(scratch.write("arm.toml", time + rest + kArm + weld)));
    const MotionRecord r = run_motion(PreparedCase(scene), {}).record;
    return Vec2(r.table.at("arm.end_ux").back(), r.table.at("arm.end_uy").back());
  };
  for (const char* mode : {"partial", "edge", "full"}) {
    const std::string by = std::string("mode = \"") + mode + "\"\n";
    const Vec2 hub = end("[[hub]]\nname = \"hub\"\nposition = [0.1, 0.2]\nangular_velocity = 3.0\n",
                         "to = \"hub\"\n" + by);
    const Vec2 rigid =
        end("[[drive]]\nname = \"turn\"\nformula = \"3*t\"\n"
            "[[rigid_body]]\nname = \"crank\"\nmass = 1.0\nsize = [0.1, 0.1]\n"
            "position = [0.1, 0.2]\n",
            "to = \"crank\"\n" + by +
                "[[joint]]\ntype = \"revolute\"\nb = \"crank\"\n"
                "[[joint]]\ntype = \"angle_drive\"\nb = \"crank\"\nangle = \"turn\"\n");
    EXPECT_NEAR((hub - rigid).norm(), 0, 1e-8) << mode;
    EXPECT_GT(hub.norm(), 0.1) << mode;
  }
}

// An arc of a quarter circle whose supports do not hinder it expands by α ΔT in all directions.
TEST(HotBeam, ArcGrowsWithoutStress) {
  const PathRecord r =
      path_of("beam_heated_static",
              {"body.arc=1.5707963267948966", "body.heat.rise=100", "static.grows=temperatures",
               "load=[]", "joint.1.components=[\"y\"]", "body.elements=6"});
  const double R = 2 / std::numbers::pi;
  EXPECT_LE(largest_size(r.table.at("beam.max_elastic_strain")), 1e-11);
  // The root is held and the end keeps its height, therefore the expanded arc is rotated about the
  // root until its end is at this height.
  const double far = std::sqrt(2.0) * R, s = 1.008;
  const double angle = std::asin(1 / (std::sqrt(2.0) * s));
  EXPECT_NEAR(r.table.at("beam.end_ux").back(), s * far * std::cos(angle) - R, 1e-9);
}

}  // namespace
}  // namespace flexmorph::cases
