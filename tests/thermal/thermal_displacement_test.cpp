// Shows that both methods of T for the thermal displacement, by sweeping (7)-(11) and by the
// inverse mass matrix (12)-(15), give the closed form a (e_o - A_r X_cm) for beams and plates for
// any eliminated positions; that M_H is positive definite; which printed matrices of T are right
// ((33), (37), (A.4), (A.7), (A.12)) and which are wrong ((38), (A.13), (A.14), and (16) for
// references that are not straight).
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <iostream>
#include <numbers>

#include "tests/support/dense.h"
#include "tests/support/errors.h"
#include "tests/thermal/hot_models.h"
#include "tests/thermal/solved_thermal_displacement.h"

namespace flexmorph::fem {
namespace {

using testing::error_of;
using testing::mentions;
using testing::ShapeSet;

constexpr double kRise = 0.02;

AncfBeam beam_of(int n, double angle, double length = 1, double height = 0.1) {
  if (angle == 0) return {length, height, n};
  return {uniform_nodes(length, n), height, arc_reference(length, angle, n)};
}

/// Returns the numbers of the positions of a mesh.
std::vector<int> positions(const Element& e) {
  std::vector<int> out;
  for (int k = 0; k < e.n_vectors(); ++k)
    if (e.is_position(k)) out.push_back(k);
  return out;
}

/// Returns the largest difference as a displacement, relative to the largest displacement.
double relative(const Element& e, const MatrixXd& is, const MatrixXd& should) {
  double difference = 0, largest = 0;
  for (int k = 0; k < e.n_vectors(); ++k) {
    difference = std::max(difference, e.scale(k) * (is - should).row(k).cwiseAbs().maxCoeff());
    largest = std::max(largest, e.scale(k) * should.row(k).cwiseAbs().maxCoeff());
  }
  return difference / largest;
}

struct HeldBeam {
  int n;
  double angle;
};
class ThreeWays : public ::testing::TestWithParam<HeldBeam> {};
INSTANTIATE_TEST_SUITE_P(Beams, ThreeWays,
                         ::testing::Values(HeldBeam{1, 0}, HeldBeam{2, 0}, HeldBeam{6, 0},
                                           HeldBeam{1, std::numbers::pi / 2},
                                           HeldBeam{2, std::numbers::pi / 2},
                                           HeldBeam{6, std::numbers::pi / 2}));

// Condition numbers are below 1e6, so that solutions have errors of 1e-10 at most; they agree to
// 1e-11.
TEST_P(ThreeWays, AgreeWhateverIsEliminated) {
  const AncfBeam beam = beam_of(GetParam().n, GetParam().angle);
  const MatrixXd closed = thermal_displacement(beam, kRise);
  double worst_sweeping = 0, worst_mass = 0;
  for (const int i : positions(beam))
    for (const int j : {positions(beam).front(), i}) {
      const int eliminated[] = {i, j};
      const auto sweeping = thermal_displacement_by_sweeping(beam, kRise, eliminated),
                 mass = thermal_displacement_by_mass(beam, kRise, eliminated);
      EXPECT_LT(relative(beam, sweeping.value, closed), 1e-11);
      EXPECT_LT(relative(beam, mass.value, closed), 1e-11);
      worst_sweeping = std::max(worst_sweeping, sweeping.condition);
      worst_mass = std::max(worst_mass, mass.condition);
    }
  std::cout << "  " << GetParam().n << " elements, " << GetParam().angle
            << " rad: condition of M_H " << worst_sweeping << ", of H^T I_u H " << worst_mass
            << '\n';
  RecordProperty("condition_sweeping", std::to_string(worst_sweeping));
  RecordProperty("condition_mass", std::to_string(worst_mass));
  EXPECT_LT(worst_sweeping, 1e6);
  EXPECT_LT(worst_mass, 1e6);
}

// In the closed form every point moves away from the centre of mass, which is found here by a
// separate sum.
TEST_P(ThreeWays, EveryPointGrowsFromTheCentreOfMass) {
  const AncfBeam beam = beam_of(GetParam().n, GetParam().angle);
  const MatrixXd closed = thermal_displacement(beam, kRise);
  ShapeTable t;
  double mass = 0;
  Eigen::RowVector2d centre(0, 0);
  for (int e = 0; e < beam.n_elements(); ++e) {
    beam.tabulate(e, 10, Tabulate::position, {}, ScaleFactorKind::none, t);
    mass += t.weight.sum();
    const MatrixXd local = testing::rows_of_element(beam, beam.reference(), e);
    centre += t.weight.transpose() * (t.N * local);
  }
  centre /= mass;
  for (int e = 0; e < beam.n_elements(); ++e) {
    beam.tabulate(e, 4, Tabulate::position, {}, ScaleFactorKind::none, t);
    const MatrixXd X = t.N * testing::rows_of_element(beam, beam.reference(), e),
                   u = t.N * testing::rows_of_element(beam, closed, e);
    for (Eigen::Index p = 0; p < X.rows(); ++p)
      EXPECT_LT((u.row(p) - kRise * (X.row(p) - centre)).norm(), 1e-15);
  }
}

TEST(ThermalDisplacement, OfPlatesThreeWays) {
  for (const int dim : {2, 3})
    for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16}) {
      const AncfPlate plate(dim, shapes, {{0.1, {}}, {0.17, {}}, {0.4, {}}},
                            {{-0.05, {}}, {0.01, {}}, {0.07, {}}});
      const MatrixXd closed = thermal_displacement(plate, kRise);
      EXPECT_NEAR(closed(0, 0), kRise * (0.1 - 0.25), 1e-15);
      for (const int i : {0, positions(plate)[4], positions(plate).back()}) {
        const std::vector<int> eliminated(static_cast<size_t>(dim), i);
        const auto sweeping = thermal_displacement_by_sweeping(plate, kRise, eliminated),
                   mass = thermal_displacement_by_mass(plate, kRise, eliminated);
        // The error is round-off times the condition number, which is larger than for beams.
        EXPECT_LT(relative(plate, sweeping.value, closed), 1e-15 * sweeping.condition);
        EXPECT_LT(relative(plate, mass.value, closed), 1e-10);
        std::cout << "  plate " << dim << "d h" << plate.n_shapes() << ": condition of M_H "
                  << sweeping.condition << ", of H^T I_u H " << mass.condition << "; errors "
                  << relative(plate, sweeping.value, closed) << ' '
                  << relative(plate, mass.value, closed) << '\n';
      }
    }
}

