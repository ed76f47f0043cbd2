// Shows that forces distributed over a location have the right resultant and moment, that a pin has
// the expected pressure, and that a ring under a torque turns by the analytic angle.

#include "optim/verification/force_spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "optim/verification/verification.h"

namespace flexmorph::verification {
namespace {

/// Points of a circle, counterclockwise and optionally unequally spaced, and the fraction of the
/// rim that belongs to each.
struct Rim {
  std::vector<Vec2> points;
  std::vector<double> shares;

  Rim(const Vec2& center, double radius, int n, double uneven, double from = 0,
      double to = 2 * std::numbers::pi) {
    std::vector<double> angles;
    for (int k = 0; k <= n; ++k) {
      const double u = static_cast<double>(k) / n;
      angles.push_back(from + (to - from) * (u + uneven * std::sin(2 * std::numbers::pi * u)));
    }
    for (size_t k = 0; k + 1 < angles.size(); ++k) {
      const double middle = 0.5 * (angles[k] + angles[k + 1]);
      points.push_back(center + radius * Vec2(std::cos(middle), std::sin(middle)));
      shares.push_back((angles[k + 1] - angles[k]) / (to - from));
    }
  }
};

Vec2 sum(const std::vector<Vec2>& forces) {
  Vec2 out = Vec2::Zero();
  for (const Vec2& f : forces) out += f;
  return out;
}

double moment_around(const Vec2& center, const Rim& rim, const std::vector<Vec2>& forces) {
  double out = 0;
  for (size_t k = 0; k < forces.size(); ++k) {
    const Vec2 arm = rim.points[k] - center;
    out += arm.x() * forces[k].y() - arm.y() * forces[k].x();
  }
  return out;
}

// Reference: the pressure of a pin is 2 F / (pi R) cos(angle) on the half of the bore in front of
// it.
TEST(ForceSpread, OfAPinIsACosine) {
  const Vec2 center(3, -2), force(-30, 40);
  const double radius = 0.25;
  const Rim rim(center, radius, 4000, 0.1);
  const std::vector<Vec2> found = spread({force, 0, true, center}, rim.points, rim.shares);
  ASSERT_EQ(found.size(), rim.points.size());
  EXPECT_NEAR((sum(found) - force).norm(), 0, 1e-12 * force.norm());
  EXPECT_NEAR(moment_around(center, rim, found), 0, 1e-12 * force.norm() * radius);
  for (size_t k = 0; k < found.size(); ++k) {
    const Vec2 normal = (rim.points[k] - center) / radius;
    const double cosine = normal.dot(force) / force.norm();
    const double pressure = cosine > 0 ? 2 * force.norm() / (std::numbers::pi * radius) * cosine *
                                             (2 * std::numbers::pi * radius) * rim.shares[k]
                                       : 0;
    EXPECT_NEAR((found[k] - pressure * normal).norm(), 0, 1e-3 * force.norm() * rim.shares[k]);
  }
}

// The resultant is the force even if the bore has material on one side of the force only.
TEST(ForceSpread, OfAPinHasTheForceAsItsResultant) {
  const Vec2 center(0, 0), force(0, -7);
  const Rim quarter(center, 2, 31, 0.05, -0.5 * std::numbers::pi, 0.1 * std::numbers::pi);
  const std::vector<Vec2> found = spread({force, 0, true, center}, quarter.points, quarter.shares);
  EXPECT_NEAR((sum(found) - force).norm(), 0, 1e-12);
  // Material behind the pin cannot carry its force, and a single point can carry it in one
  // direction only; no distribution is returned.
  const Rim behind(center, 2, 31, 0, 0.1 * std::numbers::pi, 0.9 * std::numbers::pi),
      point(center, 2, 1, 0, -1.7, -1.4);
  EXPECT_TRUE(spread({force, 0, true, center}, behind.points, behind.shares).empty());
  EXPECT_TRUE(spread({force, 0, true, center}, point.points, point.shares).empty());
}

TEST(ForceSpread, OfAMomentHasNoResultant) {
  const Vec2 center(1, 5);
  const Rim rim(center, 0.3, 17, 0.12);
  const std::vector<Vec2> found = spread({{2, 3}, 11, false, center}, rim.points, rim.shares);
  EXPECT_NEAR((sum(found) - Vec2(2, 3)).norm(), 0, 1e-12);
  const std::vector<Vec2> turning = spread({{0, 0}, 11, false, center}, rim.points, rim.shares);
  EXPECT_NEAR(sum(turning).norm(), 0, 1e-12);
  EXPECT_NEAR(moment_around(center, rim, turning), 11, 1e-11);
  const std::vector<Vec2> one = {{4, 4}};
  const std::vector<double> all = {1};
  EXPECT_TRUE(spread({{0, 0}, 11, false, center}, one, all).empty());
}

std::vector<Vec2> circle(double radius, int sides, bool clockwise) {
  std::vector<Vec2> out;
  for (int k = 0; k < sides; ++k) {
    const double angle = (clockwise ? -2 : 2) * std::numbers::pi * k / sides;
    out.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return out;
}

// Reference: a ring held at its outer rim turns by M / (4 pi G t) (1 / a^2 - 1 / b^2) at its inner
// rim, because its shear stress is M / (2 pi r^2 t).
TEST(ForceSpread, TorqueTurnsARingAsItsShearSays) {
  const double a = 1, b = 3, moment = 5, thickness = 0.2, young = 7, nu = 0.3;
  const double shear_modulus = young / (2 * (1 + nu));
  const std::vector<Vec2> inner = circle(a, 240, true), outer = circle(b, 360, false);
  Loads loads;
  loads.supports.push_back({loads.add(border_location(outer)), true, true});
  Load load;
  load.forces.push_back({loads.add(border_location(inner)), {0, 0}, moment});
  loads.loads.push_back(load);
  const std::vector<Region> ring = {{outer, {inner}}};
  const OutlineVerification found = verify_outline(ring, {thickness, young, nu, 0}, loads,
                                                   {.tolerance = 1e-3, .size = 0.3, .reach = 0.1});
  const double turn =
      moment / (4 * std::numbers::pi * shear_modulus * thickness) * (1 / (a * a) - 1 / (b * b));
  EXPECT_NEAR(found.compliance, moment * turn, 1e-3 * moment * turn);
}

}  // namespace
}  // namespace flexmorph::verification
