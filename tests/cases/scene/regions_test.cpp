// Shows that passive regions are exact in outlines and sampled in cells, and that invalid regions
// are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

/// short_beam (2 x 1 m, 80 x 40 cells) with passive regions; `all` is a component that covers
/// everything.
struct Regions {
  mmc::BodyProblem problem;
  std::vector<Component> all = {
      {.center = {1, 0.5}, .half_length = 50, .c1 = 40, .c2 = 40, .c3 = 40}};

  explicit Regions(const Changes& changes)
      : problem(build_problems(read("short_beam", elsewhere(changes))).front()) {}

  /// Adds a support and a load at locations that are void in no test.
  static Changes elsewhere(Changes changes) {
    changes.insert(changes.end(), {"support.edge=\"bottom\"", "load.force.point=[1.2, 1.0]"});
    return changes;
  }
  std::vector<Region> exported(std::span<const Component> components) const {
    return mmc::regions_of(problem, components, tolerance());
  }
  double tolerance() const { return mmc::kOutlineTolerance * problem.grid.dx(); }
  double crisp(std::span<const Component> components) const {
    const Grid& g = problem.grid;
    return mmc::fractions_of(problem, components).sum() * g.dx() * g.dy();
  }
};

// The sides of the polygon are within t of the circle, and its vertices lie on the circle: its area
// is too small by less than t times the circumference. On cells, the samples along the circle
// (spacing: an eighth of a cell) have an error of at most half of their own area.
TEST(PassiveRegions, ADiscIsRound) {
  const double r = 0.2, exact = std::numbers::pi * r * r, around = 2 * std::numbers::pi * r;
  const Regions solid({"design.solid=[{disc=[0.5, 0.5, 0.2]}]"});
  const std::vector<Region> disc = solid.exported({});
  ASSERT_EQ(disc.size(), 1u);
  EXPECT_LE(area(disc), exact);
  EXPECT_GE(area(disc), exact - solid.tolerance() * around);
  for (const Vec2& p : disc[0].outer) EXPECT_NEAR((p - Vec2(0.5, 0.5)).norm(), r, 1e-15);
  EXPECT_NEAR(solid.crisp({}), exact, 1e-3 * exact);

  const Regions hole({"design.void=[{disc=[0.5, 0.5, 0.2]}]"});
  const std::vector<Region> rest = hole.exported(hole.all);
  ASSERT_EQ(rest.size(), 1u);
  ASSERT_EQ(rest[0].holes.size(), 1u);
  EXPECT_NEAR(area(rest), 2 - area(disc), 1e-14);
  EXPECT_NEAR(hole.crisp(hole.all), 2 - exact, 1e-3 * exact);
}

TEST(PassiveRegions, APolygonHasItsCorners) {
  // A triangle with clockwise corners, and a disc that is cut in half by the border.
  const Changes regions = {
      "design.void=[{polygon=[0.3, 0.3, 0.3, 0.9, 1.1, 0.3]}, {disc=[2.0, 0.5, 0.25]}]"};
  const Regions r(regions);
  const double triangle = 0.5 * 0.8 * 0.6, half = 0.5 * std::numbers::pi * 0.25 * 0.25;
  const std::vector<Region> rest = r.exported(r.all);
  ASSERT_EQ(rest.size(), 1u);
  ASSERT_EQ(rest[0].holes.size(), 1u);
  EXPECT_EQ(rest[0].holes[0].size(), 3u);
  EXPECT_NEAR(area(rest), 2 - triangle - half, r.tolerance() * std::numbers::pi * 0.25);
  EXPECT_NEAR(r.crisp(r.all), 2 - triangle - half, 1e-3);
}

TEST(PassiveRegions, CellsWithCentresInThemAreFixed) {
  const Regions r(
      {"design.void=[{disc=[0.5, 0.5, 0.2]}]", "design.solid=[{polygon=[1, 0, 2, 0, 2, 1]}]"});
  const Grid& g = r.problem.grid;
  mmc::CellScaleFactors factors;
  const VectorXd half = VectorXd::Constant(g.n_nodes(), 0.5);
  mmc::ersatz_of(r.problem).factors(half, half, factors);
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      const Vec2 c = g.cell_center(i, j);
      const double mass = factors.mass[g.cell(i, j)];
      const double off = std::abs(c.y() - (c.x() - 1));  // distance from the triangle's long side
      const double from = (c - Vec2(0.5, 0.5)).norm();
      const bool free = from > 0.2 && c.y() > c.x() - 1;
      if (std::abs(from - 0.2) < 1e-3 || off < 1e-9) continue;
      EXPECT_EQ(mass > 0.1 && mass < 0.9, free) << c.transpose();
      if (free) continue;
      EXPECT_EQ(mass, from < 0.2 ? 0 : 1);
    }
}

