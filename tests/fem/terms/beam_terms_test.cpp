// Shows that the elastic terms of the beam are right: the energy agrees with Gauss points in the
// straight coordinates with J J_o⁻¹ written out, force and tangent agree with differences, rigid
// motions, uniform strains and batches are right, and the mean force is a discrete gradient; for
// straight, curved and crooked references.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "fem/elements/ancf_beam.h"
#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "tests/support/crooked_beam.h"
#include "tests/support/dense.h"
#include "tests/support/differences.h"
#include "tests/support/errors.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::rows_of_element;

constexpr double kDepth = 0.1;

struct Case {
  const char *model, *reference;
  bool ecm() const { return model[0] == 'e'; }
  bool assumed() const { return std::string(model).find("_full") == std::string::npos; }
};

AncfBeam beam_of(const std::string& reference) {
  if (reference == "straight") return {{0, 0.2, 0.45, 0.6}, kDepth};
  if (reference == "arc")  // 90 degrees, 9 elements: one full batch and one element more
    return {uniform_nodes(0.9, 9), kDepth, arc_reference(0.9, std::numbers::pi / 2, 9)};
  return testing::crooked_beam(kDepth);
}

class BeamTerm : public ::testing::TestWithParam<Case> {
 protected:
  BeamTerm() { term->prepare(beam, {}, true); }

  MatrixXd random_shape(double size, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(-size, size);
    MatrixXd q = beam.reference();
    for (int k = 0; k < beam.n_vectors(); ++k)
      for (int c = 0; c < 2; ++c) q(k, c) += part(random) * (k % 3 == 0 ? beam.scale(1) : 1);
    return q;
  }
  Local local(int e, const MatrixXd& all) const {
    Local x;
    x.q = rows_of_element(beam, all, e);
    x.v = x.a = LocalRows::Zero(6, 2);
    return x;
  }
  LocalRows force(int e, const Local& x) const {
    LocalRows f = LocalRows::Zero(6, 2);
    term->add_force(e, x, f);
    return f;
  }
  double energy(const MatrixXd& all) const {
    double sum = 0;
    for (int e = 0; e < beam.n_elements(); ++e) sum += term->strain_energy(e, local(e, all));
    return sum;
  }
  double area() const {
    double sum = 0;
    ShapeTable t;
    for (int e = 0; e < beam.n_elements(); ++e) {
      beam.tabulate(e, 8, Tabulate::position, {}, ScaleFactorKind::none, t);
      sum += t.weight.sum();
    }
    return sum;
  }

  AncfBeam beam = beam_of(GetParam().reference);
  BodyTerm term = make_term(GetParam().model, kBeamSection);
};
INSTANTIATE_TEST_SUITE_P(Beams, BeamTerm, ::testing::ValuesIn([] {
                           std::vector<Case> out;
                           for (const char* model : {"gcm", "ecm", "gcm_full", "ecm_full"})
                             for (const char* reference : {"straight", "arc", "crooked"})
                               out.push_back({model, reference});
                           return out;
                         }()),
                         [](const auto& c) {
                           return std::string(c.param.model) + "_" + c.param.reference;
                         });

using Matrix2 = Eigen::Matrix2d;

/// Strains of one element from T (A.2), with derivatives by x and y as polynomials at ξ = s and y;
/// axis 2 is along X_y and axis 1 perpendicular to it.
struct PlainStrains {
  LocalRows X, q;
  double l;

  Matrix2 gradients(const LocalRows& nodal, double s, double y) const {  // (r_x r_y)
    Eigen::Matrix<double, 6, 2> by;
    by << 6 / l * (s * s - s), 0, 1 - 4 * s + 3 * s * s, 0, -y / l, 1 - s, 6 / l * (s - s * s), 0,
        3 * s * s - 2 * s, 0, y / l, s;
    return nodal.transpose() * by;
  }
  double area_ratio(double s, double y) const { return gradients(X, s, y).determinant(); }
  Matrix2 axes(double s) const {
    const Vec2 e2 = gradients(X, s, 0).col(1).normalized();
    Matrix2 out;
    out << e2.y(), e2.x(), -e2.x(), e2.y();
    return out;
  }
  Matrix2 strain(double s, double y) const {
    const Matrix2 F = gradients(q, s, y) * gradients(X, s, y).inverse() * axes(s);
    return (F.transpose() * F - Matrix2::Identity()) / 2;
  }

