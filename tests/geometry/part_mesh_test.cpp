// Shows that meshes of parts have the area of the outline, that no triangle crosses it, and that
// angles and sizes are within their limits.

#include "geometry/parts/part_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "tests/geometry/random_components.h"

namespace flexmorph {
namespace {

std::vector<Vec2> rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

std::vector<Vec2> clockwise(std::vector<Vec2> ring) {
  std::reverse(ring.begin(), ring.end());
  return ring;
}

PartMesh mesh_of(std::span<const Region> regions, double size,
                 std::span<const Segment> lines = {}) {
  PartMesher mesher(regions, lines);
  mesher.refine(SizeField({{-10, -10}, {10, 10}}, size));
  return mesher.mesh();
}

double longest_side(const PartMesh& mesh) {
  double out = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    out = std::max({out, (b - a).norm(), (c - b).norm(), (a - c).norm()});
  }
  return out;
}

double smallest_angle(const PartMesh& mesh) {
  double out = 180;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto p = mesh.corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      out = std::min(out, std::acos(u.dot(v) / (u.norm() * v.norm())) * 180 / std::numbers::pi);
    }
  }
  return out;
}

/// Returns sides with a triangle on one side only, by the number of their middle node.
std::map<int, std::pair<int, int>> border_of(const PartMesh& mesh) {
  std::map<int, std::pair<int, int>> out;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, fresh] = out.try_emplace(t[3 + k], t[k], t[(k + 1) % 3]);
      if (!fresh) out.erase(at);
    }
  return out;
}

TEST(PartMesh, FillsAFrameWithGoodTriangles) {
  const std::vector<Region> frame = {{rectangle(0, 0, 3, 2), {clockwise(rectangle(1, 0.5, 2, 1))}}};
  const PartMesh mesh = mesh_of(frame, 0.2);
  EXPECT_NEAR(mesh.area(), 6 - 0.5, 1e-13);
  EXPECT_LE(longest_side(mesh), 0.2);
  EXPECT_GE(smallest_angle(mesh), 20.7);
  EXPECT_EQ(mesh.n_connected_regions, 1);
  // Euler's formula: vertices - edges + faces = 1 - holes.
  const auto n_edges = static_cast<int>(mesh.points.size()) - mesh.n_corners;
  EXPECT_EQ(mesh.n_corners - n_edges + static_cast<int>(mesh.triangles.size()), 0);
  double border = 0;
  for (const auto& [middle, ends] : border_of(mesh))
    border += (mesh.point(ends.first) - mesh.point(ends.second)).norm();
  EXPECT_NEAR(border, 10 + 3, 1e-12);
}

TEST(PartMesh, MiddlesLieHalfwayAndCornersTurnLeft) {
  const PartMesh mesh = mesh_of(std::vector<Region>{{rectangle(0, 0, 1, 1), {}}}, 0.3);
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 between = 0.5 * (mesh.point(t[k]) + mesh.point(t[(k + 1) % 3]));
      EXPECT_EQ(mesh.point(t[3 + k]), between);
      EXPECT_LT(t[k], mesh.n_corners);
      EXPECT_GE(t[3 + k], mesh.n_corners);
    }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    EXPECT_GT((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(), 0);
  }
}

// A line across is a chain of sides from one border to the other, also where it is within round-off
// of vertices of the outline.
TEST(PartMesh, LinesAreSides) {
  const double x = 0.7;
  const std::vector<Region> plate = {
      {{{0, 0}, {x + 1e-16, 0}, {1, 0}, {1, 1}, {x - 1e-15, 0.9}, {0, 1}}, {}}};
  const std::vector<Segment> lines = {{{x, -1}, {x, 2}}, {{0.3, 0.2}, {0.3, 0.6}}};
  const PartMesh mesh = mesh_of(plate, 0.25, lines);
  for (const Segment& line : lines) {
    std::map<int, double> on;
    for (const auto& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (distance(line, mesh.point(t[k])) < 1e-9 &&
            distance(line, mesh.point(t[(k + 1) % 3])) < 1e-9)
          on[t[3 + k]] = (mesh.point(t[k]) - mesh.point(t[(k + 1) % 3])).norm();
    double length = 0;
    for (const auto& [middle, each] : on) length += each;
    EXPECT_NEAR(length, line.a.x() == x ? 0.9 : 0.4, 1e-9);
  }
  EXPECT_GE(longest_side(mesh), 1e-3);
}

// Loads along a moving border begin where others end, except for round-off. Refinement between such
// points must end.
TEST(PartMesh, LinesThatAgreeUpToRoundOffAreOne) {
  const double x = 0.37209595141998519, upper = 0.05;
  const std::vector<Region> plate = {{rectangle(0, -0.05, x, upper), {}}};
  std::vector<Segment> lines = {{{0.2, -0.06}, {0.2, 0.06}}};
  for (int k = 0; k < 19; ++k)
    lines.push_back({{x, -upper + 0.005 * k}, {x, 0.005 * (k + 2) - upper + (k % 2) * 7e-18}});
  for (int k = 0; k < 9; ++k) {
    const double y = -0.04 + 0.01 * k;
    lines.push_back({{0.1 + 1e-17 * k, y}, {0.3, y}});
  }
  const PartMesh mesh = mesh_of(plate, 0.02, lines);
  EXPECT_NEAR(mesh.area(), x * 2 * upper, 1e-15);
  EXPECT_GT(smallest_angle(mesh), 20.7);
  double shortest = 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    shortest = std::min({shortest, (b - a).norm(), (c - b).norm(), (a - c).norm()});
  }
  EXPECT_GT(shortest, 1e-4);
}

