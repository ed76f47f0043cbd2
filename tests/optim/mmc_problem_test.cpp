// Shows that the values of the design problem with fixed loads are those of its parts, that its
// gradients pass the Taylor test over three decades for every load definition and support, and that
// a design that is not connected is refused.

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

// `inertia` with `far_end` is refused, see mmc_compliance_test.
const Choice kChoices[] = {
    {"inertia_moving_root", LoadDefinition::inertia, Support::moving_root},
    {"frozen_moving_root", LoadDefinition::frozen, Support::moving_root},
    {"frozen_far_end", LoadDefinition::frozen, Support::far_end},
    {"stiffness_moving_root", LoadDefinition::stiffness, Support::moving_root},
    {"stiffness_far_end", LoadDefinition::stiffness, Support::far_end}};

/// A design problem and all objects that it refers to.
struct FullProblem {
  Design design;
  Ersatz ersatz;
  ComplianceEvaluator compliance;
  MmcProblem problem;

  explicit FullProblem(const std::vector<Component>& start, const ComplianceSettings& settings = {},
                       double max_volume = 0.5)
      : design(kGrid, start, kScale),
        ersatz(kGrid, tdf_settings().alpha, strip(), {}),
        compliance(turning_plate(4), kSection, settings, VectorXd::Constant(kGrid.n_cells(), 0.5),
                   VectorXd::Constant(kGrid.n_cells(), 0.5)),
        problem({kPlate, design, ersatz, compliance}, tdf_settings(),
                least_compliance(max_volume)) {}

  /// Returns the change of the variables for a change of one cell (positions, lengths, thicknesses;
  /// an angle moves the end of a component by one cell).
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

/// Returns, of a few random directions of at most one cell, the one with the largest second
/// derivative of f. Along some directions the second derivatives of many nodes nearly cancel, and
/// the third order would dominate.
VectorXd bent_direction(FullProblem& whole, const std::function<double(const VectorXd&)>& f,
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

// Steps from 1e-3 of a cell down to 1e-6: with larger steps nodes cross the edges of the band,
// where H is differentiable only once. log f and V/V_max are of order one and the last remainders
// of order 1e-14, therefore no point has to be left out because of noise.
TEST_P(EveryLoadDefinition, GradientsPassTheTaylorTest) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    FullProblem whole(random_layout(seed), settings());
    MmcProblem& problem = whole.problem;
    const VectorXd x = whole.design.x();
    const optim::ProblemValues at = problem.evaluate(x);
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

// Every single variable is compared with central differences, so that a wrong or missing entry
// cannot be hidden by others.
TEST(MmcProblem, EveryEntryAgreesWithDifferences) {
  FullProblem whole(random_layout(7));
  MmcProblem& problem = whole.problem;
  const VectorXd x = whole.design.x();
  const optim::ProblemValues at = problem.evaluate(x);
  const VectorXd unit = whole.of_cells(VectorXd::Ones(x.size()));
  const double largest = at.df.cwiseProduct(unit).cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    VectorXd d = VectorXd::Zero(x.size());
    d[i] = 1e-3 * unit[i];
    const optim::ProblemValues plus = problem.evaluate(x + d), minus = problem.evaluate(x - d);
    // If the edge of the band lies within the step of 1e-3 cells, the jump of the second derivative
    // causes an error of 1e-3 / 4 of this jump.
    EXPECT_NEAR((plus.f - minus.f) / 2e-3, at.df[i] * unit[i], 1e-3 * largest) << i;
    EXPECT_NEAR((plus.g[0] - minus.g[0]) / 2e-3, at.dg(0, i) * unit[i], 1e-6) << i;
  }
}

TEST(MmcProblem, IsMadeOfItsParts) {
  FullProblem whole(random_layout(8), {}, 0.4);
  MmcProblem& problem = whole.problem;
  EXPECT_EQ(problem.n_variables(), 168);
  EXPECT_EQ(problem.n_constraints(), 1);
  EXPECT_EQ(problem.start(), whole.design.x());
  const optim::ProblemValues r = problem.evaluate(problem.start());

  UnionTdf tdf(kGrid, tdf_settings());
  tdf.evaluate(whole.design.components());
  CellScaleFactors factors;
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

// A repeated evaluation of a design is equal bit for bit, whatever was evaluated in between.
TEST(MmcProblem, RepeatsItself) {
  FullProblem whole(random_layout(9));
  MmcProblem& problem = whole.problem;
  const VectorXd x = problem.start();
  const optim::ProblemValues first = problem.evaluate(x);
  problem.evaluate(x + whole.of_cells(VectorXd::Ones(x.size())));
  const optim::ProblemValues again = problem.evaluate(x);
  EXPECT_EQ(first.f, again.f);
  EXPECT_EQ(first.df, again.df);
  EXPECT_EQ(first.dg, again.dg);
}

/// Returns the layout with a gap of this width around x = 0.3 m: components that reach into it are
/// moved aside.
std::vector<Component> cut_layout(double width) {
  std::vector<Component> all = layout(0.01);
  const double aside = 0.5 * width + 0.035;  // about the reach of a component to each side
  for (Component& c : all) {
    const double from_cut = c.center.x() - 0.3;
    if (std::abs(from_cut) < aside) c.center.x() = 0.3 + std::copysign(aside, from_cut);
  }
  return all;
}

TEST(MmcProblem, RefusesADesignThatHasComeApart) {
  const FullProblem cut(cut_layout(0.08));
  FullProblem whole(layout(0.01));
  MmcProblem& problem = whole.problem;
  const VectorXd start = problem.start();
  const double compliance = std::exp(problem.evaluate(start).f);
  EXPECT_TRUE(problem.acceptable(start));
  const double apart = std::exp(problem.evaluate(cut.design.x()).f);
  EXPECT_GT(apart, 100 * compliance);
  const int counted = whole.compliance.factorizations();
  EXPECT_FALSE(problem.acceptable(cut.design.x()));
  EXPECT_EQ(whole.compliance.factorizations(), counted);  // a resumed run compares it a second time
  problem.evaluate(start);
  EXPECT_TRUE(problem.acceptable(start));
  EXPECT_EQ(whole.compliance.factorizations(), counted + 1);
}

// An optimizer that steps back from refused designs reports only connected designs, however long
// its steps are.
TEST(MmcProblem, IteratesHangTogether) {
  FullProblem whole(layout());
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
  FullProblem whole(layout());
  VectorXd x = whole.problem.start();
  x[10] = std::nan("");
  EXPECT_THROW(whole.problem.evaluate(x), Error);
}

}  // namespace
}  // namespace flexmorph::mmc::test
