// Shows that heat in the design problem is correct: Taylor tests of every derivative up to the
// variables of the design; loads of hot plates from the state of a motion, whose strain energy is
// that of the static analysis, or zero if nothing is held.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <random>

#include "fem/dynamics/esl.h"
#include "fem/elements/ancf_plate.h"
#include "fem/terms.h"
#include "optim/mmc/problem/shared_problem.h"
#include "tests/optim/mmc_hot.h"
#include "tests/support/gradient_check.h"

namespace flexmorph::mmc::test {
namespace {

// ------------------------------------------------------------ Taylor tests

struct Choice {
  const char* name;
  LoadDefinition loads;
  Support support;
  bool edge_grows;
};
void PrintTo(const Choice& choice, std::ostream* out) { *out << choice.name; }

const Choice kChoices[] = {
    {"inertia_moving_root_held", LoadDefinition::inertia, Support::moving_root, false},
    {"inertia_moving_root_free", LoadDefinition::inertia, Support::moving_root, true},
    {"frozen_moving_root_held", LoadDefinition::frozen, Support::moving_root, false},
    {"frozen_far_end_held", LoadDefinition::frozen, Support::far_end, false},
    {"stiffness_moving_root_held", LoadDefinition::stiffness, Support::moving_root, false},
    {"stiffness_far_end_held", LoadDefinition::stiffness, Support::far_end, false}};

/// Scale factors along a line s: exponential of a sine (stiffness, 1e-3 to 1), and 0.02 to 1
/// (mass).
struct Line {
  VectorXd phase, speed;

