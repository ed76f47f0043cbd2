// Shows that damping is right in hot bodies: free expansion dissipates nothing, tangents are
// derivatives, and energies, forces and powers are consistent while the temperature changes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/energy_rate.h"
#include "tests/support/sections.h"
#include "tests/thermal/hot_models.h"

namespace flexmorph::fem {
namespace {

using testing::element_in;
using testing::first_difference;
using testing::force_of;
using testing::moving_heat;
using testing::state_of;
using Names = std::vector<std::string>;

constexpr double kNow = 0.4;

const std::vector<std::pair<Names, TermDomain>> kDamped = {
    {{"inertia", "membrane", "damping"}, TermDomain::plane},
    {{"inertia", "membrane", "bending", "damping"}, TermDomain::space},
    {{"inertia", "ecm", "damping"}, TermDomain::beam}};

Workspace hot_model(const Names& names, TermDomain location) {
  Workspace model;
  Body& body = model.add_body(
      "body", element_in(location), kSoftSection,
      make_terms(names, kSoftSection, {{"damping_time", 0.3}, {"bending_points", 12}}));
  heat(body, moving_heat());
  return model;
}

// Strains are those of q/s: if q/s is constant there is no damping stress at any rate of q.
TEST(HotDamping, FreeGrowthDissipatesNothing) {
  for (const auto& [names, location] : kDamped) {
    Workspace model = hot_model(names, location);
    State x = model.reference();
    x.t = kNow;
    model.prepare(x);
    const Motion s = moving_heat().stretch(kNow);
    x.v = (s.rate / s.value) * x.q;
    const double growing = model.dissipation(x);
    x.v.setZero();
    EXPECT_LT(growing, 1e-28 * model.dissipation(x) + 1e-28);
    // with fixed unknowns the strain changes like the free expansion
    EXPECT_GT(model.dissipation(x), 0);
  }
}

TEST(HotDamping, TangentsAreDerivatives) {
  for (const auto& [names, location] : kDamped) {
    const auto element = element_in(location);
    auto terms = make_terms(names, kSoftSection, {{"damping_time", 0.3}});
    const BodyTerm term = make_heated(std::move(terms.back()), moving_heat());
    term.heated->heat_to(kNow);
    term->prepare(*element, {}, true);
    const Local x = state_of(*element, 1);
    for (const Weights w : {Weights{1, 0, 0}, {0.7, 130, 0}}) {
      LocalTangent exact = LocalTangent::Zero(x.q.size(), x.q.size());
      term->add_tangent(1, x, w, exact);
      MatrixXd by(x.q.size(), x.q.size());
      for (Eigen::Index k = 0; k < x.q.size(); ++k)
        by.col(k) = first_difference(
            [&](double h) {
              Local moved = x;
              moved.q.data()[k] += w.q * h;
              moved.v.data()[k] += w.v * h;
              return force_of(*term, 1, moved);
            },
            1e-4);
      EXPECT_LT((exact - by).lpNorm<Eigen::Infinity>(), 1e-8 * by.lpNorm<Eigen::Infinity>());
    }
  }
}

// d(T + U)/dt = (M q̈ + F) · q̇ + heat - loss must hold for any motion.
TEST(HotDamping, ChangesTheEnergyByThePowers) {
  for (const auto& [names, location] : kDamped) {
    Workspace model = hot_model(names, location);
    const testing::SmoothMotion motion = testing::any_motion(model);
    for (const double time : {0.3, 0.9}) {
      const auto [rate, work, p] = testing::energy_rate(model, motion, time);
      EXPECT_NEAR(work + p.total(), rate, 1e-8 * (std::abs(work) + p.loss + std::abs(p.heat)));
      EXPECT_GT(p.loss, 1e-2 * std::abs(rate));
    }
  }
}

// Batches of eight elements must give the forces of single elements.
TEST(HotDamping, BatchesAreElements) {
  Workspace model = hot_model(kDamped[0].first, kDamped[0].second);
  State x = model.reference();
  x.t = kNow;
  model.prepare(x);
  const testing::SmoothMotion motion = testing::any_motion(model);
  x = motion.state(kNow);
  x.lambda.resize(0);
  model.prepare(x);
  VectorXd force;
  model.force(x, force);
  const Body& body = model.bodies()[0];
  VectorXd by_elements = VectorXd::Zero(force.size());
  for (int e = 0; e < body.element->n_elements(); ++e) {
    const auto rows = [&](const VectorXd& all) {
      return testing::rows_of_element(*body.element, testing::rows_of_body(model, all), e);
    };
    const Local local{rows(x.q), rows(x.v), rows(x.a)};
    for (const auto& term : body.terms) {
      const VectorXd f = force_of(*term, e, local);
      const auto vectors = body.element->vectors(e);
      for (size_t k = 0; k < vectors.size(); ++k)
        by_elements.segment<2>(2 * vectors[k]) += f.segment<2>(2 * static_cast<Eigen::Index>(k));
    }
  }
  EXPECT_LT((force - by_elements).lpNorm<Eigen::Infinity>(),
            1e-12 * force.lpNorm<Eigen::Infinity>());
}

}  // namespace
}  // namespace flexmorph::fem
