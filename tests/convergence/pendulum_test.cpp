// Shows the order of generalized-alpha on a pendulum in Cartesian coordinates (index 3) whose
// motion is known: 2 in position, velocity and multiplier at the end; a start-up transient of order
// 1 in the largest error of the multiplier; a drift of the velocity constraint that stays of
// order 2. Also: a joint whose Φ_q depends on q converges quadratically through its part of the
// tangent.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fem/dynamics/generalized_alpha.h"
#include "tests/support/rates.h"

namespace flexmorph::fem {
namespace {

constexpr double kLength = 1, kGravity = 9.81, kMass = 2, kEnd = 2;

/// A body of one point: r = q.
class Particle final : public Element {
 public:
  int dim() const override { return 2; }
  int n_shapes() const override { return 1; }
  int n_elements() const override { return 1; }
  int n_vectors() const override { return 1; }
  std::span<const int> vectors(int) const override { return {&zero_, 1}; }
  double scale(int) const override { return 1; }
  bool is_position(int) const override { return true; }
  MatrixXd reference() const override { return Eigen::RowVector2d(0, -kLength); }
  std::vector<NodeVectors> edge(const std::string&) const override {
    return {{0, -1, -1, -1, {0, 0}}};
  }
  void move_to(double) override {}
  bool moving(int) const override { return false; }
  void tabulate(int, int, Tabulate, const Factors&, FactorKind, ShapeTable& out) const override {
    out.weight = VectorXd::Ones(1);
    out.material = {Vec2::Zero()};
    out.N = MatrixXd::Ones(1, 1);
    for (MatrixXd* none : {&out.N_t, &out.N_tt, &out.N_m, &out.N_n, &out.N_mt, &out.N_nt})
      none->resize(0, 0);
  }
  int locate(const Vec2&, Tabulate what, ShapeTable& out) const override {
    tabulate(0, 0, what, {}, FactorKind::none, out);
    return 0;
  }

 private:
  int zero_ = 0;
};

/// (|r|² - L²) / 2 = 0.
class Rod final : public Joint {
 public:
  explicit Rod(bool exact_tangent) : exact_tangent_(exact_tangent) {}
  std::string name() const override { return "rod"; }
  int size() const override { return 1; }
  void bind(std::span<const BodyView> bodies) override {
    first_ = find_body(bodies, name(), "bob").first_dof;
  }
  void evaluate(double, const VectorXd& q, const VectorXd& v, ConstraintRows& rows) const override {
    const auto r = q.segment<2>(first_), r_t = v.segment<2>(first_);
    rows.value = VectorXd::Constant(1, (r.squaredNorm() - kLength * kLength) / 2);
    rows.rate = VectorXd::Zero(1);
    rows.acceleration = VectorXd::Constant(1, -r_t.squaredNorm());
    rows.jacobian.clear();
    for (int c = 0; c < 2; ++c) rows.jacobian.emplace_back(0, first_ + c, r[c]);
  }
  void add_stiffness(double, const VectorXd&, const VectorXd& lambda,
                     std::vector<Eigen::Triplet<double>>& out) const override {
    if (exact_tangent_)
      for (int c = 0; c < 2; ++c) out.emplace_back(first_ + c, first_ + c, lambda[0]);
  }

