// Shows that plates of cells have the stiffness of the design problem when undeformed, that nearly
// empty cells have forces that are derivatives of their energy, as single elements and in batches,
// and that nearly empty cells do not invert.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "fem/model/body_term.h"
#include "fem/shapes/batch.h"
#include "fem/solve/q4_cell.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

constexpr int kNx = 4, kNy = 3;

/// A plate of 4 x 3 cells with one factor for each.
struct Cells {
  AncfPlate plate{2, ShapeSet::q4, testing::uniform_lines(0, 0.01, kNx),
                  testing::uniform_lines(-0.004, 0.005, kNy)};
  ScaleFactors factors;
  BodyTerm term = make_membrane(kThinSection);

  explicit Cells(const std::function<double(int)>& factor) {
    factors.grid = {0, -0.004, 0.01, 0.009, kNx, kNy};
    factors.stiffness.resize(kNx * kNy);
    for (int c = 0; c < kNx * kNy; ++c) factors.stiffness[c] = factor(c);
    factors.mass = factors.stiffness;
    term->prepare(plate, factors, true);
  }
  Local local(int e, const MatrixXd& q) const {
    Local x;
    x.q = testing::rows_of_element(plate, q, e);
    x.v = x.a = LocalRows::Zero(4, 2);
    return x;
  }
  LocalRows force(int e, const Local& x) const {
    LocalRows out = LocalRows::Zero(4, 2);
    term->add_force(e, x, out);
    return out;
  }
  LocalTangent tangent(int e, const Local& x) const {
    LocalTangent out = LocalTangent::Zero(8, 8);
    term->add_tangent(e, x, {1, 0, 0}, out);
    return out;
  }
};

/// Returns factors from void (1e-4) to full material (1), increasing with the number of the cell.
double spread(int c) { return std::pow(10.0, -4 + 4.0 * c / (kNx * kNy - 1)); }

TEST(Cells, AtRestHaveTheStiffnessOfTheDesignProblem) {
  const Cells cells(spread);
  const auto k = q4_stiffness(kThinSection, 0.0025, 0.003);
  // The corners are numbered around the cell in q4_stiffness() and column by column in the element.
  constexpr std::array<std::array<int, 2>, 4> kAround = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  const auto there = [&](int corner) {
    for (size_t a = 0; a < 4; ++a)
      if (kCornerI[a] == kAround[static_cast<size_t>(corner)][0] &&
          kCornerJ[a] == kAround[static_cast<size_t>(corner)][1])
        return static_cast<int>(a);
    return -1;
  };
  for (int e = 0; e < kNx * kNy; ++e) {
    const Local x = cells.local(e, cells.plate.reference());
    const LocalTangent found = cells.tangent(e, x);
    const double factor = cells.factors.stiffness[cells.factors.grid.cell(e / kNy, e % kNy)];
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j)
        EXPECT_NEAR(found(i, j), factor * k(2 * there(i / 2) + i % 2, 2 * there(j / 2) + j % 2),
                    1e-12 * factor * k.cwiseAbs().maxCoeff());
    EXPECT_LT(cells.force(e, x).norm(), 1e-12 * factor * k.cwiseAbs().maxCoeff() * 0.003);
  }
}

TEST(Cells, HaveForcesThatAreDerivativesOfTheirEnergy) {
  const Cells cells(spread);
  const MatrixXd q = testing::random_shape(cells.plate, 0.15, 3);
  for (int e = 0; e < kNx * kNy; ++e) {
    const Local x = cells.local(e, q);
    const LocalRows f = cells.force(e, x);
    const LocalTangent k = cells.tangent(e, x);
    EXPECT_LT((k - k.transpose()).norm(), 1e-12 * k.norm());
    EXPECT_LT(f.colwise().sum().norm(), 1e-12 * f.norm());
    double moment = 0;
    for (int l = 0; l < 4; ++l) moment += x.q(l, 0) * f(l, 1) - x.q(l, 1) * f(l, 0);
    EXPECT_NEAR(moment, 0, 1e-12 * f.norm() * x.q.norm());
    for (int l = 0; l < 4; ++l)
      for (int c = 0; c < 2; ++c) {
        const auto moved = [&](double by) {
          Local y = x;
          y.q(l, c) += by;
          return y;
        };
        const double step = 2e-6;
        const double slope = first_difference(
            [&](double by) { return cells.term->strain_energy(e, moved(by)); }, step);
        EXPECT_NEAR(slope, f(l, c), 1e-7 * f.norm()) << e;
        const MatrixXd column =
            first_difference([&](double by) { return MatrixXd(cells.force(e, moved(by))); }, step);
        for (int row = 0; row < 8; ++row)
          EXPECT_NEAR(column(row / 2, row % 2), k(row, 2 * l + c), 1e-7 * k.norm()) << e;
      }
  }
}

TEST(Cells, AreTheSameAloneAndSideBySide) {
  const Cells cells(spread);
  const MatrixXd q = testing::random_shape(cells.plate, 0.15, 4);
  for (int first = 0; first < kNx * kNy; first += kLanes) {
    Pack all[8] = {}, force[8] = {}, tangent[64] = {};
    Batch batch{.first = first,
                .count = std::min(kLanes, kNx * kNy - first),
                .n_shapes = 4,
                .dim = 2,
                .q = all,
                .v = all,
                .a = all};
    for (int lane = 0; lane < kLanes; ++lane) {
      const Local x = cells.local(first + std::min(lane, batch.count - 1), q);
      for (int k = 0; k < 8; ++k) all[k][lane] = x.q(k / 2, k % 2);
    }
    cells.term.add_forces(batch, force);
    cells.term.add_tangents(batch, {1, 0, 0}, tangent);
    for (int lane = 0; lane < batch.count; ++lane) {
      const Local x = cells.local(first + lane, q);
      const LocalRows f = cells.force(first + lane, x);
      const LocalTangent k = cells.tangent(first + lane, x);
      for (int i = 0; i < 8; ++i) {
        EXPECT_NEAR(force[i][lane], f(i / 2, i % 2), 1e-13 * f.norm());
        for (int j = 0; j < 8; ++j)
          EXPECT_NEAR(tangent[8 * j + i][lane], k(i, j), 1e-13 * k.norm());
      }
    }
  }
}

// A cell is compressed along m to 0.3 of its length: the St. Venant-Kirchhoff material becomes
// unstable below 1/√3, a void cell does not.
TEST(Cells, ThatAreVoidDoNotTurnInsideOut) {
  for (const double factor : {1.0, 1e-4}) {
    const Cells cells([&](int) { return factor; });
    MatrixXd q = cells.plate.reference();
    q.col(0) *= 0.3;
    Eigen::Matrix<double, 8, 1> squeeze = Eigen::Matrix<double, 8, 1>::Zero();
    squeeze[2] = squeeze[4] = 1;  // the corners at the far end along m
    const LocalTangent k = cells.tangent(0, cells.local(0, q));
    const double along = squeeze.dot(k * squeeze) / factor;
    if (factor == 1.0) {
      EXPECT_LT(along, 0);
    } else {
      EXPECT_GT(along, 0.9 * kThinSection.youngs_modulus * kThinSection.thickness);
    }
  }
}

}  // namespace
}  // namespace flexmorph::fem