TEST(ThermalDisplacement, GrowsFromTheCentreOfTheDesignedMass) {
  const AncfPlate plate(2, ShapeSet::h16, {{0.1, {}}, {0.3, {}}, {0.45, {}}},
                        {{-0.05, {}}, {0.07, {}}});
  const ScaleFactors factors = testing::random_factors(3);
  const ThermalMatrices m = thermal_matrices(plate, 27, factors);
  double mass = 0, first = 0;
  for (int e = 0; e < 2; ++e) {
    const auto sum = [&](auto f) {
      return 27 *
             testing::integrate(plate, e, factors, ScaleFactorKind::mass, Tabulate::position, f);
    };
    mass += sum([](const ShapeTable&) { return 1.0; });
    first += sum([&](const ShapeTable& t) {
      return (t.N * testing::rows_of_element(plate, plate.reference(), e))(0, 0);
    });
  }
  EXPECT_NEAR(m.S.dot(m.A_r), mass, 1e-12 * mass);
  EXPECT_NEAR(m.centre[0], first / mass, 1e-12);
}

TEST(ThermalDisplacement, RefusesOtherEliminations) {
  const AncfBeam beam(1, 0.1, 2);
  const auto refused = [&](std::vector<int> eliminated, const std::string& why) {
    EXPECT_TRUE(
        mentions(error_of(Error::Kind::input,
                          [&] { thermal_displacement_by_sweeping(beam, 0.01, eliminated); }),
                 why));
    EXPECT_TRUE(mentions(
        error_of(Error::Kind::input, [&] { thermal_displacement_by_mass(beam, 0.01, eliminated); }),
        why));
  };
  refused({0, 1}, "no position");
  refused({2, 0}, "no position");
  refused({0, 17}, "no position");
  refused({0}, "translation");
  refused({0, 0, 3, 3}, "translation");  // a pair per element
  const AncfPlate moving = testing::swinging_plate(ShapeSet::h16);
  EXPECT_TRUE(
      mentions(error_of(Error::Kind::input, [&] { thermal_displacement(moving, 0.01); }), "lines"));
}

// The matrices that T prints for one straight element, one direction of them.
class Printed : public ::testing::Test {
 protected:
  static constexpr double l = 0.7, h = 0.2;
  AncfBeam beam{l, h, 1};
  ThermalMatrices m = thermal_matrices(beam, 5);
  MatrixXd of_beam = relative_mass(beam, 5);  // M_rd
  double mass = 5 * l * h;
  MatrixXd H = sweeping_matrix(m, 0);
  MatrixXd M_inverse = testing::inverse(m.M);
  MatrixXd I_u = MatrixXd::Identity(6, 6) - M_inverse * m.S * VectorXd::Unit(6, 0).transpose();
  MatrixXd system = H.transpose() * I_u * H;  // HᵀI_uH

