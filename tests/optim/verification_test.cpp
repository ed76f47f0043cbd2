// Shows that verifications of outlines agree with closed forms, finer meshes and mirror images.
#include "optim/verification/verification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flexmorph::verification {
namespace {

std::vector<Vec2> rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

const fem::PlaneSection kUnit{1, 1, 0.3, 0};
const VerificationSettings kCoarse{.size = 0.5, .reach = 0.1};
constexpr double kLength = 8;

/// Returns a cantilever 8 x 1 of unit modulus, clamped at x = 0, with a force downwards at its end.
Loads tip_load() {
  Loads out;
  out.supports.push_back({out.add(box_location({{0, 0}, {0, 1}})), true, true});
  Load load;
  load.name = "tip";
  load.forces.push_back({out.add(box_location({{kLength, 0}, {kLength, 1}})), {0, -1}});
  out.loads.push_back(load);
  return out;
}

const std::vector<Region> kBeam = {{rectangle(0, 0, kLength, 1), {}}};

/// Returns the compliance under a unit force: bending, and shear with Cowper's coefficient.
double timoshenko(double length) {
  const double nu = kUnit.poisson_ratio, inertia = 1. / 12, kappa = 10 * (1 + nu) / (12 + 11 * nu);
  return std::pow(length, 3) / (3 * inertia) + 2 * (1 + nu) * length / kappa;
}

TEST(OutlineVerification, CantileverIsTimoshenkos) {
  const OutlineVerification found =
      verify_outline(kBeam, kUnit, tip_load(), {.tolerance = 0.001, .size = 0.5, .reach = 0.1});
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.compliance, timoshenko(kLength), 0.004 * timoshenko(kLength));
  EXPECT_LE(found.error, 0.001);
  EXPECT_EQ(found.n_connected_regions, 1);
  EXPECT_EQ(found.n_omitted_regions, 0);
  EXPECT_NEAR(found.area, kLength, 1e-12);
  // Reference at 0.1 from the clamp: 6 (L - x) / h².
  EXPECT_NEAR(found.largest_stress, 6 * (kLength - 0.1), 0.05 * 6 * kLength);
}

/// Returns a beam 20 x 1 with pins at the middle of its ends and no clamp.
Loads link_loads(bool floating, const Grid& grid) {
  Loads out;
  out.grid = grid;
  const Region border{rectangle(0, 0, 20, 1), {}};
  Balance& balance = out.balance.emplace();
  balance.floating = floating;
  for (size_t k = 0; k < 2; ++k) {
    const Vec2 at(k == 0 ? 0.0 : 20.0, 0.5);
    balance.pins[k] = {out.add(point_location(at, border, 0.25)), at, false};
  }
  return out;
}

// Reference: a link on two pins under its own inertia, M = q x (L - x) / 2, and a free link with a
// force at its middle, M = P x² / (2 L) up to the middle: 2 U = ∫ M² / EI + ∫ V² / (κ G A).
TEST(OutlineVerification, LinksBetweenTwoPinsAreBeams) {
  const std::vector<Region> beam = {{rectangle(0, 0, 20, 1), {}}};
  const double L = 20, EI = 1. / 12, shear = 2 * (1 + kUnit.poisson_ratio) * 1.2;
  Grid grid{.x0 = 0, .y0 = 0, .width = 20, .height = 1};
  grid.nx = 20;
  grid.ny = 1;
  fem::PlaneSection section = kUnit;
  section.density = 1;
  VectorXd acceleration = VectorXd::Zero(2 * grid.n_nodes());
  for (Eigen::Index k = 1; k < acceleration.size(); k += 2) acceleration[k] = 3;
  const VerificationSettings settings{.tolerance = 0.001, .size = 0.5, .reach = 0.5};

  Loads pinned = link_loads(false, grid);
  pinned.loads.push_back({.name = "inertia", .acceleration = &acceleration});
  const double q = 3;
  const double between = q * q * (std::pow(L, 5) / (120 * EI) + std::pow(L, 3) * shear / 12);
  EXPECT_NEAR(verify_outline(beam, section, pinned, settings).compliance, between, 0.01 * between);

  Loads floating = link_loads(true, grid);
  Load& push = floating.loads.emplace_back();
  push.name = "push";
  const Region border{rectangle(0, 0, 20, 1), {}};
  push.forces.push_back({floating.add(box_location({{9.9, 0}, {10.1, 1}})), {0, -2}});
  push.acceleration = &acceleration;  // a uniform acceleration causes no bending
  const double bent = 4 * (std::pow(L, 3) / (320 * EI) + L * shear / 12);
  EXPECT_NEAR(verify_outline(beam, section, floating, settings).compliance, bent, 0.01 * bent);
}

