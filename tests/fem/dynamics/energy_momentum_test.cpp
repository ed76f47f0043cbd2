// Shows that the mean forces of the energy-momentum scheme are discrete gradients: their work over
// a step is the difference of the energy, to round-off at large random states; elastic ones have
// neither resultant nor moment; their tangents agree with differences. This is tested for the terms
// of the plate and for a term with GramGradient whose energy is not quadratic.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/integrators/integrator.h"
#include "fem/loads.h"
#include "fem/model/body_term.h"
#include "fem/shapes/gram_gradient.h"
#include "fem/terms.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/sections.h"

namespace flexmorph::fem {
namespace {

using testing::first_difference;
using testing::ShapeSet;

const Vec2 kGravity(1.3, -9.81);
constexpr double kMeanStep = 0.02;

/// A term with stretches instead of Green-Lagrange strains: objective, neither quadratic nor
/// polynomial in q.
///   U = k/2 Σ_p w_p ((|r_m| - 1)² + (|r_n| - 1)² + (r_m·r_n)²)
class Stretch final : public Term, public MeanForceTerm {
 public:
  std::unique_ptr<Term> clone() const override { return std::make_unique<Stretch>(*this); }
  void prepare(const Element& element, const ScaleFactors& factors, bool) override {
    gradient_.prepare(element);
    tables_.resize(static_cast<size_t>(element.n_elements()));
    for (int e = 0; e < element.n_elements(); ++e)
      element.tabulate(e, 6, Tabulate::gradient, factors, ScaleFactorKind::stiffness,
                       tables_[static_cast<size_t>(e)]);
  }
  void add_force(int e, const Local& x, LocalRows& force) const override {
    const ShapeTable& t = tables_[static_cast<size_t>(e)];
    for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
      const Eigen::RowVectorXd m = t.N_m.row(p) * x.q, n = t.N_n.row(p) * x.q;
      const Eigen::RowVectorXd s_m = (1 - 1 / m.norm()) * m + m.dot(n) * n,
                               s_n = (1 - 1 / n.norm()) * n + m.dot(n) * m;
      force += kStiffness * t.weight[p] *
               (t.N_m.row(p).transpose() * s_m + t.N_n.row(p).transpose() * s_n);
    }
  }
  void add_tangent(int e, const Local& x, const Weights& w, LocalTangent& tangent) const override {
    for (Eigen::Index j = 0; j < x.q.size(); ++j)
      tangent.col(j) += w.q * first_difference(
                                  [&](double by) {
                                    Local y = x;
                                    y.q.data()[j] += by;
                                    LocalRows f = LocalRows::Zero(x.q.rows(), x.q.cols());
                                    add_force(e, y, f);
                                    return VectorXd(Eigen::Map<VectorXd>(f.data(), f.size()));
                                  },
                                  1e-4);
  }
  Energies energies(int e, const Local& x) const override {
    const ShapeTable& t = tables_[static_cast<size_t>(e)];
    double sum = 0;
    for (Eigen::Index p = 0; p < t.weight.size(); ++p) {
      const Eigen::RowVectorXd m = t.N_m.row(p) * x.q, n = t.N_n.row(p) * x.q;
      sum += 0.5 * kStiffness * t.weight[p] *
             (std::pow(m.norm() - 1, 2) + std::pow(n.norm() - 1, 2) + std::pow(m.dot(n), 2));
    }
    return {.strain = sum};
  }
  void add_mean_force(int e, const LocalStep& x, LocalRows& force) const override {
    gradient_.add_force(*this, e, x, force);
  }
  void add_mean_tangent(int e, const LocalStep& x, const Weights& w,
                        LocalTangent& tangent) const override {
    gradient_.add_tangent(*this, e, x, w, tangent);
  }

