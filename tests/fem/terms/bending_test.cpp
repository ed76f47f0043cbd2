// Shows that the bending term is ½ ∫ κᵀ D κ dA with the curvatures of the deformed surface, against
// known surfaces (cylinder, saddle) and differences; that rigid motions have no bending energy; and
// that the membrane in space has these properties, too.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/sections.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

struct BendingTerm {
  std::string term;
  ShapeSet shapes;
  bool designed;
};

class SpaceTerm : public ::testing::TestWithParam<BendingTerm> {
 protected:
  SpaceTerm()
      : plate(3, GetParam().shapes, {{0.1, {}}, {0.21, {}}, {0.3, {}}, {0.45, {}}},
              {{-0.05, {}}, {0.01, {}}, {0.07, {}}}),
        term(make_term(GetParam().term, kThinSection)) {
    if (GetParam().designed) factors = testing::random_factors(5);
    term->prepare(plate, factors, true);
  }
  Local local(int e, double size = 0.2, unsigned seed = 1) const {
    Local x;
    x.q = testing::rows_of_element(plate, testing::random_shape(plate, size, seed), e);
    return x;
  }
  LocalRows force(int e, const Local& x) const {
    LocalRows f = LocalRows::Zero(x.q.rows(), 3);
    term->add_force(e, x, f);
    return f;
  }

  AncfPlate plate;
  ScaleFactors factors;
  BodyTerm term;
};
INSTANTIATE_TEST_SUITE_P(Shapes, SpaceTerm,
                         ::testing::Values(BendingTerm{"bending", ShapeSet::h12, false},
                                           BendingTerm{"bending", ShapeSet::h16, false},
                                           BendingTerm{"bending", ShapeSet::h12, true},
                                           BendingTerm{"bending", ShapeSet::h16, true},
                                           BendingTerm{"membrane", ShapeSet::h12, false},
                                           BendingTerm{"membrane", ShapeSet::h16, true},
                                           BendingTerm{"membrane_assumed", ShapeSet::h12, false},
                                           BendingTerm{"membrane_assumed", ShapeSet::h16, true}),
                         [](const auto& c) {
                           return c.param.term +
                                  (c.param.shapes == ShapeSet::h12 ? "_h12" : "_h16") +
                                  (c.param.designed ? "_designed" : "_uniform");
                         });

// With steps of 1e-3 of the element, truncation is 1e-12 times the growth of fifth derivatives, and
// round-off is 1e-16 / 1e-3.
TEST_P(SpaceTerm, TangentIsTheDerivativeOfTheForceAndForceThatOfTheEnergy) {
  const int e = 3;
  const Local x = local(e);
  LocalTangent k = LocalTangent::Zero(x.q.size(), x.q.size());
  term->add_tangent(e, x, {1, 0, 0}, k);
  EXPECT_LT((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-12 * k.cwiseAbs().maxCoeff());
  const LocalRows f = force(e, x);
  const auto vectors = plate.vectors(e);
  for (Eigen::Index l = 0; l < x.q.rows(); ++l)
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double step = 5e-5 / plate.scale(vectors[static_cast<size_t>(l)]);
      const auto moved = [&](double by) {
        Local y = x;
        y.q(l, c) += by;
        return y;
      };
      const MatrixXd df =
          first_difference([&](double by) { return MatrixXd(force(e, moved(by))); }, step);
      double worst = 0, largest = 0;
      for (Eigen::Index row = 0; row < f.size(); ++row) {
        worst = std::max(worst, std::abs(df(row / 3, row % 3) - k(row, 3 * l + c)));
        largest = std::max(largest, std::abs(k(row, 3 * l + c)));
      }
      EXPECT_LT(worst, 1e-7 * largest);
      const double du =
          first_difference([&](double by) { return term->strain_energy(e, moved(by)); }, step);
      EXPECT_NEAR(du, f(l, c), 1e-7 * f.col(c).cwiseAbs().maxCoeff());
    }
}

