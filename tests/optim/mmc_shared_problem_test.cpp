// Shows that the problem of bodies that share one budget of mass consists of the bodies' own
// problems, that its gradients pass the Taylor test, and that bodies which cannot share are
// refused.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "optim/mmc/problem/shared_problem.h"
#include "tests/optim/mmc_sharing.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::mmc::test {
namespace {

/// Two bodies with all objects that they refer to: one under loads that depend on its design, one
/// under fixed loads.
struct Pair {
  Design design_a, design_b;
  Ersatz ersatz;
  ComplianceEvaluator compliance_a;
  ComplianceEvaluator compliance_b;
  MmcProblem a, b;
  SharedProblem shared;

  Pair(const std::vector<Component>& start_a, const std::vector<Component>& start_b,
       double force_b = 3)
      : design_a(kGrid, start_a, kScale),
        design_b(kGrid, start_b, kScale),
        ersatz(kGrid, tdf_settings().alpha, strip(), {}),
        compliance_a(turning_plate(3), kSection, {}, {}, {}),
        compliance_b(tip_load(kSecondSection, force_b, 2)),
        a({kPlate, design_a, ersatz, compliance_a}, tdf_settings(), least_compliance(0.4)),
        b({kOtherPlate, design_b, ersatz, compliance_b}, tdf_settings(1), least_compliance(0.6)),
        shared({{&a, mass_of(kSection)}, {&b, mass_of(kSecondSection)}}) {}

  static double mass_of(const fem::PlaneSection& s) {
    return s.density * s.thickness * kGrid.width * kGrid.height;
  }
  /// Returns the change of the variables for a change of one cell (angles: the end of a component
  /// moves by one cell).
  VectorXd of_cells(VectorXd cells) const {
    VectorXd unit = VectorXd::Ones(cells.size() / 2);
    design_a.scale_gradient(unit);  // both have the same scale
    for (Eigen::Index i = 3; i < cells.size(); i += Component::kParameters)
      cells[i] /= kScale.half_length;
    for (int k = 0; k < 2; ++k)
      cells.segment(k * unit.size(), unit.size()) =
          kGrid.dx() * cells.segment(k * unit.size(), unit.size()).cwiseQuotient(unit);
    return cells;
  }
  /// Returns, of a few random directions, the one with the largest second derivative of f, see
  /// mmc_problem_test.
  VectorXd bent_direction(const std::function<double(const VectorXd&)>& f, unsigned seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const VectorXd x = shared.start();
    const double middle = f(x);
    VectorXd best;
    double most = -1;
    for (int k = 0; k < 4; ++k) {
      VectorXd d(x.size());
      for (double& each : d) each = uniform(engine);
      d = of_cells(d);
      const double bend = std::abs(f(x + 1e-3 * d) + f(x - 1e-3 * d) - 2 * middle);
      if (bend > most) most = bend, best = d;
    }
    return best;
  }
};

TEST(SharedProblem, IsMadeOfItsParts) {
  Pair pair(random_layout(1), random_layout(2));
  const int n = pair.a.n_variables();
  EXPECT_EQ(pair.shared.n_variables(), 2 * n);
  EXPECT_EQ(pair.shared.n_constraints(), 1);
  const VectorXd x = pair.shared.start();
  EXPECT_EQ(x.head(n), pair.design_a.x());
  EXPECT_EQ(x.tail(n), pair.design_b.x());
  EXPECT_EQ(pair.shared.part_of(x, 1), pair.design_b.x());
  EXPECT_EQ(pair.shared.lower().tail(n), pair.design_b.lower());
  EXPECT_EQ(pair.shared.upper().head(n), pair.design_a.upper());

  const optim::ProblemValues r = pair.shared.evaluate(x);
  // Both compliances and masses are recomputed from the designs.
  double compliance = 0, mass = 0;
  const auto add = [&](const Design& design, ComplianceEvaluator& loads, double band,
                       const fem::PlaneSection& s) {
    UnionTdf tdf(kGrid, tdf_settings(band));
    tdf.evaluate(design.components());
    CellScaleFactors factors;
    pair.ersatz.factors(tdf.density(), tdf.eroded(), factors);
    ComplianceEvaluator::Value value;
    loads.evaluate(factors.stiffness, factors.mass, value);
    compliance += value.f;
    mass += s.density * s.thickness * kGrid.dx() * kGrid.dy() * factors.mass.sum();
  };
  add(pair.design_a, pair.compliance_a, 1.5, kSection);
  add(pair.design_b, pair.compliance_b, 1, kSecondSection);
  const double area = kGrid.width * kGrid.height;
  const double budget = 2700 * 0.01 * area * 0.4 + 900 * 0.02 * area * 0.6;
  EXPECT_NEAR(r.f, std::log(compliance), 1e-12);
  EXPECT_NEAR(r.g[0], mass / budget - 1, 1e-13);
}

TEST(SharedProblem, GradientsPassTheTaylorTest) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    // This load makes both compliances equal; otherwise one of them would dominate the sum.
    Pair first(random_layout(seed), random_layout(seed + 10));
    first.shared.evaluate(first.shared.start());
    const double ratio = first.a.compliance() / first.b.compliance();
    Pair pair(random_layout(seed), random_layout(seed + 10), 3 * std::sqrt(ratio));
    const VectorXd x = pair.shared.start();
    const optim::ProblemValues at = pair.shared.evaluate(x);
    EXPECT_NEAR(pair.b.compliance(), pair.a.compliance(), 1e-9 * pair.a.compliance());
    const auto objective = [&](const VectorXd& y) { return pair.shared.evaluate(y).f; };
    const auto budget = [&](const VectorXd& y) { return pair.shared.evaluate(y).g[0]; };
    const auto of_f = optim::taylor_test(objective, at.df, x,
                                         pair.bent_direction(objective, seed + 100), 1e-3, 3, 0);
    EXPECT_NEAR(of_f.order, 2, 0.05) << "objective, seed " << seed << "\n" << of_f.table();
    const auto of_g = optim::taylor_test(budget, at.dg.row(0), x,
                                         pair.bent_direction(budget, seed + 200), 1e-3, 3, 0);
    RecordProperty("orders_" + std::to_string(seed),
                   std::to_string(of_f.order) + ", " + std::to_string(of_g.order));
    EXPECT_NEAR(of_g.order, 2, 0.05) << "budget, seed " << seed << "\n" << of_g.table();
  }
}

