// Shows that the crisp geometry of a design is right: area fractions agree with exact polygons,
// passive boxes have priority, and connectivity is found.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/components/outline.h"
#include "geometry/parts/picture.h"
#include "tests/geometry/random_components.h"

namespace flexmorph {
namespace {

double crisp_area(const Grid& grid, const VectorXd& fractions) {
  return fractions.sum() * grid.dx() * grid.dy();
}

// Each of the 8 x 8 samples of a cell is inside or outside, and errors along an edge alternate in
// sign: on 60 x 30 cells the error of the sum is well below 1e-3 of the domain.
TEST(AreaFractions, AgreeWithTheExactUnion) {
  const Grid grid{.x0 = 0.1, .y0 = -0.2, .width = 2, .height = 1, .nx = 60, .ny = 30};
  for (unsigned seed = 1; seed <= 6; ++seed) {
    test::RandomComponents random(seed);
    std::vector<Component> design = random.several(12, 2.2, 1.2);
    std::vector<std::vector<Vec2>> outlines;
    for (Component& c : design) {
      c.center += Vec2(0, -0.3);
      outlines.push_back(outline(c, 0.03, 128));
    }
    const double exact = area(unite(outlines, {{0.1, -0.2}, {2.1, 0.8}}));
    const VectorXd fractions = area_fractions(grid, design, 0.03, {}, {});
    EXPECT_NEAR(crisp_area(grid, fractions), exact, 1e-3 * grid.width * grid.height) << seed;
    EXPECT_GE(fractions.minCoeff(), 0);
    EXPECT_LE(fractions.maxCoeff(), 1);
  }
}

// Fractions from samples of the polygons are close to the exact fractions of their union; a region
// may be in the hole of another one.
TEST(AreaFractions, OfRegionsAreThoseOfTheirPolygons) {
  const Grid grid{.x0 = 0, .y0 = 0, .width = 2, .height = 1, .nx = 40, .ny = 20};
  test::RandomComponents random(5);
  std::vector<std::vector<Vec2>> outlines;
  for (const Component& c : random.several(12, 2, 1)) outlines.push_back(outline(c, 0.03, 64));
  const std::vector<Region> regions = unite(outlines, {{0, 0}, {2, 1}});
  const VectorXd of_polygons = area_fractions(grid, {}, 0.03, outlines, {}),
                 of_regions = area_fractions(grid, regions);
  EXPECT_LE((of_polygons - of_regions).cwiseAbs().maxCoeff(), 0.15);
  EXPECT_NEAR(crisp_area(grid, of_regions), area(regions), 1e-12);
  const auto box = [](double a) { return corners_of({{1 - a, 0.5 - a}, {1 + a, 0.5 + a}}); };
  std::vector<Region> rings = {{box(0.1), {}}, {box(0.4), {box(0.2)}}};
  std::reverse(rings[1].holes[0].begin(), rings[1].holes[0].end());
  EXPECT_NEAR(crisp_area(grid, area_fractions(grid, rings)), 0.64 - 0.16 + 0.04, 1e-12);
}

// For 64 x 64 samples per cell on 40 x 20 cells, random samples along a boundary of length P would
// give an area error of sqrt(P h) h, where h is the distance of samples: about 1e-6 of the domain.
TEST(AreaFractions, OfFineSamplesAgreeWithTheExactUnion) {
  const Grid grid{.x0 = 0, .y0 = 0, .width = 2, .height = 1, .nx = 40, .ny = 20};
  for (unsigned seed = 1; seed <= 4; ++seed) {
    test::RandomComponents random(seed);
    const std::vector<Component> design = random.several(20, 2, 1);
    std::vector<std::vector<Vec2>> outlines;
    for (const Component& c : design) outlines.push_back(outline_within(c, 0.03, 1e-5));
    const double exact = area(unite(outlines, {{0, 0}, {2, 1}}));
    const VectorXd fractions = area_fractions(grid, design, 0.03, {}, {}, 64);
    EXPECT_NEAR(crisp_area(grid, fractions), exact, 1e-4 * exact) << seed;
  }
}

// When one component is moved, only the columns that it touches are recomputed.
TEST(AreaFractions, AreUpdatedBitForBit) {
  const Grid grid{.x0 = 0, .y0 = 0, .width = 2, .height = 1, .nx = 40, .ny = 20};
  test::RandomComponents random(3);
  std::vector<Component> design = random.several(12, 2, 1);
  const std::vector<std::vector<Vec2>> solid = {{{1.9, 0.1}, {2, 0.1}, {2, 0.4}, {1.9, 0.4}}};
  VectorXd fractions = area_fractions(grid, design, 0.03, solid, {});
  for (Component& c : design) {
    const Box before = bounding_box(c, 0.03, 0);
    c.center.x() += 0.1;
    c.angle += 0.2;
    const Box after = bounding_box(c, 0.03, 0);
    update_area_fractions(grid, design, 0.03, solid, {},
                          std::min(before.lower.x(), after.lower.x()),
                          std::max(before.upper.x(), after.upper.x()), fractions);
    EXPECT_EQ(fractions, area_fractions(grid, design, 0.03, solid, {}));
  }
}

TEST(AreaFractions, LieWhereTheMaterialIs) {
  const Grid grid{.width = 10, .height = 4, .nx = 10, .ny = 4};
  const Component bar{.center = {5, 1.25}, .half_length = 50, .c1 = 0.75, .c2 = 0.75, .c3 = 0.75};
  const VectorXd fractions = area_fractions(grid, {&bar, 1}, 0.01, {}, {});
  for (int i = 0; i < 10; ++i) {  // material from y = 0.5 to 2, edges between samples
    EXPECT_EQ(fractions[grid.cell(i, 0)], 0.5);
    EXPECT_EQ(fractions[grid.cell(i, 1)], 1);
    EXPECT_EQ(fractions[grid.cell(i, 2)], 0);
  }
}

TEST(AreaFractions, SolidWinsOverEmptyAndEmptyOverComponents) {
  const Grid grid{.width = 10, .height = 4, .nx = 10, .ny = 4};
  const Component all{.center = {5, 2}, .half_length = 50, .c1 = 40, .c2 = 40, .c3 = 40};
  const std::vector<std::vector<Vec2>> solid = {corners_of({{8, 0}, {10, 4}})},
                                       empty = {corners_of({{4, 0}, {9, 2.5}})};
  const VectorXd fractions = area_fractions(grid, {&all, 1}, 0.01, solid, empty);
  EXPECT_EQ(fractions[grid.cell(3, 0)], 1);    // the component
  EXPECT_EQ(fractions[grid.cell(4, 0)], 0);    // empty
  EXPECT_EQ(fractions[grid.cell(4, 2)], 0.5);  // half empty
  EXPECT_EQ(fractions[grid.cell(8, 0)], 1);    // solid and empty
  const VectorXd without = area_fractions(grid, {}, 0.01, solid, {});
  EXPECT_EQ(without.sum(), 8);
  EXPECT_THROW(area_fractions(grid, {}, 0.01, {}, {}, 0), Error);
}

/// Returns the connectivity of a text picture: top row first, '#' is material.
Connectivity connectivity_of(const std::vector<std::string>& rows) {
  const Grid grid{.nx = static_cast<int>(rows[0].size()), .ny = static_cast<int>(rows.size())};
  VectorXd fractions(grid.n_cells());
  for (int i = 0; i < grid.nx; ++i) {
    for (int j = 0; j < grid.ny; ++j) {
      fractions[grid.cell(i, j)] = rows[grid.ny - 1 - j][i] == '#' ? 0.5 : 0.49;
    }
  }
  return connectivity(grid, fractions);
}

void expect(const Connectivity& found, bool connected, int islands) {
  EXPECT_EQ(found.connected, connected);
  EXPECT_EQ(found.islands, islands);
}

TEST(Connectivity, OneBar) { expect(connectivity_of({"......", "######", "......"}), true, 0); }

TEST(Connectivity, TwoBarsWithAGap) { expect(connectivity_of({"###.##", "###.##"}), false, 1); }

TEST(Connectivity, CornersDoNotJoin) { expect(connectivity_of({"###...", "...###"}), false, 1); }

TEST(Connectivity, EdgesJoin) { expect(connectivity_of({"####..", "...###"}), true, 0); }

TEST(Connectivity, IslandsAreCountedBesideTheMainPiece) {
  expect(connectivity_of({"#.#..#", "......", "######", "......", ".##..."}), true, 4);
}

TEST(Connectivity, SecondBarIsAnIsland) {
  expect(connectivity_of({"######", "......", "######"}), true, 1);
}

TEST(Connectivity, DetoursConnect) {
  expect(connectivity_of({"#.###.#", "#.#.#.#", "###.###"}), true, 0);
}

TEST(Connectivity, NothingIsNotConnected) { expect(connectivity_of({"....", "...."}), false, 0); }

TEST(Connectivity, NamedLocationsMustBeJoined) {
  const Grid grid{.nx = 4, .ny = 3};
  VectorXd fractions = VectorXd::Zero(grid.n_cells());
  for (int i = 0; i < 4; ++i) fractions[grid.cell(i, 0)] = 1;
  const std::vector<HeldOrLoaded> low = {{"left", true, {grid.cell(0, 0), grid.cell(0, 1)}},
                                         {"right", false, {grid.cell(2, 0)}}};
  const std::vector<HeldOrLoaded> high = {{"left", true, {grid.cell(0, 0)}},
                                          {"top", false, {grid.cell(3, 2), grid.cell(2, 2)}}};
  EXPECT_TRUE(connectivity(grid, fractions, low).connected);
  EXPECT_FALSE(connectivity(grid, fractions, high).connected);
  for (int j = 0; j < 3; ++j) fractions[grid.cell(2, j)] = 1;
  EXPECT_TRUE(connectivity(grid, fractions, high).connected);
}

// A support that no load needs is named, but does not disconnect anything; a load on a separate
// region is loose.
TEST(Connectivity, NamesLooseLoadsAndUnusedSupports) {
  const Grid grid{.nx = 5, .ny = 3};
  VectorXd fractions = VectorXd::Zero(grid.n_cells());
  for (int i = 0; i < 3; ++i) fractions[grid.cell(i, 0)] = 1;
  fractions[grid.cell(4, 2)] = 1;
  std::vector<HeldOrLoaded> locations = {{"left", true, {grid.cell(0, 0)}},
                                         {"top", true, {grid.cell(4, 2)}},
                                         {"tip", false, {grid.cell(2, 0), grid.cell(2, 1)}}};
  const Connectivity whole = connectivity(grid, fractions, locations);
  EXPECT_TRUE(whole.connected);
  EXPECT_EQ(whole.islands, 1);
  EXPECT_EQ(whole.unused_supports, std::vector<std::string>{"top"});
  locations[1].is_support = false;
  const Connectivity apart = connectivity(grid, fractions, locations);
  EXPECT_FALSE(apart.connected);
  EXPECT_EQ(apart.loose_loads, std::vector<std::string>{"top"});
  EXPECT_TRUE(apart.unused_supports.empty());
  const Connectivity weighs = connectivity(grid, fractions, std::span(locations).first(1));
  EXPECT_TRUE(weighs.connected && weighs.unused_supports.empty());
  EXPECT_FALSE(connectivity(grid, 0 * fractions, std::span(locations).first(1)).connected);
}

// The expected fractions count the samples inside a triangle one by one.
TEST(AreaFractions, OfAPolygonAreThoseOfItsSamples) {
  const Grid grid{.width = 3, .height = 2, .nx = 3, .ny = 2};
  const std::vector<std::vector<Vec2>> triangle = {
      {{0.2017, 0.1033}, {2.9031, 0.4177}, {1.1059, 1.9023}}};
  const VectorXd fractions = area_fractions(grid, {}, 0.01, triangle, {}, 40);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j) {
      int inside = 0;
      for (int k = 0; k < 1600; ++k)
        inside += contains({triangle[0], {}}, {i + (k % 40 + 0.5) / 40, j + (k / 40 + 0.5) / 40});
      EXPECT_DOUBLE_EQ(fractions[grid.cell(i, j)], inside / 1600.) << i << " " << j;
    }
}

TEST(CellsWithin, LeaveOutHoles) {
  const Grid grid{.width = 10, .height = 10, .nx = 10, .ny = 10};
  const Region frame{corners_of({{1, 1}, {9, 9}}), {{{3, 3}, {3, 6}, {6, 6}, {6, 3}}}};
  const std::vector<int> cells = cells_within(grid, frame);
  EXPECT_EQ(cells.size(), 64u - 9u);
  EXPECT_EQ(std::count(cells.begin(), cells.end(), grid.cell(4, 4)), 0);
  EXPECT_EQ(std::count(cells.begin(), cells.end(), grid.cell(1, 1)), 1);
}

TEST(CellsOutside, OfAnL) {
  const Grid grid{.width = 10, .height = 10, .nx = 10, .ny = 10};
  const std::vector<Vec2> polygon = {{0, 0}, {10, 0}, {10, 4}, {4, 4}, {4, 10}, {0, 10}};
  const std::vector<signed char> outside = cells_outside(grid, {polygon, {}});
  EXPECT_EQ(std::count(outside.begin(), outside.end(), 1), 36);
  EXPECT_EQ(outside[static_cast<size_t>(grid.cell(3, 9))], 0);
  EXPECT_EQ(outside[static_cast<size_t>(grid.cell(4, 4))], 1);
}

TEST(Connectivity, SeesTheGapBetweenTwoComponents) {
  const Grid grid{.width = 10, .height = 2, .nx = 100, .ny = 20};
  std::vector<Component> bars(
      2, {.center = {2.5, 1}, .half_length = 2.6, .c1 = 0.4, .c2 = 0.4, .c3 = 0.4});
  bars[1].center = {7.5, 1};
  expect(connectivity(grid, area_fractions(grid, bars, 0.01, {}, {})), true, 0);
  for (Component& c : bars)
    c.half_length = 2.4;  // a gap of two cells; ends one cell from the sides
  bars[0].center = {2.3, 1};
  bars[1].center = {7.7, 1};
  expect(connectivity(grid, area_fractions(grid, bars, 0.01, {}, {})), false, 1);
}

}  // namespace
}  // namespace flexmorph