 private:
  bool exact_tangent_;
  int first_ = 0;
};

struct Swing {
  double angle, rate;
  Vec2 position() const { return kLength * Vec2(std::sin(angle), -std::cos(angle)); }
  Vec2 velocity() const { return kLength * rate * Vec2(std::cos(angle), std::sin(angle)); }
  /// Along r: m |v|² = λ L² + m g L cos(angle), λ < 0 pulls inwards with this sign of Φ.
  double lambda() const { return kMass * (rate * rate + kGravity / kLength * std::cos(angle)); }
};

/// θ'' = -g/L sin θ by Runge-Kutta steps of 1e-5 s: error (1e-5)^4, nothing.
Swing exact(double t) {
  static std::vector<Swing> table = {{1.0, 0.8}};
  constexpr double h = 1e-5;
  const auto rate = [](const Swing& s) {
    return Swing{s.rate, -kGravity / kLength * std::sin(s.angle)};
  };
  const auto moved = [](const Swing& s, double by, const Swing& d) {
    return Swing{s.angle + by * d.angle, s.rate + by * d.rate};
  };
  const auto index = static_cast<size_t>(std::lround(t / h));
  while (table.size() <= index) {
    const Swing s = table.back();
    const Swing k1 = rate(s), k2 = rate(moved(s, h / 2, k1)), k3 = rate(moved(s, h / 2, k2)),
                k4 = rate(moved(s, h, k3));
    table.push_back({s.angle + h / 6 * (k1.angle + 2 * k2.angle + 2 * k3.angle + k4.angle),
                     s.rate + h / 6 * (k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate)});
  }
  return table[index];
}

struct Errors {
  double q = 0, v = 0, lambda = 0;                       // at the end
  double largest_lambda = 0, drift = 0, late_drift = 0;  // over the run; drift in its second half
  StepCounts counts;
};

Errors run(double h, double rho_inf, bool exact_tangent = true, AlphaSettings settings = {}) {
  Model model;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_point_mass(kMass, {0, 0}, Vec2(0, -kGravity)));
  model.add_body("bob", std::make_unique<Particle>(), {}, std::move(terms));
  model.add_joint(std::make_unique<Rod>(exact_tangent));
  settings.rho_inf = rho_inf;
  // The multiplier sees errors of Newton's method divided by h^2: below its own error at 1 ms.
  settings.tolerance = 1e-14;
  GeneralizedAlpha alpha(model, settings);
  State x = model.reference();
  x.q.head<2>() = exact(0).position();
  x.v.head<2>() = exact(0).velocity();
  alpha.make_consistent(x);
  Errors e;
  EXPECT_NEAR(x.lambda[0], exact(0).lambda(), 1e-12);
  const int n = static_cast<int>(std::lround(kEnd / h));
  for (int k = 1; k <= n; ++k)
    alpha.advance(x, kEnd * k / n, [&](const State& y) {
      const Swing s = exact(y.t);
      e.q = (y.q - s.position()).norm();
      e.v = (y.v - s.velocity()).norm();
      e.lambda = std::abs(y.lambda[0] - s.lambda());
      e.largest_lambda = std::max(e.largest_lambda, e.lambda);
      const double drift = std::abs(y.q.dot(y.v));
      e.drift = std::max(e.drift, drift);
      if (2 * k > n) e.late_drift = std::max(e.late_drift, drift);
    });
  e.counts = alpha.counts();
  return e;
}

const std::vector<double> kSteps = {8e-3, 4e-3, 2e-3, 1e-3};

class Pendulum : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(RhoInf, Pendulum, ::testing::Values(0.0, 0.6, 0.8, 0.9),
                         [](const auto& rho) {
                           return "rho" +
                                  std::to_string(static_cast<int>(std::lround(100 * rho.param)));
                         });

// Line 14 (Arnold & Brüls 2007).
TEST_P(Pendulum, ConvergesWithOrderTwoInPositionVelocityAndMultiplier) {
  for (const auto& [name, value] :
       {std::pair{"q", &Errors::q}, {"v", &Errors::v}, {"lambda", &Errors::lambda}}) {
    const auto rate =
        testing::fit_rate(kSteps, [&](double h) { return run(h, GetParam()).*value; });
    std::cout << name << '\n' << rate.table();
    EXPECT_NEAR(rate.order(), 2, 0.1) << name << '\n' << rate.table();
  }
}

// The initial algorithmic acceleration is q̈(0); the one that belongs to the scheme differs by O(h),
// which shows in the first multipliers and is damped away for rho_inf < 1.
TEST_P(Pendulum, LargestMultiplierErrorIsAStartUpTransient) {
  const auto rate =
      testing::fit_rate(kSteps, [&](double h) { return run(h, GetParam()).largest_lambda; });
  std::cout << "largest lambda error\n" << rate.table();
  EXPECT_GT(rate.order(), 0.9) << rate.table();
}

TEST_P(Pendulum, VelocityDriftIsBoundedAndOfOrderTwo) {
  const auto rate = testing::fit_rate(kSteps, [&](double h) { return run(h, GetParam()).drift; });
  std::cout << "velocity drift\n" << rate.table();
  EXPECT_NEAR(rate.order(), 2, 0.15) << rate.table();
  const Errors e = run(2e-3, GetParam());
  EXPECT_LT(e.late_drift, 1.5 * e.drift);  // it does not grow with time
}

// Without damping at infinite frequency (rho_inf = 1) the index-3 multiplier is only weakly stable:
// position and velocity keep their order, the multiplier does not converge. A known limit of the
// method, not to be used with constraints.
TEST(Pendulum, WithoutDampingOnlyPositionAndVelocityConverge) {
  for (const auto& [name, value] : {std::pair{"q", &Errors::q}, {"v", &Errors::v}}) {
    const auto rate = testing::fit_rate(kSteps, [&](double h) { return run(h, 1).*value; });
    EXPECT_NEAR(rate.order(), 2, 0.1) << name << '\n' << rate.table();
  }
  std::cout << "rho_inf = 1: error of lambda " << run(4e-3, 1).lambda << " of "
            << exact(kEnd).lambda() << " N/m\n";
}

// With and without (Φ_qᵀ λ)_q Newton finds the same answer; the exact tangent never takes longer.
TEST(NonlinearJoint, TangentOfTheConstraintForceChangesTheWayNotTheAnswer) {
  for (const double h : {8e-3, 4e-2}) {
    const Errors with = run(h, 0.8), without = run(h, 0.8, false);
    std::cout << "h = " << h << ": Newton with " << with.counts.newton << " ("
              << with.counts.factorizations << " factors), without " << without.counts.newton
              << " (" << without.counts.factorizations << ")\n";
    EXPECT_LE(with.counts.newton, without.counts.newton);
    EXPECT_EQ(with.counts.rejected + without.counts.rejected, 0);
    EXPECT_NEAR(with.q, without.q, 1e-8);
  }
}

// A step that Newton does not manage in its iterations is halved, and grows back.
TEST(StepHalving, RecoversAndReportsWhatItCannotDo) {
  AlphaSettings settings;
  settings.max_iterations = 4;
  const Errors e = run(0.1, 0.8, true, settings);
  std::cout << "0.1 s with 4 iterations: " << e.counts.rejected << " rejected, " << e.counts.steps
            << " steps\n";
  EXPECT_GT(e.counts.rejected, 0);
  EXPECT_GT(e.counts.steps, 20);
  EXPECT_LT(e.q, 0.5);  // of order h^2, with h of 0.1 s at most

  settings.max_iterations = 1;
  settings.max_halvings = 3;
  try {
    run(0.1, 0.8, true, settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::numerical);
    const std::string text = error.what();
    EXPECT_NE(text.find("no convergence at t = 0 s"), std::string::npos) << text;
    EXPECT_NE(text.find("1: |r|"), std::string::npos) << text;
  }
  EXPECT_THROW(run(0.1, 1.2), Error);
}

}  // namespace
}  // namespace flexmorph::fem
