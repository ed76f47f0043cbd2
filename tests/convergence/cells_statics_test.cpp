// Shows that small deflections of a motion on cells agree with the static design problem: with
// equal stiffness factors, supports and nodal loads, compliances agree to 1e-6 in equilibrium and
// in a motion, and a cut through a load-carrying member has a similar effect in both. The plate is
// an optimized design; half of it is void.
#include <gtest/gtest.h>

#include <cstdio>

#include "fem/dynamics/esl.h"
#include "fem/dynamics/motion.h"
#include "fem/loads.h"
#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/support/designed_plate.h"
#include "tests/support/models.h"

namespace flexmorph {
namespace {

using mmc::test::kGrid, mmc::test::kSection;
using testing::ShapeSet;

/// Returns F · u of nodal forces (by node) on the plate of cells that is held at its left edge.
/// @param size  factor of the forces
double nonlinear_compliance(const fem::ScaleFactors& factors,
                            const std::vector<fem::NodalForce>& forces, double size) {
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_membrane(kSection));
  for (const fem::NodalForce& f : forces)
    terms.push_back(fem::make_point_force(
        kGrid.node_position(f.node / (kGrid.ny + 1), f.node % (kGrid.ny + 1)), size * f.force));
  fem::Workspace model;
  fem::Body& body =
      model.add_body("plate",
                     std::make_unique<fem::AncfPlate>(
                         2, ShapeSet::q4, testing::uniform_lines(0, kGrid.width, kGrid.nx),
                         testing::uniform_lines(kGrid.y0, 0.05, kGrid.ny)),
                     kSection, std::move(terms));
  model.add_joint(
      fem::make_hold("held", "plate", {{.at = {.edge = "root"}, .components = {0, 1}}}));
  model.set_factors(body, factors);
  fem::State x = model.reference();
  fem::solve_static(model, x);
  double sum = 0;
  for (const fem::NodalForce& f : forces) {
    const Vec2 at = kGrid.node_position(f.node / (kGrid.ny + 1), f.node % (kGrid.ny + 1));
    const Vec3 r = fem::point_position(model.body("plate"), x, at);
    sum += size * f.force.dot(Vec2(r.x(), r.y()) - at);
  }
  return sum;
}

// The displacement of a linear plate is odd in F, so that the mean of both signs contains no effect
// of first order in the strains, and the rest falls with the square of the load. Deflections are
// 1e-4 and 1e-5 of the length.
TEST(CellsAndStatics, EquilibriumHasTheComplianceOfTheDesignProblem) {
  const fem::ScaleFactors factors = testing::designed_factors();
  ASSERT_LT(factors.stiffness.minCoeff(), 2e-4);
  fem::EslSet set;
  set.deformation.setZero(2 * kGrid.n_nodes());
  set.acceleration.setZero(2 * kGrid.n_nodes());
  set.forces = {{kGrid.node(kGrid.nx, kGrid.ny / 2), {0.3, 1}},
                {kGrid.node(kGrid.nx, kGrid.ny), {-0.5, 0.2}}};
  mmc::ComplianceEvaluator compliance({kGrid, {set}}, kSection, {}, {}, {});
  const double linear = compliance.individual(factors.stiffness, factors.mass)[0];
  double miss[2];
  for (const int k : {0, 1}) {
    const double size = (k == 0 ? 1e-4 : 1e-5) * kGrid.width / linear;
    miss[k] = 0.5 *
                  (nonlinear_compliance(factors, set.forces, size) +
                   nonlinear_compliance(factors, set.forces, -size)) /
                  (size * size * linear) -
              1;
    std::printf("deflection / length about %.0e: %.2e apart\n", size * linear / kGrid.width,
                miss[k]);
  }
  EXPECT_LT(std::abs(miss[1]), 1e-6);
  EXPECT_LT(std::abs(miss[0]), 1e-4);
}

/// A plate with a mass at its tip that slides by two columns of cells out of a rotating hub.
struct SlowMotion {
  fem::EslSets loads{kGrid, {}};  ///< Loads at times when the root is on a line of cells.
  double integral = 0;            ///< Integral ∫ U dt [J s].
  double deflection = 0;          ///< Largest deflection of the tip [m].
};

/// @param speed   speed of extension [m/s]; the hub rotates by two times as many radians per second
/// @param shapes  q4: on the cells of the factors; h16: 10 x 2 elements
SlowMotion move_slowly(const fem::ScaleFactors& factors, double speed,
                       ShapeSet shapes = ShapeSet::q4) {
  testing::RotatingPlate p;
  p.longest = kGrid.width;
  p.length = kGrid.width - 3 * kGrid.dx();
  p.speed = speed;
  p.omega = 2 * speed;
  p.shapes = shapes;
  if (shapes == ShapeSet::q4) {
    p.nx = kGrid.nx - 3;
    p.ny = kGrid.ny;
  }
  p.factors = factors;
  testing::Scene scene = testing::make_scene(p);
  const fem::AttachedMass tip{p.tip_mass, p.tip()};
  fem::MotionSettings settings;
  const double column = kGrid.dx() / speed;  // time in which the root passes one column
  settings.end = 2 * column;
  settings.step = column / 20;
  settings.stops = {column, 2 * column};
  settings.alpha.tolerance = 1e-15;  // displacements are as small as 1e-8 of the length
  SlowMotion out;
  double t = 0, u = 0;
  fem::integrate(scene.model, scene.moving_roots, settings, [&](const fem::MotionStep& step) {
    out.integral += 0.5 * (step.x.t - t) * (u + step.energies.strain);
    t = step.x.t;
    u = step.energies.strain;
    out.deflection =
        std::max(out.deflection, std::abs(testing::in_hub(p, step.model, step.x, p.tip()).y()));
    if (step.stop && step.x.t > 0)
      out.loads.sets.push_back(fem::equivalent_static_load(
          step.model, step.x, scene.moving_roots[0], kGrid, {&tip, 1}, {}, {}));
  });
  return out;
}

VectorXd compliances(const fem::EslSets& loads, const fem::ScaleFactors& factors) {
  mmc::ComplianceEvaluator compliance(loads, kSection, {}, {}, {});
  return compliance.individual(factors.stiffness, factors.mass);
}

// The loads of a motion contain its inertia, so that it need not be static: at every instant two
// times the strain energy of small strains is their compliance. Strains fall with the square of the
// speed, and so do nonlinear effects.
TEST(CellsAndStatics, MotionHasTheComplianceOfItsLoads) {
  const fem::ScaleFactors factors = testing::designed_factors();
  double miss[2] = {0, 0};
  const double speeds[2] = {0.02, 0.005};
  for (const size_t k : {size_t(0), size_t(1)}) {
    const SlowMotion motion = move_slowly(factors, speeds[k]);
    const VectorXd each = compliances(motion.loads, factors);
    ASSERT_EQ(each.size(), 2);
    for (Eigen::Index l = 0; l < 2; ++l) {
      const fem::EslSet& set = motion.loads.sets[static_cast<size_t>(l)];
      EXPECT_EQ(set.root_column, 2 - l);
      miss[k] = std::max(miss[k], std::abs(each[l] / (2 * set.strain_energy) - 1));
    }
    std::printf("%.3f m/s: tip %.1e m, compliance and 2 U %.1e apart\n", speeds[k],
                motion.deflection, miss[k]);
  }
  EXPECT_LT(miss[1], 1e-6);
  EXPECT_GT(miss[0], 5 * miss[1]);
}

/// Returns factors with the upper chord cut over two columns of cells.
fem::ScaleFactors severed(fem::ScaleFactors f) {
  const double empty = f.stiffness.minCoeff(), no_mass = f.mass.minCoeff();
  const int i = kGrid.nx / 2;
  for (int j = kGrid.ny - 1; j >= kGrid.ny / 2; --j)
    for (const int k : {i, i + 1}) {
      f.stiffness[kGrid.cell(k, j)] = empty;
      f.mass[kGrid.cell(k, j)] = no_mass;
    }
  return f;
}

// A cut has a similar effect in the motion on cells and in statics; elements over many cells bridge
// it.
TEST(CellsAndStatics, MotionFeelsACutChord) {
  const fem::ScaleFactors whole = testing::designed_factors(), cut = severed(whole);
  const SlowMotion before = move_slowly(whole, 0.02), after = move_slowly(cut, 0.02);
  EXPECT_LT(after.deflection, 1e-3 * kGrid.width);
  const double statics =
      compliances(before.loads, cut).sum() / compliances(before.loads, whole).sum();
  const double motion = after.integral / before.integral;
  const double bridged = move_slowly(cut, 0.02, ShapeSet::h16).integral /
                         move_slowly(whole, 0.02, ShapeSet::h16).integral;
  std::printf("cut: compliance x %.2f, int U dt x %.2f, on h16 x %.2f\n", statics, motion, bridged);
  EXPECT_GT(statics, 2);
  EXPECT_GT(motion - 1, 0.8 * (statics - 1));
  EXPECT_LT(bridged - 1, 0.5 * (statics - 1));
}

}  // namespace
}  // namespace flexmorph
