// Shows that the loads of a link between two pins reproduce its strains: for the unchanged design,
// on equal cells with equal factors, the static problem has the strain energy and the displacements
// of the motion with either support, in the limit of small loads. Half of the link is void.
#include <gtest/gtest.h>

#include <cstdio>

#include "fem/dynamics/esl.h"
#include "fem/solve/statics.h"
#include "fem/terms.h"
#include "optim/mmc/loads/compliance_evaluator.h"
#include "tests/support/designed_plate.h"
#include "tests/support/models.h"

namespace flexmorph {
namespace {

using mmc::test::kGrid, mmc::test::kSection;
using testing::ShapeSet;

const std::array<Vec2, 2> kPins = {kGrid.node_position(2, 5), kGrid.node_position(59, 5)};

/// Returns the load of the link at an instant with prescribed accelerations, in equilibrium with
/// its inertia. Joints hold both pins, so that the balance alone does not determine the force along
/// their line.
/// @param size  factor of the accelerations
fem::EslSet load_of_motion(const fem::ScaleFactors& factors, double size) {
  std::vector<std::unique_ptr<fem::Term>> terms;
  terms.push_back(fem::make_membrane(kSection));
  terms.push_back(fem::make_inertia(kSection));
  fem::Workspace model;
  fem::Body& link =
      model.add_body("link",
                     std::make_unique<fem::AncfPlate>(
                         2, ShapeSet::q4, testing::uniform_lines(0, kGrid.width, kGrid.nx),
                         testing::uniform_lines(kGrid.y0, 0.05, kGrid.ny)),
                     kSection, std::move(terms));
  std::vector<fem::AttachedJoint> joints;
  for (const Vec2& pin : kPins) {
    joints.push_back({joints.empty() ? "first" : "second", pin, false});
    const std::vector<fem::Motion> rest = {{pin.x(), 0, 0}, {pin.y(), 0, 0}};
    model.add_joint(
        fem::make_pin(joints.back().name, "link", pin, [rest](double) { return rest; }, {0, 1}));
  }
  model.set_factors(link, factors);
  fem::State x = model.reference();
  x.a = VectorXd::Zero(model.n_dofs());
  for (int i = 0; i <= kGrid.nx; ++i)
    for (int j = 0; j <= kGrid.ny; ++j) {
      const Vec2 at = kGrid.node_position(i, j);
      const Vec2 a = Vec2(30, -80) - 40 * at + 300 * Vec2(-at.y(), at.x()) +
                     Vec2(0, 90 * std::sin(9 * at.x()));
      x.a.segment<2>(link.first_dof + 2 * kGrid.node(i, j)) = size * a;
    }
  fem::solve_carried_equilibrium(model, x);
  return fem::equivalent_static_load(model, x, model.body("link"), kPins, kGrid, {},
                                     fem::joint_forces(model, x, model.body("link"), joints), {});
}

// The displacement of a linear link is odd in F, so that the mean of both signs contains no
// nonlinear effect of first order, and the rest falls with the square of the load.
TEST(LinkStatics, LoadsReturnTheStrainsOfTheMotion) {
  const fem::ScaleFactors factors = testing::designed_factors();
  ASSERT_LT(factors.stiffness.minCoeff(), 2e-4);
  const std::array<int, 2> pins = {fem::node_at(kGrid, kPins[0]), fem::node_at(kGrid, kPins[1])};
  for (const mmc::Support support : {mmc::Support::pins, mmc::Support::floating}) {
    double miss[2] = {0, 0}, moved[2] = {0, 0}, deflection = 0;
    for (const size_t k : {size_t{0}, size_t{1}}) {
      VectorXd implausible_static, implausible_motion;
      for (const double sign : {1.0, -1.0}) {
        const fem::EslSet set = load_of_motion(factors, sign * (k == 0 ? 1e-3 : 1e-4));
        mmc::ComplianceEvaluator statics({kGrid, {set}, pins}, kSection,
                                         {mmc::LoadDefinition::inertia, support, true, 1e-10}, {},
                                         {});
        const double twice = statics.individual(factors.stiffness, factors.mass)[0];
        miss[k] += 0.5 * (twice / (2 * set.strain_energy) - 1);
        const VectorXd u = statics.displacement(factors.stiffness, factors.mass, 0);
        if (sign > 0)
          implausible_static = u, implausible_motion = set.deformation;
        else
          implausible_static -= u, implausible_motion -= set.deformation;
        deflection = set.deformation.lpNorm<Eigen::Infinity>();
      }
      moved[k] = (implausible_static - implausible_motion).norm() / implausible_motion.norm();
      std::printf("%s, deflection %.1e m: energy %.1e, displacements %.1e apart\n",
                  support == mmc::Support::pins ? "pins" : "floating", deflection, miss[k],
                  moved[k]);
    }
    EXPECT_LT(std::abs(miss[1]), 1e-9);
    // Displacements of `floating` belong to another frame.
    if (support == mmc::Support::pins) {
      EXPECT_LT(moved[1], 1e-9);
    }
  }
}

}  // namespace
}  // namespace flexmorph