// Pins press on the rims of bores of a rotating link: the forces are balanced, act on the half of
// the rim in front of each pin, and carry the centrifugal force of the link.
TEST(OutlineVerification, PinsPressOnTheRimsOfBores) {
  Loads loads;
  loads.grid = {.x0 = 0, .y0 = -1, .width = 12, .height = 2};
  loads.grid.nx = 12;
  loads.grid.ny = 2;
  Balance& balance = loads.balance.emplace();
  Region link{rectangle(0, -1, 12, 1), {}};
  for (size_t k = 0; k < 2; ++k) {
    const Vec2 at(k == 0 ? 1.0 : 11.0, 0);
    std::vector<Vec2> bore = circle_within(at, 0.4, 1e-3);
    std::reverse(bore.begin(), bore.end());
    link.holes.push_back(bore);
    balance.pins[k] = {loads.add(border_location(bore)), at, true};
  }
  VectorXd acceleration = VectorXd::Zero(2 * loads.grid.n_nodes());
  for (int k = 0; k < loads.grid.n_nodes(); ++k)
    acceleration[2 * k] = -(k / 3);  // towards the end of the first pin, -X
  loads.loads.push_back({.name = "turning", .acceleration = &acceleration});
  fem::PlaneSection section = kUnit;
  section.density = 1;
  const std::vector<Region> regions = {link};
  const OutlineVerification found =
      verify_outline(regions, section, loads, {.tolerance = 0.002, .size = 0.3, .reach = 0.1});
  ASSERT_EQ(found.mesh_loads.size(), 1u);
  Vec2 sum = Vec2::Zero();
  double moment = 0, pressed = 0;
  for (const fem::NodalForce& f : found.mesh_loads[0].forces) {
    const Vec2& p = found.mesh.point(f.node);
    sum += f.force;
    moment += p.x() * f.force.y() - p.y() * f.force.x();
    if ((p - Vec2(1, 0)).norm() < 0.401 && f.force.x() < -1e-3) {
      EXPECT_LT(p.x(), 1 + 1e-6);  // the pin of the first bore pulls to the left
      pressed -= f.force.x();
    }
  }
  EXPECT_LT(sum.norm(), 1e-9 * pressed);
  EXPECT_LT(std::abs(moment), 1e-9 * pressed * 12);
  // The first pin carries all of ρ x dA: 12² for the plate, minus the bores.
  const double bores = std::numbers::pi * 0.16 * (1 + 11);
  EXPECT_NEAR(pressed, 144 - bores, 0.02 * 144);
}

// Tension of a plate with a small hole. Reference: three times the stress far away (Kirsch's
// solution); for a hole of a twentieth of the width 3.008 (Heywood's formula).
TEST(OutlineVerification, HoleHasThreeTimesTheStress) {
  std::vector<Vec2> hole;
  constexpr int kSides = 240;
  for (int k = 0; k < kSides; ++k) {  // clockwise, with a vertex where the stress is largest
    const double angle = -2 * std::numbers::pi * k / kSides;
    hole.emplace_back(std::sin(angle), std::cos(angle));
  }
  const std::vector<Region> plate = {{rectangle(-20, -20, 20, 20), {hole}}};
  Loads loads;
  loads.supports.push_back({loads.add(box_location({{-20, -20}, {-20, 20}})), true, false});
  const Region border{rectangle(-20, -20, 20, 20), {}};
  loads.supports.push_back({loads.add(point_location({-20, -20}, border, 0.01)), false, true});
  Load load;
  load.forces.push_back({loads.add(box_location({{20, -20}, {20, 20}})), {40, 0}});
  loads.loads.push_back(load);
  const OutlineVerification found =
      verify_outline(plate, kUnit, loads, {.tolerance = 2e-5, .size = 2, .reach = 1});
  EXPECT_NEAR(found.largest_stress, 3.008, 0.03 * 3.008);
  EXPECT_NEAR(std::abs(found.largest_at.y()), 1, 0.02);
}

