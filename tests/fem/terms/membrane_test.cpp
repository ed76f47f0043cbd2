// Shows that the Gram form of the in-plane elastic force is the St. Venant-Kirchhoff plate, against
// a plain Gauss integration of the virtual work and against differences, with uniform material and
// with cells cut by moving lines; that rigid motions have no strain; and that the power of the flow
// closes the balance of the strain energy.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;
using testing::swinging_plate;

struct Point {
  Eigen::RowVector2d r_m, r_n;
  Vec3 strain, stress;  // stress: membrane force per length
};

Point point(const ShapeTable& t, const LocalRows& q) {
  Point p;
  p.r_m = t.N_m * q;
  p.r_n = t.N_n * q;
  p.strain << 0.5 * (p.r_m.squaredNorm() - 1), 0.5 * (p.r_n.squaredNorm() - 1), p.r_m.dot(p.r_n);
  const double nu = kThinSection.poisson_ratio;
  const double c = kThinSection.thickness * kThinSection.youngs_modulus / (1 - nu * nu);
  p.stress << c * (p.strain[0] + nu * p.strain[1]), c * (p.strain[1] + nu * p.strain[0]),
      c * (1 - nu) / 2 * p.strain[2];
  return p;
}

/// Returns the variation of the strain by unknown (k, c).
Vec3 variation(const Point& p, const ShapeTable& t, Eigen::Index k, Eigen::Index c) {
  return {t.N_m(0, k) * p.r_m[c], t.N_n(0, k) * p.r_n[c],
          t.N_m(0, k) * p.r_n[c] + t.N_n(0, k) * p.r_m[c]};
}

/// Force, energy or tangent of one element by 7 x 7 points in every cell.
struct ByPoints {
  const AncfPlate& plate;
  int e;
  const LocalRows& q;
  const ScaleFactors& factors;

  double sum(const std::function<double(const ShapeTable&)>& f) const {
    return testing::integrate(plate, e, factors, ScaleFactorKind::stiffness, Tabulate::gradient, f);
  }
  double energy() const {
    return sum([&](const ShapeTable& t) {
      const Point p = point(t, q);
      return 0.5 * p.strain.dot(p.stress);
    });
  }
  LocalRows force() const {
    LocalRows out(q.rows(), 2);
    for (Eigen::Index k = 0; k < q.rows(); ++k)
      for (Eigen::Index c = 0; c < 2; ++c)
        out(k, c) = sum([&](const ShapeTable& t) {
          const Point p = point(t, q);
          return variation(p, t, k, c).dot(p.stress);
        });
    return out;
  }
  double tangent(Eigen::Index k, Eigen::Index b, Eigen::Index l, Eigen::Index c) const {
    const Eigen::Matrix3d elasticity = kThinSection.thickness * kThinSection.elasticity();
    return sum([&](const ShapeTable& t) {
      const Point p = point(t, q);
      const double mm = t.N_m(0, k) * t.N_m(0, l), nn = t.N_n(0, k) * t.N_n(0, l),
                   mn = t.N_m(0, k) * t.N_n(0, l) + t.N_n(0, k) * t.N_m(0, l);
      const double geometric = b == c ? Vec3(mm, nn, mn).dot(p.stress) : 0;
      return variation(p, t, k, b).dot(elasticity * variation(p, t, l, c)) + geometric;
    });
  }
};

struct MembraneTerm {
  ShapeSet shapes;
  bool designed;
};

class Membrane : public ::testing::TestWithParam<MembraneTerm> {
 protected:
  Membrane() {
    if (GetParam().designed) factors = testing::random_factors(5);
    plate.move_to(0.37);
    term->prepare(plate, factors, true);
  }
  Local local(int e, double size = 0.2, unsigned seed = 1) const {
    Local x;
    x.q = testing::rows_of_element(plate, testing::random_shape(plate, size, seed), e);
    x.v = x.a = LocalRows::Zero(x.q.rows(), 2);
    return x;
  }
  LocalRows force(int e, const Local& x) const {
    LocalRows f = LocalRows::Zero(x.q.rows(), 2);
    term->add_force(e, x, f);
    return f;
  }
  LocalTangent tangent(int e, const Local& x) const {
    LocalTangent k = LocalTangent::Zero(x.q.size(), x.q.size());
    term->add_tangent(e, x, {1, 0, 0}, k);
    return k;
  }
  double unit_energy() const {  // approximate energy of unit strain everywhere
    return kThinSection.youngs_modulus * kThinSection.thickness * 0.1 * 0.06;
  }