  static double largest(const MatrixXd& x) { return x.cwiseAbs().maxCoeff(); }
};

TEST_F(Printed, SAndM_rdAndHAreRight) {  // (A.4), (A.7), (A.12)
  VectorXd S(6);
  S << 1, l / 6, 0, 1, -l / 6, 0;
  EXPECT_LT(largest(m.S - mass / 2 * S), 1e-15);
  MatrixXd M_rd(6, 6);
  M_rd << 13. / 35, -13 * l / 420, 0, -13. / 35, 11 * l / 210, 0,    //
      -13 * l / 420, l * l / 105, 0, 13 * l / 420, -l * l / 140, 0,  //
      0, 0, h * h / 36, 0, 0, h * h / 72,                            //
      -13. / 35, 13 * l / 420, 0, 13. / 35, -11 * l / 210, 0,        //
      11 * l / 210, -l * l / 140, 0, -11 * l / 210, l * l / 105, 0,  //
      0, 0, h * h / 72, 0, 0, h * h / 36;
  EXPECT_LT(largest(of_beam - mass * M_rd), 1e-14);
  MatrixXd printed = MatrixXd::Zero(6, 5);
  printed.row(0) << -l / 6, 0, -1, l / 6, 0;
  printed.bottomRows(5).setIdentity();
  EXPECT_LT(largest(H - printed), 1e-14);
}

TEST_F(Printed, CoefficientsOfTheAlternateApproachAreRight) {  // (33), its inverse (34), (37)
  MatrixXd printed = MatrixXd::Identity(5, 5);
  printed.row(2) << l / 6, 0, 2, -l / 6, 0;
  EXPECT_LT(largest(system - printed), 1e-12);
  MatrixXd inverse = MatrixXd::Identity(5, 5);
  inverse.row(2) << -l / 12, 0, 0.5, l / 12, 0;
  EXPECT_LT(largest(testing::inverse(system) - inverse), 1e-12);
  // (36) comes from quadrature, then (37) follows.
  ShapeTable t;
  beam.tabulate(0, 8, Tabulate::position, {}, ScaleFactorKind::none, t);
  VectorXd I_x = VectorXd::Zero(6), I_y = I_x, in_x(6), in_y(6);
  for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
    I_x += 5 * t.weight[p] * t.material[static_cast<size_t>(p)].x() * t.N.row(p).transpose();
    I_y += 5 * t.weight[p] * t.material[static_cast<size_t>(p)].y() * t.N.row(p).transpose();
  }
  in_x << 1.5, l / 3, 0, 3.5, -l / 2, 0;
  in_y << 0, 0, 1, 0, 0, 1;
  EXPECT_LT(largest(I_x - mass * l / 10 * in_x), 1e-14);
  EXPECT_LT(largest(I_y - mass * h * h / 24 * in_y), 1e-14);
  VectorXd x(5), y(5);
  x << 1, 0, l / 2, 1, 0;
  y << 0, 1, 0, 0, 1;
  const VectorXd is_x = testing::solve(system, H.transpose() * (M_inverse * I_x)),
                 is_y = testing::solve(system, H.transpose() * (M_inverse * I_y));
  EXPECT_LT(largest(is_x - x), 1e-11);
  EXPECT_LT(largest(is_y - y), 1e-11);
  // (38) prints H times it as [-l/2 1 0 l/2 0], which are five entries. The missing entry is the 1
  // of r_x at the second node.
  VectorXd all(6);
  all << -l / 2, 1, 0, l / 2, 1, 0;
  EXPECT_LT(largest(H * is_x - all), 1e-11);
}

