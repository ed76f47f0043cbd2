// Shows that both shape sets of the plate reproduce rigid motions and linear fields, that all
// tables agree with differences in space and in time while lines accelerate through the material,
// and that factors on cells cut by moving lines are integrated exactly.
#include "fem/elements/ancf_plate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/differences.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::second_difference;
using testing::ShapeSet;
using testing::swinging_plate;

const std::vector<Vec2> kPoints = {
    {0.17, -0.03}, {0.19, 0.04}, {0.24, -0.02}, {0.29, 0.05}, {0.4, 0.06}};

class EveryShapeSet : public ::testing::TestWithParam<ShapeSet> {};
INSTANTIATE_TEST_SUITE_P(Plate, EveryShapeSet, ::testing::Values(ShapeSet::h12, ShapeSet::h16),
                         [](const auto& set) {
                           return set.param == ShapeSet::h12 ? "h12" : "h16";
                         });

/// Returns the nodal values of r = turn X + shift.
MatrixXd linear_field(const AncfPlate& plate, const Eigen::Matrix2d& turn, const Vec2& shift) {
  MatrixXd q = plate.reference() * turn.transpose();
  for (int k = 0; k < plate.n_vectors(); ++k)
    if (plate.is_position(k)) q.row(k) += shift.transpose();
  return q;
}

// The shape functions contain all linear fields, rotations included, so that only round-off
// remains.
TEST_P(EveryShapeSet, ReproducesLinearFields) {
  const AncfPlate plate = swinging_plate(GetParam(), 0.3);
  Eigen::Matrix2d turn;
  turn << 0.8, -0.7, 0.5, 1.3;
  const Vec2 shift(0.4, -2);
  const MatrixXd q = linear_field(plate, turn, shift);
  ShapeTable t;
  for (const Vec2& x : kPoints) {
    const int e = plate.locate(x, Tabulate::gradient, t);
    const LocalRows rows = testing::rows_of_element(plate, q, e);
    EXPECT_LT(((t.N * rows).transpose() - (turn * x + shift)).norm(), 1e-14);
    EXPECT_LT(((t.N_m * rows).transpose() - turn.col(0)).norm(), 1e-13);
    EXPECT_LT(((t.N_n * rows).transpose() - turn.col(1)).norm(), 1e-13);
    EXPECT_LT((t.material[0] - x).norm(), 1e-15);
  }
}

// The complete set of Bogner-Fox-Schmit contains the twist m n, the incomplete set does not
// (fem/README.md, Plate element).
TEST(AncfPlate, OnlyTheCompleteSetContainsTheTwist) {
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16}) {
    const AncfPlate plate(2, shapes, testing::uniform_lines(0, 1, 1),
                          testing::uniform_lines(0, 1, 1));
    MatrixXd q = MatrixXd::Zero(plate.n_vectors(), 2);
    for (const char* name : {"root", "free_end"})
      for (const NodeVectors& node : plate.edge(name)) {
        q(node.r, 0) = node.material.x() * node.material.y();
        q(node.r_m, 0) = node.material.y();
        q(node.r_n, 0) = node.material.x();
        if (node.r_mn >= 0) q(node.r_mn, 0) = 1;
      }
    ShapeTable t;
    const int e = plate.locate({0.25, 0.25}, Tabulate::position, t);
    const double error = std::abs((t.N * testing::rows_of_element(plate, q, e))(0, 0) - 0.0625);
    if (shapes == ShapeSet::h16)
      EXPECT_LT(error, 1e-15);
    else
      EXPECT_GT(error, 1e-3);
  }
}

TEST_P(EveryShapeSet, GradientsAreDifferencesInTheMaterial) {
  const AncfPlate plate = swinging_plate(GetParam(), 0.3);
  ShapeTable t, near;
  for (const Vec2& x : kPoints) {
    plate.locate(x, Tabulate::gradient, t);
    const auto along = [&](const Vec2& direction) {
      return [&, direction](double step) {
        plate.locate(x + step * direction, Tabulate::position, near);
        return MatrixXd(near.N);
      };
    };
    // The functions are cubic in each direction; therefore differences of order 4 are exact, and
    // the round-off is 1e-16 / 1e-3.
    EXPECT_LT((t.N_m - first_difference(along({1, 0}), 1e-3)).norm(), 1e-11);
    EXPECT_LT((t.N_n - first_difference(along({0, 1}), 1e-3)).norm(), 1e-11);
  }
}