// The ends of a line along a slanted border must be nodes of the border.
TEST(PartMesh, EndsOnASlantedBorderAreNodes) {
  const std::vector<Region> triangle = {{{{0, 0}, {1, 0}, {0, 0.7}}, {}}};
  const auto on = [](double t) { return Vec2(1 - t, 0.7 * t); };
  const std::vector<Segment> lines = {{on(0.3), on(0.31)}};
  const PartMesh mesh = mesh_of(triangle, 0.5, lines);
  for (const Vec2& end : {lines[0].a, lines[0].b})
    EXPECT_TRUE(std::any_of(mesh.points.begin(), mesh.points.begin() + mesh.n_corners,
                            [&](const Vec2& p) { return (p - end).norm() < 1e-12; }));
  EXPECT_NEAR(mesh.area(), 0.35, 1e-12);
}

TEST(PartMesh, PiecesThatTouchInAPointStayApart) {
  const std::vector<Region> both = {{rectangle(0, 0, 1, 1), {}}, {rectangle(1, 1, 2, 2), {}}};
  const PartMesh mesh = mesh_of(both, 0.5);
  EXPECT_EQ(mesh.n_connected_regions, 2);
  const auto there = std::count_if(mesh.points.begin(), mesh.points.end(),
                                   [](const Vec2& p) { return p == Vec2(1, 1); });
  EXPECT_EQ(there, 2);
}

TEST(PartMesh, RefinesWhereItIsToldTo) {
  const std::vector<Region> plate = {{rectangle(0, 0, 1, 1), {}}};
  SizeField sizes({{0, 0}, {1, 1}}, 0.5);
  PartMesher mesher(plate, {});
  mesher.refine(sizes);
  const std::size_t before = mesher.mesh().triangles.size();
  sizes.refine({0.1, 0.1}, 0.25, 0.01);
  EXPECT_EQ(sizes.at({0.1, 0.1}), 0.01);
  EXPECT_EQ(sizes.at({0.9, 0.9}), 0.5);
  mesher.refine(sizes);
  const PartMesh mesh = mesher.mesh();
  EXPECT_GT(mesh.triangles.size(), before);
  EXPECT_NEAR(mesh.area(), 1, 1e-13);
  double near = 1, far = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const Vec2 middle = (a + b + c) / 3;
    if ((middle - Vec2(0.1, 0.1)).norm() < 0.01) near = std::min(near, (b - a).norm());
    if ((middle - Vec2(0.9, 0.9)).norm() < 0.1) far = std::max(far, (b - a).norm());
  }
  EXPECT_LE(near, 0.01);
  EXPECT_GT(far, 0.1);
}

// Typical designs are unions of many components, with tiny sides and sharp wedges.
TEST(PartMesh, UnionsOfComponentsAreMeshedAndTheSameTwice) {
  std::mt19937 engine(7);
  for (int round = 0; round < 5; ++round) {
    std::vector<std::vector<Vec2>> outlines;
    for (int k = 0; k < 25; ++k) {
      const auto draw = [&] { return static_cast<double>(engine()) / 4294967295.0; };
      Component c;
      c.center = {2 * draw(), draw()};
      c.half_length = 0.1 + 0.3 * draw();
      c.angle = 3 * draw();
      c.c1 = c.c2 = c.c3 = 0.01 + 0.04 * draw();
      outlines.push_back(outline_within(c, 1e-3, 1e-4));
    }
    const std::vector<Region> regions = unite(outlines, Box{{0, 0}, {2, 1}});
    std::vector<Segment> lines;
    for (int k = 1; k < 20; ++k) lines.push_back({{0.1 * k, -1}, {0.1 * k, 2}});
    const PartMesh mesh = mesh_of(regions, 0.05, lines), again = mesh_of(regions, 0.05, lines);
    EXPECT_NEAR(mesh.area(), area(regions), 1e-9);
    EXPECT_EQ(mesh.n_connected_regions, static_cast<int>(regions.size()));
    EXPECT_EQ(mesh.points, again.points);
    EXPECT_EQ(mesh.triangles, again.triangles);
    for (const auto& t : mesh.triangles)
      for (const Segment& line : lines) {
        bool left = false, right = false;
        for (std::size_t k = 0; k < 3; ++k) {
          left = left || mesh.point(t[k]).x() < line.a.x() - 1e-8;
          right = right || mesh.point(t[k]).x() > line.a.x() + 1e-8;
        }
        EXPECT_FALSE(left && right) << "a triangle across x = " << line.a.x();
      }
  }
}

TEST(PartMesh, ReentrantCornersAreFound) {
  const std::vector<Region> bracket = {
      {{{0, 0}, {1, 0}, {1, 0.4}, {0.4, 0.4}, {0.4, 1}, {0, 1}}, {}}};
  const std::vector<Vec2> corners = reentrant_corners(bracket, 200 * std::numbers::pi / 180);
  ASSERT_EQ(corners.size(), 1u);
  EXPECT_EQ(corners[0], Vec2(0.4, 0.4));
}

}  // namespace
}  // namespace flexmorph
