// Shows that multipliers that alternate from step to step are distinguished from multipliers that
// vary smoothly or whose alternation is damped.
#include "fem/dynamics/integrators/step_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/body_joints.h"
#include "fem/dynamics/integrators/integrator.h"
#include "fem/elements/rigid_body.h"
#include "fem/rigid.h"

namespace flexmorph::fem {
namespace {

/// Returns a rod on a pin: its rows are the unit axis (0) and the pin (1, 2).
Model rod() {
  Model out;
  std::vector<std::unique_ptr<Term>> terms;
  terms.push_back(make_rigid_inertia({1, {0.5, 0}, 1.0 / 12}));
  out.add_body("rod", std::make_unique<RigidBody>(std::sqrt(1.0 / 12)), {}, std::move(terms));
  out.add_joint(make_unit_axis("axis", "rod"));
  out.add_joint(make_revolute("pin", {}, {"rod"}));
  return out;
}

/// Runs the watch over n steps of 1e-3 s with the multiplier of(k) in the pin's second row and 100
/// N in the other rows.
template <class Of>
std::optional<Alternation> seen(int n, const Of& of) {
  const Model model = rod();
  MultiplierWatch watch;
  State x = model.reference();
  for (int k = 0; k < n; ++k) {
    x.t = 1e-3 * k;
    x.lambda = Vec3(100, 100, of(k));
    watch.see(model, x, 1e-3);
  }
  return watch.found();
}
double sign(int k) { return k % 2 == 0 ? 1 : -1; }

TEST(MultiplierWatch, FindsWhatAlternates) {
  const auto found = seen(400, [](int k) { return 50 + (k >= 200 ? 2 * sign(k) : 0.0); });
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->joint, "pin");
  EXPECT_NEAR(found->time, 0.2, 2e-3);
  EXPECT_NEAR(found->part, 2.0 / 52, 1e-3);
}

TEST(MultiplierWatch, LeavesWhatVariesOrIsDamped) {
  using std::numbers::pi;
  // A period of nine steps; a small alternation; an alternation that is damped as with rho_inf =
  // 0.9.
  EXPECT_FALSE(seen(1000, [](int k) { return 50 * std::sin(2 * pi * k / 9); }));
  EXPECT_FALSE(seen(1000, [](int k) { return 50 + 0.2 * sign(k); }));
  EXPECT_FALSE(seen(1000, [](int k) { return 50 + 20 * sign(k) * std::pow(0.9, k); }));
}

// Observations with one step size do not count for another step size.
TEST(MultiplierWatch, BeginsAnewWithEveryLengthOfStep) {
  const Model model = rod();
  MultiplierWatch watch;
  State x = model.reference();
  for (int k = 0; k < 1000; ++k) {
    x.t = 1e-3 * k;
    x.lambda = Vec3(100, 100, 50 + 20 * sign(k));
    watch.see(model, x, k / 50 % 2 == 0 ? 1e-3 : 5e-4);
  }
  EXPECT_FALSE(watch.found());
}

// A jump of the velocity between two steps causes multipliers that alternate and grow with rho_inf
// = 1 and decay with 0.9.
TEST(MultiplierWatch, SeesWhatRhoInfDoesNotDamp) {
  for (const double rho : {1.0, 0.9}) {
    Workspace model(rod());
    IntegratorSettings settings;
    settings.alpha.rho_inf = rho;
    const auto integrator = make_integrator(model, settings);
    State x = model.reference();
    x.v << 0, 0, 0, 5;
    integrator->make_consistent(x);
    integrator->advance(x, 1e-2, [](const State&) {});
    x.v *= 1.1;
    MultiplierWatch watch;
    for (int k = 1; k <= 150; ++k)
      integrator->advance(x, 1e-2 * (k + 1), [&](const State& s) { watch.see(model, s, 1e-2); });
    EXPECT_EQ(watch.found().has_value(), rho == 1.0) << rho;
  }
}

}  // namespace
}  // namespace flexmorph::fem