 private:
  static constexpr double kStiffness = 1e6;
  std::vector<ShapeTable> tables_;
  GramGradient gradient_;
};

struct ElasticTerm {
  std::string name;
  ShapeSet shapes;
  bool designed;
  std::unique_ptr<Term> (*make)();
};
std::unique_ptr<Term> membrane() { return make_membrane(kThinSection); }
std::unique_ptr<Term> stretch() { return std::make_unique<Stretch>(); }
std::unique_ptr<Term> inertia() { return make_inertia(kThinSection); }
std::unique_ptr<Term> weight() { return make_gravity(kThinSection, kGravity); }
std::unique_ptr<Term> point_mass() { return make_point_mass(0.5, {0.3, 0.06}, kGravity); }

class MeanForce : public ::testing::TestWithParam<ElasticTerm> {
 protected:
  MeanForce() {
    if (GetParam().designed) factors = testing::random_factors(5);
    term->prepare(plate, factors, true);
  }
  /// Returns a step between two random shapes; its mean rates and accelerations follow from a
  /// random rate at the start as in the scheme.
  LocalStep step(int e, double size = 0.3) const {
    LocalStep x;
    x.start = testing::rows_of_element(plate, testing::random_shape(plate, size, 1), e);
    x.end = testing::rows_of_element(plate, testing::random_shape(plate, size, 2), e);
    const LocalRows rate =
        40 * (testing::rows_of_element(plate, testing::random_shape(plate, size, 3), e) - x.start);
    x.mean.q = 0.5 * (x.start + x.end);
    x.mean.v = (x.end - x.start) / kMeanStep;
    x.mean.a = 2 / kMeanStep * (x.mean.v - rate);
    return x;
  }
  double energy(int e, const LocalRows& q, const LocalRows& v) const {
    const Local x{q, v, LocalRows::Zero(q.rows(), 2)};
    return term->kinetic_energy(e, x) + term->strain_energy(e, x) + term->potential_energy(e, x);
  }
  double start_energy(int e, const LocalStep& x) const {
    return energy(e, x.start, x.mean.v - 0.5 * kMeanStep * x.mean.a);
  }
  double end_energy(int e, const LocalStep& x) const {
    return energy(e, x.end, x.mean.v + 0.5 * kMeanStep * x.mean.a);
  }
  LocalRows force(int e, const LocalStep& x) const {
    LocalRows f = LocalRows::Zero(x.start.rows(), 2);
    term.with_mean_force().add_mean_force(e, x, f);
    return f;
  }
  bool elastic() const { return GetParam().make == membrane || GetParam().make == stretch; }
  /// Returns add_force() at the mean state, as a scale of the forces.
  LocalRows force_at_mean(int e, const LocalStep& x) const {
    LocalRows f = LocalRows::Zero(x.start.rows(), 2);
    term->add_force(e, x.mean, f);
    return f;
  }

