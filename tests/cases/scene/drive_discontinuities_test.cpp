// Shows that steps end exactly at jumps of a drive's acceleration, and that the order of the
// integrators is kept there.
#include <gtest/gtest.h>

#include <cmath>

#include "cases/assembly/build.h"
#include "tests/cases/scene/breathing_scene.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

/// Two masses on the x axis: one is driven, the other one is coupled to it by a spring.
const std::string kPulled = R"toml(
[time]
end = 2.0
step = 0.01
start = "rigid"

[[drive]]
name = "path"
formula = "piecewise(t^2, 0.31415, 0.31415^2 + 2*0.31415*(t - 0.31415)) - max(t - 1.2345, 0)^2"

[[rigid_body]]
name = "cart"
mass = 3.0
size = [0.1, 0.1]

[[rigid_body]]
name = "load"
mass = 2.0
size = [0.1, 0.1]

[[joint]]
type = "slider"
name = "rail"
a = "ground"
b = "cart"

[[joint]]
type = "slider"
a = "ground"
b = "load"

[[joint]]
type = "point_drive"
name = "pull"
a = "cart"
x = "path"

[[spring]]
name = "spring"
a = "cart"
b = "load"
stiffness = 50.0
)toml";

/// Solution of x" + w^2 (x - s) = 0 with s" = 2 until 0.31415 s, 0 until 1.2345 s and -2
/// afterwards: each jump of s" by j adds -j/w^2 (1 - cos w t) to x - s.
double pulled_load(double t) {
  const double w = 5;
  const auto answer = [&](double jump, double from) {
    const double tau = t - from;
    if (tau < 0) return 0.0;
    return jump * (0.5 * tau * tau - (1 - std::cos(w * tau)) / (w * w));
  };
  return answer(2, 0) - answer(2, 0.31415) - answer(2, 1.2345);
}

// Discontinuities are no multiples of the step. Steps end exactly there and keep their order.
TEST_F(Drives, WithDiscontinuitiesKeepTheOrderOfTheSteps) {
  for (const std::string integrator : {"generalized_alpha", "energy_momentum"}) {
    std::vector<double> errors, energy_errors;
    for (const double step : {0.02, 0.01, 0.005}) {
      const Scene scene =
          read({"time.step=" + io::to_text(step), "time.integrator=" + integrator}, kPulled);
      Mechanism m = build_mechanism(scene);
      ASSERT_EQ(m.motion.discontinuities, (std::vector<double>{0.31415, 1.2345}));
      double error = 0;
      int met = 0;
      const fem::MotionResult r =
          fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& s) {
            error = std::max(error, std::abs(s.x.q[4] - pulled_load(s.x.t)));
            met += s.x.t == 0.31415 || s.x.t == 1.2345;
          });
      EXPECT_EQ(met, 2) << integrator;
      errors.push_back(error);
      energy_errors.push_back(r.energy_error);
    }
    for (size_t i = 1; i < errors.size(); ++i) {
      EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 2, 0.1) << integrator << errors[i];
      if (integrator == "generalized_alpha") {
        EXPECT_GT(std::log2(energy_errors[i - 1] / energy_errors[i]), 1.9) << energy_errors[i];
      }
    }
    EXPECT_LT(energy_errors.back(), integrator == "generalized_alpha" ? 1e-4 : 1e-12);
  }
  // Adaptive and explicit steps end there, too. Their errors are a few tolerances times the
  // displacement.
  for (const Changes& changes :
       {Changes{"time.step=adaptive", "time.tolerance=1e-4"},
        Changes{"time.integrator=minimal_coordinates", "time.tolerance=1e-9"}}) {
    Mechanism m = build_mechanism(read(changes, kPulled));
    double error = 0;
    int met = 0;
    fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& s) {
      error = std::max(error, std::abs(s.x.q[4] - pulled_load(s.x.t)));
      met += s.x.t == 0.31415 || s.x.t == 1.2345;
    });
    EXPECT_EQ(met, 2) << changes[0];
    EXPECT_LT(error, changes[0].find("adaptive") != std::string::npos ? 1e-3 : 1e-7) << changes[0];
  }
}

// The force of the drive is m s" + k (s - x). At a discontinuity it is the value behind it; the
// step before ends with the acceleration before it.
TEST_F(Drives, JumpsOfAccelerationAreSeenFromBehind) {
  const Scene scene = read({"time.step=0.001"}, kPulled);
  Mechanism m = build_mechanism(scene);
  const auto force = [&](const fem::MotionStep& s) {
    for (size_t i = 0; i < m.model.joints().size(); ++i)
      if (m.model.joints()[i]->name() == "pull") return s.x.lambda[m.model.first_row(i)];
    return 0.0;
  };
  double worst = 0;
  fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& s) {
    const fem::Motion path = scene.drives[0].motion(s.x.t);
    const double exact = 3 * path.acceleration + 50 * (path.value - pulled_load(s.x.t));
    worst = std::max(worst, std::abs(-force(s) - exact));
  });
  EXPECT_LT(worst, 1e-3 * 6);  // relative to the jumps of 6 N
}

TEST_F(Drives, ThatJumpAreRefusedWhereSomethingMoves) {
  const std::vector<std::pair<Changes, std::vector<std::string>>> wrong = {
      {{"drive.turn.table=", "drive.turn.formula=\"abs(t - 0.25)\""},
       {"hub.angle", "'turn'", "rate", "-1", "1", "t = 0.25 s"}},
      {{"drive.side.csv=", "drive.side.column=", "drive.side.formula=\"step(t - 0.5)\""},
       {"hub.position", "'side'", "value", "0", "1", "t = 0.5 s"}},
      {{"drive.out.formula=\"0.45 + max(t - 0.5, 0)\""},
       {"hub.position", "'out'", "rate", "0", "1", "t = 0.5 s"}},
  };
  for (const auto& [changes, parts] : wrong)
    EXPECT_TRUE(testing::mentions_all(complaint(changes), parts, scratch_ / "breathing.toml:"));
  EXPECT_EQ(complaint({"drive.out.formula=\"0.45 + 0.1*smoothstep(t/0.5)\""}), "");
}

}  // namespace
}  // namespace flexmorph::cases