TEST(PassiveRegions, StripsLieAlongBothEnds) {
  for (const char* kind : {"solid", "void"}) {
    const std::string name = std::string("design.") + kind;
    const Regions r({name + "=[{strip=\"root\", cells=4}, {strip=\"free_end\"}]"});
    const auto& strips = kind[0] == 's' ? r.problem.solid : r.problem.empty;
    ASSERT_EQ(strips.size(), 2u);
    EXPECT_NEAR(bounds_of(strips[0]).upper.x(), 0.1, 1e-15);
    EXPECT_NEAR(bounds_of(strips[1]).lower.x(), 1.95, 1e-15);
    const bool solid = kind[0] == 's';
    EXPECT_NEAR(area(solid ? r.exported({}) : r.exported(r.all)), solid ? 0.15 : 1.85, 1e-14);
  }
}

// A narrow bridge between two voids or a narrow gap in a solid region is given by the case; a
// design cannot change it, therefore it is not reported.
TEST(PassiveRegions, NarrowLocationsOfTheirOwnAreGiven) {
  const Regions r({"design.void=[{polygon=[0.5, 0.2, 1.5, 0.2, 1.5, 0.23, 0.5, 0.23]}]",
                   "design.solid=[{box=[0.5, 0.5, 1.5, 0.53]}]"});
  EXPECT_TRUE(mmc::length_scale_violations_of(r.problem, r.exported(r.all), 0.05).empty());
  EXPECT_FALSE(length_scale_violations(r.exported(r.all), mmc::domain_of(r.problem), 0.05).empty());
  EXPECT_TRUE(mmc::length_scale_violations_of(r.problem, r.exported({}), 0.05).empty());
}

struct BadRegion {
  const char* name;
  const char* region;
  std::vector<std::string> parts;  ///< Parts of the message after its location.
};
class PassiveRegionRefused : public ::testing::TestWithParam<BadRegion> {};
TEST_P(PassiveRegionRefused, AndSaysWhy) {
  for (const std::string kind : {"solid", "void"}) {
    const std::string change = "design." + kind + "=[" + GetParam().region + "]";
    std::string said;
    try {
      read("l_bracket", {change});
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), Error::Kind::input);
      said = e.what();
    }
    EXPECT_TRUE(testing::mentions_all(said, GetParam().parts, "--set " + change + ": "));
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, PassiveRegionRefused,
    ::testing::Values(
        BadRegion{"none", "{cells=2}", {"box", "disc", "polygon", "strip"}},
        BadRegion{
            "two", "{disc=[0.1, 0.1, 0.1], box=[0, 0, 1, 1]}", {"box", "disc", "polygon", "strip"}},
        BadRegion{"crossing", "{polygon=[0, 0, 0.3, 0.3, 0.3, 0, 0, 0.3]}", {"polygon", "cross"}},
        BadRegion{"flat", "{polygon=[0.1, 0.1, 0.2, 0.1, 0.3, 0.1]}", {"area", "polygon"}},
        BadRegion{"collinear", "{polygon=[0.1, 0.1, 0.2, 0.2, 0.3, 0.3]}", {"polygon", "cross"}},
        BadRegion{"two_corners", "{polygon=[0.1, 0.1, 0.2, 0.2]}", {"polygon", "list", "6"}},
        BadRegion{"odd", "{polygon=[0.1, 0.1, 0.2, 0.2, 0.1, 0.3, 0.7]}", {"polygon", "corners"}},
        BadRegion{"no_radius", "{disc=[0.1, 0.1, 0]}", {"disc", "positive", "radius"}},
        BadRegion{"negative_radius", "{disc=[0.1, 0.1, -0.1]}", {"disc", "positive", "radius"}},
        BadRegion{"nan", "{disc=[0.1, nan, 0.1]}", {"disc", "finite"}},
        BadRegion{"disc_of_two", "{disc=[0.1, 0.1]}", {"disc", "list of 3"}},
        BadRegion{"outside", "{disc=[3, 3, 0.1]}", {"disc", "cell", "[0, 1] x [0, 1] [m]"}},
        // within the bounding box of the bracket, but outside of its domain
        BadRegion{
            "in_the_corner", "{disc=[0.8, 0.8, 0.1]}", {"disc", "cell", "[0, 1] x [0, 1] [m]"}},
        BadRegion{"small", "{disc=[0.1, 0.1, 1e-4]}", {"disc", "cell", "[0, 1] x [0, 1] [m]"}},
        BadRegion{"cells_of_a_disc", "{disc=[0.1, 0.1, 0.1], cells=3}", {"cells = 3", "strip"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(PassiveRegions, AreNotSolidAndVoid) {
  const auto both = [](const std::string& hole) {
    try {
      read("short_beam", {"design.solid=[{disc=[0.5, 0.5, 0.2]}]", "design.void=[{" + hole + "}]"});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_TRUE(testing::mentions_all(both("disc=[0.85, 0.5, 0.2]"), {"design.void", "solid"},
                                    "--set design.void=[{disc=[0.85, 0.5, 0.2]}]: "));
  EXPECT_EQ(both("disc=[0.91, 0.5, 0.2]"), "");
  // the regions only touch
  EXPECT_EQ(both("polygon=[0.7, 0.3, 0.9, 0.3, 0.9, 0.7, 0.7, 0.7]"), "");
}

}  // namespace
}  // namespace flexmorph::cases