// The scale is the energy of unit strain, or of a curvature of one over the plate's width. After a
// motion of 10 m the positions have a round-off of 1e-15 m, 2e-14 of an element, and curvatures
// 1e-12 of 1/width.
TEST_P(SpaceTerm, RigidMotionStoresNoEnergyAndNeedsNoForce) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.3, Vec3(1, 2, 3).normalized()).matrix();
  MatrixXd q = plate.reference() * turn.transpose();
  for (int k = 0; k < plate.n_vectors(); ++k)
    if (plate.is_position(k)) q.row(k) += Eigen::RowVector3d(8, -6, 1);
  const double c = kThinSection.thickness, area = 0.1 * 0.06,
               unit = kThinSection.youngs_modulus * area *
                      (GetParam().term != "bending" ? c : c * c * c / 12 / 0.06 / 0.06);
  for (int e = 0; e < plate.n_elements(); ++e) {
    Local x;
    x.q = testing::rows_of_element(plate, q, e);
    EXPECT_LT(std::abs(term->strain_energy(e, x)), 1e-12 * unit);
    EXPECT_LT(force(e, x).cwiseAbs().maxCoeff(), 1e-10 * unit / 0.06);
  }
}

TEST_P(SpaceTerm, EnergyDoesNotSeeLargeRotationsAndForceTurnsAlong) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.3, Vec3(1, -2, 3).normalized()).matrix();
  Local x = local(1);
  const double before = term->strain_energy(1, x);
  const MatrixXd turned = force(1, x) * turn.transpose();
  x.q = (x.q * turn.transpose()).eval();
  EXPECT_NEAR(term->strain_energy(1, x), before, 1e-12 * before);
  EXPECT_LT((force(1, x) - turned).cwiseAbs().maxCoeff(), 1e-11 * turned.cwiseAbs().maxCoeff());
}

/// Returns the energy of a surface r(m, n) interpolated by h16; the term is integrated with n x n
/// points.
double energy_of_surface(const std::function<Vec3(double, double)>& r, int elements, int n_points) {
  AncfPlate plate(3, ShapeSet::h16, testing::uniform_lines(0, 1, elements),
                  testing::uniform_lines(0, 1, elements));
  MatrixXd q = plate.reference();
  for (const NodeVectors& node : plate.nodes()) {
    const double m = node.material.x(), n = node.material.y(), h = 1e-3;
    const auto by_n = [&](double at) {
      return Vec3(first_difference([&](double d) { return r(at, n + d); }, h));
    };
    q.row(node.r) = r(m, n);
    q.row(node.r_m) = first_difference([&](double d) { return r(m + d, n); }, h);
    q.row(node.r_n) = by_n(m);
    q.row(node.r_mn) = first_difference([&](double d) { return by_n(m + d); }, h);
  }
  const BodyTerm term = make_bending(kThinSection, n_points);
  term->prepare(plate, {}, true);
  double out = 0;
  for (int e = 0; e < plate.n_elements(); ++e) {
    Local x;
    x.q = testing::rows_of_element(plate, q, e);
    out += term->strain_energy(e, x);
  }
  return out;
}

// A plate is rolled on a cylinder of radius R along a direction at angle a: κ = (cos², sin², 2 sin
// cos)/R; the energy is D/(2 R²) for any a. Hermite interpolation has a local error of (h/R)²/12 in
// the curvature and of its square in the energy: (0.125/0.6)⁴/144 = 1e-5, a few times more with
// cross derivatives.
TEST(Bending, CylinderHasTheEnergyOfItsCurvature) {
  const double d = kThinSection.elasticity()(0, 0) * std::pow(kThinSection.thickness, 3) / 12,
               radius = 0.6;
  for (const double a : {0.0, 0.5, std::numbers::pi / 2}) {
    const Vec3 along(std::cos(a), std::sin(a), 0), across(-std::sin(a), std::cos(a), 0);
    const auto cylinder = [&](double m, double n) {
      const double s = m * along.x() + n * along.y(), t = m * across.x() + n * across.y();
      return Vec3(radius * std::sin(s / radius) * along + t * across +
                  Vec3(0, 0, radius * (1 - std::cos(s / radius))));
    };
    EXPECT_NEAR(energy_of_surface(cylinder, 8, 5) / (d / (2 * radius * radius)), 1, 1e-4) << a;
  }
}

