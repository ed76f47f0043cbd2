// Shows for the plate pendulum of P 4.1, a very soft square plate that falls about a corner: energy
// is conserved, the motion of the corner converges with order 2 in the step, the symmetry of the
// exact solution is kept, a published plate with equal energy moves equally at first, and driven
// lines that do not move change nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/integrators/energy_momentum.h"
#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/loads.h"
#include "fem/terms.h"
#include "tests/support/space_plates.h"

namespace flexmorph::fem {
namespace {

using testing::ShapeSet;
using testing::SpacePlate;
using testing::vector;

struct Fall {
  std::vector<Vec3> corner;  // positions at the given times
  double drift = 0;          // of the total energy, relative to all changes of the potential energy
  State end;
  StepCounts counts;
};

SpacePlate pendulum(ShapeSet shapes, int n) {
  SpacePlate p;
  p.length = p.width = 0.3;
  p.nx = p.ny = n;
  p.shapes = shapes;
  p.section = {0.01, 1e5, 0.3, 7810};
  p.terms = {"membrane", "bending", "inertia"};
  return p;
}

Workspace hung(const SpacePlate& p) {
  Workspace model = p.model(make_gravity(p.section, vector(0, 0, -9.81)));
  const auto still = [](double) { return std::vector<Motion>(3); };
  model.add_joint(make_pin("pin", "plate", {0, 0}, still, {}));
  return model;
}

Fall fall(Workspace& model, double h, const std::vector<double>& times) {
  Fall out;
  State x = model.reference();
  AlphaSettings settings;
  settings.rho_inf = 0.9;
  GeneralizedAlpha integrator(model, settings);
  integrator.make_consistent(x);
  Energies last = model.energies(x);
  const double start = last.total();
  double exchanged = 0;
  for (const double time : times) {
    while (x.t < time - 1e-9) {
      integrator.advance(x, x.t + h, [](const State&) {});
      const Energies e = model.energies(x);
      exchanged += std::abs(e.potential - last.potential);
      last = e;
      out.drift = std::max(out.drift, std::abs(e.total() - start));
    }
    out.corner.push_back(testing::at_point(model, x.q, {0.3, 0.3}));
  }
  out.drift /= exchanged;
  out.end = x;
  out.counts = integrator.counts();
  return out;
}

class Pendulum : public ::testing::TestWithParam<ShapeSet> {};
INSTANTIATE_TEST_SUITE_P(Plate, Pendulum, ::testing::Values(ShapeSet::h12, ShapeSet::h16),
                         [](const auto& test) {
                           return test.param == ShapeSet::h12 ? "h12" : "h16";
                         });

TEST_P(Pendulum, KeepsItsEnergyAndSymmetry) {
  Workspace model = hung(pendulum(GetParam(), 8));
  const Fall x = fall(model, 1e-3, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
  for (const Vec3& c : x.corner) std::printf("  %.5f %.5f %.5f\n", c.x(), c.y(), c.z());
  std::printf("energy %.2e of what is exchanged, Newton %d, factorizations %d\n", x.drift,
              x.counts.newton, x.counts.factorizations);
  EXPECT_LT(x.drift, 1e-3);
  for (const Vec3& c : x.corner) EXPECT_NEAR(c.x(), c.y(), 1e-9);
  // Exudyn's ANCFThinPlate, 8 x 8, incomplete quartic shapes, has equal energy and other shapes. At
  // first the fall is nearly rigid; later (0.4 s) meshes and shapes differ by centimetres.
  EXPECT_NEAR(x.corner[0].z(), -0.049049, 1e-4);
  EXPECT_NEAR(x.corner[1].z(), -0.196177, 1e-3);
  EXPECT_NEAR(x.corner[1].x(), 0.29568, 1e-3);
}

/// Compares the motion of the corner for the default rule of the bending term with that for 13 x 13
/// points.
/// @param end  end of the motion [s]
void expect_same_by_finer_quadrature(double end) {
  std::vector<double> times;
  for (int k = 1; 5e-3 * k < end + 1e-9; ++k) times.push_back(5e-3 * k);
  const auto corner = [&](double points) {
    SpacePlate p = pendulum(ShapeSet::h16, 8);
    Workspace model;
    std::vector<std::unique_ptr<Term>> terms =
        points > 0 ? make_terms(p.terms, p.section, {{"bending_points", points}})
                   : make_terms(p.terms, p.section, {});
    terms.push_back(make_gravity(p.section, vector(0, 0, -9.81)));
    model.add_body(
        "plate",
        std::make_unique<testing::AncfPlate>(3, p.shapes, testing::uniform_lines(0, 0.3, 8),
                                             testing::uniform_lines(0, 0.3, 8)),
        p.section, std::move(terms));
    const auto still = [](double) { return std::vector<Motion>(3); };
    model.add_joint(make_pin("pin", "plate", {0, 0}, still, {}));
    return fall(model, 1e-3, times).corner;
  };
  const std::vector<Vec3> fine = corner(13), standard = corner(0), coarse = corner(5);
  double worst = 0, worst_coarse = 0;
  for (size_t k = 0; k < fine.size(); ++k) {
    worst = std::max(worst, (standard[k] - fine[k]).norm());
    worst_coarse = std::max(worst_coarse, (coarse[k] - fine[k]).norm());
  }
  std::printf("  off by %.3f mm, 5 x 5 points by %.3f mm\n", 1e3 * worst, 1e3 * worst_coarse);
  EXPECT_LT(worst, 5e-4);
  EXPECT_GT(worst_coarse, 5e-4);
}

// From 0.36 s on the free corner folds within its element, where the curvature is far from a
// polynomial.
TEST(FoldingPendulum, IsTheSameByFinerQuadrature) { expect_same_by_finer_quadrature(0.45); }

// Until 0.58 s the rule of the term is within 0.25 mm of 13 x 13 points, and 5 x 5 points differ by
// 2.9 mm. After that the fold snaps, and the results of any two rules diverge.
TEST(LongFoldingPendulum, IsTheSameByFinerQuadrature) { expect_same_by_finer_quadrature(0.58); }

TEST_P(Pendulum, ConvergesWithOrderTwo) {
  Workspace model = hung(pendulum(GetParam(), 4));
  std::vector<Vec3> at;
  for (const double h : {1e-3, 5e-4, 2.5e-4}) at.push_back(fall(model, h, {0.2}).corner[0]);
  const double order = std::log2((at[0] - at[1]).norm() / (at[1] - at[2]).norm());
  std::printf("order %.2f, last difference %.1e m\n", order, (at[1] - at[2]).norm());
  EXPECT_NEAR(order, 2, 0.2);
}

// For lines that are driven but do not move, the element with flow must equal the plain plate.
TEST_P(Pendulum, LinesThatStandStillChangeNothing) {
  const SpacePlate p = pendulum(GetParam(), 3);
  Workspace plain = hung(p);
  auto lines = testing::uniform_lines(0, 0.3, 3);
  for (auto& line : lines) line.drive = [at = line.value](double) { return Motion{at, 0, 0}; };
  Workspace driven;
  std::vector<std::unique_ptr<Term>> terms;
  for (const std::string& name : p.terms) terms.push_back(make_term(name, p.section));
  terms.push_back(make_gravity(p.section, vector(0, 0, -9.81)));
  driven.add_body(
      "plate",
      std::make_unique<testing::AncfPlate>(3, GetParam(), lines, testing::uniform_lines(0, 0.3, 3)),
      p.section, std::move(terms));
  const VectorXd a = plain.reference().q;
  State x = plain.reference();
  const testing::SmoothMotion motion(a, 0.05 * plain.scales().cwiseInverse(), 3);
  x.q = motion.q(0.3);
  x.v = motion.v(0.3);
  x.a = motion.a(0.3);
  VectorXd one, two;
  plain.prepare(x);
  driven.prepare(x);
  plain.force(x, one);
  driven.force(x, two);
  EXPECT_LT((one - two).lpNorm<Eigen::Infinity>(), 1e-13 * one.lpNorm<Eigen::Infinity>());
  EXPECT_NEAR(plain.energies(x).total(), driven.energies(x).total(),
              1e-13 * std::abs(plain.energies(x).strain));
}

// The bending energy is not quadratic; its discrete gradient is that of GramGradient.
TEST(PendulumByEnergyMomentum, KeepsItsEnergy) {
  Workspace model = hung(pendulum(ShapeSet::h16, 3));
  EnergyMomentum integrator(model, EnergyMomentumSettings{});
  State x = model.reference();
  integrator.make_consistent(x);
  const double start = model.energies(x).total();
  double drift = 0, strain = 0;
  while (x.t < 0.4 - 1e-9) {
    integrator.advance(x, x.t + 1e-3, [](const State&) {});
    drift = std::max(drift, std::abs(model.energies(x).total() - start));
    strain = std::max(strain, model.energies(x).strain);
  }
  std::printf("strain energy to %.2f J, drift %.1e J, Newton %d, factorizations %d\n", strain,
              drift, integrator.counts().newton, integrator.counts().factorizations);
  EXPECT_LT(drift, 1e-11 * strain);
}

}  // namespace
}  // namespace flexmorph::fem
