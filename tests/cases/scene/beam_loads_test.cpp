// Shows that loads on beams give the deflections of textbook formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "fem/solve/statics.h"
#include "tests/cases/scene/loaded_scenes.h"

namespace flexmorph::cases {
namespace {

constexpr double kEI = 2e9 * 0.01 * 8e-6 / 12, kGA = 1e9 * 0.02 * 0.01;

struct Bent {
  Mechanism m;
  fem::State x;
  Vec2 tip() const { return fem::point_position(m.model.body("rod"), x, {1, 0}).head<2>(); }
  /// Returns the angle of the axis at the tip.
  double angle() const {
    const Vec2 before = fem::point_position(m.model.body("rod"), x, {1 - 1e-6, 0}).head<2>();
    const Vec2 along = tip() - before;
    return std::atan2(along.y(), along.x());
  }
};

Bent bend(const std::string& text, const Changes& changes = {}) {
  const Scene scene = scene_of(text, changes);
  Bent out{build_mechanism(scene), {}};
  out.x = fem::start_state(out.m.model, out.m.moving_roots, 0, fem::Start::rigid,
                           out.m.motion.body_poses);
  EXPECT_TRUE(fem::solve_static(out.m.model, out.x, {}).completed);
  return out;
}

// Reference: Timoshenko's beam, q L^4 / (8 E I) + q L^2 / (2 G A), with the shear area of these
// elements, the whole section. The deflection is 2e-5 of the length, and nonlinear terms are the
// square of this. The error of the ANCF mesh is some 1e-3.
TEST(Loads, ForcePerLengthBendsABeamAsTheTextbookSays) {
  const double q = 2e-3, expected = q / (8 * kEI) + q / (2 * kGA);
  for (const std::string turns : {"false", "true"}) {
    const Bent bent =
        bend(kCantilever + load("line", "body = \"rod\"\nforce = [0.0, 2e-3]\nturns = " + turns));
    EXPECT_NEAR(bent.tip().y() / expected, 1, 2e-3) << turns;
  }
}

// An end moment bends the beam to an arc whose tip has turned by M L / (E I) = 1 rad.
TEST(Loads, TorqueAtTheTipBendsABeamToAnArc) {
  const Bent bent =
      bend(kCantilever +
           load("torque", "body = \"rod\"\npoint = [1.0, 0.0]\ntorque = " + io::to_text(kEI)));
  EXPECT_NEAR(bent.tip().x(), std::sin(1.0), 2e-3);
  EXPECT_NEAR(bent.tip().y(), 1 - std::cos(1.0), 2e-3);
}

// A force turns with the tip. The reaction at the root is this force, rotated as the tip is, and
// its moment about the root, whatever the stiffness.
TEST(Loads, TurningForceOfABeamIsTurnedAsItsTip) {
  Bent bent = bend(kCantilever + load("point",
                                      "body = \"rod\"\npoint = [1.0, 0.0]\nforce = [0.0, 20.0]\n"
                                      "turns = true"));
  EXPECT_GT(bent.angle(), 0.5);
  const Vec2 force = fem::rotation(bent.angle()) * Vec2(0, 20), tip = bent.tip();
  fem::Wrench root;
  for (size_t i = 0; i < bent.m.model.joints().size(); ++i) {
    const fem::Wrench each = bent.m.model.joint_wrench(i, "rod", Vec3::Zero(), bent.x);
    root.force += each.force;
    root.moment += each.moment;
  }
  EXPECT_LT((root.force.head<2>() + force).norm(), 20 * 1e-5);
  EXPECT_NEAR(root.moment.z(), -(tip.x() * force.y() - tip.y() * force.x()), 20 * 1e-5);
}

// Reference: m g a^2 (3 L - a) / (6 E I) + m g a / (G A). The rod itself has practically no weight.
TEST(Loads, PointMassAnywhereOnABeamWeighs) {
  const double a = 0.375, mg = 1e-3 * 10;
  const Bent bent =
      bend("gravity = [0.0, -10.0]\n" + kCantilever +
               "\n[[point_mass]]\nbody = \"rod\"\npoint = [0.375, 0.0]\nmass = 1e-3\n",
           {"body.rod.density=1e-9"});
  EXPECT_NEAR(bent.tip().y() / -(mg * a * a * (3 - a) / (6 * kEI) + mg * a / kGA), 1, 3e-3);
}

}  // namespace
}  // namespace flexmorph::cases