  AncfPlate plate{2, GetParam().shapes, testing::uniform_lines(0.1, 0.3, 2),
                  testing::uniform_lines(-0.05, 0.06, 2)};
  ScaleFactors factors;
  BodyTerm term = GetParam().make();
};
INSTANTIATE_TEST_SUITE_P(
    Terms, MeanForce,
    ::testing::Values(ElasticTerm{"membrane_h12", ShapeSet::h12, false, membrane},
                      ElasticTerm{"membrane_h16", ShapeSet::h16, false, membrane},
                      ElasticTerm{"membrane_h16_designed", ShapeSet::h16, true, membrane},
                      ElasticTerm{"stretch_h12", ShapeSet::h12, false, stretch},
                      ElasticTerm{"stretch_h16", ShapeSet::h16, false, stretch},
                      ElasticTerm{"inertia", ShapeSet::h16, true, inertia},
                      ElasticTerm{"gravity", ShapeSet::h16, true, weight},
                      ElasticTerm{"point_mass", ShapeSet::h16, false, point_mass}),
    [](const auto& c) { return c.param.name; });

// The tolerance is round-off of the energies and of the products of force and step.
TEST_P(MeanForce, WorkOverAStepIsTheDifferenceOfTheEnergy) {
  for (int e = 0; e < plate.n_elements(); ++e) {
    const LocalStep x = step(e);
    const LocalRows work = force(e, x).cwiseProduct(x.end - x.start);
    const double start = start_energy(e, x), end = end_energy(e, x);
    const double scale = std::abs(start) + std::abs(end) + work.cwiseAbs().sum();
    EXPECT_NEAR(work.sum(), end - start, 1e-14 * scale) << e;
    if (e == 3) {
      EXPECT_GT(std::abs(end - start), 1e-3 * scale);  // the difference is not negligible
    }
  }
}

// Elastic mean forces have no resultant and no moment about the mean positions.
TEST_P(MeanForce, ElasticMeanForceKeepsTheMomenta) {
  if (!elastic()) return;
  for (int e = 0; e < plate.n_elements(); ++e) {
    const LocalStep x = step(e);
    const LocalRows f = force(e, x);
    Vec2 resultant = Vec2::Zero();
    double moment = 0, scale = 0;
    const auto vectors = plate.vectors(e);
    for (Eigen::Index k = 0; k < f.rows(); ++k) {
      if (plate.is_position(vectors[static_cast<size_t>(k)])) resultant += f.row(k).transpose();
      moment += x.mean.q(k, 0) * f(k, 1) - x.mean.q(k, 1) * f(k, 0);
      scale += std::abs(x.mean.q(k, 0) * f(k, 1)) + std::abs(x.mean.q(k, 1) * f(k, 0));
    }
    EXPECT_LT(resultant.norm(), 1e-13 * f.cwiseAbs().sum());
    EXPECT_NEAR(moment, 0, 1e-13 * scale);
  }
}

// The energy is conserved for any component of F̄ normal to the step. That F̄ is the right force is
// shown by its difference to the force at the mean state, which is O(step²).
TEST_P(MeanForce, IsTheForceAtTheMeanStateUpToSecondOrder) {
  const int e = 1;
  const LocalStep whole = step(e, 0.2);
  const auto difference = [&](double part) {
    LocalStep x = whole;
    x.start = whole.mean.q - 0.5 * part * (whole.end - whole.start);
    x.end = whole.mean.q + 0.5 * part * (whole.end - whole.start);
    return (force(e, x) - force_at_mean(e, x)).norm();
  };
  if (!elastic()) {
    EXPECT_EQ(difference(1), 0);
    return;
  }
  EXPECT_LT(difference(0.01), 1e-3 * force_at_mean(e, whole).norm());
  EXPECT_NEAR(std::log2(difference(0.02) / difference(0.01)), 2, 0.05);
}

// In a rigid rotation the mean configuration is shorter than either end. There is no strain at the
// ends, and the only force comes from the shortening, which is of second order.
TEST_P(MeanForce, RigidRotationDoesNoWork) {
  if (!elastic()) return;
  const MatrixXd reference = plate.reference();
  const auto turned = [&](double angle) {
    Eigen::Matrix2d turn;
    turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    return MatrixXd(reference * turn.transpose());
  };
  for (const double angle : {1e-4, 0.3}) {
    LocalStep x;
    x.start = testing::rows_of_element(plate, turned(0.5), 2);
    x.end = testing::rows_of_element(plate, turned(0.5 + angle), 2);
    x.mean.q = 0.5 * (x.start + x.end);
    x.mean.v = x.mean.a = LocalRows::Zero(x.start.rows(), 2);
    const LocalRows f = force(2, x), work = f.cwiseProduct(x.end - x.start);
    EXPECT_LT(f.cwiseAbs().maxCoeff(), 1e8 * 0.01 * 0.1 * angle * angle);
    EXPECT_NEAR(work.sum(), 0, 1e-14 * 1e8 * 0.01 * 0.1 * 0.1);
  }
}

TEST_P(MeanForce, TangentIsTheDerivativeByTheEnd) {
  const int e = 2;
  const LocalStep x = step(e, 0.2);
  LocalTangent k = LocalTangent::Zero(x.start.size(), x.start.size());
  term.with_mean_force().add_mean_tangent(e, x, {0.5, 1 / kMeanStep, 2 / (kMeanStep * kMeanStep)},
                                          k);
  const auto vectors = plate.vectors(e);
  const double largest = k.cwiseAbs().maxCoeff();
  if (elastic()) {
    ASSERT_GT(largest, 0);
  }
  for (Eigen::Index j = 0; j < x.start.size(); ++j) {
    const double by = 1e-3 * 0.1 / plate.scale(vectors[static_cast<size_t>(j / 2)]);
    const VectorXd df = first_difference(
        [&](double s) {
          LocalStep y = x;
          y.end.data()[j] += s;
          y.mean.q.data()[j] += 0.5 * s;
          y.mean.v.data()[j] += s / kMeanStep;
          y.mean.a.data()[j] += 2 * s / (kMeanStep * kMeanStep);
          LocalRows f = force(e, y);
          return VectorXd(Eigen::Map<VectorXd>(f.data(), f.size()));
        },
        by);
    const double column = std::max(k.col(j).cwiseAbs().maxCoeff(), 1e-9 * largest);
    EXPECT_LT((df - k.col(j)).cwiseAbs().maxCoeff(), 1e-7 * column + 1e-300) << j;
  }
}

/// A term without a mean force.
class Spring final : public Term {
 public:
  std::unique_ptr<Term> clone() const override { return std::make_unique<Spring>(*this); }
  void prepare(const Element&, const ScaleFactors&, bool) override {}
  void add_force(int, const Local&, LocalRows&) const override {}
  void add_tangent(int, const Local&, const Weights&, LocalTangent&) const override {}
  std::string name() const override { return "spring"; }
};

TEST(IntegratorTable, NamesWhatItKnowsAndWhatATermLacks) {
  Workspace model;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(inertia());
  terms.push_back(std::make_unique<Spring>());
  model.add_body("plate",
                 std::make_unique<AncfPlate>(2, ShapeSet::h12, testing::uniform_lines(0, 1, 1),
                                             testing::uniform_lines(0, 1, 1)),
                 kThinSection, std::move(terms));
  const auto message = [](const std::function<void()>& f) -> std::string {
    try {
      f();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      return error.what();
    }
    return "";
  };
  IntegratorSettings settings;
  settings.name = "leapfrog";
  const std::string unknown = message([&] { make_integrator(model, settings); });
  for (const char* name :
       {"'leapfrog'", "energy_momentum", "generalized_alpha", "minimal_coordinates"})
    EXPECT_NE(unknown.find(name), std::string::npos) << unknown;
  settings.name = "generalized_alpha";
  settings.alpha.rho_inf = 1.2;
  EXPECT_NE(message([&] { make_integrator(model, settings); }).find("rho_inf"), std::string::npos);
  settings.name = "energy_momentum";
  settings.energy_momentum.max_iterations = 0;
  EXPECT_NE(message([&] { make_integrator(model, settings); }).find("max_iterations"),
            std::string::npos);
  settings.energy_momentum = {};
  const auto integrator = make_integrator(model, settings);
  State x = model.reference();
  integrator->make_consistent(x);
  const std::string text = message([&] { integrator->advance(x, 1e-3, [](const State&) {}); });
  EXPECT_NE(text.find("'spring'"), std::string::npos) << text;
  EXPECT_EQ(x.t, 0);
}

}  // namespace
}  // namespace flexmorph::fem
