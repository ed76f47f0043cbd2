// Shows for every force element that its power balances its work and its energy, that its tangent
// is the derivative of its force, that the positions of its matrix entries do not change, and that
// the mean forces of springs and loads conserve energy.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/fem/force_element_cases.h"
#include "tests/support/differences.h"
#include "tests/support/models.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using namespace test;
using testing::first_difference;
using testing::ShapeSet;
using testing::SmoothMotion;

class EveryForceElement : public ::testing::TestWithParam<ForceElementCase> {
 protected:
  EveryForceElement() : model(bodies()) {
    model.add_force_element(GetParam().make());
    motion = std::make_unique<SmoothMotion>(away(model));
  }
  VectorXd force(const State& x) {
    VectorXd out;
    model.force(x, out);
    return out;
  }
  const ForceElement& link() const { return *model.force_elements()[0]; }

  Workspace model;
  std::unique_ptr<SmoothMotion> motion;
};
INSTANTIATE_TEST_SUITE_P(Links, EveryForceElement, ::testing::ValuesIn(force_element_cases()),
                         [](const auto& c) { return c.param.name; });

// The energy balance must hold along a motion: d(energies)/dt = power + f · q̇.
TEST_P(EveryForceElement, WorkPowerAndEnergyAddUp) {
  for (const double t : {0.6, 2.1}) {
    const auto energy = [&](double dt) {
      const Energies e = model.energies(motion->state(t + dt));
      return e.strain + e.potential;
    };
    const State x = motion->state(t);
    // f · q̇ is the work on the unknowns; the energies grow by this work and by the power that
    // enters.
    EXPECT_NEAR(first_difference(energy, 1e-3), model.force_element_power(x) + force(x).dot(x.v),
                1e-9);
  }
}

// Only dampers, driven or rotating loads, and markers that move in their bodies have power.
TEST_P(EveryForceElement, HasNoPowerWhereItStoresAll) {
  const State x = motion->state(0.6);
  const bool shifted = GetParam().name.find("shifted") != std::string::npos;
  EXPECT_EQ(model.force_element_power(x) == 0, GetParam().stores && !shifted);
}

// Truncation (1e-3)^4 and round-off 1e-13 are below 1e-8.
TEST_P(EveryForceElement, TangentIsTheDerivativeOfTheForce) {
  const State x = motion->state(0.6);
  const VectorXd direction = VectorXd::Random(model.n_dofs());
  Constraints none;
  model.constraints(x, none);
  SparseMatrix tangent;
  for (const bool by_rate : {false, true}) {
    const auto at = [&](double by) {
      State y = x;
      (by_rate ? y.v : y.q) += by * direction;
      return force(y);
    };
    model.kkt(x, none, {by_rate ? 0.0 : 1.0, by_rate ? 1.0 : 0.0, 0}, 1, tangent);
    EXPECT_LT((tangent * direction - first_difference(at, 1e-3)).norm(), 1e-8) << by_rate;
  }
}

TEST_P(EveryForceElement, LocationsStay) {
  const auto locations = [&](const State& x) {
    std::vector<Eigen::Triplet<double>> entries;
    link().add_tangent(x, {}, entries);
    std::vector<std::pair<int, int>> out;
    for (const auto& entry : entries) out.emplace_back(entry.row(), entry.col());
    return out;
  };
  std::vector<Eigen::Triplet<double>> pattern;
  link().add_pattern(pattern);
  std::vector<std::pair<int, int>> expected;
  for (const auto& entry : pattern) expected.emplace_back(entry.row(), entry.col());
  EXPECT_EQ(locations(motion->state(0.6)), expected);
  EXPECT_EQ(locations(motion->state(2.1)), expected);
}

class EveryForceElementBetween : public EveryForceElement {};
INSTANTIATE_TEST_SUITE_P(Links, EveryForceElementBetween, ::testing::ValuesIn([] {
                           std::vector<ForceElementCase> out = force_element_cases();
                           std::erase_if(out, [](const ForceElementCase& c) {
                             return c.kind != ForceElementCase::between;
                           });
                           return out;
                         }()),
                         [](const auto& c) { return c.param.name; });

// Internal forces do not change the momenta: resultant and moment of all forces vanish.
TEST_P(EveryForceElementBetween, BodiesItsForcesBalance) {
  const State x = motion->state(0.6);
  const VectorXd f = force(x);
  Vec2 sum(0, 0);
  double moment = 0;
  for (const Body& b : model.bodies())
    for (int k = 0; k < b.element->n_vectors(); ++k) {
      const Vec2 q = x.q.segment<2>(b.first_dof + 2 * k), g = f.segment<2>(b.first_dof + 2 * k);
      if (b.element->is_position(k)) sum += g;
      moment += q.x() * g.y() - q.y() * g.x();
    }
  EXPECT_GT(f.norm(), 0.1);
  EXPECT_LT(sum.norm(), 1e-14);
  EXPECT_NEAR(moment, 0, 1e-14);
}

// The work of the mean force of a step equals the change of the energy for any step size (with a
// damper it is larger), and its tangent is the derivative by the end of the step.
TEST(MeanForce, OfSpringsAndForcesKeepsTheEnergy) {
  for (const auto& [make, damped] :
       {std::pair{+[] {
                    return make_spring("l", one(), two(), {3, 0, 0.4});
                  },
                  false},
        {+[] {
           return make_spring("l", two(), plate(), {3, 0, 0});
         },
         false},
        {+[] {
           return make_spring("l", ground(), plate(), {3, 2, 0.4});
         },
         true},
        {+[] {
           return make_spring("l", one(), two(), {0, 2, 0.4});
         },
         true},
        {+[] { return make_point_force("l", plate(), Vec2(2, -3)); }, false}}) {
    Workspace model = bodies();
    model.add_force_element(make());
    const SmoothMotion motion = away(model);
    const double h = 0.3;
    State start = motion.state(0.6), end = motion.state(0.6 + h), mean = start;
    const auto set = [&](const VectorXd& q1) {
      end.q = q1;
      mean.q = 0.5 * (start.q + end.q);
      mean.v = (end.q - start.q) / h;
    };
    set(end.q);
    VectorXd f;
    model.mean_force(mean, start.q, end.q, f);
    const auto energy = [&](const State& x) {
      const Energies e = model.energies(x);
      return e.strain + e.potential;
    };
    const double work = f.dot(end.q - start.q), stored = energy(end) - energy(start);
    if (damped)
      EXPECT_GT(work, stored + 1e-3);
    else
      EXPECT_NEAR(work, stored, 1e-14);

    const VectorXd q1 = end.q, direction = VectorXd::Random(q1.size());
    const auto force = [&](double by) {
      set(q1 + by * direction);
      VectorXd out;
      model.mean_force(mean, start.q, end.q, out);
      return out;
    };
    const VectorXd difference = first_difference(force, 1e-3);
    set(q1);
    Constraints none;
    model.constraints(mean, none);
    SparseMatrix tangent;
    model.mean_kkt(mean, start.q, end.q, none, none, {0.5, 1 / h, 0}, 1, tangent);
    EXPECT_LT((tangent * direction - difference).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace flexmorph::fem