  AncfPlate plate = swinging_plate(GetParam().shapes);
  ScaleFactors factors;
  BodyTerm term = make_membrane(kThinSection);
};
INSTANTIATE_TEST_SUITE_P(
    Shapes, Membrane,
    ::testing::Values(MembraneTerm{ShapeSet::h12, false}, MembraneTerm{ShapeSet::h16, false},
                      MembraneTerm{ShapeSet::h12, true}, MembraneTerm{ShapeSet::h16, true},
                      MembraneTerm{ShapeSet::q4, false}, MembraneTerm{ShapeSet::q4, true}),
    [](const auto& c) {
      return std::string(c.param.shapes == ShapeSet::h12   ? "h12"
                         : c.param.shapes == ShapeSet::h16 ? "h16"
                                                           : "q4") +
             (c.param.designed ? "_designed" : "_uniform");
    });

// Both are exact for the polynomial of degree 12, so that they differ only by round-off of about
// 10^4 products.
TEST_P(Membrane, ForceAndEnergyAreThoseOfGaussPoints) {
  for (int e = 0; e < plate.n_elements(); ++e) {
    const Local x = local(e);
    const ByPoints points{plate, e, x.q, factors};
    const LocalRows expected = points.force();
    EXPECT_LT((force(e, x) - expected).cwiseAbs().maxCoeff(),
              1e-12 * expected.cwiseAbs().maxCoeff());
    EXPECT_NEAR(term->strain_energy(e, x), points.energy(), 1e-12 * points.energy());
  }
}

TEST_P(Membrane, TangentIsThatOfGaussPoints) {
  const int e = 3;
  const Local x = local(e);
  const ByPoints points{plate, e, x.q, factors};
  const LocalTangent k = tangent(e, x);
  const double largest = k.cwiseAbs().maxCoeff();
  // Only every seventh entry is compared, because the loop over points is slow; 7 is prime to the
  // pattern.
  for (Eigen::Index entry = 0; entry < k.size(); entry += 7) {
    const Eigen::Index row = entry / k.cols(), column = entry % k.cols();
    EXPECT_NEAR(k(row, column), points.tangent(row / 2, row % 2, column / 2, column % 2),
                1e-12 * largest);
  }
}