// z = t m n with a small t has κ = (0, 0, 2 t) and the energy ½ D (1-ν)/2 (2t)²; corrections are
// t².
TEST(Bending, SaddleHasTheEnergyOfItsTwist) {
  const double d = kThinSection.elasticity()(2, 2) * std::pow(kThinSection.thickness, 3) / 12,
               t = 1e-4;
  const double energy =
      energy_of_surface([&](double m, double n) { return Vec3(m, n, t * m * n); }, 2, 5);
  EXPECT_NEAR(energy / (0.5 * d * 4 * t * t), 1, 1e-7);
}

// The integrand is rational; for a moderate dome of 4 x 4 elements the default rule has converged.
TEST(Bending, SevenPointsConfirmFive) {
  const auto dome = [](double m, double n) {
    return Vec3(m, n, 0.3 * std::sin(2 * m) * std::cos(n));
  };
  const double five = energy_of_surface(dome, 4, 5), seven = energy_of_surface(dome, 4, 7);
  EXPECT_NEAR(five / seven, 1, 1e-6);
}

// The kernels sum over one direction after the other. The expected energy is summed point by point
// from the tables of all shape functions, with equal points and weights and κ by its definition.
// The tolerance is round-off of sums of 81 and 256 points.
TEST(Bending, EnergyIsThatOfItsPoints) {
  const Eigen::Matrix3d d = std::pow(kThinSection.thickness, 3) / 12 * kThinSection.elasticity();
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
    for (const bool designed : {false, true}) {
      const AncfPlate plate(3, shapes, {{0.1, {}}, {0.21, {}}, {0.3, {}}},
                            {{-0.05, {}}, {0.01, {}}, {0.07, {}}});
      const ScaleFactors factors = designed ? testing::random_factors(5) : ScaleFactors{};
      const BodyTerm term = make_bending(kThinSection);
      term->prepare(plate, factors, true);
      const MatrixXd shape = testing::random_shape(plate, 0.2, 1);
      for (int e = 0; e < plate.n_elements(); ++e) {
        Local x;
        x.q = testing::rows_of_element(plate, shape, e);
        ShapeTable t;
        plate.tabulate(e, 16, Tabulate::curvature, factors, ScaleFactorKind::stiffness, t);
        const MatrixXd q = x.q, r_m = t.N_m * q, r_n = t.N_n * q, r_mm = t.N_mm * q,
                       r_nn = t.N_nn * q, r_mn = t.N_mn * q;
        double expected = 0;
        for (Eigen::Index g = 0; g < t.weight.size(); ++g) {
          const auto at = [g](const MatrixXd& rows) { return Vec3(rows.row(g).transpose()); };
          const Vec3 n = at(r_m).cross(at(r_n));
          const Vec3 kappa =
              Vec3(at(r_mm).dot(n), at(r_nn).dot(n), 2 * at(r_mn).dot(n)) / std::pow(n.norm(), 3);
          expected += 0.5 * t.weight[g] * kappa.dot(d * kappa);
        }
        EXPECT_NEAR(term->strain_energy(e, x) / expected, 1, 1e-13);
      }
    }
}

