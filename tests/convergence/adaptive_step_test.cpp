// Shows that adaptive steps attain their target error: errors are proportional to the tolerance;
// positions, velocities and multipliers have order 2 from the first step on and with steps of any
// sizes; states within a step are as good as those at its ends; and extending plates move as with
// equal steps.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "fem/dynamics/integrators/dense_output.h"
#include "fem/dynamics/integrators/generalized_alpha.h"
#include "fem/dynamics/motion.h"
#include "tests/support/models.h"
#include "tests/support/particle_pendulum.h"
#include "tests/support/rates.h"
#include "tests/support/rigid_models.h"

namespace flexmorph::fem {
namespace {

using testing::exact_swing;
using testing::RotatingPlate;
using testing::Swing;

constexpr double kUnlimited = 1e300;  // an allowed error that accepts every step
constexpr double kTable = 1e-5;       // spacing of exact_swing()

AlphaSettings crisp(double rho_inf) {
  AlphaSettings settings;
  settings.rho_inf = rho_inf;
  settings.tolerance = 1e-14;
  return settings;
}

struct Errors {
  // largest error, and that of the first five steps
  double q = 0, v = 0, lambda = 0, first_lambda = 0;
};

enum class Steps { equal, random };

/// Returns the errors over 2 s of a pendulum in steps of about h; random steps are between h/1.5
/// and 1.5 h, with a period of 40 steps.
/// @param adapts  true: as adaptive steps; false: as fixed steps, whose formulas do not depend on
///                changes of their size
Errors swing(double h, double rho_inf, Steps steps, bool adapts) {
  Workspace model = testing::particle_pendulum();
  GeneralizedAlpha alpha(model, crisp(rho_inf));
  State x = testing::swing_start(model);
  alpha.make_consistent(x);
  if (adapts) alpha.first_step(x, 1, h);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> power(-1, 1);
  std::array<double, 40> parts;
  for (double& part : parts) part = steps == Steps::random ? std::pow(1.5, power(random)) : 1;
  Errors out;
  for (int n = 0; x.t < 2; ++n) {
    const double size = h * parts[static_cast<size_t>(n) % parts.size()];
    const double end = kTable * std::round((x.t + size) / kTable);
    if (adapts)
      EXPECT_TRUE(alpha.try_step(x, end - x.t, kUnlimited).converged);
    else
      alpha.advance(x, end, [](const State&) {});
    x.t = end;
    const Swing s = exact_swing(end);
    out.q = std::max(out.q, (x.q - s.position()).norm());
    out.v = std::max(out.v, (x.v - s.velocity()).norm());
    out.lambda = std::max(out.lambda, std::abs(x.lambda[0] - s.lambda()));
    if (n < 5) out.first_lambda = out.lambda;
  }
  return out;
}

double order(double Errors::*what, double rho_inf, Steps steps, bool adapts) {
  const auto rate = testing::fit_rate(
      {8e-3, 4e-3, 2e-3, 1e-3}, [&](double h) { return swing(h, rho_inf, steps, adapts).*what; });
  std::printf("%s", rate.table().c_str());
  return rate.order();
}

class AdaptivePendulum : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(RhoInf, AdaptivePendulum, ::testing::Values(0.0, 0.5, 0.8),
                         [](const auto& rho) {
                           return "rho" +
                                  std::to_string(static_cast<int>(std::lround(100 * rho.param)));
                         });

// The multiplier of fixed steps starts with an error of O(h): see pendulum_test.
TEST_P(AdaptivePendulum, MultiplierHasOrderTwoFromTheFirstStep) {
  EXPECT_NEAR(order(&Errors::first_lambda, GetParam(), Steps::equal, true), 2, 0.1);
  EXPECT_NEAR(order(&Errors::lambda, GetParam(), Steps::equal, true), 2, 0.1);
  EXPECT_NEAR(order(&Errors::first_lambda, GetParam(), Steps::equal, false), 1, 0.2);
}

// Alternating random step sizes are the worst case for a controller.
TEST_P(AdaptivePendulum, StepsOfAnySizesKeepOrderTwo) {
  for (const auto what : {&Errors::q, &Errors::v})
    EXPECT_NEAR(order(what, GetParam(), Steps::random, true), 2, 0.1);
  EXPECT_NEAR(order(&Errors::lambda, GetParam(), Steps::random, true), 2, 0.35);
  // Without a correction for changing step sizes the order is lost.
  EXPECT_LT(order(&Errors::lambda, GetParam(), Steps::random, false), 1.4);
}

/// Returns exact_swing() between the entries of its table.
Swing swing_at(double t) {
  const double low = kTable * std::floor(t / kTable), h = t - low;
  const Swing s = exact_swing(low);
  // Taylor expansions of second and first order over at most 1e-5 s: errors of 1e-14 rad, 1e-9
  // rad/s.
  const double spin = -testing::kGravity / testing::kLength * std::sin(s.angle);
  return {s.angle + h * (s.rate + 0.5 * h * spin), s.rate + h * spin};
}

/// The pendulum as a rigid body on a hinge: m g l / I = g / L.
struct RigidPendulum {
  RigidSection section{2, {0.5, 0}, 0.5};

