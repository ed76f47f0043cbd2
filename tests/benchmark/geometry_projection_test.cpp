// Shows that the measure of the published program of generalized geometry projection is reproduced:
// it gives the first line that this program prints.

#include "tests/benchmark/geometry_projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace flexmorph::benchmark {
namespace {

/// Returns the start of the published program: two crossed bars of mass 0.5 at nine locations.
std::vector<ProjectedFeature> published_start() {
  std::vector<ProjectedFeature> out;
  const double length = 2 * std::hypot(60 / 3., 30 / 3.), angle = std::atan2(30, 60);
  for (const double sign : {1., -1.})
    for (const double x : {0., 30., 60.})
      for (const double y : {0., 15., 30.})
        out.push_back(round_bar({x, y}, length, 2, sign * angle, 0.5));
  return out;
}

// Reference: "It.: 1 Obj.: 4.236e+04 Vol.: 0.074" (GGP.html of the program); all printed digits are
// compared.
TEST(GeometryProjection, BeginsAsThePublishedProgramDoes) {
  const Grid grid{0, 0, 60, 30, 60, 30};
  const ProjectedElements start = project(grid, published_start());
  EXPECT_NEAR(short_cantilever(grid, start.stiffness), 4.236e4, 5);
  EXPECT_NEAR(start.volume(), 0.074, 5e-4);
}

// Far inside of a feature elements are full, except for the rounding of the saturation, log 2 / p /
// (1 - s0); far outside they have the least fraction.
TEST(GeometryProjection, IsFullInsideAndEmptyOutside) {
  const Grid grid{0, 0, 12, 12, 12, 12};
  for (const int n : {1, 18}) {
    std::vector<ProjectedFeature> features(static_cast<std::size_t>(n),
                                           round_bar({100, 100}, 1, 1, 0, 1));
    features[0] = round_bar({6, 6}, 12, 6, 0, 1);
    const ProjectedElements found = project(grid, features);
    EXPECT_NEAR(found.density[grid.cell(6, 6)], 1, 7e-3);
    EXPECT_NEAR(found.density[grid.cell(6, 0)], 0, 1e-6);
    EXPECT_EQ(found.density, found.stiffness);
    // Half of the element is inside: the mean over 18 features gives less than a single feature
    // does.
    features[0] = round_bar({6, 6}, 100, 5, 0, 1);
    EXPECT_NEAR(project(grid, features).density[grid.cell(6, 3)], n == 1 ? 0.496 : 0.308, 5e-3);
  }
}

// A component of this program and a bar with straight sides give equal elements between their ends,
// and so do two halves of the component as one feature.
TEST(GeometryProjection, SeesComponentsByTheirOutlines) {
  const Grid grid{0, 0, 20, 10, 20, 10};
  const Component ours{{10, 5}, 12, 0.1, 1.3, 1.3, 1.3};
  const std::vector<ProjectedFeature> bar = {round_bar({10, 5}, 40, 2.6, 0.1, 1)};
  const std::vector<ProjectedFeature> one = {feature_of(ours, 0.5)};
  Component left = ours, right = ours;
  left.half_length = right.half_length = 8;
  left.center -= 4 * Vec2(std::cos(0.1), std::sin(0.1));
  right.center += 4 * Vec2(std::cos(0.1), std::sin(0.1));
  const Component both[] = {left, right};
  const std::vector<ProjectedFeature> united = {feature_of(both, 0.5, {{0, 0}, {20, 10}})};
  const VectorXd wanted = project(grid, bar).density;
  const VectorXd found = project(grid, one).density, halves = project(grid, united).density;
  for (int i = 4; i < 16; ++i)
    for (int j = 0; j < grid.ny; ++j) {
      EXPECT_NEAR(found[grid.cell(i, j)], wanted[grid.cell(i, j)], 5e-3);
      EXPECT_NEAR(halves[grid.cell(i, j)], wanted[grid.cell(i, j)], 5e-3);
    }
}

}  // namespace
}  // namespace flexmorph::benchmark
