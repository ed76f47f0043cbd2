// Shows that mechanisms are assembled with the smallest motion of mass, and that joints which
// cannot be assembled are named.
#include "fem/solve/assembly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "fem/solve/diagnosis.h"
#include "tests/support/differences.h"
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

// Two masses at a rod are moved along the line between them, their centre of mass does not move,
// and the speeds along the rod become equal as in an inelastic impact. Every mass is increased by
// 1e-8 of the mean mass (assembly.h).
TEST(Assembly, MovesTheLeastMass) {
  const double extra = 1e-8 * 2.5, m1 = 1 + extra, m2 = 4 + extra, length = 2;
  Workspace model = point_model(locations({{0, 0}, {3, 4}}), Vec2(1, 4));
  add<Rod>(model, "rod", 0, 1, constant(length));
  State x = model.reference();
  x.v << 1, 2, -3, 1;
  const Vec2 along(0.6, 0.8), v1 = x.v.head<2>(), v2 = x.v.tail<2>();
  const Assembly report = assemble(model, x);
  const Vec2 centre = m2 * Vec2(3, 4) / (m1 + m2);
  EXPECT_LT((x.q.head<2>() - (centre - m2 / (m1 + m2) * length * along)).norm(), 1e-12);
  EXPECT_LT((x.q.tail<2>() - (centre + m1 / (m1 + m2) * length * along)).norm(), 1e-12);
  const double impulse = m1 * m2 / (m1 + m2) * (v2 - v1).dot(along);
  EXPECT_LT((x.v.head<2>() - (v1 + impulse / m1 * along)).norm(), 1e-12);
  EXPECT_LT((x.v.tail<2>() - (v2 - impulse / m2 * along)).norm(), 1e-12);
  EXPECT_NEAR(report.displacement, 0.8 * 3 * m2 / (m1 + m2), 1e-12);  // y of the lighter mass
  EXPECT_LE(report.iterations, 12);
}

// From starts that are up to 20 % of the length of the coupler away, positions must equal the
// closed form and velocities differences of it.
TEST(Assembly, FourBarFromAStartFarOff) {
  const FourBar bar;
  const double speed = 3;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-0.2 * bar.l, 0.2 * bar.l);
  int most = 0;
  for (int i = 0; i < 20; ++i) {
    const double angle = 0.3 * i;
    Workspace model = bar.model(linear(angle, speed));
    State x = model.reference();
    for (double& entry : x.q) entry += off(random);
    for (double& entry : x.v) entry += off(random);
    most = std::max(most, assemble(model, x).iterations);
    const auto near = [&](double t) { return bar.locations(angle + speed * t); };
    EXPECT_LT((x.q - near(0)).lpNorm<Eigen::Infinity>(), 1e-12) << i;
    EXPECT_LT((x.v - testing::first_difference(near, 1e-3)).lpNorm<Eigen::Infinity>(), 1e-8) << i;
  }
  EXPECT_LE(most, 20);
}

// The points start ten times too far away, and a rod that is too short has to lengthen and rotate.
TEST(Assembly, ConvergesFromFarAway) {
  Workspace model = point_model(locations({{10, 0.5}, {10.1, -0.3}, {-8, 3}}));
  add<Rod>(model, "a", 0, -1, constant(1));
  add<Rod>(model, "b", 0, 1, constant(0.5));
  add<Rod>(model, "c", 1, 2, constant(0.5));
  State x = model.reference();
  assemble(model, x);
  EXPECT_NEAR(x.q.head<2>().norm(), 1, 1e-12);
  EXPECT_NEAR((x.q.segment<2>(2) - x.q.head<2>()).norm(), 0.5, 1e-12);
  EXPECT_NEAR((x.q.tail<2>() - x.q.segment<2>(2)).norm(), 0.5, 1e-12);
}

