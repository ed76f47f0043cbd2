// Growing plates in space: an inserted line changes no point's place and no momentum, starts
// without weight are those of the plane, and starts under weight are equilibria.
#include <gtest/gtest.h>

#include "fem/dynamics/motion.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::even_lines;
using testing::ShapeSet;
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

/// A plate that leaves its hub with this speed, in the plane or in space.
Model plate(int dim, double speed, const VectorXd& gravity, const FrameDrive& drive) {
  const PlaneSection section{0.005, 7e8, 0.3, 2700};
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(section));
  terms.push_back(make_membrane(section));
  if (dim == 3) terms.push_back(make_bending(section));
  if (gravity.size() > 0) terms.push_back(make_gravity(section, gravity));
  auto lines = even_lines(kWhole - kLength, kWhole, 4);
  if (speed != 0)
    lines[0].drive = [speed](double t) { return Motion{kWhole - kLength - speed * t, -speed, 0}; };
  Model model;
  model.add_body("plate",
                 std::make_unique<AncfPlate>(dim, ShapeSet::h16, lines, even_lines(0, kWidth, 2)),
                 section, std::move(terms));
  model.add_joint(make_weld("hub", "plate", "root", drive, WeldMode::edge));
  return model;
}

TEST(GrowthInSpace, InsertionLeavesFieldsAndMomentumUnchanged) {
  Model model = plate(3, 0.5, {}, hub);
  State x = start_state(model, std::vector<Growth>{{"plate", hub}}, 0, Start::rigid);
  x.t = 0.05;
  model.prepare(x.t);
  const VectorXd scales = model.scales();
  for (Eigen::Index k = 0; k < x.q.size(); ++k) {  // anything smooth in each element
    x.q[k] += 0.05 * std::sin(1.0 + 0.7 * static_cast<double>(k)) / scales[k];
    x.v[k] += 0.3 * std::cos(2.0 + 0.9 * static_cast<double>(k)) / scales[k];
  }
  Body& body = model.bodies()[0];
  std::vector<Vec2> points;
  const double root = grid_of(body).line_m(0).value;
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; j <= 4; ++j)
      points.emplace_back(root + (kWhole - root) * i / 20, kWidth * j / 4);
  std::vector<Vec3> before;
  for (const Vec2& p : points) before.push_back(point_position(body, x, p));
  const Vec3 momentum = momentum_in_space(model, x);
  EXPECT_GT(std::abs(before.back().z()), 1e-3);
  EXPECT_GT(std::abs(momentum.z()), 1e-4);

  change_mesh(model, body, MeshChange::insertion, x);
  EXPECT_EQ(grid_of(body).n_m(), 5);
  EXPECT_EQ(x.q.size(), model.n_dofs());
  for (size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((point_position(body, x, points[i]) - before[i]).norm(), 1e-13);
  EXPECT_LT((momentum_in_space(model, x) - momentum).norm(), 1e-13 * momentum.norm());
}

// Without weight nothing pulls out of the plane.
TEST(GrowthInSpace, StartsAsInThePlane) {
  for (const Start start : {Start::rigid, Start::prestretched}) {
    const std::vector<Growth> growths = {{"plate", hub}};
    Model plane = plate(2, 0.5, {}, hub), space = plate(3, 0.5, {}, hub);
    const State a = start_state(plane, growths, 0, start),
                b = start_state(space, growths, 0, start);
    for (int k = 0; k < plane.n_dofs() / 2; ++k) {
      EXPECT_LT((a.q.segment<2>(2 * k) - b.q.segment<2>(3 * k)).norm(), 1e-10) << k;
      EXPECT_LT((a.v.segment<2>(2 * k) - b.v.segment<2>(3 * k)).norm(), 1e-6) << k;  // differences
      EXPECT_LT(std::abs(b.q[3 * k + 2]) + std::abs(b.v[3 * k + 2]), 1e-12) << k;
    }
  }
}

// In a hub at rest the start is what load stepping finds from the undeformed plate.
TEST(GrowthInSpace, StartsHangingUnderItsWeight) {
  const std::vector<Growth> growths = {{"plate", hub_at_rest}};
  const VectorXd gravity = vector(0, 0, -9.81);
  Model model = plate(3, 0, gravity, hub_at_rest);
  const State hanging = start_state(model, growths, 0, Start::prestretched);
  State x = start_state(model, growths, 0, Start::rigid);
  EXPECT_TRUE(solve_static(model, x).completed);
  EXPECT_LT(point_position(model.bodies()[0], x, {kWhole, 0.05}).z(), -0.03);
  EXPECT_LT((hanging.q - x.q).cwiseProduct(model.scales()).lpNorm<Eigen::Infinity>(), 1e-9);
  EXPECT_LT(hanging.v.lpNorm<Eigen::Infinity>(), 1e-9);
}

}  // namespace
}  // namespace flexmorph::fem
