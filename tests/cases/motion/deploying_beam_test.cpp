// Shows that the shipped deploying beam, and the beam as it is drawn in, agree with a series of
// modes of the growing beam.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

/// Returns the tip deflection at 0.25 s, 0.5 s, ... 2 s, scaled to a gravity of 1 m/s^2 [m].
std::array<double, 8> tips(const Changes& changes) {
  const Scene scene = read("deploying_beam", changes);
  Mechanism m = build_mechanism(scene);
  const Vec2 tip(scene.bodies[0].longest(scene.time.end), 0);
  std::array<double, 8> out{};
  size_t next = 0;
  // values of the previous step; steps end at changes of the mesh, not at quarters of a second
  double t = 0, y = 0;
  fem::integrate(m.model, m.moving_roots, m.motion, [&](const fem::MotionStep& s) {
    const double now = 1e2 * fem::point_position(s.model.body("beam"), s.x, tip).y();
    const double quarter = 0.25 * static_cast<double>(next + 1);
    if (next < out.size() && s.x.t > quarter - 1e-9 && s.x.t > t)
      out[next++] = y + (quarter - t) / (s.x.t - t) * (now - y);
    t = s.x.t;
    y = now;
  });
  return out;
}

void compare(const std::array<double, 8>& tips, const std::array<double, 8>& series) {
  for (size_t i = 0; i < series.size(); ++i)
    EXPECT_NEAR(tips[i], series[i], 0.005 * std::abs(series[i])) << "quarter " << i + 1;
}

// Reference values: a Galerkin series in x/L of (d/dt + v d/dx)^2 w + w_xxxx = -1, starting static,
// L = 1 + t/2, printed to five digits.
TEST(DeployingBeam, DropsWhileItComesOut) {
  compare(tips({}), {-.04346, -.15319, -.30534, -.47016, -.65148, -.84840, -1.05522, -1.28237});
}

// Reference values: a Galerkin series in x/L with L = 2 - t/2, printed to four digits.
TEST(DeployingBeam, DropsWhileItIsDrawnIn) {
  compare(tips({"constants.L0=2", "constants.v=-0.5"}),
          {-.0286, -.1491, -.4294, -.7527, -1.0502, -1.3083, -1.2162, -.6300});
}

}  // namespace
}  // namespace flexmorph::cases
