// Shows that inertia with material flow is the mass times the material acceleration: total mass,
// momentum, force, energy and power agree with second differences of trajectories of material
// points while the lines of the mesh accelerate through the material. Shows also point mass and
// weight.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/loads.h"
#include "fem/model/body_term.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::second_difference;
using testing::ShapeSet;
using testing::SmoothMotion;
using testing::swinging_plate;
using testing::VectorRows;

constexpr double kTime = 0.41;
// With this step, truncation (step x 3 rad/s)^4 and round-off 1e-16 / step^2 are near 1e-10 of the
// accelerations.
constexpr double kStep = 1e-3;

VectorRows as_rows(const VectorXd& q) {
  return Eigen::Map<const VectorRows>(q.data(), q.size() / 2, 2);
}

VectorXd flat(const MatrixXd& rows) {
  const VectorRows q = rows;
  return Eigen::Map<const VectorXd>(q.data(), q.size());
}

VectorXd scales(const AncfPlate& plate) {
  VectorXd out(2 * plate.n_vectors());
  for (int k = 0; k < plate.n_vectors(); ++k)
    out.segment<2>(2 * k).setConstant(0.1 / plate.scale(k));
  return out;
}

class Flow : public ::testing::TestWithParam<ShapeSet> {
 protected:
  Flow() { plate.move_to(kTime); }

  Local local(int e) const { return local_of(e, motion.state(kTime)); }
  Local local_of(int e, const State& x) const {
    return {testing::rows_of_element(plate, as_rows(x.q), e),
            testing::rows_of_element(plate, as_rows(x.v), e),
            testing::rows_of_element(plate, as_rows(x.a), e)};
  }
  /// Returns the position of a material point by the field of element e, with the mesh and the
  /// unknowns of given times. Points near an edge leave the element meanwhile; its polynomials are
  /// continued.
  Vec2 position(int e, const Vec2& material, double mesh, double unknowns) {
    moved.move_to(mesh);
    const Motion m1 = moved.line_m(e / moved.n_n()), m2 = moved.line_m(e / moved.n_n() + 1);
    const Motion n1 = moved.line_n(e % moved.n_n()), n2 = moved.line_n(e % moved.n_n() + 1);
    moved.at(e, (material.x() - m1.value) / (m2.value - m1.value),
             (material.y() - n1.value) / (n2.value - n1.value), Tabulate::position, near);
    return (near.N * testing::rows_of_element(moved, as_rows(motion.q(unknowns)), e)).transpose();
  }
  Vec2 velocity(int e, const Vec2& x) {
    return first_difference([&](double dt) { return position(e, x, kTime + dt, kTime + dt); },
                            kStep);
  }
  Vec2 acceleration(int e, const Vec2& x) {
    return second_difference([&](double dt) { return position(e, x, kTime + dt, kTime + dt); },
                             kStep);
  }
  /// Returns the velocity of the flow with constant unknowns.
  Vec2 feed(int e, const Vec2& x) {
    return first_difference([&](double dt) { return position(e, x, kTime + dt, kTime); }, kStep);
  }
  double mass_integral(int e, const std::function<double(const ShapeTable&)>& f) const {
    return kThinSection.density * kThinSection.thickness *
           testing::integrate(plate, e, factors, ScaleFactorKind::mass, Tabulate::position, f);
  }
  LocalRows force(const Term& term, int e, const Local& x) const {
    LocalRows f = LocalRows::Zero(x.q.rows(), 2);
    term.add_force(e, x, f);
    return f;
  }
  void check_tangent(const Term& term, int e);

  AncfPlate plate = swinging_plate(GetParam()), moved = plate;
  ScaleFactors factors = testing::random_factors(11);
  SmoothMotion motion{flat(plate.reference()), scales(plate), 4};
  ShapeTable near;
  BodyTerm inertia = make_inertia(kThinSection);
};
INSTANTIATE_TEST_SUITE_P(Shapes, Flow, ::testing::Values(ShapeSet::h12, ShapeSet::h16),
                         [](const auto& s) { return s.param == ShapeSet::h12 ? "h12" : "h16"; });