// Batches of eight elements must give the results of single elements, with one table for all
// (uniform lines), with separate tables (scale factors, moving lines) and in a batch that is not
// full: 15 elements. The tolerance is round-off of equal sums in vector registers.
TEST(Bending, BatchesAreTheirElements) {
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16})
    for (const bool designed : {false, true})
      for (const bool moves : {false, true}) {
        std::vector<MaterialLine> lines = testing::uniform_lines(0.1, 0.45, 5);
        if (moves) lines[0] = testing::swinging_line(0.1, 0.03, 2.1);
        AncfPlate plate(3, shapes, lines, testing::uniform_lines(-0.05, 0.07, 3));
        const BodyTerm term = make_bending(kThinSection);
        const ScaleFactors factors = designed ? testing::random_factors(3) : ScaleFactors{};
        term->prepare(plate, factors, true);
        plate.move_to(0.37);
        term->prepare(plate, factors, false);
        const MatrixXd shape = testing::random_shape(plate, 0.2, 4);
        const int n = 3 * plate.n_shapes(), n_elements = plate.n_elements();
        const Weights w{0.7, 3, 20};
        for (int first = 0; first < n_elements; first += kLanes) {
          const auto size = static_cast<size_t>(n);
          std::vector<Pack> q(size), f(size), t(size * size);
          const int count = std::min(kLanes, n_elements - first);
          for (int lane = 0; lane < kLanes; ++lane) {
            const LocalRows rows =
                testing::rows_of_element(plate, shape, first + std::min(lane, count - 1));
            for (size_t k = 0; k < size; ++k) q[k][lane] = rows.data()[k];
          }
          const Batch batch{first, count, plate.n_shapes(), 3, q.data(), q.data(), q.data()};
          term.add_forces(batch, f.data());
          term.add_tangents(batch, w, t.data());
          for (int lane = 0; lane < count; ++lane) {
            Local x;
            x.q = testing::rows_of_element(plate, shape, first + lane);
            LocalRows force = LocalRows::Zero(x.q.rows(), 3);
            LocalTangent tangent = LocalTangent::Zero(n, n);
            term->add_force(first + lane, x, force);
            term->add_tangent(first + lane, x, w, tangent);
            double worst_force = 0, worst_tangent = 0;
            for (int k = 0; k < n; ++k) {
              worst_force = std::max(worst_force, std::abs(f[k][lane] - force.data()[k]));
              for (int l = 0; l < n; ++l)
                worst_tangent =
                    std::max(worst_tangent, std::abs(t[n * l + k][lane] - tangent(k, l)));
            }
            EXPECT_LT(worst_force, 1e-13 * force.cwiseAbs().maxCoeff());
            EXPECT_LT(worst_tangent, 1e-13 * tangent.cwiseAbs().maxCoeff());
          }
        }
      }
}

TEST(Bending, NeedsSpace) {
  Workspace model;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_term("bending", kThinSection));
  model.add_body("arm",
                 std::make_unique<AncfPlate>(2, ShapeSet::h16, testing::uniform_lines(0, 1, 1),
                                             testing::uniform_lines(0, 1, 1)),
                 kThinSection, std::move(terms));
  try {
    model.prepare(0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    const std::string text = error.what();
    for (const char* part : {"'arm'", "'bending'", "three-dimensional"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

// Second derivatives of the shape functions must equal differences of the first derivatives.
TEST(Bending, SecondDerivativesAreDerivativesOfTheFirst) {
  for (const ShapeSet shapes : {ShapeSet::h12, ShapeSet::h16}) {
    const AncfPlate plate = testing::swinging_plate(shapes, 0.4);
    for (const int e : {0, 5}) {
      const int i = e / plate.n_n(), j = e % plate.n_n();
      const double a = plate.line_m(i + 1).value - plate.line_m(i).value,
                   b = plate.line_n(j + 1).value - plate.line_n(j).value;
      const auto table = [&](double s, double u) {
        ShapeTable t;
        plate.at(e, s, u, Tabulate::curvature, t);
        return t;
      };
      const ShapeTable t = table(0.3, 0.6);
      const auto along_m = [&](double d) { return MatrixXd(table(0.3 + d / a, 0.6).N_m); };
      const auto along_n = [&](double d) { return MatrixXd(table(0.3, 0.6 + d / b).N_n); };
      const auto mixed = [&](double d) { return MatrixXd(table(0.3, 0.6 + d / b).N_m); };
      // The functions are cubic: the differences are exact except for round-off 1e-16 / 1e-2 of
      // values up to 1/a.
      EXPECT_LT((t.N_mm - first_difference(along_m, 1e-2)).norm(), 1e-12 * t.N_mm.norm());
      EXPECT_LT((t.N_nn - first_difference(along_n, 1e-2)).norm(), 1e-12 * t.N_nn.norm());
      EXPECT_LT((t.N_mn - first_difference(mixed, 1e-2)).norm(), 1e-12 * t.N_mn.norm());
    }
  }
}

TEST(SpaceModel, SmallestAreaRatioIsThatOfTheSurface) {
  testing::SpacePlate p;
  p.nx = p.ny = 2;
  Workspace model = p.model();
  State x = model.reference();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 0).normalized()).matrix();
  for (Eigen::Index k = 0; k < x.q.size(); k += 3)
    x.q.segment<3>(k) = (turn * (Vec3(0.5, 1.2, 1).asDiagonal() * x.q.segment<3>(k))).eval();
  EXPECT_NEAR(model.smallest_area_ratio(x), 0.6, 1e-14);
}

}  // namespace
}  // namespace flexmorph::fem