Loads bracket_load() {
  Loads out;
  out.supports.push_back({out.add(box_location({{0, 1}, {0.4, 1}})), true, true});
  Load load;
  load.name = "foot";
  load.forces.push_back({out.add(box_location({{1, 0.3}, {1, 0.4}})), {0, -1}});
  out.loads.push_back(load);
  return out;
}

const std::vector<Region> kBracket = {
    {{{0, 0}, {1, 0}, {1, 0.4}, {0.4, 0.4}, {0.4, 1}, {0, 1}}, {}}};

// At a re-entrant corner of 270 degrees and at the ends of a clamp stresses have no limit; the
// error estimate must hold there, too.
TEST(OutlineVerification, EstimatesItsErrorAtACorner) {
  const auto at = [](double tolerance) {
    return verify_outline(kBracket, kUnit, bracket_load(),
                          {.tolerance = tolerance, .size = 0.3, .reach = 0.02});
  };
  const double exact = at(1e-4).compliance;
  for (const double tolerance : {0.03, 0.005}) {
    const OutlineVerification found = at(tolerance);
    const double error = exact / found.compliance - 1;
    EXPECT_TRUE(found.converged);
    EXPECT_LE(found.error, tolerance);
    EXPECT_GT(error, 0) << "compliances come from below";
    EXPECT_LE(error, 1.1 * found.error) << "at " << tolerance;
    EXPECT_GE(error, 0.05 * found.error) << "at " << tolerance;
  }
}

// A smooth field on uniform meshes: the error of the energy decreases with h⁴.
TEST(OutlineVerification, CompliancesConvergeWithOrderFour) {
  // A square that rotates about its corner, held by its two lines of symmetry.
  const std::vector<Region> square = {{rectangle(0, 0, 1, 1), {}}};
  const fem::PlaneSection heavy{1, 1, 0.3, 1};
  Loads loads;
  loads.supports.push_back({loads.add(box_location({{0, 0}, {0, 1}})), true, false});
  loads.supports.push_back({loads.add(box_location({{0, 0}, {1, 0}})), false, true});
  loads.grid = {0, 0, 1, 1, 1, 1};
  VectorXd acceleration(8);
  for (int node = 0; node < 4; ++node)
    acceleration.segment<2>(2 * node) = -loads.grid.node_position(node / 2, node % 2);
  Load load;
  load.acceleration = &acceleration;
  loads.loads.push_back(load);
  const auto at = [&](double size) {
    return verify_outline(square, heavy, loads,
                          {.tolerance = 1e-12, .size = size, .reach = 0.01, .max_meshes = 1});
  };
  const double exact = at(0.03).compliance;
  const OutlineVerification coarse = at(0.24), fine = at(0.08);
  // The meshes are unstructured, therefore the order refers to the mean size of triangles.
  const double ratio = static_cast<double>(fine.mesh.triangles.size()) /
                       static_cast<double>(coarse.mesh.triangles.size());
  const double order =
      2 * std::log((exact - coarse.compliance) / (exact - fine.compliance)) / std::log(ratio);
  EXPECT_NEAR(order, 4, 0.6);
  // Recovered stresses estimate the error.
  EXPECT_NEAR(coarse.error * coarse.compliance / (exact - coarse.compliance), 1, 0.5);
}

/// A rod along x that rotates about the origin, in the rotating frame: a = -ω² x.
struct SpinningRod {
  Loads loads;
  VectorXd acceleration;

  SpinningRod(double length, std::span<const double> clamps) {
    loads.grid = {0, -0.1, length, 0.2, 7, 3};
    acceleration.setZero(2 * loads.grid.n_nodes());
    for (int node = 0; node < loads.grid.n_nodes(); ++node)
      acceleration[2 * node] = -loads.grid.node_position(node / 4, node % 4).x();
    for (const double x : clamps) {
      Load load;
      load.name = "clamp at " + std::to_string(x);
      load.clamp = x;
      load.acceleration = &acceleration;
      loads.loads.push_back(load);
    }
  }
  SpinningRod(const SpinningRod&) = delete;
};