  explicit Line(unsigned seed) : phase(kGrid.n_cells()), speed(kGrid.n_cells()) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (Eigen::Index c = 0; c < phase.size(); ++c)
      phase(c) = 2 * std::numbers::pi * uniform(engine), speed(c) = 0.5 + uniform(engine);
  }
  VectorXd stiffness(double s) const {
    return (1.5 * std::numbers::ln10 * ((phase + s * speed).array().sin() - 1)).exp();
  }
  VectorXd mass(double s) const { return 0.51 + 0.49 * (phase + s * speed).array().sin(); }
  VectorXd d_stiffness(double s) const {
    return stiffness(s).array() * 1.5 * std::numbers::ln10 * speed.array() *
           (phase + s * speed).array().cos();
  }
  VectorXd d_mass(double s) const {
    return 0.49 * speed.array() * (phase + s * speed).array().cos();
  }
};

/// Returns the order of the remainder of f(s) at 0 with derivative df, for steps from 3e-3 to 3e-6.
double taylor_order(const std::function<double(double)>& f, double df) {
  const auto of_x = [&](const VectorXd& x) { return f(x[0]); };
  return optim::taylor_test(of_x, VectorXd::Constant(1, df), VectorXd::Zero(1), VectorXd::Ones(1),
                            3e-3, 3, 0)
      .order;
}

class HotLoads : public ::testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(Table, HotLoads, ::testing::ValuesIn(kChoices),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(HotLoads, RemaindersAreOfSecondOrder) {
  const fem::EslSets loads = hot_plate(4, kStretch, GetParam().edge_grows);
  for (const unsigned seed : {1u, 2u}) {
    const Line start(seed + 10), line(seed);
    ComplianceEvaluator compliance(loads, kSection, {GetParam().loads, GetParam().support},
                                   start.stiffness(0), start.mass(0));
    ComplianceEvaluator::Value value;
    compliance.evaluate(line.stiffness(0), line.mass(0), value);
    const double slope =
        value.d_stiffness.dot(line.d_stiffness(0)) + value.d_mass.dot(line.d_mass(0));
    const auto sum = [&](double s) {
      ComplianceEvaluator::Value at;
      compliance.evaluate(line.stiffness(s), line.mass(s), at);
      return at.f;
    };
    EXPECT_NEAR(taylor_order(sum, slope), 2, 0.05) << seed;

    ComplianceEvaluator::Each each;
    compliance.evaluate_each(line.stiffness(0), line.mass(0), each);
    for (const int l : {0, 3}) {
      double of_load = each.d_stiffness.row(l).dot(line.d_stiffness(0));
      if (each.d_mass.size() > 0) of_load += each.d_mass.row(l).dot(line.d_mass(0));
      const auto one = [&](double s) {
        ComplianceEvaluator::Each at;
        compliance.evaluate_each(line.stiffness(s), line.mass(s), at);
        return at.f(l);
      };
      EXPECT_NEAR(taylor_order(one, of_load), 2, 0.05) << seed << ", load " << l;
    }
  }
}

// Heat and loads contribute similarly to the compliance, so that these tests are sensitive to both.
TEST(HotCompliance, TheTestsWeighHeatAndLoadsAlike) {
  const Line line(1);
  for (const VectorXd& k : {line.stiffness(0), VectorXd(VectorXd::Ones(kGrid.n_cells()))}) {
    ComplianceEvaluator::Value hot, cold;
    ComplianceEvaluator(hot_plate(4, kStretch), kSection, {}, {}, {})
        .evaluate(k, line.mass(0), hot);
    ComplianceEvaluator(hot_plate(4, 0), kSection, {}, {}, {}).evaluate(k, line.mass(0), cold);
    const double share = (hot.f - cold.f) / hot.f;
    EXPECT_GT(share, 0.05);
    EXPECT_LT(share, 0.98);
  }
}

// ------------------------------------------------------------ from dynamics

/// A static hot plate of 12 x 8 elements, refined towards its root, in a hub at an arbitrary
/// position. Its root edge keeps its width, and the rest is in equilibrium to first order: s = 1 +
/// a, r = o + R (s (X, Y) + w) with K_ff w_f = -K_fc w_c and the stiffness matrix of the plate.
/// With `edge_grows` w = 0.
struct HotDynamics {
  double a;
  fem::Workspace model;
  fem::State x;
  fem::MovingRoot growth;
  double strain_energy = 0;  // s³ U_cold(q / s), fem/README.md, Heat

  HotDynamics(bool edge_grows, double stretch) : a(stretch) {
    fem::FrameMotion hub;
    hub.origin = {0.3, -0.2};
    hub.angle = 0.7;
    growth = {"plate", [hub](double) { return hub; }, 1, 0.01};
    add_plate();
    model.prepare(0.0);
    x = model.reference();
    VectorXd w = VectorXd::Zero(x.q.size());
    if (!edge_grows) w = held_edge();
    const Eigen::Matrix2d turn = fem::rotation(hub.angle);
    const fem::State cold = x;
    fem::State scaled = x;
    for (Eigen::Index k = 0; k < x.q.size() / 2; ++k) {
      const Vec2 local = (1 + a) * cold.q.segment<2>(2 * k) + w.segment<2>(2 * k);
      x.q.segment<2>(2 * k) = turn * local + (k % 4 == 0 ? hub.origin : Vec2(0, 0));
      scaled.q.segment<2>(2 * k) = local / (1 + a);
    }
    strain_energy = std::pow(1 + a, 3) * model.energies(scaled).strain;
    model.bodies()[0].heat = fem::Heat{a, [](double) { return fem::Motion{1, 0, 0}; }};
  }

 private:
  void add_plate() {
    const auto lines = [](double from, double to, int n, double power) {
      std::vector<fem::MaterialLine> out;
      for (int i = 0; i <= n; ++i)
        out.push_back({from + (to - from) * std::pow(1.0 * i / n, power), {}, false});
      return out;
    };
    std::vector<std::unique_ptr<fem::Term>> terms;
    terms.push_back(fem::make_inertia(kSection));
    terms.push_back(fem::make_membrane(kSection));
    model.add_body(
        "plate",
        std::make_unique<fem::AncfPlate>(2, fem::AncfPlate::ShapeSet::h16, lines(0, 0.6, 12, 2.5),
                                         lines(-0.05, 0.05, 8, 1)),
        kSection, std::move(terms));
  }
  /// Returns w: at the nine nodes of the root, r and r_n are held as by a weld.
  VectorXd held_edge() {
    fem::SparseMatrix sparse;
    model.kkt(x, {}, {1, 0, 0}, 1, sparse);
    const MatrixXd K = sparse;
    VectorXd w = VectorXd::Zero(x.q.size());
    std::vector<int> held, free;
    for (int i = 0; i < w.size(); ++i) {
      const int vector = i / 2;
      const bool is_held = vector / 4 < 9 && vector % 2 == 0;  // r, r_n of r, r_m, r_n, r_mn
      (is_held ? held : free).push_back(i);
      if (is_held) w(i) = i % 2 == 1 ? -a * x.q(i) : 0;
    }
    w(free) = VectorXd(MatrixXd(K(free, free)).llt().solve(-VectorXd(K(free, held) * w(held))));
    return w;
  }
};

fem::EslSets load_of(HotDynamics& hot, const Grid& grid) {
  return {grid, {equivalent_static_load(hot.model, hot.x, hot.growth, grid, {}, {}, {})}};
}

// 1/2 w . K w is compared with the strain energy of the motion, and the static deformation with
// that of the motion, which was computed with another element and another method. The stress at the
// corners of the held edge is singular, therefore energies converge from above with about the first
// order of the cell size.
TEST(HotDynamicsLoads, AnEdgeThatIsHeldHasTheStaticAnswer) {
  const double a = 1e-5;  // small, because linear statics is compared
  HotDynamics hot(false, a);
  std::vector<double> ratios;
  for (const int fine : {1, 2, 4}) {
    Grid grid = kGrid;
    grid.nx *= fine;
    grid.ny *= fine;
    const fem::EslSets loads = load_of(hot, grid);
    EXPECT_NEAR(loads.sets[0].held_stretch, a, 1e-9 * a);
    ComplianceEvaluator compliance(loads, kSection, {}, {}, {});
    const VectorXd ones = VectorXd::Ones(grid.n_cells());
    ratios.push_back(0.5 * compliance.individual(ones, ones)(0) / hot.strain_energy);
    VectorXd u = compliance.displacement(ones, ones, 0);
    for (int n = 0; n < grid.n_nodes(); ++n)
      u.segment<2>(2 * n) -= a * grid.node_position(n / (grid.ny + 1), n % (grid.ny + 1));
    EXPECT_LT((u - loads.sets[0].deformation).norm(), 0.05 * u.norm());
  }
  EXPECT_GT(ratios[0], ratios[1]);
  EXPECT_GT(ratios[1], ratios[2]);
  EXPECT_NEAR(ratios[2], 1, 0.01);
}

// Free expansion, computed from the state of the motion, gives no static load.
TEST(HotDynamicsLoads, FreeGrowthHasNoAnswer) {
  HotDynamics free(true, 8e-3), held(false, 8e-3);
  const fem::EslSets loads = load_of(free, kGrid), others = load_of(held, kGrid);
  EXPECT_LT(loads.sets[0].deformation.norm(), 1e-10 * others.sets[0].deformation.norm());
  const VectorXd ones = VectorXd::Ones(kGrid.n_cells());
  ComplianceEvaluator none(loads, kSection, {}, {}, {}), some(others, kSection, {}, {}, {});
  EXPECT_LT(none.individual(ones, ones)(0), 1e-20 * some.individual(ones, ones)(0));
}

// ------------------------------------------------------------ design problems

/// Returns a plate with both ends welded to walls, pulled at the middle, at three temperatures.
ComplianceEvaluator both_ends_held() {
  std::vector<LoadCase> cases;
  for (int l = 0; l < 3; ++l)
    cases.push_back({"load", 1 + 0.5 * l, {{kGrid.node(30, 3 + 2 * l), {1.0 * l, 20}}}, 3e-4 * l});
  return ComplianceEvaluator({kGrid, kSection, {}}, edge(0, {0, 1}) + edge(kGrid.nx, {0, 1}), cases,
                             true);
}

struct FullProblem {
  Design design;
  Ersatz ersatz;
  ComplianceEvaluator turning;
  ComplianceEvaluator resting;
  MmcProblem of_turning, of_resting;

  explicit FullProblem(const ResponseRow& row = kComplianceSum)
      : design(kGrid, random_layout(7), kScale),
        ersatz(kGrid, tdf_settings().alpha, strip(), {}),
        turning(hot_plate(4, kStretch), kSection, {}, {}, {}),
        resting(both_ends_held()),
        of_turning({kPlate, design, ersatz, turning}, tdf_settings(), least_compliance(0.5, row)),
        of_resting({kPlate, design, ersatz, resting}, tdf_settings(), least_compliance(0.5, row)) {}

  VectorXd unit() const { return cells_of(design); }
};

TEST(HotProblem, GradientsPassTheTaylorTest) {
  for (const ResponseRow* of : {&kComplianceSum, &kComplianceWorst}) {
    FullProblem whole(*of);
    for (MmcProblem* problem : {&whole.of_turning, &whole.of_resting}) {
      const bool sum = of == &kComplianceSum;
      const VectorXd x = problem->start();
      const optim::ProblemValues at = problem->evaluate(x);
      for (Eigen::Index row = sum ? -1 : 1; row < (sum ? 0 : at.g.size()); ++row) {
        const auto f = [&](const VectorXd& y) {
          const optim::ProblemValues r = problem->evaluate(y);
          return row < 0 ? r.f : r.g[row];
        };
        const VectorXd df = row < 0 ? at.df : VectorXd(at.dg.row(row));
        const auto taylor =
            optim::taylor_test(f, df, x, bent_direction(f, x, whole.unit(), 3), 1e-3, 3, 0);
        EXPECT_NEAR(taylor.order, 2, 0.05) << row << "\n" << taylor.table();
      }
    }
  }
}

TEST(HotProblem, EveryEntryAgreesWithDifferences) {
  FullProblem whole;
  const VectorXd unit = whole.unit();
  for (MmcProblem* problem : {&whole.of_turning, &whole.of_resting}) {
    const VectorXd x = problem->start();
    const optim::ProblemValues at = problem->evaluate(x);
    const double largest = at.df.cwiseProduct(unit).cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      VectorXd d = VectorXd::Zero(x.size());
      d[i] = 1e-3 * unit[i];
      const double plus = problem->evaluate(x + d).f, minus = problem->evaluate(x - d).f;
      // A jump of the second derivative at the edge of the band, see mmc_problem_test.
      EXPECT_NEAR((plus - minus) / 2e-3, at.df[i] * unit[i], 1e-3 * largest) << i;
    }
  }
}

// For bodies that share mass, the sum includes the energy of the hot body.
TEST(HotProblem, SharedMassPassesTheTaylorTest) {
  FullProblem whole;
  SharedProblem shared({{&whole.of_turning, 2.0}, {&whole.of_resting, 1.0}});
  const VectorXd x = shared.start();
  const optim::ProblemValues at = shared.evaluate(x);
  EXPECT_EQ(at.f, std::log(whole.of_turning.compliance() + whole.of_resting.compliance()));
  const auto f = [&](const VectorXd& y) { return shared.evaluate(y).f; };
  VectorXd unit(x.size());
  unit << whole.unit(), whole.unit();
  const auto taylor = optim::taylor_test(f, at.df, x, bent_direction(f, x, unit, 4), 1e-3, 3, 0);
  EXPECT_NEAR(taylor.order, 2, 0.05) << taylor.table();
}

}  // namespace
}  // namespace flexmorph::mmc::test
