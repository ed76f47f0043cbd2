// Shows that every row of the table of responses is correct as an objective and as a limit:
// derivatives against differences and by the Taylor test, values against their definitions; and
// that goals are described correctly and solve the state as rarely as possible.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "optim/mmc/problem/goal.h"
#include "tests/optim/mmc_small.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::mmc {
extern const ResponseRow kFirstMoment;  // tests/examples/response.cpp
}

namespace flexmorph::mmc::test {
namespace {

/// A response that depends on the components only: the length of all axes [m].
class Axes final : public Response {
 public:
  void evaluate(const DesignView& at, Values& out) override {
    const auto n = static_cast<Eigen::Index>(at.components.size());
    out.f = VectorXd::Zero(1);
    out.d_parameters = MatrixXd::Zero(1, n * Component::kParameters);
    for (Eigen::Index c = 0; c < n; ++c) {
      out.f[0] += 2 * at.components[static_cast<size_t>(c)].half_length;
      out.d_parameters(0, c * Component::kParameters + 2) = 2;
    }
  }
};
const ResponseRow kAxes{.name = "axes",
                        .words = "length of all axes",
                        .unit = "m",
                        .full = [](const Plate& plate) { return 10 * plate.grid.width; },
                        .make = make_response<Axes>};

/// A design problem with a goal on a rotating plate whose loads depend on its mass.
struct FullProblem {
  Design design;
  Ersatz ersatz;
  ComplianceEvaluator loads;
  MmcProblem problem;