TEST_F(Printed, ProductsWithTheSweepingMatrixAreWrong) {  // (A.13), (A.14)
  // S_rd H at a point is printed as [s₂ s₃ 2s₄ s₅ s₆]; the right one has ± l/6 s₄ added at the
  // slopes.
  ShapeTable t;
  beam.locate({0.4 * l, 0.1 * h}, Tabulate::position, t);
  Eigen::RowVectorXd S_rd = t.N.row(0);
  S_rd[0] -= 1;
  const Eigen::RowVectorXd is = S_rd * H;
  Eigen::RowVectorXd printed(5), right(5);
  const double s4 = t.N(0, 3);
  printed << t.N(0, 1), t.N(0, 2), 2 * s4, t.N(0, 4), t.N(0, 5);
  right = printed;
  right[0] += l / 6 * s4;
  right[3] -= l / 6 * s4;
  EXPECT_LT(largest(is - right), 1e-15);
  EXPECT_GT(largest(is - printed), 0.03 * l);

  MatrixXd M_H(5, 5);
  M_H << l * l / 105, 0, 13 * l / 210, -l * l / 140, 0,  //
      0, h * h / 36, 0, 0, h * h / 72,                   //
      13 * l / 210, 0, 52. / 35, -11 * l / 105, 0,       //
      -l * l / 140, 0, -11 * l / 105, l * l / 105, 0,    //
      0, h * h / 72, 0, 0, h * h / 36;
  const MatrixXd exact = H.transpose() * of_beam * H / mass, error = (exact - M_H).eval();
  // These entries are right: all of r_y, and r₂ with itself.
  for (const auto& [i, j] : {std::pair{1, 1}, {1, 4}, {4, 4}, {2, 2}, {0, 1}, {2, 4}})
    EXPECT_NEAR(exact(i, j), M_H(i, j), 1e-14);
  // These entries are wrong: all of the slopes r_x, with each other and with r₂.
  for (const auto& [i, j] : {std::pair{0, 0}, {0, 2}, {0, 3}, {2, 3}, {3, 3}})
    EXPECT_GT(std::abs(error(i, j) / exact(i, j)), 0.3) << i << ' ' << j;
  std::cout << "  (A.14) over what is right: (1,1) " << M_H(0, 0) / exact(0, 0) << ", (1,3) "
            << M_H(0, 2) / exact(0, 2) << ", (1,4) " << M_H(0, 3) / exact(0, 3) << ", (3,4) "
            << M_H(2, 3) / exact(2, 3) << ", (4,4) " << M_H(3, 3) / exact(3, 3) << '\n';
  // The printed matrix would give another result.
  const VectorXd b = H.transpose() * of_beam * m.reference.col(0) / mass;
  const VectorXd e = testing::solve(M_H, b), right_e = testing::solve(exact, b);
  EXPECT_LT((right_e - m.from_centre().col(0).tail(5)).norm(), 1e-12);
  EXPECT_GT((e - right_e).norm(), 0.05);
}

// (16) has a J_o x instead of a (X - X_o); both are equal only if J_o is constant.
TEST(PrintedEquation16, HoldsForStraightReferencesOnly) {
  for (const double angle : {0.0, std::numbers::pi / 2}) {
    const AncfBeam beam = beam_of(1, angle);
    const ThermalMatrices m = thermal_matrices(beam, 1);
    const MatrixXd H = sweeping_matrix(m, 0);
    const MatrixXd M_inverse = testing::inverse(m.M);
    const MatrixXd I_u =
        MatrixXd::Identity(6, 6) - M_inverse * m.S * VectorXd::Unit(6, 0).transpose();
    ShapeTable t;
    beam.tabulate(0, 12, Tabulate::gradient, {}, ScaleFactorKind::none, t);
    MatrixXd right = MatrixXd::Zero(6, 2);
    // J_o contains the derivatives of X by x and y, from differences of located points.
    for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
      const Vec2 x = t.material[static_cast<size_t>(p)];
      const auto X = [&](const Vec2& at) {
        ShapeTable one;
        beam.locate(at, Tabulate::position, one);
        return Eigen::RowVector2d(one.N.row(0) * m.reference);
      };
      const double d = 1e-4;
      const Eigen::RowVector2d X_x = (X(x + Vec2(d, 0)) - X(x - Vec2(d, 0))) / (2 * d),
                               X_y = (X(x + Vec2(0, d)) - X(x - Vec2(0, d))) / (2 * d);
      right += t.weight[p] * t.N.row(p).transpose() * kRise * (x[0] * X_x + x[1] * X_y);
    }
    const MatrixXd system = H.transpose() * I_u * H, b = H.transpose() * (M_inverse * right);
    const MatrixXd e = H * testing::solve(system, b);
    const double error = relative(beam, e, thermal_displacement(beam, kRise));
    if (angle == 0)
      EXPECT_LT(error, 1e-8);
    else
      EXPECT_GT(error, 0.1);
    std::cout << "  (16) at " << angle << " rad: relative error " << error << '\n';
  }
}

}  // namespace
}  // namespace flexmorph::fem
