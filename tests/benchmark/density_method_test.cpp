// Shows that the density method used for comparisons is correct: its filter, its derivatives
// against differences, its contours against known areas.

#include "tests/benchmark/density_method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/benchmark/density_outline.h"

namespace flexmorph::benchmark {
namespace {

/// 12 x 6 cells, clamped at the left, with two loads, a strip of given material at the right end
/// and a void of four cells; one corner cell does not belong to the domain.
struct SmallPlate {
  DensityPlate plate;
  mmc::ComplianceEvaluator loads;

  explicit SmallPlate(bool worst) : plate(make(worst)), loads(load(plate.plate)) {}

  static DensityPlate make(bool worst) {
    DensityPlate out{{{0, 0, 1.2, 0.6, 12, 6}, {1, 1, 0.3, 0}, {}}, {}, 0, false};
    const Grid& g = out.plate.grid;
    out.plate.outside.assign(static_cast<std::size_t>(g.n_cells()), 0);
    out.given.assign(static_cast<std::size_t>(g.n_cells()), 0);
    const auto at = [&](int i, int j) { return static_cast<std::size_t>(g.cell(i, j)); };
    out.plate.outside[at(0, 5)] = 1;
    out.given[at(0, 5)] = -1;
    for (int j = 0; j < 6; ++j) out.given[at(11, j)] = 1;
    for (int k = 0; k < 4; ++k) out.given[at(5 + k / 2, 2 + k % 2)] = -1;
    out.volume = 0.5;
    out.worst = worst;
    return out;
  }

  static mmc::ComplianceEvaluator load(const mmc::Plate& plate) {
    const Grid& g = plate.grid;
    std::vector<fem::HeldUnknown> held;
    for (int j = 0; j < g.ny; ++j)
      for (int c = 0; c < 2; ++c) held.push_back({g.node(0, j), c});
    const mmc::LoadCase loads[] = {{"tip", 1, {{g.node(12, 3), {0, -1}}}, 0},
                                   {"side", 2, {{g.node(8, 6), {0.5, 0.3}}}, 0}};
    return {plate, held, loads, false};
  }
};

VectorXd some_densities(Eigen::Index n) {
  VectorXd x(n);
  for (Eigen::Index k = 0; k < n; ++k) x[k] = 0.5 + 0.35 * std::sin(1.3 * static_cast<double>(k));
  return x;
}

// The weights of every row sum up to one: a uniform field stays uniform, also at the border and
// next to cells outside of the domain.
TEST(DensityFilter, KeepsEvenDensities) {
  const SmallPlate small(false);
  const Grid& g = small.plate.plate.grid;
  const Eigen::SparseMatrix<double> filter = density_filter(small.plate.plate, 2 * g.dx());
  const VectorXd out = filter * VectorXd::Constant(g.n_cells(), 0.3);
  for (int c = 0; c < g.n_cells(); ++c)
    EXPECT_NEAR(out[c], small.plate.plate.has(c) ? 0.3 : 0, 1e-14) << c;
  // Far from the border: w = 2 at the cell, 1 at its sides, 2 - √2 at its corners.
  const double sum = 2 + 4 + 4 * (2 - std::numbers::sqrt2);
  EXPECT_NEAR(filter.coeff(g.cell(3, 2), g.cell(3, 2)), 2 / sum, 1e-14);
  EXPECT_NEAR(filter.coeff(g.cell(3, 2), g.cell(4, 2)), 1 / sum, 1e-14);
  EXPECT_NEAR(filter.coeff(g.cell(3, 2), g.cell(5, 2)), 0, 1e-14);
}

class Derivatives : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(OfTheSumAndOfTheWorst, Derivatives, ::testing::Values(false, true));

// Central differences with steps of 1e-5. The functions are of the order of one, and their third
// derivatives are β^3 times as large: the error is 1e-10 * 500, round-off 1e-11, relative to the
// largest derivative.
TEST_P(Derivatives, AreThoseOfDifferences) {
  SmallPlate small(GetParam());
  const Eigen::SparseMatrix<double> filter =
      density_filter(small.plate.plate, 2 * small.plate.plate.grid.dx());
  const auto n = std::count(small.plate.given.begin(), small.plate.given.end(), 0);
  DensityProblem problem(small.plate, filter, small.loads, {3, 8, 0.6, 1}, some_densities(n));
  const VectorXd x = problem.start();
  const optim::ProblemValues at = problem.evaluate(x);
  ASSERT_EQ(at.g.size(), GetParam() ? 3 : 1);
  const double h = 1e-5;
  for (int k = 0; k < problem.n_variables(); k += 3) {
    VectorXd more = x, less = x;
    more[k] += h;
    less[k] -= h;
    const optim::ProblemValues a = problem.evaluate(more), b = problem.evaluate(less);
    EXPECT_NEAR((a.f - b.f) / (2 * h), at.df[k], 1e-6 * at.df.cwiseAbs().maxCoeff()) << k;
    for (Eigen::Index i = 0; i < at.g.size(); ++i)
      EXPECT_NEAR((a.g[i] - b.g[i]) / (2 * h), at.dg(i, k),
                  1e-6 * at.dg.row(i).cwiseAbs().maxCoeff())
          << i << ' ' << k;
  }
}

// Given cells keep their density; the densities of other cells are projected away from 0.5.
TEST(DensityProblem, LeavesGivenCellsAlone) {
  SmallPlate small(false);
  const Eigen::SparseMatrix<double> filter =
      density_filter(small.plate.plate, 2 * small.plate.plate.grid.dx());
  const auto n = std::count(small.plate.given.begin(), small.plate.given.end(), 0);
  const DensityProblem problem(small.plate, filter, small.loads, {3, 32, 0.5, 1},
                               some_densities(n));
  const Densities found = problem.densities(problem.start());
  for (int c = 0; c < small.plate.plate.grid.n_cells(); ++c) {
    const double filtered = found.filtered[c], projected = found.projected[c];
    if (!small.plate.designs(c))
      EXPECT_EQ(projected, small.plate.given[static_cast<std::size_t>(c)] > 0 ? 1 : 0);
    else
      EXPECT_GE((projected - filtered) * (filtered - 0.5), -1e-12) << c;
  }
}

// A few stages make a cantilever stiffer than uniform densities, which have an eighth of the
// stiffness of material here, and satisfy its volume.
TEST(DensityMethod, BeatsEvenDensities) {
  SmallPlate small(false);
  DensitySettings settings;
  settings.stages = {{1, 1, 0.5, 15}, {3, 1, 0.5, 25}, {3, 8, 0.5, 25}};
  const std::vector<DensityDesign> found = design_by_densities(small.plate, small.loads, settings);
  ASSERT_EQ(found.size(), 3u);
  const VectorXd& rho = found.back().densities.projected;
  EXPECT_LE(rho.sum() / small.plate.plate.n_domain_cells(), small.plate.volume * (1 + 1e-4));
  mmc::ComplianceEvaluator::Value even;
  const VectorXd eighth = VectorXd::Constant(rho.size(), std::pow(small.plate.volume, 3));
  small.loads.evaluate(eighth, eighth, even);
  EXPECT_LT(found.back().compliance, 0.6 * even.f);
}

mmc::BodyProblem empty_problem(const Grid& grid) {
  return {.body = "plate",
          .grid = grid,
          .section = {1, 1, 0.3, 0},
          .design = {grid, {Component{}}, {}},
          .bands = {}};
}

/// Returns a field at the centres of cells that decreases linearly with the distance from a point.
VectorXd cone(const Grid& g, const Vec2& tip, double slope) {
  VectorXd out(g.n_cells());
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j)
      out[g.cell(i, j)] = 1 - slope * (g.cell_center(i, j) - tip).norm();
  return out;
}

// Chords and nodal means neglect the curvature: the error is a quarter of (h / r)² of the area.
TEST(Contour, OfAConeIsADisc) {
  const Grid g{0, 0, 2, 1, 80, 40};
  const double radius = 0.3;
  const std::vector<Region> found =
      regions_above(empty_problem(g), cone(g, {1.013, 0.496}, 1), 1 - radius);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found.front().holes.empty());
  EXPECT_NEAR(area(found), std::numbers::pi * radius * radius,
              0.5 * std::numbers::pi * g.dx() * g.dx());
}

