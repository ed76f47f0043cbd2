// The design problem over fixed loads: its values are those of its parts, its gradients pass the
// Taylor test over three decades for every load definition and support, and a
// design that has come apart is refused.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/optim/mmc_small.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::mmc::test {
namespace {

struct Choice {
  const char* name;
  LoadDefinition loads;
  Support support;
};
void PrintTo(const Choice& choice, std::ostream* out) { *out << choice.name; }

// `inertia` with `far_end` is refused: see mmc_compliance_test.
const Choice kChoices[] = {
    {"inertia_moving_root", LoadDefinition::inertia, Support::moving_root},
    {"frozen_moving_root", LoadDefinition::frozen, Support::moving_root},
    {"frozen_far_end", LoadDefinition::frozen, Support::far_end},
    {"stiffness_moving_root", LoadDefinition::stiffness, Support::moving_root},
    {"stiffness_far_end", LoadDefinition::stiffness, Support::far_end}};

/// A design problem with everything it refers to.
struct Whole {
  Design design;
  Ersatz ersatz;
  ComplianceEvaluator compliance;
  MmcProblem problem;

  explicit Whole(const std::vector<Component>& start, const ComplianceSettings& settings = {},
                 double max_volume = 0.5)
      : design(kGrid, start, kScale),
        ersatz(kGrid, tdf_settings().alpha, strip(), {}),
        compliance(turning_plate(4), kSection, settings, VectorXd::Constant(kGrid.n_cells(), 0.5),
                   VectorXd::Constant(kGrid.n_cells(), 0.5)),
        problem({kPlate, design, ersatz, compliance}, tdf_settings(),
                least_compliance(max_volume)) {}

  /// x by which a vector of one cell (positions, lengths, thicknesses; angles turn an end of a
  /// component by one cell) changes the variables.
  VectorXd of_cells(VectorXd cells) const {
    VectorXd unit = VectorXd::Ones(cells.size());
    design.scale_gradient(unit);
    for (Eigen::Index i = 3; i < cells.size(); i += Component::kParameters)
      cells[i] /= kScale.half_length;
    return kGrid.dx() * cells.cwiseQuotient(unit);
  }
};

class EveryLoadDefinition : public ::testing::TestWithParam<Choice> {
 protected:
  ComplianceSettings settings() const { return {GetParam().loads, GetParam().support}; }
};
INSTANTIATE_TEST_SUITE_P(Table, EveryLoadDefinition, ::testing::ValuesIn(kChoices),
                         [](const auto& test) { return std::string(test.param.name); });

/// A random direction of at most one cell, along which f bends most out of a few: the curvatures
/// of many nodes nearly cancel along some, and what is left of order two drowns in order three.
VectorXd bent_direction(Whole& whole, const std::function<double(const VectorXd&)>& f,
                        unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const VectorXd x = whole.design.x();
  const double middle = f(x);
  VectorXd best;
  double most = -1;
  for (int k = 0; k < 4; ++k) {
    VectorXd d(x.size());
    for (double& each : d) each = uniform(engine);
    d = whole.of_cells(d);
    const double bend = std::abs(f(x + 1e-3 * d) + f(x - 1e-3 * d) - 2 * middle);
    if (bend > most) most = bend, best = d;
  }
  return best;
}

// From 1e-3 of a cell down to 1e-6: above, nodes cross the edges of the band, where H is once
// differentiable only. log f and V/V_max are of order one, the remainders at the end of order
// 1e-14: no noise needs to be left out.
TEST_P(EveryLoadDefinition, GradientsPassTheTaylorTest) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Whole whole(random_layout(seed), settings());
    MmcProblem& problem = whole.problem;
    const VectorXd x = whole.design.x();
    const optim::Response at = problem.evaluate(x);
    const auto objective = [&](const VectorXd& y) { return problem.evaluate(y).f; };
    const auto volume = [&](const VectorXd& y) { return problem.evaluate(y).g[0]; };
    const auto of_f = optim::taylor_test(objective, at.df, x,
                                         bent_direction(whole, objective, seed + 100), 1e-3, 3, 0);
    EXPECT_NEAR(of_f.order, 2, 0.05) << "objective, seed " << seed << "\n" << of_f.table();
    EXPECT_NEAR(of_f.decades, 3, 1e-9);
    const auto of_g = optim::taylor_test(volume, at.dg.row(0), x,
                                         bent_direction(whole, volume, seed + 200), 1e-3, 3, 0);
    EXPECT_NEAR(of_g.order, 2, 0.05) << "volume, seed " << seed << "\n" << of_g.table();
    EXPECT_NEAR(of_g.decades, 3, 1e-9);
  }
}

