// Shows that a free beam keeps energy and momenta (energy_momentum), and that a pendulum on a joint
// converges with order 2 and equals the rigid pendulum if it is stiff.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "fem/body_joints.h"
#include "fem/dynamics/integrators/integrator.h"
#include "fem/elements/ancf_beam.h"
#include "fem/loads.h"
#include "fem/model/workspace.h"
#include "fem/terms.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

constexpr double kPendulum = 1, kPendulumHeight = 0.05, kGravity = 9.81;

PlaneSection section(double youngs_modulus) { return {0.05, youngs_modulus, 0.3, 7200}; }

Workspace beam_model(const std::string& term, std::unique_ptr<AncfBeam> beam, double youngs_modulus,
                     bool gravity) {
  const PlaneSection s = section(youngs_modulus);
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_inertia(s));
  terms.push_back(make_term(term, s));
  const Vec2 g(0, -kGravity);
  if (gravity) terms.push_back(make_gravity(s, g));
  Workspace model;
  model.add_body("beam", std::move(beam), s, std::move(terms));
  return model;
}

/// Returns ∫ ρ r × ṙ dV by 7 x 4 points and the tables of the element.
double angular_momentum(const Model& model, const State& x) {
  const Body& body = model.bodies()[0];
  double sum = 0;
  ShapeTable t;
  for (int e = 0; e < body.element->n_elements(); ++e) {
    body.element->tabulate(e, 12, Tabulate::position, {}, ScaleFactorKind::none, t);
    const auto vectors = body.element->vectors(e);
    MatrixXd q(6, 2), v(6, 2);
    for (Eigen::Index k = 0; k < 6; ++k) {
      q.row(k) = x.q.segment<2>(2 * vectors[static_cast<size_t>(k)]);
      v.row(k) = x.v.segment<2>(2 * vectors[static_cast<size_t>(k)]);
    }
    const MatrixXd r = t.N * q, r_t = t.N * v;
    const VectorXd moment = r.col(0).cwiseProduct(r_t.col(1)) - r.col(1).cwiseProduct(r_t.col(0));
    sum += body.section->density * body.section->thickness * t.weight.dot(moment);
  }
  return sum;
}

// A soft curved beam rotates, translates, is bent and deforms at random: 500 steps of 2 ms.
// Round-off of Newton's method accumulates.
TEST(FreeBeam, KeepsEnergyAndMomenta) {
  for (const char* term : {"gcm", "ecm"}) {
    Workspace model =
        beam_model(term,
                   std::make_unique<AncfBeam>(uniform_nodes(kPendulum, 8), kPendulumHeight,
                                              arc_reference(kPendulum, 1, 8)),
                   1e7, false);
    State x = model.reference();
    std::mt19937 random(4);
    std::uniform_real_distribution<double> part(-1, 1);
    for (int k = 0; k < model.n_dofs() / 2; ++k) {
      const double scale = k % 3 == 0 ? kPendulum / 8 : 1;
      const Vec2 r = x.q.segment<2>(2 * k);
      x.v.segment<2>(2 * k) = 5 * Vec2(-r.y(), r.x()) + scale * Vec2(part(random), part(random));
      x.q.segment<2>(2 * k) += 0.01 * scale * Vec2(part(random), part(random));
      if (k % 3 == 0) x.v.segment<2>(2 * k) += Vec2(0.4, 0.3);
    }
    IntegratorSettings settings;
    settings.name = "energy_momentum";
    const std::unique_ptr<Integrator> integrator = make_integrator(model, settings);
    model.prepare(0);
    integrator->make_consistent(x);
    const double energy = model.energies(x).total(), turning = angular_momentum(model, x);
    const Vec3 momentum = model.momentum(x);
    EXPECT_GT(model.energies(x).strain, 1e-3 * energy);
    double worst = 0;
    for (int k = 1; k <= 500; ++k) {
      integrator->advance(x, 2e-3 * k, [](const State&) {});
      worst = std::max({worst, std::abs(model.energies(x).total() / energy - 1),
                        std::abs(angular_momentum(model, x) / turning - 1),
                        (model.momentum(x) - momentum).norm() / momentum.norm()});
    }
    std::cout << "  " << term << ": largest defect " << worst << ", strain energy "
              << model.energies(x).strain / energy << " of all\n";
    EXPECT_LT(worst, 1e-10) << term;
  }
}

/// Returns the tip of a pendulum that starts at rest horizontally and is pinned at its root by a
/// revolute joint.
Vec2 pendulum_tip(const std::string& integrator_name, double youngs_modulus, double step,
                  double end) {
  Workspace model = beam_model("ecm", std::make_unique<AncfBeam>(kPendulum, kPendulumHeight, 4),
                               youngs_modulus, true);
  model.add_joint(make_revolute("pin", {}, {"beam", {0, 0}}));
  State x = model.reference();
  IntegratorSettings settings;
  settings.name = integrator_name;
  settings.alpha.tolerance = 1e-12;
  const std::unique_ptr<Integrator> integrator = make_integrator(model, settings);
  model.prepare(0);
  integrator->make_consistent(x);
  const int n = static_cast<int>(std::lround(end / step));
  for (int k = 1; k <= n; ++k) integrator->advance(x, end * k / n, [](const State&) {});
  EXPECT_LT(model.location_motion({"beam", {0, 0}}, x).position.norm(), 1e-10);
  return model.location_motion({"beam", {kPendulum, 0}}, x).position;
}

// The beam is so soft that the steps resolve the vibrations of the sudden start, including the
// stretch of the sections (260 rad/s). At E = 1e7 Pa and steps of 1 ms, phases would not be
// reproducible.
TEST(PendulumBeam, ConvergesWithOrderTwo) {
  for (const char* name : {"generalized_alpha", "energy_momentum"}) {
    const double end = 0.3;
    const Vec2 fine = pendulum_tip(name, 1e5, 6.25e-5, end);
    const testing::Rate rate = testing::fit_rate({1e-3, 5e-4, 2.5e-4}, [&](double h) {
      return (pendulum_tip(name, 1e5, h, end) - fine).norm();
    });
    std::cout << "  " << name << "\n" << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.1) << name << "\n" << rate.table();
  }
}

// J φ'' = -m g L/2 cos φ with J = m (L²/3 + h²/12), which includes the rotary inertia of the
// section. Bending moves the tip by about g/ω² = 9.81/1170² m.
TEST(PendulumBeam, IsTheRigidPendulumWhereItIsStiff) {
  const double end = 0.6;
  double angle = 0, rate = 0;
  const int n = 6000;
  const double h = end / n,
               c = kGravity * kPendulum / 2 /
                   (kPendulum * kPendulum / 3 + kPendulumHeight * kPendulumHeight / 12);
  for (int k = 0; k < n; ++k) {  // classical Runge-Kutta
    const auto a = [c](double phi) { return -c * std::cos(phi); };
    const double k1 = rate, l1 = a(angle), k2 = rate + h / 2 * l1, l2 = a(angle + h / 2 * k1),
                 k3 = rate + h / 2 * l2, l3 = a(angle + h / 2 * k2), k4 = rate + h * l3,
                 l4 = a(angle + h * k3);
    angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    rate += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }
  EXPECT_LT(angle, -1.5);
  const Vec2 tip = pendulum_tip("generalized_alpha", 2e11, 1e-3, end);
  std::cout << "  off by " << (tip - Vec2(std::cos(angle), std::sin(angle))).norm() << " m\n";
  EXPECT_LT((tip - Vec2(std::cos(angle), std::sin(angle))).norm(), 4e-5);
}

}  // namespace
}  // namespace flexmorph::fem
