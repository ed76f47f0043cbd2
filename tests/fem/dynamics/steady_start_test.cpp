// Shows that a steady start is the equilibrium in the present motion: a rotating bar keeps its
// shape, flow bends a plate by the Coriolis forces of its closed form, and velocities are those of
// the changing shape.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/motion.h"
#include "fem/dynamics/starts/start_parts.h"
#include "fem/terms.h"
#include "tests/support/models.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

constexpr double kDelta = 1e-4;

RotatingPlate slender() {
  RotatingPlate p;
  p.tip_mass = 0;
  p.section.poisson_ratio = 0;
  return p;
}

// The bar obeys (E A u')' + ρ A ω² (x + u) = 0, u(0) = 0, u'(L) = 0:  x + u = sin(k x) / (k cos(k
// L)), k² = ρ ω² / E. The material is linear in Green's strain; therefore strains of 1e-3 make it
// stiffer by 1.5 times the mean strain, which is the only difference from the closed form.
TEST(SteadyStart, RotatingBarStretchesWithSpinSoftening) {
  RotatingPlate p = slender();
  p.speed = 0;
  p.omega = 40;
  testing::Scene scene = testing::make_scene(p);
  const State x = start_state(scene.model, scene.moving_roots, 0, Start::steady, {}, kDelta);
  const double k = p.omega * std::sqrt(p.section.density / p.section.youngs_modulus), L = p.length;
  const double stretch = std::tan(k * L) / k - L, linear = k * k * L * L * L / 3;
  const double found = testing::in_hub(p, scene.model, x, p.tip()).x() - L;
  // Spin softening, which the closed form contains, is 2/5 (k L)² = 0.43 %. The cubic part of the
  // material changes the stretch by a similar amount; the tolerance is three times the strain of
  // 0.36 %.
  EXPECT_NEAR(found / stretch, 1, 3 * linear / L);
  const VectorXd spin = VectorXd::Constant(x.q.size(), p.omega * p.omega);
  State turning = x;
  turning.q *= 0.999;
  solve_rotating_equilibrium(scene.model, spin, VectorXd::Zero(x.q.size()), turning);
  EXPECT_LT((turning.q - x.q).lpNorm<Eigen::Infinity>(), 1e-11 * L);
}

// The motion keeps the shape: the strain energy is constant except for the error of the time
// integration (ω h)².
TEST(SteadyStart, TurningPlateStaysAsItIs) {
  RotatingPlate p;
  p.speed = 0;
  p.section.youngs_modulus = 1e7;
  testing::Scene scene = testing::make_scene(p);
  MotionSettings settings;
  settings.end = 0.2;
  settings.step = 1e-3;
  settings.start = Start::steady;
  double least = 1e99, most = 0;
  integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& step) {
    least = std::min(least, step.energies.strain);
    most = std::max(most, step.energies.strain);
  });
  EXPECT_LT(most / least - 1, 1e-3 * std::pow(p.omega, 2) * 1e-3);
}

// The load 2 ρ A ω s' per length gives w = q L⁴ / (8 E I) + q L² / (2 κ G A). The centrifugal
// tension stiffens the plate by (ω/ω_1)² = 2e-4 only.
TEST(SteadyStart, FlowBendsByCoriolisForces) {
  RotatingPlate p = slender();
  p.speed = 0.1;
  p.omega = 1;
  testing::Scene scene = testing::make_scene(p);
  const State x = start_state(scene.model, scene.moving_roots, 0, Start::steady, {}, kDelta);
  const double L = p.length, b = p.width(), area = b * p.section.thickness,
               inertia = area * b * b / 12, E = p.section.youngs_modulus;
  const double q = -2 * p.section.density * area * p.omega * p.speed;
  const double w =
      q * std::pow(L, 4) / (8 * E * inertia) + q * L * L / (2 * 5.0 / 6 * 0.5 * E * area);
  EXPECT_NEAR(testing::in_hub(p, scene.model, x, p.tip()).y() / w, 1, 0.01);
}

// Velocities must equal the derivative of the shape in the inertial frame, by a one-sided
// difference of order 4.
TEST(SteadyStart, VelocitiesAreThoseOfTheShape) {
  for (const ShapeSet shapes : {ShapeSet::h16, ShapeSet::q4}) {
    RotatingPlate p;
    p.shapes = shapes;
    p.nx = 8;
    testing::Scene scene = testing::make_scene(p);
    const State x = start_state(scene.model, scene.moving_roots, 0, Start::steady, {}, kDelta);
    const auto at = [&](double t) {
      return start::steady_equilibrium(scene.model, scene.moving_roots, {}, t).strained.q;
    };
    const double h = 1e-3;
    const VectorXd rate =
        (-25 * at(0) + 48 * at(h) - 36 * at(2 * h) + 16 * at(3 * h) - 3 * at(4 * h)) / (12 * h);
    EXPECT_LT((x.v - rate).lpNorm<Eigen::Infinity>(), 1e-7 * x.v.lpNorm<Eigen::Infinity>());
  }
}

}  // namespace
}  // namespace flexmorph::fem
