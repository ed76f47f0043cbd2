// Shows that the energy balance of plates in space has an error of order 2 in the step while
// material flows and the plate bends: out of a hub at a given speed, and through a sleeve with a
// free line of nodes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/rates.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::ShapeSet;
using testing::uniform_lines;
using testing::vector;

/// Returns a frame that rotates about z at the origin.
FrameDrive turning(double rate) {
  return [rate](double t) {
    FrameMotion out;
    out.angle = rate * t;
    out.angle_rate = rate;
    return out;
  };
}

struct Books {
  double energy_error = 0;                 ///< Largest energy error [J].
  double relative = 0;                     ///< Value of MotionResult::energy_error.
  double drive = 0, feed = 0, inflow = 0;  ///< Work of each power [J].
};

Books run(testing::Scene scene, double h, double end, Start start) {
  MotionSettings settings;
  settings.step = h;
  settings.end = end;
  settings.start = start;
  Books out;
  Powers last;
  double t = 0;
  out.relative = integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& step) {
                   const double half = 0.5 * (step.x.t - t);
                   out.drive += half * (last.drive + step.powers.drive);
                   out.feed += half * (last.feed + step.powers.feed);
                   out.inflow += half * (last.inflow + step.powers.inflow);
                   out.energy_error = std::max(out.energy_error, std::abs(step.energy_error));
                   last = step.powers;
                   t = step.x.t;
                 }).energy_error;
  return out;
}

/// Returns cases/deploying_plate.toml: a plate slides out of a slowly rotating hub, with gravity
/// across.
testing::Scene deploying(const std::string& membrane, int n = 8) {
  const PlaneSection section{0.005, 7e9, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  for (const std::string& name : {std::string("inertia"), membrane, std::string("bending")})
    terms.push_back(make_term(name, section));
  terms.push_back(make_gravity(section, vector(0, 0, -9.81)));
  auto lines = uniform_lines(0.5, 0.9, n);
  lines[0].drive = [](double t) { return Motion{0.5 - 0.5 * t, -0.5, 0}; };
  testing::Scene out;
  out.model.add_body("plate",
                     std::make_unique<AncfPlate>(3, ShapeSet::h16, lines, uniform_lines(0, 0.1, 2)),
                     section, std::move(terms));
  out.model.add_joint(make_weld("hub", "plate", "root", turning(0.5), WeldMode::edge));
  out.moving_roots = {{"plate", turning(0.5), 0.8 / n, 0.24 / n}};
  return out;
}

void print(const char* name, const Books& b) {
  std::printf(
      "%s: defect %.2e J, relative %.1e; work of the drive %.2e, feed %.2e, inflow %.2e J\n", name,
      b.energy_error, b.relative, b.drive, b.feed, b.inflow);
}

void expect_order_two(const char* name, const std::function<Books(double)>& books) {
  Books finest;
  const auto rate = testing::fit_rate({1e-3, 5e-4, 2.5e-4, 1.25e-4}, [&](double h) {
    finest = books(h);
    print(name, finest);
    return finest.energy_error;
  });
  std::printf("%s\n", rate.table().c_str());
  EXPECT_NEAR(rate.order(), 2, 0.2) << rate.table();
  EXPECT_LT(finest.relative, 1e-4);
  // Every power is necessary: without the smallest one the error of the balance would be far
  // larger.
  for (const double work : {finest.drive, finest.feed, finest.inflow}) {
    if (work != 0) {
      EXPECT_GT(std::abs(work), 100 * finest.energy_error);
    }
  }
}

TEST(EnergyBalanceInSpace, OfADeployingPlateIsOfOrderTwo) {
  for (const char* membrane : {"membrane", "membrane_assumed"})
    expect_order_two(
        membrane, [&](double h) { return run(deploying(membrane), h, 0.1, Start::prestretched); });
}

/// Returns the energy loss within 20 ms after the first insertion, relative to the strain energy.
double loss_in_space(int n, double h) {
  testing::Scene scene = deploying("membrane_assumed", n);
  MotionSettings settings;
  settings.step = h;
  settings.end = 0.4 / n / 0.5 + 0.02;
  double strain = 0, energy_error = 0;
  const MotionResult r =
      integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& s) {
        strain = s.energies.strain;
        energy_error = s.energy_error;
      });
  EXPECT_EQ(r.events.size(), 1u);
  return -energy_error / strain;
}

// The state is no equilibrium of the richer mesh and relaxes, as in the plane
// (growing_plate_test.cpp): the loss is smaller on finer meshes and does not depend on the step.
// Powers of multipliers of the old mesh would cause an error of the order of the step.
TEST(EnergyBalanceInSpace, LosesByInsertionsWhatTheRicherMeshSetsFree) {
  const double coarse = loss_in_space(4, 5e-4), middle = loss_in_space(8, 5e-4),
               fine = loss_in_space(16, 5e-4), twice = loss_in_space(8, 1e-3);
  std::printf("loss / strain energy: %.2e, %.2e, %.2e with 4, 8, 16 elements; %.2e with 2 h\n",
              coarse, middle, fine, twice);
  EXPECT_LT(middle, 0.6 * coarse);
  EXPECT_LT(fine, 0.6 * middle);
  EXPECT_NEAR(twice / middle, 1, 0.2);
}

/// Returns a strip that slides out of a sleeve with a free root line: the sleeve rotates about the
/// vertical, so that the strip is thrown out of it while it sags.
testing::Scene flying_out(double at_start) {
  const PlaneSection section{0.005, 1e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  for (const char* name : {"inertia", "membrane", "bending"})
    terms.push_back(make_term(name, section));
  terms.push_back(make_gravity(section, vector(0, 0, -9.81)));
  auto lines = uniform_lines(0, 0.3, 5);
  lines[0].free = true;
  testing::Scene out;
  out.model.add_body(
      "strip", std::make_unique<AncfPlate>(3, ShapeSet::h16, lines, uniform_lines(0, 0.05, 1)),
      section, std::move(terms));
  out.model.add_joint(make_weld("sleeve", "strip", "root", turning(3), WeldMode::direction));
  out.moving_roots = {{"strip", turning(3), 0.2, 0.01, 0, at_start}};
  return out;
}

// The motion of the line has no power; the material that comes out of the sleeve carries kinetic
// energy and weight, but no strain energy.
TEST(EnergyBalanceInSpace, OfAFreeRootLineIsOfOrderTwo) {
  expect_order_two("free root",
                   [&](double h) { return run(flying_out(-0.3), h, 0.1, Start::rigid); });
}

}  // namespace
}  // namespace flexmorph::fem