TEST_P(Flow, InertiaForceIsMassTimesAccelerationOfMaterialPoints) {
  inertia->prepare(plate, factors, true);
  for (const int e : {0, 3}) {
    const Local x = local(e);
    const LocalRows f = force(*inertia, e, x);
    const double largest = f.cwiseAbs().maxCoeff();
    // Only one position, one slope and the last function are compared, because the loop over points
    // is slow.
    for (const Eigen::Index k : {Eigen::Index(0), Eigen::Index(1), f.rows() - 1})
      for (Eigen::Index c = 0; c < 2; ++c) {
        const double expected = mass_integral(
            e, [&](const ShapeTable& t) { return t.N(0, k) * acceleration(e, t.material[0])[c]; });
        EXPECT_NEAR(f(k, c), expected, 1e-8 * largest) << k;
      }
  }
}

TEST_P(Flow, KineticEnergyIsThatOfMaterialPoints) {
  inertia->prepare(plate, factors, true);
  for (const int e : {0, 3}) {
    const double expected = mass_integral(
        e, [&](const ShapeTable& t) { return 0.5 * velocity(e, t.material[0]).squaredNorm(); });
    EXPECT_NEAR(inertia->kinetic_energy(e, local(e)), expected, 1e-9 * expected);
  }
}

TEST_P(Flow, FlowPowerIsInertiaTimesTheVelocityOfTheFeed) {
  inertia->prepare(plate, factors, true);
  for (const int e : {0, 3}) {
    double size = 0;
    const double expected = mass_integral(e, [&](const ShapeTable& t) {
      const Vec2 a = acceleration(e, t.material[0]), v = feed(e, t.material[0]);
      size += a.norm() * v.norm() / 1e4;
      return a.dot(v);
    });
    EXPECT_NEAR(inertia.flow->flow_power(e, local(e)), expected, 1e-8 * (std::abs(expected) + size))
        << e;
  }
}

void Flow::check_tangent(const Term& term, int e) {
  const Local x = local(e);
  const Weights w{0.7, -1.3, 2.1};
  const auto n = x.q.size();
  LocalTangent tangent = LocalTangent::Zero(n, n);
  term.add_tangent(e, x, w, tangent);
  // q, v and a move by their weights along one unknown. The force is linear; therefore the
  // difference is exact.
  for (Eigen::Index column = 0; column < n; ++column) {
    const MatrixXd df = first_difference(
        [&](double by) {
          Local y = x;
          y.q(column / 2, column % 2) += w.q * by;
          y.v(column / 2, column % 2) += w.v * by;
          y.a(column / 2, column % 2) += w.a * by;
          return MatrixXd(force(term, e, y));
        },
        1.0);
    for (Eigen::Index row = 0; row < n; ++row)
      EXPECT_NEAR(tangent(row, column), df(row / 2, row % 2),
                  1e-11 * (tangent.cwiseAbs().maxCoeff() + 1));
  }
}

TEST_P(Flow, TangentsAreDerivativesByTheWeightedUnknown) {
  const BodyTerm mass = make_point_mass(0.5, {0.17, -0.02}, Vec2(0, -9.81));
  const BodyTerm weight = make_gravity(kThinSection, Vec2(1, -9.81));
  for (Term* term : {&*inertia, &*mass, &*weight}) {
    term->prepare(plate, factors, true);
    check_tangent(*term, 0);
  }
}