// The force is cubic in the unknowns: differences of order 4 are exact except for round-off.
TEST_P(Membrane, TangentIsTheDerivativeOfTheForceAndForceThatOfTheEnergy) {
  const int e = 2;
  const Local x = local(e);
  const LocalTangent k = tangent(e, x);
  const LocalRows f = force(e, x);
  const auto vectors = plate.vectors(e);
  EXPECT_LT((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-13 * k.cwiseAbs().maxCoeff());
  for (Eigen::Index l = 0; l < x.q.rows(); ++l)
    for (Eigen::Index c = 0; c < 2; ++c) {
      const double step = 1e-2 / plate.scale(vectors[static_cast<size_t>(l)]) * 0.05;
      const auto moved = [&](double by) {
        Local y = x;
        y.q(l, c) += by;
        return y;
      };
      const MatrixXd df =
          first_difference([&](double by) { return MatrixXd(force(e, moved(by))); }, step);
      double worst = 0, largest = 0;
      for (Eigen::Index row = 0; row < f.size(); ++row) {
        worst = std::max(worst, std::abs(df(row / 2, row % 2) - k(row, 2 * l + c)));
        largest = std::max(largest, std::abs(k(row, 2 * l + c)));
      }
      EXPECT_LT(worst, 1e-9 * largest);
      const double du =
          first_difference([&](double by) { return term->strain_energy(e, moved(by)); }, step);
      EXPECT_NEAR(du, f(l, c), 1e-9 * f.col(c).cwiseAbs().maxCoeff());
    }
}

// A motion of 10 m has a round-off of 10 m x 1e-16 in the positions, 2e-14 of the element size.
TEST_P(Membrane, RigidMotionStrainsNothing) {
  Eigen::Matrix2d turn;
  turn << std::cos(0.7), -std::sin(0.7), std::sin(0.7), std::cos(0.7);
  MatrixXd q = plate.reference() * turn.transpose();
  for (int k = 0; k < plate.n_vectors(); ++k)
    if (plate.is_position(k)) q.row(k) += Eigen::RowVector2d(8, -6);
  for (int e = 0; e < plate.n_elements(); ++e) {
    Local x;
    x.q = testing::rows_of_element(plate, q, e);
    EXPECT_LT(std::abs(term->strain_energy(e, x)), 1e-12 * unit_energy());
    EXPECT_LT(force(e, x).cwiseAbs().maxCoeff(), 1e-12 * unit_energy() / 0.06);
  }
}

// Stress and strain rotate with the body; therefore the energy does not change in a large rotation.
TEST_P(Membrane, EnergyDoesNotSeeRotations) {
  Eigen::Matrix2d turn;
  turn << std::cos(2.1), -std::sin(2.1), std::sin(2.1), std::cos(2.1);
  Local x = local(1);
  const double before = term->strain_energy(1, x);
  x.q = (x.q * turn.transpose()).eval();
  EXPECT_NEAR(term->strain_energy(1, x), before, 1e-12 * before);
}

// With constant unknowns, dU/dt = power of the flow + energy density x speed over the moving edges
// (which balance.h counts as inflow and flow_power() does not contain). Only uniform material is
// tested, because with cells the edge term jumps with the factor.
TEST_P(Membrane, FlowPowerClosesTheEnergyBalance) {
  if (GetParam().designed) return;
  const double time = 0.37;
  const GaussRule& rule = gauss(7);
  for (int e = 0; e < plate.n_elements(); ++e) {
    const Local x = local(e);
    const double du = first_difference(
        [&](double dt) {
          plate.move_to(time + dt);
          term->prepare(plate, factors, true);
          return term->strain_energy(e, x);
        },
        1e-4);
    plate.move_to(time);
    term->prepare(plate, factors, true);
    const int i = e / plate.n_n(), j = e % plate.n_n();
    const Motion left = plate.line_m(i), right = plate.line_m(i + 1), low = plate.line_n(j),
                 high = plate.line_n(j + 1);
    const auto density = [&](double s, double u) {
      ShapeTable t;
      plate.at(e, s, u, Tabulate::gradient, t);
      const Point p = point(t, x.q);
      return 0.5 * p.strain.dot(p.stress);
    };
    double edges = 0;
    for (size_t g = 0; g < 7; ++g) {
      const double w = rule.weights[g], z = rule.points[g];
      edges +=
          w * (high.value - low.value) * (right.rate * density(1, z) - left.rate * density(0, z));
      edges +=
          w * (right.value - left.value) * (high.rate * density(z, 1) - low.rate * density(z, 0));
    }
    const double power = term.flow->flow_power(e, x);
    // Truncation (1e-4 s)^4 and round-off 1e-16 / 1e-4 of an energy that changes within seconds.
    const double scale = std::abs(power) + std::abs(edges) + term->strain_energy(e, x);
    EXPECT_NEAR(du, power + edges, 1e-9 * scale) << e;
  }
}

TEST(MembraneTerm, TableNamesWhatItKnows) {
  EXPECT_NO_THROW(make_term("membrane", kThinSection));
  try {
    make_term("torsion", kThinSection);
    FAIL();
  } catch (const Error& error) {
    for (const TermRow* row : term_rows())
      EXPECT_NE(std::string(error.what()).find(row->name), std::string::npos) << row->name;
  }
}

}  // namespace
}  // namespace flexmorph::fem
