// Shows that the shipped spin-up agrees with published numbers, in the axes of the hub.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

// Reference values. Simo & Vu-Quoc (1986): the beam that turns steadily is stretched by 5.14e-4 m.
// An independent model: the largest deflection is 0.574 m, opposite to the turn. Both tolerances
// are 0.5 %. The stretch also follows from the equations of Simo & Vu-Quoc with the distance x from
// the hub: EA u' = rho A w^2 (L^2 - x^2)/2, u(L) = rho A w^2 L^3 / (3 EA) = 5.143e-4 m, reduced by
// the shortening due to the deflection of the vibration. The test takes the mean over the last five
// seconds.
TEST(SpinUp, LagsAndStretchesAsOthersFound) {
  const Scene scene = read("spin_up");
  Mechanism m = build_mechanism(scene);
  const auto turn = scene.motion_of(scene.hubs[0].turn);
  double largest = 0, when = 0, stretch = 0, n = 0;
  const fem::MotionResult r =
      fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& s) {
        const Vec3 tip = fem::point_position(s.model.body("beam"), s.x, {10, 0});
        const Vec2 seen = fem::rotation(turn(s.x.t).value).transpose() * tip.head<2>();
        if (seen.y() < largest) {
          largest = seen.y();
          when = s.x.t;
        }
        if (s.x.t < 15) return;
        stretch += seen.x() - 10;
        ++n;
      });
  EXPECT_NEAR(largest, -0.574, 0.005 * 0.574);
  EXPECT_NEAR(when, 6.8, 0.1);
  EXPECT_NEAR(stretch / n, 5.14e-4, 0.005 * 5.14e-4);
  EXPECT_LT(r.energy_error, 5e-4);
}

}  // namespace
}  // namespace flexmorph::cases