  /// Returns the strains of the axis: a uniform tensor C is fitted to ε₁₁ and ε₁₂ at the ends and
  /// in the middle and to ε₂₂ at the ends, and polynomials interpolate the remainders
  /// (beam_strains.h).
  Matrix2 assumed(double s) const {
    const double at[3] = {0, 0.5, 1};
    Eigen::Matrix<double, 8, 3> by_uniform;  // C₁₁, C₂₂, C₁₂
    Eigen::Matrix<double, 8, 1> samples;
    int row = 0;
    for (int k = 0; k < 3; ++k) {
      const Matrix2 e = strain(at[k], 0), a = axes(at[k]);
      const auto sample = [&](int i, int j, double scale) {  // scale: 2 because 2ε₁₂ is fitted
        samples[row] = scale * e(i, j);
        by_uniform.row(row++) << scale * a(0, i) * a(0, j), scale * a(1, i) * a(1, j),
            scale * (a(0, i) * a(1, j) + a(1, i) * a(0, j));
      };
      sample(0, 0, 1);
      sample(0, 1, 2);
      if (k != 1) sample(1, 1, 1);
    }
    const Vec3 c = by_uniform.colPivHouseholderQr().solve(samples);
    Matrix2 C;
    C << c[0], c[2], c[2], c[1];
    const auto left = [&](int k, int i, int j) {
      const Matrix2 a = axes(at[k]);
      return strain(at[k], 0)(i, j) - (a.transpose() * C * a)(i, j);
    };
    const auto parabola = [&](int i, int j) {
      const double first = left(0, i, j), middle = left(1, i, j), last = left(2, i, j);
      return first + s * (4 * middle - 3 * first - last) + 2 * s * s * (first - 2 * middle + last);
    };
    Matrix2 out = axes(s).transpose() * C * axes(s);
    out(0, 0) += parabola(0, 0);
    out(0, 1) += parabola(0, 1);
    out(1, 0) = out(0, 1);
    out(1, 1) += left(0, 1, 1) + s * (left(2, 1, 1) - left(0, 1, 1));
    return out;
  }
};

/// Returns the strain energy of one element by 16 Gauss points each way.
double energy_by_points(const Case& which, const LocalRows& X, const LocalRows& q, double l) {
  const double E = kBeamSection.youngs_modulus, nu = kBeamSection.poisson_ratio,
               G = E / (2 * (1 + nu)), c = E / (1 - nu * nu);
  const PlainStrains plain{X, q, l};
  const GaussRule& rule = gauss(16);
  double sum = 0;
  for (size_t g = 0; g < 16; ++g) {
    const double s = rule.points[g];
    const Matrix2 of_axis = plain.strain(s, 0), axis = which.assumed() ? plain.assumed(s) : of_axis;
    for (size_t h = 0; h < 16; ++h) {
      const double y = (rule.points[h] - 0.5) * kDepth;
      const Matrix2 e = plain.strain(s, y) - of_axis + axis;
      const double twice =
          which.ecm() ? E * e(0, 0) * e(0, 0) + E * e(1, 1) * e(1, 1) + 4 * G * e(0, 1) * e(0, 1)
                      : c * (e(0, 0) * e(0, 0) + e(1, 1) * e(1, 1) + 2 * nu * e(0, 0) * e(1, 1)) +
                            4 * G * e(0, 1) * e(0, 1);
      sum += rule.weights[g] * rule.weights[h] * plain.area_ratio(s, y) * twice / 2;
    }
    if (!which.ecm()) continue;
    sum +=
        rule.weights[g] * plain.area_ratio(s, 0) * nu * c / 2 *
        (nu * axis(0, 0) * axis(0, 0) + nu * axis(1, 1) * axis(1, 1) + 2 * axis(0, 0) * axis(1, 1));
  }
  return sum * l * kDepth * kBeamSection.thickness;
}