TEST(SharedProblem, RefusesADesignOneBodyOfWhichHasComeApart) {
  Pair pair(layout(0.01), layout(0.01));
  VectorXd x = pair.shared.start();
  pair.shared.evaluate(x);
  EXPECT_TRUE(pair.shared.acceptable(x));
  std::vector<Component> cut = layout(0.01);
  for (Component& c : cut)
    if (const double d = c.center.x() - 0.3; std::abs(d) < 0.08)
      c.center.x() = 0.3 + std::copysign(0.08, d);
  x.tail(pair.b.n_variables()) = Design(kGrid, cut, kScale).x();
  pair.shared.evaluate(x);
  EXPECT_FALSE(pair.shared.acceptable(x));
}

TEST(SharedProblem, RefusesWhatCannotBeShared) {
  Pair pair(layout(), layout());
  EXPECT_THROW(SharedProblem({}), Error);
  EXPECT_THROW(SharedProblem({{&pair.a, 1}, {&pair.b, 0}}), Error);
  const DesignedPlate plate{kOtherPlate, pair.design_b, pair.ersatz, pair.compliance_b};
  MmcProblem worst(plate, tdf_settings(), least_compliance(0.5, kComplianceWorst));
  EXPECT_THROW(SharedProblem({{&pair.a, 1}, {&worst, 1}}), Error);
  MmcProblem light(plate, tdf_settings(), least_volume(1));
  EXPECT_THROW(SharedProblem({{&pair.a, 1}, {&light, 1}}), Error);
  Goal twice = least_compliance();
  twice.limits.emplace_back(kMass, 0.5, false, kOtherPlate);
  MmcProblem limited_twice(plate, tdf_settings(), twice);
  EXPECT_THROW(SharedProblem({{&pair.a, 1}, {&limited_twice, 1}}), Error);
}

}  // namespace
}  // namespace flexmorph::mmc::test