  explicit FullProblem(const Goal& goal, unsigned seed = 3)
      : design(kGrid, random_layout(seed), kScale),
        ersatz(kGrid, tdf_settings().alpha, strip(), {}),
        loads(turning_plate(4), kSection, {}, {}, {}),
        problem({kPlate, design, ersatz, loads}, tdf_settings(), goal) {}
};

double value_of(const ResponseRow& row) {
  FullProblem whole({&kVolume, {Limit(row, 1, false, kPlate)}});
  whole.problem.evaluate(whole.problem.start());
  return whole.problem.values(row)->maxCoeff();
}

/// A value of f or g as a function of the variables.
using Each = std::function<double(const VectorXd&)>;
template <class Use>
void each_value(MmcProblem& problem, const optim::ProblemValues& at, const Use& use) {
  const bool linear = problem.goal().objective->per_load;  // f is its bound
  for (Eigen::Index row = linear ? 0 : -1; row < at.g.size(); ++row) {
    const Each f = [&problem, row](const VectorXd& x) {
      const optim::ProblemValues r = problem.evaluate(x);
      return row < 0 ? r.f : r.g[row];
    };
    use(f, row < 0 ? at.df : VectorXd(at.dg.row(row)), "row " + std::to_string(row));
  }
}

std::vector<const ResponseRow*> all_rows() {
  std::vector<const ResponseRow*> rows(responses().begin(), responses().end());
  // Responses of a motion are tested in tests/cases/motion_design_test.cpp.
  std::erase_if(rows, [](const ResponseRow* row) { return row->of_motion; });
  rows.push_back(&kCompliancePeak);  // replaces the worst compliance where gradients are needed
  rows.push_back(&kAxes);
  rows.push_back(&kFirstMoment);
  return rows;
}

class EveryResponse : public ::testing::TestWithParam<const ResponseRow*> {
 protected:
  /// Returns the response as the objective, and as both bounds under an objective without a state.
  /// Neither its values nor its derivatives depend on the bounds.
  static std::vector<Goal> goals() {
    const ResponseRow& row = *GetParam();
    const Limit other(row.needs_state() ? kVolume : kComplianceSum, 0.5, false, kPlate);
    const ResponseRow* objective = &row == &kVolume ? &kMass : &kVolume;
    return {{&row, {other}},
            {objective, {Limit(row, 0.7, false, kPlate), Limit(row, 0.3, true, kPlate)}}};
  }
};
INSTANTIATE_TEST_SUITE_P(Table, EveryResponse, ::testing::ValuesIn(all_rows()),
                         [](const auto& test) { return key_of(*test.param); });

// The steps are explained in mmc_problem_test.
TEST_P(EveryResponse, PassesTheTaylorTest) {
  for (const Goal& goal : goals()) {
    FullProblem whole(goal);
    const VectorXd x = whole.problem.start();
    const optim::ProblemValues at = whole.problem.evaluate(x);
    ASSERT_EQ(at.g.size(), whole.problem.n_constraints());
    const VectorXd unit = cells_of(whole.design);
    each_value(whole.problem, at, [&](const Each& f, const VectorXd& df, const std::string& what) {
      const VectorXd along = bent_direction(f, x, unit, 5);
      // A response that is linear in the variables has only round-off in its remainder.
      const auto taylor = optim::taylor_test(f, df, x, along, 1e-3, 3, 1e-15);
      if (GetParam() == &kAxes && !(taylor.order < 10)) return;
      EXPECT_NEAR(taylor.order, 2, 0.05) << what << "\n" << taylor.table();
    });
  }
}

TEST_P(EveryResponse, AgreesWithDifferences) {
  for (const Goal& goal : goals()) {
    FullProblem whole(goal, 8);
    const VectorXd x = whole.problem.start();
    const optim::ProblemValues at = whole.problem.evaluate(x);
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    VectorXd along(x.size());
    for (double& each : along) each = 1e-5 * uniform(engine);
    each_value(whole.problem, at, [&](const Each& f, const VectorXd& df, const std::string& what) {
      const double slope = df.dot(along), found = (f(x + along) - f(x - along)) / 2;
      EXPECT_NEAR(slope, found, 1e-4 * std::abs(slope) + 1e-11) << what;
    });
  }
}

// A constraint is 0 if the design meets its bound exactly. Otherwise it is the relative distance
// from the bound, or the logarithm of the ratio.
TEST_P(EveryResponse, IsMeasuredInPartsOfItsLimit) {
  const ResponseRow& row = *GetParam();
  const double value = value_of(row);
  EXPECT_GT(value, 0);
  const ResponseRow* objective = &row == &kVolume ? &kMass : &kVolume;
  FullProblem whole({objective,
                     {Limit(row, value, false, kPlate), Limit(row, 2 * value, false, kPlate),
                      Limit(row, 2 * value, true, kPlate)}});
  const optim::ProblemValues at = whole.problem.evaluate(whole.problem.start());
  const Eigen::Index m = at.g.size() / 3;
  EXPECT_EQ(m, row.per_load ? 4 : 1);
  const double half = row.full ? 0.5 - 1 : std::log(0.5);
  EXPECT_NEAR(at.g.head(m).maxCoeff(), 0, 1e-14);
  EXPECT_NEAR(at.g.segment(m, m).maxCoeff(), half, 1e-14);
  EXPECT_NEAR(at.g.tail(m).minCoeff(), -half, 1e-14);
  EXPECT_NEAR(whole.problem.goal().limits[2].excess(value), 0.5, 1e-14);
}

TEST(Responses, AreMadeOfWhatTheyMeasure) {
  const Goal all{&kComplianceSum,
                 {Limit(kVolume, 0.5, false, kPlate), Limit(kMass, 1, false, kPlate),
                  Limit(kComplianceWorst, 1, false, kPlate), Limit(kAxes, 1, false, kPlate)}};
  FullProblem whole(all);
  const optim::ProblemValues r = whole.problem.evaluate(whole.problem.start());
  const CellScaleFactors& b = whole.problem.factors();
  ComplianceEvaluator again(turning_plate(4), kSection, {}, {}, {});
  ComplianceEvaluator::Value value;
  again.evaluate(b.stiffness, b.mass, value);
  ComplianceEvaluator::Each each;
  again.evaluate_each(b.stiffness, b.mass, each);
  EXPECT_EQ((*whole.problem.values(kComplianceSum))[0], value.f);
  EXPECT_EQ(*whole.problem.values(kComplianceWorst), each.f);
  EXPECT_EQ((*whole.problem.values(kVolume))[0], b.mass.mean());
  EXPECT_NEAR((*whole.problem.values(kMass))[0], 2700 * 0.01 * 0.06 * b.mass.mean(), 1e-14);
  double length = 0;
  for (const Component& c : whole.design.components()) length += 2 * c.half_length;
  EXPECT_NEAR((*whole.problem.values(kAxes))[0], length, 1e-12);
  EXPECT_EQ(r.f, std::log(value.f));
  EXPECT_EQ(whole.problem.compliance(), value.f);  // the minimized compliance represents the design
  EXPECT_EQ(r.g.size(), 1 + 1 + 4 + 1);
  EXPECT_EQ(whole.problem.row_of(3), 6);
}

TEST(Responses, ShareOneFactorization) {
  FullProblem whole(
      {&kComplianceWorst,
       {Limit(kVolume, 0.5, false, kPlate), Limit(kComplianceSum, 1, false, kPlate)}});
  const VectorXd x = whole.problem.start();
  const int before = whole.loads.factorizations();
  whole.problem.evaluate(x + 1e-3 * VectorXd::Ones(x.size()));
  EXPECT_EQ(whole.loads.factorizations(), before + 1);
}

// A run that is continued has counted the factorization of its last design already.
TEST(Responses, ContinueToCountFactorizations) {
  const Goal goal{&kComplianceSum, {Limit(kVolume, 0.5, false, kPlate)}};
  FullProblem earlier(goal), later(goal);
  const VectorXd x = earlier.problem.start(), y = x + 1e-3 * VectorXd::Ones(x.size());
  earlier.problem.evaluate(x);
  earlier.problem.evaluate(y);
  const int made = earlier.loads.factorizations();
  later.problem.evaluate(x);
  later.loads.continue_from(earlier.loads.work());
  EXPECT_EQ(later.loads.work().factored, earlier.loads.work().factored);
  for (const VectorXd& each : {y, x, y}) {
    later.problem.evaluate(each);
    earlier.problem.evaluate(each);
    EXPECT_EQ(later.loads.factorizations(), earlier.loads.factorizations());
  }
  EXPECT_EQ(later.loads.factorizations(), made + 2);  // y is factored already
}

TEST(Responses, WithoutAStateNoneIsSolved) {
  FullProblem whole({&kMass, {Limit(kAxes, 1, true, kPlate)}});
  const int before = whole.loads.factorizations();
  const VectorXd x = whole.problem.start();
  whole.problem.evaluate(x);
  EXPECT_EQ(whole.loads.factorizations(), before);
  EXPECT_TRUE(std::isnan(whole.problem.compliance()));
  // Only the connectivity of such a design is known.
  EXPECT_TRUE(whole.problem.acceptable(x));
}

// Reference: a full rectangle about the middle of its left edge, m (w² / 3 + h² / 12).
TEST(Inertia, OfAFullPlateIsThatOfARectangle) {
  const ResponseRow& row = *find_response("inertia", "");
  Plate plate = kPlate;
  const double mass = 2700 * 0.01 * 0.6 * 0.1;
  const double whole = mass * (0.6 * 0.6 / 3 + 0.1 * 0.1 / 12);
  EXPECT_NEAR(row.full(plate), whole, 1e-14);
  ComplianceEvaluator loads(turning_plate(1), kSection, {}, {}, {});
  DesignState state(loads);
  const VectorXd full = VectorXd::Ones(kGrid.n_cells());
  Values found;
  row.make(plate)->evaluate({{full, full}, {}, state}, found);
  EXPECT_NEAR(found.f[0], whole, 1e-14);
  // Only the half next to the root: half of the mass and half of the length.
  plate.outside.assign(static_cast<size_t>(kGrid.n_cells()), 0);
  for (int cell = kGrid.cell(kGrid.nx / 2, 0); cell < kGrid.n_cells(); ++cell)
    plate.outside[static_cast<size_t>(cell)] = 1;
  EXPECT_NEAR(row.full(plate), 0.5 * mass * (0.3 * 0.3 / 3 + 0.1 * 0.1 / 12), 1e-14);
}

TEST(Goal, KnowsWhatItAllowsAndWhatHoldsItBack) {
  const double mass = 0.3 * kPlate.full_mass();
  Goal goal = least_compliance(0.4);
  EXPECT_EQ(allowed_volume(goal), 0.4);
  goal.limits.emplace_back(kMass, mass, false, kPlate);
  EXPECT_NEAR(*allowed_volume(goal), 0.3, 1e-15);
  EXPECT_TRUE(is_held_back(goal));
  EXPECT_FALSE(allowed_volume(least_volume(1)).has_value());
  EXPECT_TRUE(is_held_back(least_volume(1)));
  EXPECT_TRUE(is_held_back({&kMass, {Limit(kVolume, 0.2, true, kPlate)}}));
  EXPECT_FALSE(is_held_back({&kMass, {Limit(kVolume, 0.2, false, kPlate)}}));
  EXPECT_FALSE(is_held_back({&kComplianceSum, {Limit(kVolume, 0.2, true, kPlate)}}));
  EXPECT_FALSE(is_held_back({&kComplianceSum, {Limit(kComplianceWorst, 2, false, kPlate)}}));

  EXPECT_EQ(&compliance_row({&kMass, {Limit(kComplianceWorst, 2, false, kPlate)}}),
            &kComplianceWorst);
  EXPECT_EQ(&compliance_row({&kMass, {Limit(kVolume, 0.2, true, kPlate)}}), &kComplianceSum);
  EXPECT_EQ(further_rows(goal), (std::vector<const ResponseRow*>{&kMass}));
}

TEST(Table, HasRowsByTheirNamesAndLoads) {
  EXPECT_EQ(find_response("compliance", "sum"), &kComplianceSum);
  EXPECT_EQ(find_response("compliance", "worst"), &kComplianceWorst);
  EXPECT_EQ(find_response("volume", "worst"), &kVolume);
  EXPECT_EQ(find_response("beauty", "sum"), nullptr);
  for (const ResponseRow* row : responses())
    EXPECT_EQ(find_response(row->name, row->loads), row) << key_of(*row);
}

}  // namespace
}  // namespace flexmorph::mmc::test
