// Shows that the deflection of the extending, rotating plate agrees with an independent model: a
// shear-deformable, geometrically exact beam (support/reissner_beam.h), which shares neither
// kinematics nor strains nor frame nor time integration with the plate. Shows also why the weld
// leaves the slopes of the root free by default.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "fem/dynamics/motion.h"
#include "tests/support/models.h"
#include "tests/support/reissner_beam.h"

namespace flexmorph::fem {
namespace {

using testing::RotatingPlate;
using testing::ShapeSet;

const reference::TipHistory& beam(double speed) {
  static std::map<double, reference::TipHistory> known;
  const auto row = known.find(speed);
  if (row != known.end()) return row->second;
  reference::ReissnerBeam b;
  b.speed = speed;
  return known.emplace(speed, reference::simulate(b, VectorXd::LinSpaced(101, 0, 1))).first->second;
}

/// Returns the root mean square difference of the tip's deflection over 1 s, in percent of its
/// maximum.
double difference(double speed, ShapeSet shapes, WeldMode weld) {
  RotatingPlate p;
  p.speed = speed;
  p.shapes = shapes;
  p.weld = weld;
  testing::Scene scene = testing::make_scene(p);
  MotionSettings settings;
  settings.start = Start::rigid;
  for (int k = 1; k <= 100; ++k) settings.stops.push_back(0.01 * k);
  const reference::TipHistory& expected = beam(speed);
  double sum = 0;
  Eigen::Index k = 0;
  integrate(scene.model, scene.moving_roots, settings, [&](const MotionStep& step) {
    if (!step.stop && step.x.t > 0) return;
    ASSERT_NEAR(step.x.t, expected.time[k], 1e-9);
    const double d = testing::in_hub(p, step.model, step.x, p.tip()).y() - expected.deflection[k++];
    sum += d * d;
  });
  EXPECT_EQ(k, expected.time.size());
  const double out =
      100 * std::sqrt(sum / static_cast<double>(k)) / expected.deflection.cwiseAbs().maxCoeff();
  std::printf("v %.1f, %s, weld %s: %.3f %%\n", speed, shapes == ShapeSet::h12 ? "h12" : "h16",
              weld == WeldMode::edge        ? "edge"
              : weld == WeldMode::direction ? "direction"
                                            : "full",
              out);
  return out;
}

// With 20 x 4 elements h16 the differences are 0.32 and 1.22 % (0.40 and 1.54 % here). They come
// mainly from the models and not from the mesh (the clamp of a plate prevents lateral contraction,
// strains of a beam are averages over the section). The incomplete shapes h12 are stiffer than the
// plate (plate_statics_test.cpp): 1.10 and 4.38 % here. The limits are 1.15 to 1.5 times these
// values.
TEST(Reissner, PlateMovesLikeTheBeam) {
  EXPECT_LT(difference(0.5, ShapeSet::h16, WeldMode::edge), 0.6);
  EXPECT_LT(difference(0.1, ShapeSet::h16, WeldMode::edge), 2.2);
  EXPECT_LT(difference(0.5, ShapeSet::h12, WeldMode::edge), 1.5);
  EXPECT_LT(difference(0.1, ShapeSet::h12, WeldMode::edge), 5);
}

// Holding the direction of r_m prevents shear at the root, which a clamped edge has.
TEST(Reissner, HoldingSlopesAtTheRootIsWorse) {
  for (const double speed : {0.1, 0.5}) {
    const double edge = difference(speed, ShapeSet::h16, WeldMode::edge);
    const double direction = difference(speed, ShapeSet::h16, WeldMode::direction);
    const double full = difference(speed, ShapeSet::h16, WeldMode::full);
    EXPECT_GT(direction, 1.5 * edge);
    EXPECT_GT(full, 1.5 * edge);
  }
}

}  // namespace
}  // namespace flexmorph::fem