  Workspace model() const {
    Workspace out;
    testing::add_rigid(out, "arm", section, Vec2(0, -testing::kGravity));
    out.add_joint(make_revolute("hinge", {}, {.body = "arm"}));
    return out;
  }
  static BodyPoses body_poses() {
    return [](double) {
      FrameMotion frame;
      frame.angle = exact_swing(0).angle - std::numbers::pi / 2;
      frame.angle_rate = exact_swing(0).rate;
      return std::vector<BodyPose>{{"arm", frame, 0}};
    };
  }
  double angle_error(const Model& model, const State& x) const {
    return std::abs(std::remainder(
        testing::angle_of(model, "arm", x) + std::numbers::pi / 2 - swing_at(x.t).angle,
        2 * std::numbers::pi));
  }
  /// Returns the error of the force of the hinge: m (c̈ - g) with the centre of mass c [N].
  double force_error(Workspace& model, const State& x) const {
    const Swing s = swing_at(x.t);
    const double l = section.center.norm(),
                 spin = -testing::kGravity / testing::kLength * std::sin(s.angle);
    const Vec2 along(std::sin(s.angle), -std::cos(s.angle)), across(-along.y(), along.x());
    const Vec2 force =
        section.mass * (l * (spin * across - s.rate * s.rate * along) + Vec2(0, testing::kGravity));
    const Vec3 hinge = model.joint_wrench(1, "arm", Vec3::Zero(), x).force;
    return (Vec2(hinge.head<2>()) - force).norm();
  }
};

MotionSettings adaptive(double tolerance, double end) {
  MotionSettings settings;
  settings.end = end;
  settings.start = Start::rigid;
  settings.balance = false;
  settings.alpha.tolerance = 1e-14;
  settings.adaptive = AdaptiveStep{};
  settings.adaptive->tolerance = tolerance;
  return settings;
}

/// Largest errors of a run, at its steps and at stops, which are inside steps.
struct RunErrors {
  double step = 0, stop = 0;              // error of the angle [rad]
  double step_force = 0, stop_force = 0;  // error of the hinge's force [N]
  double drift = 0;                       // |Φ| and |Φ_q v| at stops
  int stops = 0;
  MotionResult result;
};

RunErrors swing_adaptively(MotionSettings settings, double rho_inf) {
  const RigidPendulum p;
  Workspace model = p.model();
  settings.body_poses = p.body_poses();
  settings.alpha.rho_inf = rho_inf;
  for (int k = 1; k <= 40; ++k) settings.stops.push_back(0.0497 * k);
  RunErrors out;
  out.result = integrate(model, {}, settings, [&](const MotionStep& step) {
    double& error = step.stop ? out.stop : out.step;
    double& force = step.stop ? out.stop_force : out.step_force;
    error = std::max(error, p.angle_error(step.model, step.x));
    force = std::max(force, p.force_error(step.model, step.x));
    if (!step.stop) return;
    ++out.stops;
    if (step.x.t == settings.end) return;  // the end of a step
    Constraints c;
    step.model.constraints(step.x, c);
    VectorXd rate = c.rate;
    for (const auto& entry : c.jacobian) rate[entry.row()] += entry.value() * step.x.v[entry.col()];
    out.drift = std::max({out.drift, c.value.cwiseAbs().maxCoeff(), rate.cwiseAbs().maxCoeff()});
  });
  return out;
}

// States at stops are as good as those at steps, and consistent. Their errors have an order for
// tolerances from 1e-3 on: at 1e-2 (steps of 0.1 s) the angle has an error of 3 degrees.
// Multipliers at steps have no order. Whether a step may grow depends on the iterations of Newton's
// method, which round-off decides, and the remaining error of the multiplier depends on the changes
// of step size: between 0.07 and 0.97 N at 1e-4, depending on settings.alpha.tolerance. It only
// vanishes with the tolerance. Multipliers at stops follow from the position.
TEST(AdaptiveSteps, ErrorsAreProportionalToTheTolerance) {
  for (const double rho : {0.0, 0.8}) {
    testing::Rate angle, force;
    std::vector<double> step_force;
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
      MotionSettings settings = adaptive(tolerance, 2);
      settings.adaptive->largest = 0.5;
      const RunErrors e = swing_adaptively(settings, rho);
      const StepCounts& c = e.result.counts;
      std::printf(
          "rho %.1f, tolerance %.0e: angle %.2e, at stops %.2e; force %.2e, at stops %.2e; drift "
          "at "
          "stops %.1e; %d steps, %d inaccurate, %.1e to %.1e s\n",
          rho, tolerance, e.step, e.stop, e.step_force, e.stop_force, e.drift, c.steps,
          c.inaccurate, e.result.smallest_step, e.result.largest_step);
      EXPECT_LT(e.stop, 1.2 * e.step);
      EXPECT_LT(e.stop_force, 1.2 * e.step_force);
      EXPECT_LT(e.drift, 1e-11);
      EXPECT_EQ(e.stops, 41);
      EXPECT_LT(c.inaccurate, 0.25 * c.steps);
      step_force.push_back(e.step_force);
      if (tolerance > 2e-3) continue;
      for (testing::Rate* rate : {&angle, &force}) rate->step.push_back(tolerance);
      angle.error.push_back(e.step);
      force.error.push_back(e.stop_force);
    }
    EXPECT_NEAR(angle.order(), 1, 0.1) << angle.table();
    EXPECT_NEAR(force.order(), 1, 0.15) << force.table();
    // The largest force is 45 N, m (g + l rate²) at the bottom.
    EXPECT_LT(step_force.back(), 1e-3 * 45);
    EXPECT_LT(step_force.back(), 0.02 * step_force.front());
  }
}

TEST(AdaptiveSteps, AreReproducible) {
  const RunErrors a = swing_adaptively(adaptive(1e-4, 2), 0.8),
                  b = swing_adaptively(adaptive(1e-4, 2), 0.8);
  EXPECT_EQ(a.result.final.q, b.result.final.q);
  EXPECT_EQ(a.result.final.lambda, b.result.final.lambda);
  EXPECT_EQ(a.result.counts.newton, b.result.counts.newton);
}

TEST(AdaptiveSteps, LandOnKinksAndKeepTheirLimits) {
  const RigidPendulum p;
  Workspace model = p.model();
  MotionSettings settings = adaptive(1e-2, 1);
  settings.body_poses = p.body_poses();
  settings.discontinuities = {0.731, 0.2345};
  settings.adaptive->largest = 0.01;
  int met = 0;
  settings.adaptive->first = 1e-3;
  double last = 0, first = 0;
  const MotionResult r = integrate(model, {}, settings, [&](const MotionStep& step) {
    for (const double discontinuity : settings.discontinuities) met += step.x.t == discontinuity;
    EXPECT_LE(step.x.t - last, 0.01 + 1e-12);
    if (last == 0 && step.x.t > 0) first = step.x.t;
    last = step.x.t;
  });
  EXPECT_EQ(met, 2);
  EXPECT_EQ(first, 1e-3);
  EXPECT_EQ(last, 1);
  EXPECT_EQ(r.largest_step, 0.01);
  EXPECT_EQ(r.smallest_step, 1e-3);
  EXPECT_GT(r.counts.steps, 100);
  EXPECT_LT(r.counts.steps, 120);
}

TEST(AdaptiveSteps, NeedAnIntegratorThatKnowsItsError) {
  const RigidPendulum p;
  Workspace model = p.model();
  MotionSettings settings = adaptive(1e-3, 1);
  settings.body_poses = p.body_poses();
  settings.integrator = "energy_momentum";
  try {
    integrate(model, {}, settings, [](const MotionStep&) {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    EXPECT_NE(std::string(error.what()).find("local error"), std::string::npos) << error.what();
  }
}

/// Returns the errors [m], [m/s], [N] within a step between exact ends at start and start + h.
std::array<double, 3> within(double start, double h) {
  Workspace model = testing::particle_pendulum();
  const auto exact = [&](double t) {
    const Swing s = exact_swing(t);
    State x = model.reference();
    x.t = t;
    x.q.head<2>() = s.position();
    x.v.head<2>() = s.velocity();
    const double spin = -testing::kGravity / testing::kLength * std::sin(s.angle);
    x.a.head<2>() = testing::kLength * spin * Vec2(std::cos(s.angle), std::sin(s.angle)) -
                    s.rate * s.rate * s.position();
    x.lambda = VectorXd::Constant(1, s.lambda());
    return x;
  };
  const State a = exact(start), b = exact(start + h), c = exact(start + 0.3 * h);
  DenseOutput dense(model);
  dense.set_step(a, b);
  State x;
  dense.at(c.t, x);
  EXPECT_LT(std::abs(x.q.dot(x.v)), 1e-13);
  EXPECT_NEAR(x.q.norm(), testing::kLength, 1e-13);
  return {(x.q - c.q).norm(), (x.v - c.v).norm(), (x.lambda - c.lambda).norm()};
}

// The polynomial has degree five: h⁶ in the position, h⁵ in the velocity and in values that depend
// on it.
TEST(DenseOutput, HasTheOrderOfTheQuintic) {
  const char* const names[] = {"q", "v", "lambda"};
  for (size_t k = 0; k < 3; ++k) {
    const auto rate = testing::fit_rate({0.1, 0.05, 0.025}, [&](double h) {
      double most = 0;
      for (int i = 1; i <= 10; ++i) most = std::max(most, within(0.1 * i, h)[k]);
      return most;
    });
    std::printf("%s\n%s", names[k], rate.table().c_str());
    EXPECT_NEAR(rate.order(), k == 0 ? 6 : 5, 0.7) << rate.table();
  }
}

struct Growing {
  MotionResult result;
  std::vector<Vec2> tip;  // in the hub's axes, at stops
};

Growing grow(const RotatingPlate& p, MotionSettings settings) {
  testing::Scene scene = testing::make_scene(p);
  for (int k = 1; k <= 10; ++k) settings.stops.push_back(settings.end * k / 10);
  Growing out;
  out.result = integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& step) {
    if (step.stop) out.tip.push_back(testing::in_hub(p, step.model, step.x, p.tip()));
  });
  return out;
}

// Nodes are inserted at the right times, the energy balance holds, and the tip agrees with small
// equal steps.
TEST(AdaptiveSteps, LandOnChangesOfTheMesh) {
  RotatingPlate p;
  p.speed = 0.5;
  MotionSettings fixed, adapted = adaptive(3e-4, 0.35);
  fixed.end = 0.35;
  fixed.step = 2.5e-4;
  adapted.start = fixed.start;
  adapted.balance = true;
  adapted.alpha = fixed.alpha;
  const Growing a = grow(p, fixed), b = grow(p, adapted);
  ASSERT_EQ(b.result.events.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const MeshEvent& e = b.result.events[i];
    EXPECT_NEAR(e.time, 0.1 * static_cast<double>(i + 1), 1e-12);
    EXPECT_LT(e.tip_jump, 1e-6);
    EXPECT_NEAR(e.after.strain / e.before.strain, 1, 0.01);
  }
  ASSERT_EQ(a.tip.size(), 10u);
  ASSERT_EQ(b.tip.size(), 10u);
  double error = 0;
  for (size_t i = 0; i < 10; ++i) error = std::max(error, (a.tip[i] - b.tip[i]).norm());
  const StepCounts& c = b.result.counts;
  std::printf("tip misses by %.2e m in %d steps (%d inaccurate, %d rejected), defect %.1e\n", error,
              c.steps, c.inaccurate, c.rejected, b.result.energy_error);
  EXPECT_LT(error, 2 * 3e-4 * p.length);
  EXPECT_LT(c.steps, 120);
  EXPECT_EQ(c.rejected, 0);
  EXPECT_LT(b.result.energy_error, 1e-3);
  const Growing again = grow(p, adapted);
  EXPECT_EQ(again.result.final.q, b.result.final.q);
}

// Steps with a loose tolerance do not resolve axial vibrations. Changes of the step size must not
// excite them, because Newton's method would then need shorter steps than with a tight tolerance.
TEST(AdaptiveSteps, LooserTolerancesTakeFewerSteps) {
  RotatingPlate p;
  p.speed = 0.5;
  std::vector<int> steps;
  for (const double tolerance : {1e-2, 1e-3, 3e-4}) {
    MotionSettings settings = adaptive(tolerance, 0.35);
    settings.start = Start::prestretched;
    settings.alpha = AlphaSettings{};
    const StepCounts c = grow(p, settings).result.counts;
    std::printf("tolerance %.0e: %d steps (%d inaccurate, %d rejected)\n", tolerance, c.steps,
                c.inaccurate, c.rejected);
    EXPECT_EQ(c.rejected, 0);
    steps.push_back(c.steps);
  }
  EXPECT_LT(steps[0], steps[1]);
  EXPECT_LT(steps[1], steps[2]);
}

}  // namespace
}  // namespace flexmorph::fem