TEST_P(EveryShapeSet, RatesAreDifferencesInTimeAtAFixedMaterialPoint) {
  AncfPlate plate = swinging_plate(GetParam()), moved = plate;
  const double time = 0.3;
  plate.move_to(time);
  ShapeTable t, near;
  for (const Vec2& x : kPoints) {
    plate.locate(x, Tabulate::gradient_rates, t);
    ASSERT_GT(t.N_t.size(), 0);
    const auto later = [&](MatrixXd ShapeTable::*field) {
      return [&, field](double dt) {
        moved.move_to(time + dt);
        moved.locate(x, Tabulate::gradient, near);
        return MatrixXd(near.*field);
      };
    };
    // With the step 1e-3 truncation and round-off of the second difference are near 1e-9; the
    // derivatives of the functions reach 1 / 0.06.
    EXPECT_LT((t.N_t - first_difference(later(&ShapeTable::N), 1e-3)).norm(), 1e-9);
    EXPECT_LT((t.N_tt - second_difference(later(&ShapeTable::N), 1e-3)).norm(), 3e-8);
    EXPECT_LT((t.N_mt - first_difference(later(&ShapeTable::N_m), 1e-3)).norm(), 1e-7);
    EXPECT_LT((t.N_nt - first_difference(later(&ShapeTable::N_n), 1e-3)).norm(), 1e-7);
    plate.locate(x, Tabulate::curvature_rates, t);
    const auto rate = [&](MatrixXd ShapeTable::*field) {
      return first_difference(
          [&](double dt) {
            moved.move_to(time + dt);
            moved.locate(x, Tabulate::curvature, near);
            return MatrixXd(near.*field);
          },
          1e-3);
    };
    // Second derivatives reach (1 / 0.06)².
    EXPECT_LT((t.N_mmt - rate(&ShapeTable::N_mm)).norm(), 1e-5);
    EXPECT_LT((t.N_nnt - rate(&ShapeTable::N_nn)).norm(), 1e-5);
    EXPECT_LT((t.N_mnt - rate(&ShapeTable::N_mn)).norm(), 1e-5);
  }
}

TEST(AncfPlate, TablesWithoutFlowHaveNoRates) {
  const AncfPlate plate(2, ShapeSet::h16, testing::uniform_lines(0, 1, 2),
                        testing::uniform_lines(0, 1, 1));
  ShapeTable t;
  plate.tabulate(0, 3, Tabulate::gradient_rates, {}, ScaleFactorKind::none, t);
  EXPECT_EQ(t.N_t.size() + t.N_tt.size() + t.N_mt.size() + t.N_nt.size(), 0);
  plate.tabulate(0, 3, Tabulate::curvature_rates, {}, ScaleFactorKind::none, t);
  EXPECT_EQ(t.N_mmt.size() + t.N_nnt.size() + t.N_mnt.size(), 0);
  EXPECT_FALSE(plate.moving(0));
}

/// Returns a polynomial of exactly the given degree in each direction.
double polynomial(const Vec2& x, int degree) {
  return std::pow(3 * x.x() - 0.4, degree) * std::pow(9 * x.y() + 0.3, degree);
}

// Weights on cells that are cut by moving lines are compared with an integration of each cell.
TEST_P(EveryShapeSet, FactorsAreIntegratedCellByCell) {
  const ScaleFactors factors = testing::random_factors(7);
  AncfPlate plate = swinging_plate(GetParam());
  ShapeTable t;
  for (const double time : {0.0, 0.37, 1.1}) {
    plate.move_to(time);
    for (int e = 0; e < plate.n_elements(); ++e)
      for (const int degree : {0, 3, 6, 12})
        for (const ScaleFactorKind kind :
             {ScaleFactorKind::none, ScaleFactorKind::stiffness, ScaleFactorKind::mass}) {
          plate.tabulate(e, degree, Tabulate::position, factors, kind, t);
          double sum = 0, largest = 0;
          for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
            const double term =
                t.weight[p] * polynomial(t.material[static_cast<size_t>(p)], degree);
            sum += term;
            largest += std::abs(term);
          }
          const double exact = testing::integrate(
              plate, e, factors, kind, Tabulate::position,
              [&](const ShapeTable& x) { return polynomial(x.material[0], degree); });
          EXPECT_NEAR(sum, exact, 1e-12 * largest) << e << " " << degree;
        }
  }
}

