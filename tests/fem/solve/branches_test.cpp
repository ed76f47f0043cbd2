// Shows that blocks of a Jacobian are found, that a step to another branch of a loop is detected,
// and that redundant rows are left out, checked, and have multipliers of least norm.
#include <gtest/gtest.h>

#include <numbers>

#include "fem/solve/branch_watch.h"
#include "fem/solve/kinematics.h"
#include "fem/solve/redundancy.h"
#include "tests/support/errors.h"
#include "tests/support/point_mechanisms.h"

namespace flexmorph::fem {
namespace {

using testing::add;
using testing::constant;
using testing::error_of;
using testing::FourBar;
using testing::linear;
using testing::LinearRow;
using testing::locations;
using testing::mentions;
using testing::point_model;
using testing::Rod;
using Parts = std::vector<LinearRow::Part>;

// After a permutation [2 1 0; 0 0 -3; 0 5 4] is triangular with the blocks 2, -3 and 5.
TEST(BlockDeterminants, AreThoseOfTheBlocks) {
  SparseMatrix a(3, 3);
  a.insert(0, 0) = 2;
  a.insert(0, 1) = 1;
  a.insert(1, 2) = -3;
  a.insert(2, 1) = 5;
  a.insert(2, 2) = 4;
  a.makeCompressed();
  BlockDeterminants blocks;
  blocks.analyze(a);
  const std::vector<Determinant> found = blocks.of(a);
  double logarithm = 0;
  int sign = 1;
  for (const Determinant& each : found) {
    logarithm += each.logarithm;
    sign *= each.sign;
  }
  EXPECT_NEAR(logarithm, std::log(30.0), 1e-14);
  EXPECT_EQ(std::abs(sign), 1);
  EXPECT_EQ(found.size(), 3u);
}

/// Returns q with the rocker pin mirrored at the line from the crank pin to the rocker's bearing.
VectorXd mirrored(const FourBar& bar, const VectorXd& q) {
  const Vec2 a = q.head<2>(), e = (Vec2(bar.g, 0) - a).normalized(), d = q.tail<2>() - a;
  VectorXd out = q;
  out.tail<2>() = a + 2 * e.dot(d) * e - d;
  return out;
}

// The points of this model are not rigid bodies; therefore the kinematic path is tested, and the
// monitor of time steps with rigid bodies by tests/cases/run/closed_loops_test.cpp.
TEST(Branches, APathDoesNotChangeToTheMirroredBranch) {
  // A parallelogram whose crank is 1e-4 m too short: the branches almost meet at 0 and π.
  const FourBar bar{.r = 0.2999, .l = 0.5, .s = 0.3, .g = 0.5};
  const testing::Course angle = linear(0.8, 2 * std::numbers::pi);
  Workspace model = bar.model(angle);
  Kinematics motion(model, model.reference(), {.largest_step = 10});
  for (const double t : {0.3, 1.0, 4.7}) {
    const VectorXd exact = bar.locations(angle(t).value);
    EXPECT_LT((motion.at(t).q - exact).lpNorm<Eigen::Infinity>(), 1e-9) << t;
    EXPECT_GT((mirrored(bar, exact) - exact).norm(), 0.01);
  }
}

/// A platform of three points on equal, parallel cranks, which a drive turns.
Workspace parallel_cranks(double angle, double rate) {
  const std::vector<Vec2> ground = {{0, 0}, {1, 0}, {0.4, 0.5}};
  const Vec2 crank = 0.3 * Vec2(std::cos(angle), std::sin(angle));
  std::vector<Vec2> points;
  for (const Vec2& g : ground) points.push_back(g + crank);
  Workspace model = point_model(locations(points));
  add<testing::AngleDrive>(model, "motor", 0, linear(angle, rate));
  for (int i = 0; i < 3; ++i)
    add<Rod>(model, "crank_" + std::to_string(i), i, -1, constant(0.3),
             ground[static_cast<size_t>(i)]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    add<Rod>(model, "side_" + std::to_string(i), i, j,
             constant((ground[static_cast<size_t>(i)] - ground[static_cast<size_t>(j)]).norm()));
  }
  return model;
}

// The platform is at a dead centre of two of its cranks six times in a revolution, where the third
// crank determines the motion.
TEST(RedundantRows, APathPassesDeadCentresOfOtherJoints) {
  Workspace model = parallel_cranks(0.4, 2 * std::numbers::pi);
  Kinematics motion(model, model.reference());
  EXPECT_EQ(model.left_out_rows().size(), 1u);
  for (int k = 0; k <= 40; ++k) {
    const double t = 0.05 * k, angle = 0.4 + 2 * std::numbers::pi * t;
    const Vec2 crank = 0.3 * Vec2(std::cos(angle), std::sin(angle));
    const VectorXd q = motion.at(t).q;
    EXPECT_LT((q.segment<2>(0) - crank).norm(), 1e-9);
    EXPECT_LT((q.segment<2>(2) - Vec2(1, 0) - crank).norm(), 1e-9);
    EXPECT_LT((q.segment<2>(4) - Vec2(0.4, 0.5) - crank).norm(), 1e-9);
  }
}

// x = 1 is held twice, y once. The two holds share the force equally, and the force on y stays.
TEST(RedundantRows, MultipliersHaveTheLeastNorm) {
  Workspace model = point_model(locations({{1, 2}}));
  add<LinearRow>(model, "a", Parts{{0, 0}}, constant(1));
  add<LinearRow>(model, "y", Parts{{0, 1}}, constant(2));
  add<LinearRow>(model, "b", Parts{{0, 0, 4}}, constant(4));  // the same row times 4
  State x = model.reference();
  leave_out_redundant(model, x);
  ASSERT_EQ(model.left_out_rows().size(), 1u);
  EXPECT_EQ(redundant_joints(model), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(model.n_kept_constraints(), 2);
  x.lambda << 6, 5, 0;
  const VectorXd least = least_multipliers(model, x);
  EXPECT_NEAR(least[0], 3, 1e-14);
  EXPECT_NEAR(least[1], 5, 1e-14);
  EXPECT_NEAR(4 * least[2], 3, 1e-14);
  Constraints c;
  model.constraints(x, c);
  const int left_out = model.left_out_rows()[0];
  EXPECT_EQ(c.value[left_out], 0);
  x.q[0] = 1.5;
  const LeftOutMiss miss = left_out_miss(model, x.q, 0);
  EXPECT_TRUE(miss.is_large);
  EXPECT_NEAR(miss.miss, 0.5, 1e-14);
}

// Where a parallelogram is flat, its joints depend on each other only there.
TEST(RedundantRows, ASingularStartIsRefused) {
  Workspace model = point_model(locations({{0.3, 0}, {0.8, 0}}));
  add<Rod>(model, "crank", 0, -1, constant(0.3));
  add<Rod>(model, "coupler", 0, 1, constant(0.5));
  add<Rod>(model, "rocker", 1, -1, constant(0.3), Vec2(0.5, 0));
  const State x = model.reference();
  EXPECT_EQ(diagnose(model, x).rank, 2);
  const std::string text = error_of(Error::Kind::input, [&] { leave_out_redundant(model, x); });
  EXPECT_TRUE(mentions(text, "singular")) << text;
  EXPECT_TRUE(model.left_out_rows().empty());
}

// A copy of a model leaves out the rows of the original.
TEST(RedundantRows, AreCopiedWithTheModel) {
  Workspace model = parallel_cranks(0.4, 1);
  leave_out_redundant(model, model.reference());
  const Workspace copy(model);
  EXPECT_EQ(copy.left_out_rows(), model.left_out_rows());
  EXPECT_EQ(copy.redundant_rows(), model.redundant_rows());
}

}  // namespace
}  // namespace flexmorph::fem