// Reference for a rod without Poisson's effect: N = ρ A (L² - x²) / 2, C = ∫ N² dx / (E A).
TEST(OutlineVerification, SpinningRodFromClampToClamp) {
  const double length = 2, area = 0.2;
  const fem::PlaneSection section{1, 7, 0, 3};
  const std::vector<double> clamps = {0.5, 1.1, 0, 0.5};  // in any order, one of them two times
  const SpinningRod rod(length, clamps);
  const std::vector<Region> bar = {{rectangle(0, -0.1, length, 0.1), {}}};
  const OutlineVerification found =
      verify_outline(bar, section, rod.loads, {.size = 0.2, .reach = 0.01});
  ASSERT_EQ(found.compliances.size(), 4u);
  double sum = 0;
  for (std::size_t l = 0; l < clamps.size(); ++l) {
    const auto integral = [&](double x) {  // ∫ (L² - x²)² dx
      return std::pow(length, 4) * x - 2 * length * length * std::pow(x, 3) / 3 +
             std::pow(x, 5) / 5;
    };
    const double exact =
        9 * area * area / 4 * (integral(length) - integral(clamps[l])) / (7 * area);
    EXPECT_NEAR(found.compliances[l], exact, 1e-4 * exact);
    sum += exact;
  }
  EXPECT_NEAR(found.compliance, sum, 1e-4 * sum);
  // The worst load is exported as mesh_loads, with the region behind its clamp held.
  ASSERT_EQ(found.mesh_loads.size(), 1u);
  EXPECT_EQ(found.mesh_loads[0].load, 2);
  double force = 0;
  for (const fem::NodalForce& f : found.mesh_loads[0].forces) force += f.force.x();
  EXPECT_NEAR(force, 3 * area * length * length / 2, 1e-9);
}

TEST(OutlineVerification, LoadsOfOneBodyAreThoseOfMany) {
  Loads two = tip_load();
  Load pull;
  pull.name = "pull";
  pull.weight = 3;
  pull.forces.push_back({two.add(box_location({{kLength, 0}, {kLength, 1}})), {5, 0}});
  two.loads.push_back(pull);
  const VerificationSettings settings{.size = 0.5, .reach = 0.1};
  const OutlineVerification both = verify_outline(kBeam, kUnit, two, settings);
  EXPECT_NEAR(both.compliance, both.compliances[0] + 3 * both.compliances[1],
              1e-12 * both.compliance);
  EXPECT_NEAR(both.compliances[1], 25 * kLength, 0.01 * 25 * kLength);
  two.worst = true;
  const OutlineVerification worst = verify_outline(kBeam, kUnit, two, settings);
  EXPECT_EQ(worst.compliance,
            *std::max_element(worst.compliances.begin(), worst.compliances.end()));
  EXPECT_EQ(worst.mesh_loads.size(), 2u);
}

TEST(OutlineVerification, PointsAreSpreadOverACell) {
  const Region border{rectangle(0, 0, kLength, 1), {}};
  const Location middle = point_location({kLength, 0.5}, border, 0.1);
  ASSERT_EQ(middle.lines.size(), 1u);
  EXPECT_NEAR((middle.lines[0].b - middle.lines[0].a).norm(), 0.2, 1e-15);
  const Location corner = point_location({0, 1}, border, 0.1);
  ASSERT_EQ(corner.lines.size(), 2u);
  for (const Segment& s : corner.lines) EXPECT_NEAR((s.b - s.a).norm(), 0.1, 1e-15);
  const Location inside = point_location({4, 0.5}, border, 0.1);
  EXPECT_TRUE(inside.lines.empty());
  ASSERT_EQ(inside.area.size(), 4u);
  // The beam bends equally wherever on its end the unit force is distributed.
  Loads loads = tip_load();
  loads.locations[1] = middle;
  const OutlineVerification found = verify_outline(kBeam, kUnit, loads, kCoarse);
  EXPECT_NEAR(found.compliance, timoshenko(kLength), 0.01 * timoshenko(kLength));
  loads.locations[1] = point_location({kLength - 0.3, 0.5}, border, 0.1);
  EXPECT_LT(verify_outline(kBeam, kUnit, loads, kCoarse).compliance, found.compliance);
}

TEST(OutlineVerification, PiecesThatNothingHoldsAreLeftOut) {
  std::vector<Region> regions = kBeam;
  regions.push_back({rectangle(3, 2, 4, 3), {}});
  const OutlineVerification alone = verify_outline(kBeam, kUnit, tip_load(), kCoarse);
  const OutlineVerification found = verify_outline(regions, kUnit, tip_load(), kCoarse);
  EXPECT_EQ(found.n_connected_regions, 2);
  EXPECT_EQ(found.n_omitted_regions, 1);
  EXPECT_NEAR(found.compliance, alone.compliance, 0.01 * alone.compliance);
  EXPECT_NEAR(found.area, kLength + 1, 1e-12);
}

