// Shows that the keys of [time] for adaptive steps have the documented defaults and effects.
#include <gtest/gtest.h>

#include "cases/assembly/build.h"
#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

Scene read(Changes changes) {
  changes.insert(changes.begin(), "time.step=adaptive");
  return cases::read("rotating_plate_v01", changes);
}

TEST(AdaptiveScene, HasDefaults) {
  const fem::MotionSettings motion = build_mechanism(read({})).motion;
  ASSERT_TRUE(motion.adaptive);
  EXPECT_EQ(motion.adaptive->tolerance, 1e-4);
  EXPECT_EQ(motion.adaptive->largest, 0);
  EXPECT_TRUE(motion.discontinuities.empty());
  EXPECT_EQ(motion.step, 1e-3);
}

TEST(AdaptiveScene, TakesToleranceAndLargestStep) {
  const fem::MotionSettings motion =
      build_mechanism(read({"time.tolerance=1e-3", "time.largest_step=0.02"})).motion;
  ASSERT_TRUE(motion.adaptive);
  EXPECT_EQ(motion.adaptive->tolerance, 1e-3);
  EXPECT_EQ(motion.adaptive->largest, 0.02);
}

TEST(AdaptiveScene, LandsOnTheEndOfTheSpinUp) {
  const Scene scene = read({"time.start=hub_at_rest", "time.spin_up=0.3"});
  EXPECT_EQ(build_mechanism(scene).motion.discontinuities, std::vector<double>{0.3});
}

// A verification uses the kind of steps of the scene, or constant steps if it gives their size.
TEST(AdaptiveScene, VerificationMayHaveItsOwnSteps) {
  const auto adapts = [](const Scene& scene) {
    Mechanism mechanism = build_mechanism(scene);
    set_step(scene, scene.verify->step, mechanism.motion);
    return mechanism.motion.adaptive.has_value();
  };
  EXPECT_TRUE(adapts(read({})));
  EXPECT_FALSE(adapts(read({"verify.step=5e-4"})));
}

}  // namespace
}  // namespace flexmorph::cases
