// Shows that crossing sides are found, against exact tests of every pair in rational numbers.
#include "geometry/crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>

namespace flexmorph {
namespace {

using Number = boost::multiprecision::cpp_rational;
using Sides = std::vector<std::pair<std::size_t, std::size_t>>;

int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Number ux = Number(b.x()) - Number(a.x()), uy = Number(b.y()) - Number(a.y());
  const Number vx = Number(c.x()) - Number(a.x()), vy = Number(c.y()) - Number(a.y());
  const Number out = ux * vy - uy * vx;
  return out.sign();
}

/// Returns true if p, which is on the line through a and b, is between them or equal to one of
/// them.
bool between(const Vec2& a, const Vec2& b, const Vec2& p) {
  return (p.array() >= a.array().min(b.array())).all() &&
         (p.array() <= a.array().max(b.array())).all();
}

bool pair_crosses(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  const auto touches = [](int side, const Vec2& p, const Vec2& q, const Vec2& end) {
    return side == 0 && between(p, q, end) && end != p && end != q;
  };
  if (touches(abc, a, b, c) || touches(abd, a, b, d) || touches(cda, c, d, a) ||
      touches(cdb, c, d, b))
    return true;
  return (a == c && b == d) || (a == d && b == c);
}

bool any_pair_crosses(const std::vector<Vec2>& points, const Sides& sides) {
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (pair_crosses(points[sides[i].first], points[sides[i].second], points[sides[j].first],
                       points[sides[j].second]))
        return true;
  return false;
}

// On a coarse raster sides share ends, touch or overlap; on a fine raster they cross or are apart.
TEST(SidesCross, AsEveryPairTells) {
  std::mt19937 random(3);
  int crossing = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto raster = static_cast<unsigned>(trial % 2 ? 4 : 1000);
    std::vector<Vec2> points;
    while (points.size() < 8) {
      const auto draw = [&] { return 0.1 * static_cast<double>(random() % raster); };
      const double x = draw(), y = draw();
      const Vec2 p(x, y);
      if (std::find(points.begin(), points.end(), p) == points.end()) points.push_back(p);
    }
    Sides sides;
    for (int k = 0; k < 2 + trial % 3; ++k) {
      const std::size_t a = random() % 8, b = random() % 8;
      if (a != b) sides.emplace_back(a, b);
    }
    const bool expected = any_pair_crosses(points, sides);
    EXPECT_EQ(sides_cross(points, sides), expected) << trial;
    crossing += expected;
  }
  EXPECT_GT(crossing, 300);
  EXPECT_LT(crossing, 1700);
}

// Round-off decides if a vertex is beside a side by the last bit, or on it.
TEST(SidesCross, LooksAtTheLastBit) {
  const std::vector<Vec2> points = {{0, 0}, {1, 1}, {0.5, 0.5}, {0, 1}};
  EXPECT_TRUE(sides_cross(points, Sides{{0, 1}, {2, 3}}));
  std::vector<Vec2> beside = points;
  beside[2].y() = std::nextafter(0.5, 1);
  EXPECT_FALSE(sides_cross(beside, Sides{{0, 1}, {2, 3}}));
  beside[2].y() = std::nextafter(0.5, 0);
  EXPECT_TRUE(sides_cross(beside, Sides{{0, 1}, {2, 3}}));
  EXPECT_FALSE(sides_cross(points, Sides{}));
}

}  // namespace
}  // namespace flexmorph