// For the straight beam both rules are exact; otherwise 7 x 4 points integrate a rational function.
TEST_P(BeamTerm, EnergyIsThatOfTheStrains) {
  const double tolerance = std::string(GetParam().reference) == "straight" ? 1e-12 : 2e-6;
  const MatrixXd X = beam.reference(), q = random_shape(0.2, 3);
  const auto nodes = beam.nodes();
  for (int e = 0; e < beam.n_elements(); ++e) {
    const double l =
        nodes[static_cast<size_t>(e + 1)].material.x() - nodes[static_cast<size_t>(e)].material.x();
    const double exact =
        energy_by_points(GetParam(), rows_of_element(beam, X, e), rows_of_element(beam, q, e), l);
    EXPECT_NEAR(term->strain_energy(e, local(e, q)), exact, tolerance * exact) << e;
  }
}

// A motion of 10 m has a round-off of 10 m x 1e-16 in the positions, 1e-14 of the element size.
TEST_P(BeamTerm, RigidMotionStrainsNothing) {
  Eigen::Matrix2d turn;
  turn << std::cos(2.7), -std::sin(2.7), std::sin(2.7), std::cos(2.7);
  MatrixXd q = beam.reference() * turn.transpose();
  for (int k = 0; k < beam.n_vectors(); k += 3) q.row(k) += Eigen::RowVector2d(8, -6);
  const double stiffness = kBeamSection.youngs_modulus * kBeamSection.thickness * kDepth;  // E A
  EXPECT_LT(std::abs(energy(q)), 1e-20 * stiffness);
  for (int e = 0; e < beam.n_elements(); ++e) {
    const LocalRows f = force(e, local(e, q));
    for (int k = 0; k < 6; ++k)  // in force units: entries of slopes are divided by their scale
      EXPECT_LT(f.row(k).norm() / beam.scale(beam.vectors(e)[static_cast<size_t>(k)]),
                1e-11 * stiffness);
  }
}

TEST_P(BeamTerm, EnergyDoesNotSeeRotations) {
  Eigen::Matrix2d turn;
  turn << std::cos(2.1), -std::sin(2.1), std::sin(2.1), std::cos(2.1);
  const MatrixXd q = random_shape(0.1, 5);
  EXPECT_NEAR(energy(q * turn.transpose()), energy(q), 1e-12 * energy(q));
}

// Any linear map of the reference configuration is represented exactly: the strain is uniform, and
// the energy is ½ ε·Dε times the volume, D plane stress, in both models and in any axes, because D
// is isotropic.
TEST_P(BeamTerm, UniformStrainHasTheExactEnergyAndStress) {
  for (const auto& [f11, f12, f21, f22] :
       {std::array{1.1, 0.0, 0.0, 1.0}, {1.0, 0.15, 0.0, 1.0}, {0.95, 0.1, -0.2, 1.2}}) {
    Eigen::Matrix2d F;
    F << f11, f12, f21, f22;
    const Eigen::Matrix2d e = (F.transpose() * F - Eigen::Matrix2d::Identity()) / 2;
    const Vec3 strain(e(0, 0), e(1, 1), 2 * e(0, 1));
    const double exact =
        0.5 * strain.dot(kBeamSection.elasticity() * strain) * area() * kBeamSection.thickness;
    EXPECT_NEAR(energy(beam.reference() * F.transpose()), exact, 1e-12 * exact);
    // The virtual work of the force in δF is P : δF times the volume, P = F S.
    const Vec3 s = kBeamSection.elasticity() * strain;
    Eigen::Matrix2d S;
    S << s[0], s[2], s[2], s[1];
    Eigen::Matrix2d dF;
    dF << 0.3, -0.7, 0.2, 0.5;
    const MatrixXd q = beam.reference() * F.transpose(), dq = beam.reference() * dF.transpose();
    double work = 0;
    for (int e1 = 0; e1 < beam.n_elements(); ++e1)
      work += force(e1, local(e1, q)).cwiseProduct(rows_of_element(beam, dq, e1)).sum();
    const double expected = (F * S).cwiseProduct(dF).sum() * area() * kBeamSection.thickness;
    EXPECT_NEAR(work, expected, 1e-12 * s.norm() * area() * kBeamSection.thickness);
  }
}

