// Shows that starts of extending plates in space equal those in the plane without weight, and are
// equilibria under weight.
#include <gtest/gtest.h>

#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::ShapeSet;
using testing::uniform_lines;
using testing::vector;

constexpr double kWhole = 0.9, kLength = 0.4, kWidth = 0.1;

FrameMotion hub(double t) {
  FrameMotion out;
  out.origin = {0.2, -0.1};
  out.angle = 0.4 + 2 * t;
  out.angle_rate = 2;
  return out;
}

FrameMotion hub_at_rest(double) { return {}; }

/// Returns a plate that leaves its hub with this speed, in the plane or in space.
Workspace plate(int dim, double speed, const VectorXd& gravity, const FrameDrive& drive) {
  const PlaneSection section{0.005, 7e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  if (dim == 3) terms.push_back(make_bending(section));
  if (gravity.size() > 0) terms.push_back(make_gravity(section, gravity));
  auto lines = uniform_lines(kWhole - kLength, kWhole, 4);
  if (speed != 0)
    lines[0].drive = [speed](double t) { return Motion{kWhole - kLength - speed * t, -speed, 0}; };
  Workspace model;
  model.add_body(
      "plate", std::make_unique<AncfPlate>(dim, ShapeSet::h16, lines, uniform_lines(0, kWidth, 2)),
      section, std::move(terms));
  model.add_joint(make_weld("hub", "plate", "root", drive, WeldMode::edge));
  return model;
}

// Without weight there is no force out of the plane.
TEST(StartInSpace, IsThatOfThePlane) {
  for (const Start start : {Start::rigid, Start::prestretched}) {
    const std::vector<MovingRoot> moving_roots = {{"plate", hub}};
    Workspace plane = plate(2, 0.5, {}, hub), space = plate(3, 0.5, {}, hub);
    const State a = start_state(plane, moving_roots, 0, start),
                b = start_state(space, moving_roots, 0, start);
    for (int k = 0; k < plane.n_dofs() / 2; ++k) {
      EXPECT_LT((a.q.segment<2>(2 * k) - b.q.segment<2>(3 * k)).norm(), 1e-10) << k;
      // velocities are differences
      EXPECT_LT((a.v.segment<2>(2 * k) - b.v.segment<2>(3 * k)).norm(), 1e-6) << k;
      EXPECT_LT(std::abs(b.q[3 * k + 2]) + std::abs(b.v[3 * k + 2]), 1e-12) << k;
    }
  }
}

// In a fixed hub the start equals the equilibrium that load stepping finds from the undeformed
// plate.
TEST(StartInSpace, HangsUnderItsWeight) {
  const std::vector<MovingRoot> moving_roots = {{"plate", hub_at_rest}};
  const VectorXd gravity = vector(0, 0, -9.81);
  Workspace model = plate(3, 0, gravity, hub_at_rest);
  const State hanging = start_state(model, moving_roots, 0, Start::prestretched);
  State x = start_state(model, moving_roots, 0, Start::rigid);
  EXPECT_TRUE(solve_static(model, x).completed);
  EXPECT_LT(point_position(model.bodies()[0], x, {kWhole, 0.05}).z(), -0.03);
  EXPECT_LT((hanging.q - x.q).cwiseProduct(model.scales()).lpNorm<Eigen::Infinity>(), 1e-9);
  EXPECT_LT(hanging.v.lpNorm<Eigen::Infinity>(), 1e-9);
}

}  // namespace
}  // namespace flexmorph::fem