// Around a corner of the domain a quarter of the disc remains and is closed by the border. Border
// nodes have the mean of cells on one side only, which shifts the contour there by half a cell.
TEST(Contour, EndsAtTheBorder) {
  const Grid g{0, 0, 2, 1, 160, 80};
  const double radius = 0.4;
  const std::vector<Region> found = regions_above(empty_problem(g), cone(g, {0, 0}, 1), 1 - radius);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(area(found), 0.25 * std::numbers::pi * radius * radius, 1e-3 * radius * radius);
}

// Regions below the level have rings of their own: an annulus around the largest values at a radius
// of 0.25.
TEST(Contour, HasHoles) {
  const Grid g{0, 0, 1, 1, 60, 60};
  VectorXd field(g.n_cells());
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j)
      field[g.cell(i, j)] = 1 - std::abs((g.cell_center(i, j) - Vec2(0.5, 0.5)).norm() - 0.25);
  const std::vector<Region> found = regions_above(empty_problem(g), field, 0.85);
  ASSERT_EQ(found.size(), 1u);
  ASSERT_EQ(found.front().holes.size(), 1u);
  EXPECT_NEAR(area(found), std::numbers::pi * (0.16 - 0.01), 1e-3);
}

// Given material and voids are kept, whatever the densities are.
TEST(Contour, KeepsToGivenRegions) {
  const Grid g{0, 0, 1, 1, 20, 20};
  mmc::BodyProblem problem = empty_problem(g);
  problem.solid = {corners_of({{0, 0.9}, {1, 1}})};
  problem.empty = {corners_of({{0.4, 0.4}, {0.6, 0.6}})};
  EXPECT_NEAR(area(regions_above(problem, VectorXd::Zero(g.n_cells()), 0.5)), 0.1, 1e-12);
  EXPECT_NEAR(area(regions_above(problem, VectorXd::Ones(g.n_cells()), 0.5)), 0.96, 1e-12);
}

TEST(DensityOutline, EnclosesWhatIsAllowed) {
  const Grid g{0, 0, 2, 1, 40, 20};
  VectorXd waves(g.n_cells());
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      const Vec2 p = g.cell_center(i, j);
      waves[g.cell(i, j)] = 0.5 + 0.4 * std::sin(9 * p.x() + p.y()) * std::cos(7 * p.y());
    }
  mmc::BodyProblem problem = empty_problem(g);
  problem.solid = {corners_of({{1.9, 0}, {2, 1}})};
  for (const double allowed : {0.5, 0.8, 1.1}) {
    const DensityOutline found = outline_of(problem, waves, allowed);
    EXPECT_NEAR(area(found.regions), allowed, 1e-6 * allowed);
    EXPECT_GT(found.level, 0);
    EXPECT_LT(found.level, 1);
  }
}

}  // namespace
}  // namespace flexmorph::benchmark