// The product form must give the numbers of the plain table.
TEST_P(EveryShapeSet, ProductsAreThePlainTable) {
  const ScaleFactors factors = testing::random_factors(7);
  const AncfPlate plate = swinging_plate(GetParam(), 0.37);
  ShapeTable t;
  ProductTable products;
  for (const ScaleFactorKind kind : {ScaleFactorKind::none, ScaleFactorKind::stiffness}) {
    plate.tabulate(1, 12, Tabulate::gradient, factors, kind, t);
    ASSERT_TRUE(plate.tabulate_products(1, 12, factors, kind, products));
    ASSERT_EQ(products.weight.size(), t.weight.size());
    for (Eigen::Index g = 0, p = 0; g < products.f_m.rows(); ++g)
      for (Eigen::Index h = 0; h < products.f_n.rows(); ++h, ++p) {
        EXPECT_EQ(products.weight(g, h), t.weight[p]);
        for (int k = 0; k < plate.n_shapes(); ++k) {
          const int i = products.function_m[static_cast<size_t>(k)];
          const int j = products.function_n[static_cast<size_t>(k)];
          EXPECT_NEAR(products.f_m(g, i) * products.f_n(h, j), t.N(p, k), 1e-15);
          EXPECT_NEAR(products.d_m(g, i) * products.f_n(h, j), t.N_m(p, k), 1e-13);
          EXPECT_NEAR(products.f_m(g, i) * products.d_n(h, j), t.N_n(p, k), 1e-13);
        }
      }
  }
}

TEST_P(EveryShapeSet, WholeMassIsTheSumOfTheCellsOutside) {
  const ScaleFactors factors = testing::random_factors(3);
  const double time = 0.62;
  const AncfPlate plate = swinging_plate(GetParam(), time);
  double sum = 0;
  ShapeTable t;
  for (int e = 0; e < plate.n_elements(); ++e) {
    plate.tabulate(e, 6, Tabulate::position, factors, ScaleFactorKind::mass, t);
    sum += t.weight.sum();
  }
  // The expected mass is the sum over all cells, each cut by the root and by the other edges.
  double exact = 0;
  const Grid& g = factors.grid;
  for (int i = 0; i < g.nx; ++i)
    for (int j = 0; j < g.ny; ++j) {
      const double m = std::max(g.x0 + i * g.dx(), plate.line_m(0).value);
      const double n = std::max(g.y0 + j * g.dy(), plate.line_n(0).value);
      exact += factors.mass[g.cell(i, j)] * std::max(0.0, g.x0 + (i + 1) * g.dx() - m) *
               std::max(0.0, g.y0 + (j + 1) * g.dy() - n);
    }
  EXPECT_NEAR(sum, exact, 1e-13 * exact);
}

// Weights are continuous when the root passes a cell line: over 1e-9 s they change only by the
// material that passes (1e-9 s x 0.06 m/s x factor per area).
TEST_P(EveryShapeSet, WeightsAreContinuousWhenALineCrossesACellLine) {
  ScaleFactors factors = testing::random_factors(3);
  AncfPlate plate = swinging_plate(GetParam());
  const double time = 0.4;
  plate.move_to(time);
  // the line is on a cell line at this time
  factors.grid.x0 = plate.line_m(0).value - 3 * factors.grid.dx();
  const auto mass = [&](double at) {
    plate.move_to(at);
    ShapeTable t;
    plate.tabulate(0, 12, Tabulate::position, factors, ScaleFactorKind::stiffness, t);
    return t.weight.sum();
  };
  EXPECT_NEAR(mass(time + 1e-9), mass(time - 1e-9), 1e-11);
  EXPECT_NEAR(mass(time + 1e-9), mass(time), 1e-11);
}

TEST(AncfPlate, RefusesWhatIsNoPlate) {
  EXPECT_THROW(AncfPlate(2, ShapeSet::h16, {{0, {}}}, testing::uniform_lines(0, 1, 1)), Error);
  EXPECT_THROW(AncfPlate(2, ShapeSet::h16, {{0.5, {}}, {0.2, {}}}, testing::uniform_lines(0, 1, 1)),
               Error);
  const AncfPlate plate(2, ShapeSet::h12, testing::uniform_lines(0, 1, 2),
                        testing::uniform_lines(0, 1, 1));
  ShapeTable t;
  EXPECT_THROW(plate.locate({1.1, 0.5}, Tabulate::position, t), Error);
  EXPECT_THROW(plate.edge("left"), Error);
}

}  // namespace
}  // namespace flexmorph::fem
