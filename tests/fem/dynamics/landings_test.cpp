// Times that steps land on: in order, stops and kinks that are next to each other as one.
#include "fem/dynamics/mesh_changes/landings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/motion.h"

namespace flexmorph::fem {
namespace {

TEST(Landings, AreInOrderAndAKinkIsAStopWhereOneIsNextToIt) {
  MotionSettings settings;
  settings.end = 1;
  settings.stops = {0.5, 0.25};
  const double behind = std::nextafter(0.5, 1);
  settings.kinks = {0.75, behind, 0, 1, 2};  // none at start and end, none behind
  const std::vector<Landing> all = landings(settings, 1e-9);
  ASSERT_EQ(all.size(), 4u);
  const Landing expected[] = {
      {0.25, true, false}, {behind, true, true}, {0.75, false, true}, {1, true, false}};
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].t, expected[i].t);
    EXPECT_EQ(all[i].stop, expected[i].stop);
    EXPECT_EQ(all[i].kink, expected[i].kink);
  }
  settings.adaptive = AdaptiveStep{};  // stops are interpolated
  EXPECT_EQ(landings(settings, 1e-9).size(), 3u);
}

// Of whatever length steps are, the sum of a time and a step that should end there is before the
// kink.
TEST(Landings, EndBeforeTheKinkHoweverTimesAreRounded) {
  for (const double kink : {1e-3, 0.31415, 1.0, 7.77, 1e4})
    for (const double from : {0.0, 0.1 * kink, 0.7 * kink, 0.999999 * kink}) {
      const double end = just_before(kink), h = end - from;
      EXPECT_LT(from + h, kink);
      EXPECT_LT(from + 0.5 * h + 0.5 * h, kink);
      EXPECT_NEAR(end, kink, 4e-15 * kink);
    }
}

}  // namespace
}  // namespace flexmorph::fem