// Every single variable against central differences: an entry that is wrong or missing cannot hide
// behind the others.
TEST(MmcProblem, EveryEntryAgreesWithDifferences) {
  Whole whole(random_layout(7));
  MmcProblem& problem = whole.problem;
  const VectorXd x = whole.design.x();
  const optim::Response at = problem.evaluate(x);
  const VectorXd unit = whole.of_cells(VectorXd::Ones(x.size()));
  const double largest = at.df.cwiseProduct(unit).cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    VectorXd d = VectorXd::Zero(x.size());
    d[i] = 1e-3 * unit[i];
    const optim::Response plus = problem.evaluate(x + d), minus = problem.evaluate(x - d);
    // A jump of the second derivative at the edge of the band, met inside the step of 1e-3 cells,
    // leaves 1e-3 / 4 of it.
    EXPECT_NEAR((plus.f - minus.f) / 2e-3, at.df[i] * unit[i], 1e-3 * largest) << i;
    EXPECT_NEAR((plus.g[0] - minus.g[0]) / 2e-3, at.dg(0, i) * unit[i], 1e-6) << i;
  }
}

TEST(MmcProblem, IsMadeOfItsParts) {
  Whole whole(random_layout(8), {}, 0.4);
  MmcProblem& problem = whole.problem;
  EXPECT_EQ(problem.n_variables(), 168);
  EXPECT_EQ(problem.n_constraints(), 1);
  EXPECT_EQ(problem.start(), whole.design.x());
  const optim::Response r = problem.evaluate(problem.start());

  UnionTdf tdf(kGrid, tdf_settings());
  tdf.evaluate(whole.design.components());
  CellFactors factors;
  whole.ersatz.factors(tdf.density(), tdf.eroded(), factors);
  EXPECT_EQ(problem.phi(), tdf.phi());
  EXPECT_EQ(problem.factors().stiffness, factors.stiffness);
  EXPECT_EQ(problem.factors().mass, factors.mass);
  ComplianceEvaluator::Value value;
  whole.compliance.evaluate(factors.stiffness, factors.mass, value);
  EXPECT_EQ(problem.compliance(), value.f);
  EXPECT_EQ(r.f, std::log(value.f));
  EXPECT_NEAR(r.g[0], factors.mass.mean() / 0.4 - 1, 1e-15);
  EXPECT_EQ(problem.volume(), factors.mass.mean());
  EXPECT_EQ(problem.x(), problem.start());
  EXPECT_EQ(problem.band(), tdf_settings().band);
}

// The same design gives the same bits, whatever was looked at in between.
TEST(MmcProblem, RepeatsItself) {
  Whole whole(random_layout(9));
  MmcProblem& problem = whole.problem;
  const VectorXd x = problem.start();
  const optim::Response first = problem.evaluate(x);
  problem.evaluate(x + whole.of_cells(VectorXd::Ones(x.size())));
  const optim::Response again = problem.evaluate(x);
  EXPECT_EQ(first.f, again.f);
  EXPECT_EQ(first.df, again.df);
  EXPECT_EQ(first.dg, again.dg);
}

/// The layout with all that reaches into a strip of this width around x = 0.3 m taken aside.
std::vector<Component> cut_layout(double width) {
  std::vector<Component> all = layout(0.01);
  const double aside = 0.5 * width + 0.035;  // about what a component reaches to each side
  for (Component& c : all) {
    const double from_cut = c.center.x() - 0.3;
    if (std::abs(from_cut) < aside) c.center.x() = 0.3 + std::copysign(aside, from_cut);
  }
  return all;
}

TEST(MmcProblem, RefusesADesignThatHasComeApart) {
  const Whole cut(cut_layout(0.08));
  Whole whole(layout(0.01));
  MmcProblem& problem = whole.problem;
  const VectorXd start = problem.start();
  const double compliance = std::exp(problem.evaluate(start).f);
  EXPECT_TRUE(problem.acceptable(start));
  const double apart = std::exp(problem.evaluate(cut.design.x()).f);
  EXPECT_GT(apart, 100 * compliance);
  EXPECT_FALSE(problem.acceptable(cut.design.x()));
  problem.evaluate(start);
  EXPECT_TRUE(problem.acceptable(start));
}

// An optimizer that steps back when told so shows no design in two parts, however long its steps.
TEST(MmcProblem, IteratesHangTogether) {
  Whole whole(layout());
  optim::Settings settings;
  settings.max_iterations = 40;
  settings.move_limit = 0.3;
  int rows = 0;
  double lowest = 1e300;
  const auto result =
      optim::make_optimizer(settings)->minimize(whole.problem, [&](const optim::Iterate& iterate) {
        ++rows;
        lowest = std::min(lowest, iterate.response->f);
        EXPECT_LT(iterate.response->f, lowest + std::log(100.0));
        return true;
      });
  EXPECT_GT(rows, 5);
  whole.problem.evaluate(result.x);
  EXPECT_TRUE(whole.problem.acceptable(result.x));
}

TEST(MmcProblem, RefusesWhatIsNotANumber) {
  Whole whole(layout());
  VectorXd x = whole.problem.start();
  x[10] = std::nan("");
  EXPECT_THROW(whole.problem.evaluate(x), Error);
}

}  // namespace
}  // namespace flexmorph::mmc::test