// In a chain of 500 braced cells held at one end, Φ_q M⁻¹ Φ_qᵀ has a condition number of 1e11; the
// increase δ of the masses must not spoil the solution of the 2000 rows.
TEST(Assembly, LongLadder) {
  const int cells = 499;
  std::vector<Vec2> points;
  for (int i = 0; i <= cells; ++i) {
    points.emplace_back(i, 0);
    points.emplace_back(i + 0.1 * std::sin(3.0 * i), 1);
  }
  Workspace model = point_model(locations(points));
  std::vector<std::pair<int, int>> rods;
  for (int a = 0; a + 1 < 2 * (cells + 1); ++a)
    for (const int b : {a + 1, a + 2})
      if (b < 2 * (cells + 1)) {
        const Vec2 d = points[static_cast<size_t>(a)] - points[static_cast<size_t>(b)];
        rods.emplace_back(a, b);
        add<Rod>(model, "rod", a, b, constant(d.norm()));
      }
  add<LinearRow>(model, "x", Parts{{0, 0}}, constant(0));
  add<LinearRow>(model, "y", Parts{{0, 1}}, constant(0));
  add<LinearRow>(model, "turn", Parts{{1, 0}}, constant(0));
  State x = model.reference();
  for (int i = 0; i < x.q.size(); ++i) x.q[i] += 0.02 * std::cos(7.0 * i);
  EXPECT_TRUE(diagnose(model, x).is_independent());
  EXPECT_LE(assemble(model, x).iterations, 10);
  double worst = 0;
  for (const auto& [a, b] : rods) {
    const double length = (points[static_cast<size_t>(a)] - points[static_cast<size_t>(b)]).norm();
    worst =
        std::max(worst, std::abs((x.q.segment<2>(2 * a) - x.q.segment<2>(2 * b)).norm() - length));
  }
  EXPECT_LT(worst, 1e-12 * cells);
}

// The rods are too short to meet. The remaining gap is that of a least-squares solution: two rods
// share 0.4 m.
TEST(Assembly, TooShortRodsAreNamed) {
  Workspace model = point_model(locations({{0.3, 0.4}}));
  add<Rod>(model, "left", 0, -1, constant(0.3));
  add<Rod>(model, "right", 0, -1, constant(0.3), Vec2(1, 0));
  State x = model.reference();
  const std::string text = error_of(Error::Kind::numerical, [&] { assemble(model, x); });
  EXPECT_TRUE(mentions(text, "'left'") && mentions(text, "'right'") && mentions(text, "iterations"))
      << text;
  EXPECT_NEAR(x.q[0], 0.5, 1e-2) << text;
  EXPECT_NEAR(x.q[1], 0, 1e-2) << text;
}

TEST(Assembly, VelocitiesThatContradictAreNamed) {
  Workspace model = point_model(locations({{1, 0}}));
  add<Rod>(model, "rod", 0, -1, constant(1));
  add<LinearRow>(model, "y", Parts{{0, 1}}, constant(0));
  add<LinearRow>(model, "pull", Parts{{0, 0}}, linear(1, 0.5));
  State x = model.reference();
  const std::string text = error_of(Error::Kind::numerical, [&] { assemble(model, x); });
  EXPECT_TRUE(mentions(text, "velocity") && mentions(text, "m/s")) << text;
}

TEST(Assembly, RedundantRodsDoNoHarm) {
  const FourBar bar;
  Workspace model = bar.model(linear(0.9, 2));
  add<Rod>(model, "second", 1, -1, constant(bar.s), Vec2(bar.g, 0));
  State x = model.reference();
  for (int i = 0; i < 4; ++i) x.q[i] += 0.05 * std::cos(2.0 * i);
  assemble(model, x);
  EXPECT_LT((x.q - bar.locations(0.9)).lpNorm<Eigen::Infinity>(), 1e-11);
}

TEST(Assembly, BadStartsAreRefused) {
  const FourBar bar;
  Workspace model = bar.model(linear(0.9, 2));
  State x = model.reference();
  x.q[1] = NAN;
  error_of(Error::Kind::input, [&] { assemble(model, x); });
  x.q.resize(3);
  error_of(Error::Kind::input, [&] { assemble(model, x); });
}

}  // namespace
}  // namespace flexmorph::fem
