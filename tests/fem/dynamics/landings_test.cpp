// Shows that event times are in order, and that neighbouring stops and discontinuities are one
// event.
#include <gtest/gtest.h>

#include <cmath>

#include "fem/dynamics/mesh_changes/event_times.h"
#include "fem/dynamics/motion.h"

namespace flexmorph::fem {
namespace {

TEST(Landings, AreInOrderAndAKinkIsAStopWhereOneIsNextToIt) {
  MotionSettings settings;
  settings.end = 1;
  settings.stops = {0.5, 0.25};
  const double behind = std::nextafter(0.5, 1);
  // Discontinuities at the start, at the end and behind it are no events.
  settings.discontinuities = {0.75, behind, 0, 1, 2};
  const std::vector<EventTime> all = event_times(settings, 1e-9);
  ASSERT_EQ(all.size(), 4u);
  const EventTime expected[] = {
      {0.25, true, false}, {behind, true, true}, {0.75, false, true}, {1, true, false}};
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].t, expected[i].t);
    EXPECT_EQ(all[i].stop, expected[i].stop);
    EXPECT_EQ(all[i].discontinuity, expected[i].discontinuity);
  }
  settings.adaptive = AdaptiveStep{};  // stops are interpolated
  EXPECT_EQ(event_times(settings, 1e-9).size(), 3u);
}

// For steps of any length, the rounded sum of a time and a step that ends at the event is before
// the discontinuity.
TEST(Landings, EndBeforeTheKinkHoweverTimesAreRounded) {
  for (const double discontinuity : {1e-3, 0.31415, 1.0, 7.77, 1e4})
    for (const double from :
         {0.0, 0.1 * discontinuity, 0.7 * discontinuity, 0.999999 * discontinuity}) {
      const double end = just_before(discontinuity), h = end - from;
      EXPECT_LT(from + h, discontinuity);
      EXPECT_LT(from + 0.5 * h + 0.5 * h, discontinuity);
      EXPECT_NEAR(end, discontinuity, 4e-15 * discontinuity);
    }
}

}  // namespace
}  // namespace flexmorph::fem