// A part that is hot and held at its root, with a cold far edge, is the mirror image of a part that
// is hot and held at its far edge, except for a rigid motion. One edge is prescribed, the other one
// is held by springs, also across the gap between two legs.
TEST(OutlineVerification, HeldEdgeIsTheMirrorOfAHotClamp) {
  constexpr double kHot = 2e-3, kEnd = 2;
  const std::vector<Vec2> outer = {{0, -0.5}, {1, -0.4}, {kEnd, -0.6}, {kEnd, 0.3}, {1, 0.5},
                                   {0, 0.4},  {0, 0.2},  {0.7, 0.1},   {0.7, -0.2}, {0, -0.3}};
  std::vector<Vec2> mirrored(outer.rbegin(), outer.rend());
  for (Vec2& p : mirrored) p.x() = kEnd - p.x();
  const fem::PlaneSection section{1, 7, 0.3, 0};
  const auto compliance = [&](const std::vector<Vec2>& part, double root, double end) {
    Loads loads;
    Load load;
    load.clamp = 0;
    load.held_stretch = root;
    load.held_end_stretch = end;
    loads.loads.push_back(load);
    loads.held_edge = {kEnd, 1e4 * section.youngs_modulus * section.thickness};
    const OutlineVerification found =
        verify_outline(std::vector<Region>{{part, {}}}, section, loads,
                       {.tolerance = 5e-4, .size = 0.1, .reach = 0.05, .max_triangles = 40000});
    EXPECT_TRUE(found.mesh_loads.empty());
    return found.compliance;
  };
  const double hot_root = compliance(outer, kHot, 0), hot_end = compliance(mirrored, 0, kHot);
  EXPECT_GT(hot_root, 0);
  EXPECT_NEAR(hot_end, hot_root, 2e-3 * hot_root);
}

// A region that can rotate about its only held point is not supported.
TEST(OutlineVerification, LoadsOnLoosePiecesMakeTheComplianceInfinite) {
  const std::vector<Region> parts = {{rectangle(0, 0, 3, 1), {}}, {rectangle(4, 0, 8, 1), {}}};
  const OutlineVerification loose = verify_outline(parts, kUnit, tip_load(), kCoarse);
  EXPECT_EQ(loose.compliance, INFINITY);
  EXPECT_EQ(loose.unsupported_load, "tip");
  EXPECT_EQ(loose.n_omitted_regions, 1);
  Loads sliding = tip_load();
  sliding.supports[0].y = false;
  EXPECT_EQ(verify_outline(kBeam, kUnit, sliding, kCoarse).compliance, INFINITY);
  Loads nowhere = tip_load();
  nowhere.locations[1] = box_location({{20, 0}, {20, 1}});
  EXPECT_EQ(verify_outline(kBeam, kUnit, nowhere, kCoarse).compliance, INFINITY);
}

TEST(OutlineVerification, IsTheSameBitForBit) {
  const VerificationSettings settings{.tolerance = 0.001, .size = 0.2, .reach = 0.02};
  const OutlineVerification a = verify_outline(kBracket, kUnit, bracket_load(), settings);
  std::vector<std::vector<double>> other;  // other addresses in memory
  for (int k = 1; k < 2000; ++k) other.emplace_back(static_cast<std::size_t>(k % 97 + 1));
  const OutlineVerification b = verify_outline(kBracket, kUnit, bracket_load(), settings);
  EXPECT_EQ(a.compliance, b.compliance);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.largest_stress, b.largest_stress);
}

TEST(OutlineVerification, EndsWhenItIsAskedTo) {
  int asked = 0;
  VerificationSettings settings{.tolerance = 1e-5, .size = 0.2, .reach = 0.02};
  settings.keep_running = [&] { return ++asked < 3; };
  const OutlineVerification found = verify_outline(kBracket, kUnit, bracket_load(), settings);
  EXPECT_EQ(found.meshes, 3);
  EXPECT_FALSE(found.converged);
  EXPECT_GT(found.compliance, 0);
}

TEST(OutlineVerification, SaysWhatItLacks) {
  EXPECT_THROW(verify_outline(kBeam, kUnit, {}, {.size = 0.5}), Error);
  EXPECT_THROW(verify_outline({}, kUnit, tip_load(), {.size = 0.5}), Error);
}

}  // namespace
}  // namespace flexmorph::verification