TEST_P(Flow, PointMassIsThatOfItsMaterialPoint) {
  const Vec2 at(0.17, -0.02), g(1, -9.81);
  const double m = 0.5;
  const BodyTerm term = make_point_mass(m, at, g);
  term->prepare(plate, factors, true);
  const int e = plate.locate(at, Tabulate::position, near);
  const Eigen::RowVectorXd shape = near.N;
  const Local x = local(e);
  const Vec2 a = acceleration(e, at), v = velocity(e, at), r = position(e, at, kTime, kTime);
  const MatrixXd expected = m * shape.transpose() * (a - g).transpose();
  EXPECT_LT((MatrixXd(force(*term, e, x)) - expected).norm(), 1e-8 * expected.norm());
  EXPECT_NEAR(term->kinetic_energy(e, x), 0.5 * m * v.squaredNorm(), 1e-9);
  EXPECT_NEAR(term->potential_energy(e, x), -m * g.dot(r), 1e-12);
  EXPECT_NEAR(term.flow->flow_power(e, x), m * feed(e, at).dot(a - g), 1e-7);
  EXPECT_EQ(force(*term, e + 1, local(e + 1)).norm(), 0);
}

TEST_P(Flow, WeightHasTheForceAndPowerOfItsMass) {
  const Vec2 g(1, -9.81);
  const BodyTerm term = make_gravity(kThinSection, g);
  term->prepare(plate, factors, true);
  for (const int e : {0, 3}) {
    const Local x = local(e);
    const LocalRows f = force(*term, e, x);
    for (Eigen::Index k = 0; k < f.rows(); ++k) {
      const double mass = mass_integral(e, [&](const ShapeTable& t) { return t.N(0, k); });
      EXPECT_LT((f.row(k) + mass * g.transpose()).norm(), 1e-11);
    }
    const double height = mass_integral(e, [&](const ShapeTable& t) { return (t.N * x.q * g)(0); });
    EXPECT_NEAR(term->potential_energy(e, x), -height, 1e-12 * std::abs(height) + 1e-14);
    const double power =
        mass_integral(e, [&](const ShapeTable& t) { return -g.dot(feed(e, t.material[0])); });
    EXPECT_NEAR(term.flow->flow_power(e, x), power, 1e-9 * (1 + std::abs(power)));
  }
}

// A uniform translation has the energy ½ m c² and the force m a, both with the mass of the area
// outside.
TEST_P(Flow, TotalMassAndMomentumAreThoseOfThePlate) {
  inertia->prepare(plate, {}, true);
  const double mass = kThinSection.density * kThinSection.thickness *
                      (plate.line_m(3).value - plate.line_m(0).value) *
                      (plate.line_n(2).value - plate.line_n(0).value);
  // All unknowns follow the flow so that the material is undeformed: r = X + c t.
  double energy = 0;
  Vec2 total = Vec2::Zero();
  for (int e = 0; e < plate.n_elements(); ++e) {
    Local x;
    x.q = testing::rows_of_element(plate, plate.reference(), e);
    x.v = x.a = LocalRows::Zero(x.q.rows(), 2);
    const auto vectors = plate.vectors(e);
    for (size_t k = 0; k < vectors.size(); ++k) {
      if (!plate.is_position(vectors[k])) continue;
      const int node = vectors[k] / plate.per_node();
      const Motion& m = plate.line_m(node / (plate.n_n() + 1));
      const Motion& n = plate.line_n(node % (plate.n_n() + 1));
      const auto row = static_cast<Eigen::Index>(k);
      x.v.row(row) << 3 + m.rate, -2 + n.rate;
      x.a.row(row) << 5 + m.acceleration, 7 + n.acceleration;
    }
    energy += inertia->kinetic_energy(e, x);
    const LocalRows f = force(*inertia, e, x);
    for (size_t k = 0; k < vectors.size(); ++k)
      if (plate.is_position(vectors[k])) total += f.row(static_cast<Eigen::Index>(k)).transpose();
  }
  EXPECT_NEAR(energy, 0.5 * mass * 13, 1e-12 * 0.5 * mass * 13);
  EXPECT_LT((total - mass * Vec2(5, 7)).norm(), 1e-11 * mass * 9);
}

}  // namespace
}  // namespace flexmorph::fem