// With assumed strains only rigid motions have no energy: three eigenvalues of the stiffness are
// zero, the next one belongs to bending and is about (h/L)² of the largest.
TEST_P(BeamTerm, NothingButRigidMotionsIsFree) {
  const int n = 2 * beam.n_vectors();
  MatrixXd stiffness = MatrixXd::Zero(n, n);
  for (int e = 0; e < beam.n_elements(); ++e) {
    LocalTangent k = LocalTangent::Zero(12, 12);
    term->add_tangent(e, local(e, beam.reference()), {1, 0, 0}, k);
    const int first = 6 * e;  // three vectors for each node
    stiffness.block(first, first, 12, 12) += k;
  }
  for (int k = 0; k < beam.n_vectors(); ++k) {  // in units of force per displacement
    stiffness.middleRows(2 * k, 2) /= beam.scale(k);
    stiffness.middleCols(2 * k, 2) /= beam.scale(k);
  }
  const VectorXd values = testing::eigenvalues(stiffness);
  EXPECT_LT(std::abs(values[2]), 1e-13 * values[n - 1]);
  EXPECT_GT(values[3], 1e-6 * values[n - 1]);
}

// The force is cubic in the unknowns; therefore differences of order 4 are exact except for
// round-off.
TEST_P(BeamTerm, TangentIsTheDerivativeOfTheForceAndForceThatOfTheEnergy) {
  const int e = beam.n_elements() - 1;
  const Local x = local(e, random_shape(0.2, 1));
  LocalTangent k = LocalTangent::Zero(12, 12);
  term->add_tangent(e, x, {1, 0, 0}, k);
  const LocalRows f = force(e, x);
  EXPECT_LT((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-13 * k.cwiseAbs().maxCoeff());
  for (Eigen::Index l = 0; l < 6; ++l)
    for (Eigen::Index c = 0; c < 2; ++c) {
      const double step = l % 3 == 0 ? 1e-3 * beam.scale(1) : 1e-3;
      const auto moved = [&](double by) {
        Local y = x;
        y.q(l, c) += by;
        return y;
      };
      const MatrixXd df =
          first_difference([&](double by) { return MatrixXd(force(e, moved(by))); }, step);
      for (Eigen::Index row = 0; row < 12; ++row)
        EXPECT_NEAR(df(row / 2, row % 2), k(row, 2 * l + c),
                    1e-9 * k.col(2 * l + c).cwiseAbs().maxCoeff());
      const double du =
          first_difference([&](double by) { return term->strain_energy(e, moved(by)); }, step);
      EXPECT_NEAR(du, f(l, c), 1e-9 * f.col(c).cwiseAbs().maxCoeff());
    }
}

// In batches of eight, force and tangent of each element must equal those of the single element.
TEST_P(BeamTerm, BatchesAreElements) {
  const MatrixXd all = random_shape(0.2, 2);
  for (int first = 0; first < beam.n_elements(); first += kLanes) {
    const int count = std::min(kLanes, beam.n_elements() - first);
    std::array<Pack, 12> q, zero{}, f{};
    for (int lane = 0; lane < kLanes; ++lane) {
      const LocalRows rows = rows_of_element(beam, all, first + std::min(lane, count - 1));
      for (size_t k = 0; k < 12; ++k) q[k][lane] = rows.data()[k];
    }
    const Batch batch{first, count, 6, 2, q.data(), zero.data(), zero.data()};
    term.add_forces(batch, f.data());
    std::vector<Pack> tangent(144, Pack{});
    term.add_tangents(batch, {0.7, 3, 5}, tangent.data());
    for (int lane = 0; lane < count; ++lane) {
      const Local x = local(first + lane, all);
      const LocalRows alone = force(first + lane, x);
      LocalTangent k = LocalTangent::Zero(12, 12);
      term->add_tangent(first + lane, x, {0.7, 3, 5}, k);
      // Sums may differ by contracted operations.
      for (size_t i = 0; i < 12; ++i)
        EXPECT_NEAR(f[i][lane], alone.data()[i], 1e-13 * alone.cwiseAbs().maxCoeff());
      for (Eigen::Index i = 0; i < 144; ++i)
        EXPECT_NEAR(tangent[static_cast<size_t>(i)][lane], k(i % 12, i / 12),
                    1e-13 * k.cwiseAbs().maxCoeff());
    }
  }
}

// F̄ · (q₁ - q₀) = U₁ - U₀ over a large step, without resultant and moment about mean positions.
TEST_P(BeamTerm, MeanForceIsADiscreteGradient) {
  const int e = 1;
  LocalStep x;
  x.start = rows_of_element(beam, random_shape(0.2, 7), e);
  x.end = rows_of_element(beam, random_shape(0.2, 8), e);
  x.mean = {0.5 * (x.start + x.end), LocalRows::Zero(6, 2), LocalRows::Zero(6, 2)};
  LocalRows f = LocalRows::Zero(6, 2);
  term.with_mean_force().add_mean_force(e, x, f);
  const double u0 = term->strain_energy(e, {x.start, {}, {}}),
               u1 = term->strain_energy(e, {x.end, {}, {}});
  EXPECT_NEAR(f.cwiseProduct(x.end - x.start).sum(), u1 - u0, 1e-12 * (u0 + u1));
  EXPECT_LT((f.row(0) + f.row(3)).norm(), 1e-14 * f.norm());
  double moment = 0;
  for (int k = 0; k < 6; ++k) moment += x.mean.q(k, 0) * f(k, 1) - x.mean.q(k, 1) * f(k, 0);
  EXPECT_LT(std::abs(moment), 1e-13 * f.norm() * x.mean.q.norm());

  LocalTangent k = LocalTangent::Zero(12, 12);
  // The weights: the end moves by one, the mean by a half.
  term.with_mean_force().add_mean_tangent(e, x, {0.5, 0, 0}, k);
  for (Eigen::Index l = 0; l < 12; ++l) {
    const double step = l / 2 % 3 == 0 ? 1e-3 * beam.scale(1) : 1e-3;
    const MatrixXd df = first_difference(
        [&](double by) {
          LocalStep y = x;
          y.end(l / 2, l % 2) += by;
          y.mean.q(l / 2, l % 2) += by / 2;
          LocalRows out = LocalRows::Zero(6, 2);
          term.with_mean_force().add_mean_force(e, y, out);
          return MatrixXd(out);
        },
        step);
    for (Eigen::Index row = 0; row < 12; ++row)
      EXPECT_NEAR(df(row / 2, row % 2), k(row, l), 1e-9 * k.col(l).cwiseAbs().maxCoeff());
  }
}

// Pure bending of a straight beam, r = (x, ½κx²) with r_y along the normal, has to first order in
// κ: ε₁₁ = -κy. The energy per length is E/(1 - ν²) I κ²/2 for gcm, because r_y cannot contract and
// expand over the height, and E I κ²/2 for ecm.
TEST(BeamBending, PoissonLockingIsOneOverOneMinusNuSquared) {
  const double l = 0.5, kappa = 1e-4, inertia = kBeamSection.thickness * std::pow(kDepth, 3) / 12;
  const AncfBeam beam(l, kDepth, 1);
  Local x;
  x.q.resize(6, 2);
  x.q << 0, 0, 1, 0, 0, 1, l, kappa * l * l / 2, 1, kappa * l, -kappa * l, 1;
  const double exact = kBeamSection.youngs_modulus * inertia * kappa * kappa / 2 * l;
  for (const auto& [name, factor] : {std::pair{"ecm", 1.0},
                                     {"gcm", 1 / (1 - 0.3 * 0.3)},
                                     {"ecm_full", 1.0},
                                     {"gcm_full", 1 / (1 - 0.3 * 0.3)}}) {
    const BodyTerm term = make_term(name, kBeamSection);
    term->prepare(beam, {}, true);
    // Terms of fourth order in κ are negligible: (κl)²/h² of the strain on the axis is below 1e-4
    // of it.
    EXPECT_NEAR(term->strain_energy(0, x) / exact, factor, 1e-6) << name;
  }
}

TEST(BeamTerms, BelongToBeamsInThePlane) {
  const AncfPlate plate(2, testing::ShapeSet::h12, testing::uniform_lines(0, 1, 2),
                        testing::uniform_lines(0, 1, 1));
  const std::string text = testing::error_of(
      Error::Kind::input, [&] { make_beam_ecm(kBeamSection)->prepare(plate, {}, true); });
  EXPECT_TRUE(testing::mentions(text, "'ecm'")) << text;
}

}  // namespace
}  // namespace flexmorph::fem
