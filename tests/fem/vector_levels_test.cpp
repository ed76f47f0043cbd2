// Shows that the vector kernels for all instruction sets of this processor give the same forces,
// tangents, topology descriptions and their derivatives to round-off, and that factors solve with
// any number of loads.
#include <gtest/gtest.h>

#include "fem/elements/ancf_plate.h"
#include "fem/model/workspace.h"
#include "fem/solve/static_solver.h"
#include "fem/terms.h"
#include "geometry/components/tdf.h"
#include "geometry/vector_limit.h"
#include "tests/geometry/random_components.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

constexpr VectorLevel kLevels[] = {VectorLevel::baseline, VectorLevel::v3, VectorLevel::v4};

/// Restores the vector level of the processor at the end of a test.
struct AllLevels {
  ~AllLevels() { limit_vector_level(VectorLevel::v4); }
};

class EveryLevel : public ::testing::TestWithParam<std::tuple<int, const char*>> {};

TEST_P(EveryLevel, GivesTheSameForcesAndTangents) {
  const auto [dim, membrane] = GetParam();
  const PlaneSection section{0.01, 1e8, 0.3, 2700};
  std::vector<std::string> names{"inertia", membrane};
  if (dim == 3) names.emplace_back("bending");
  Workspace model;
  model.add_body(
      "plate",
      std::make_unique<AncfPlate>(dim, AncfPlate::ShapeSet::h16, testing::uniform_lines(0, 1, 5),
                                  testing::uniform_lines(0, 0.3, 2)),
      section, make_terms(names, section, {}));
  State x = model.reference();
  x.q += 0.02 * VectorXd::Random(x.q.size()).cwiseQuotient(model.scales());
  x.v = VectorXd::Random(x.q.size());
  x.a = VectorXd::Random(x.q.size());
  const AllLevels afterwards;
  VectorXd first;
  SparseMatrix first_tangent;
  for (const VectorLevel level : kLevels) {
    limit_vector_level(level);
    EXPECT_LE(vector_level(), level);
    VectorXd force;
    SparseMatrix tangent;
    Constraints none;
    model.force(x, force);
    model.constraints(x, none);
    model.kkt(x, none, {1, 10, 100}, 1, tangent);
    if (first.size() == 0) first = force, first_tangent = tangent;
    ASSERT_GT(first.norm(), 0);
    EXPECT_LT((force - first).norm(), 1e-12 * first.norm());  // sums of some hundred products
    EXPECT_LT((tangent - first_tangent).norm(), 1e-12 * first_tangent.norm());
  }
}

// The residual K u - f is computed cell by cell, without the factor. The blocks of this plate have
// 2 to 100 columns, and numbers of loads leave remainders of every kind in groups of lanes.
// Backward errors are some units of round-off of |K| |u|; |K| is below 4 here.
TEST(VectorLevels, FactorsSolveWithAnyNumberOfLoads) {
  const Grid grid{.width = 6, .height = 5, .nx = 60, .ny = 50};
  std::vector<HeldUnknown> held;
  for (int j = 0; j <= grid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({grid.node(0, j), c});
  VectorXd stiffness(grid.n_cells());
  for (int cell = 0; cell < grid.n_cells(); ++cell)
    stiffness[cell] = cell % 7 < 3 ? 1.0 : 0.01 + 0.001 * (cell % 13);
  StaticSolver solver(grid, {1, 1, 0.3, 0}, held);
  constexpr int kMaxLoads = 41;
  MatrixXd loads(kMaxLoads, solver.n_unknowns());
  for (Eigen::Index k = 0; k < loads.size(); ++k)
    loads.data()[k] = std::cos(static_cast<double>(k) * static_cast<double>(k % 101));
  const AllLevels afterwards;
  for (const VectorLevel level : kLevels) {
    limit_vector_level(level);
    solver.factorize(stiffness);
    MatrixXd all = loads, forces;
    solver.solve(all);
    for (const int n : {1, 2, 3, 7, 8, 13, 24, 31, kMaxLoads}) {
      MatrixXd u = loads.topRows(n);
      solver.solve(u);
      solver.apply(stiffness, u, forces);
      EXPECT_LT((forces - loads.topRows(n)).norm(), 1e-15 * 4 * u.norm()) << n;
      if (n == 1) continue;
      EXPECT_EQ(u, all.topRows(n)) << n;  // no load depends on those beside it
    }
  }
}

TEST(VectorLevels, GiveTheSameTopologyDescription) {
  const Grid grid{.width = 2, .height = 1, .nx = 83, .ny = 37};
  test::RandomComponents random(5);
  const std::vector<Component> components = random.several(20, 2, 1);
  const VectorXd by_h = VectorXd::LinSpaced(grid.n_nodes(), -1, 2), by_eroded = by_h.array().cos();
  const MatrixXd many = by_eroded.transpose().replicate(3, 1);
  const AllLevels afterwards;
  for (const auto kind : {TdfSettings::Kind::distance, TdfSettings::Kind::paper}) {
    TdfSettings settings;
    settings.kind = kind;
    settings.band = kind == TdfSettings::Kind::paper ? 0.5 : 0.03;
    settings.sharpness = 60;
    settings.min_half_thickness = 0.02;
    UnionTdf tdf(grid, settings);
    VectorXd phi, slope, first_slope;
    MatrixXd slopes;
    for (const VectorLevel level : kLevels) {
      limit_vector_level(level);
      tdf.evaluate(components);
      tdf.pull_back(by_h, by_eroded, slope);
      tdf.pull_back(MatrixXd(), many, slopes);
      if (phi.size() == 0) phi = tdf.phi(), first_slope = slope;
      // Sums over some thousand nodes.
      EXPECT_LT((tdf.phi() - phi).lpNorm<Eigen::Infinity>(), 1e-13);
      EXPECT_LT((slope - first_slope).norm(), 1e-11 * first_slope.norm());
      VectorXd alone;
      tdf.pull_back(VectorXd::Zero(grid.n_nodes()), by_eroded, alone);
      EXPECT_LT((slopes.row(2).transpose() - alone).norm(), 1e-12 * alone.norm());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(VectorLevels, EveryLevel,
                         ::testing::Combine(::testing::Values(2, 3),
                                            ::testing::Values("membrane", "membrane_assumed")));

}  // namespace
}  // namespace flexmorph::fem
