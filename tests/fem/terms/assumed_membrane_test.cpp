// Shows that the membrane with assumed strains has the energy of strains that are sampled at the
// ends and the middle and interpolated by a parabola, ε₁₁ along m, ε₂₂ along n, ε₁₂ both ways, and
// that its force and tangent belong to that energy, in the plane and in space.
#include <gtest/gtest.h>

#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::AncfPlate;
using testing::first_difference;
using testing::ShapeSet;

struct AssumedTerm {
  int dim;
  ShapeSet shapes;
};
void PrintTo(const AssumedTerm& c, std::ostream* out) {
  *out << c.dim << (c.shapes == ShapeSet::h12 ? "d_h12" : "d_h16");
}

class AssumedMembrane : public ::testing::TestWithParam<AssumedTerm> {
 protected:
  AncfPlate plate_{GetParam().dim, GetParam().shapes, testing::uniform_lines(0.1, 0.3, 1),
                   testing::uniform_lines(-0.05, 0.02, 1)};
  std::unique_ptr<Term> term_ = make_assumed_membrane(kThinSection);
  LocalRows q_ = testing::rows_of_element(plate_, testing::random_shape(plate_, 0.2, 5), 0);

  void SetUp() override { term_->prepare(plate_, {}, true); }
  Local at(const LocalRows& q) const { return {q, 0 * q, 0 * q}; }

  /// Returns the Green-Lagrange strains 11, 22, 2 x 12 at local coordinates.
  Vec3 strain(double s, double u) const {
    ShapeTable t;
    plate_.at(0, s, u, Tabulate::gradient, t);
    const Eigen::RowVectorXd r_m = t.N_m * q_, r_n = t.N_n * q_;
    return {0.5 * (r_m.squaredNorm() - 1), 0.5 * (r_n.squaredNorm() - 1), r_m.dot(r_n)};
  }
};
INSTANTIATE_TEST_SUITE_P(All, AssumedMembrane,
                         ::testing::Values(AssumedTerm{2, ShapeSet::h12},
                                           AssumedTerm{2, ShapeSet::h16},
                                           AssumedTerm{3, ShapeSet::h12},
                                           AssumedTerm{3, ShapeSet::h16}));

TEST_P(AssumedMembrane, EnergyIsThatOfSampledStrains) {
  const auto parabola = [](int i, double s) {
    return i == 0 ? (2 * s - 1) * (s - 1) : i == 1 ? 4 * s * (1 - s) : s * (2 * s - 1);
  };
  const double samples[] = {0, 0.5, 1};
  const GaussRule& rule = gauss(10);
  double energy = 0;
  for (size_t g = 0; g < 10; ++g)
    for (size_t h = 0; h < 10; ++h) {
      const double s = rule.points[g], u = rule.points[h];
      Vec3 assumed = Vec3::Zero();
      for (int i = 0; i < 3; ++i) {
        assumed[0] += parabola(i, s) * strain(samples[i], u)[0];
        assumed[1] += parabola(i, u) * strain(s, samples[i])[1];
        for (int j = 0; j < 3; ++j)
          assumed[2] += parabola(i, s) * parabola(j, u) * strain(samples[i], samples[j])[2];
      }
      energy += 0.5 * rule.weights[g] * rule.weights[h] * 0.2 * 0.07 * kThinSection.thickness *
                assumed.dot(kThinSection.elasticity() * assumed);
    }
  EXPECT_NEAR(term_->strain_energy(0, at(q_)), energy, 1e-12 * energy);
}

TEST_P(AssumedMembrane, ForceAndTangentBelongToIt) {
  const auto force = [&](const LocalRows& q) {
    LocalRows f = LocalRows::Zero(q.rows(), q.cols());
    term_->add_force(0, at(q), f);
    return VectorXd(Eigen::Map<const VectorXd>(f.data(), f.size()));
  };
  const Eigen::Index n = q_.size();
  LocalTangent exact = LocalTangent::Zero(n, n);
  term_->add_tangent(0, at(q_), {1, 0, 0}, exact);
  VectorXd gradient(n);
  MatrixXd tangent(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto moved = [&](double h) {
      LocalRows out = q_;
      out.data()[k] += h;
      return out;
    };
    gradient[k] =
        first_difference([&](double h) { return term_->strain_energy(0, at(moved(h))); }, 1e-4);
    tangent.col(k) = first_difference([&](double h) { return force(moved(h)); }, 1e-4);
  }
  const VectorXd f = force(q_);
  EXPECT_LT((f - gradient).lpNorm<Eigen::Infinity>(), 1e-8 * f.lpNorm<Eigen::Infinity>());
  EXPECT_LT((exact - tangent).lpNorm<Eigen::Infinity>(), 1e-7 * exact.lpNorm<Eigen::Infinity>());
}

}  // namespace
}  // namespace flexmorph::fem
