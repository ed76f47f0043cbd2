#include "fem/dynamics/mesh_changes/event_times.h"

#include <algorithm>
#include <limits>

#include "fem/dynamics/motion.h"

namespace flexmorph::fem {

std::vector<EventTime> event_times(const MotionSettings& settings, double near) {
  std::vector<EventTime> all, out;
  if (!settings.adaptive)
    for (const double t : settings.stops) all.push_back({t, true, false});
  for (const double t : settings.discontinuities)
    if (t > near && t < settings.end - near) all.push_back({t, false, true});
  all.push_back({settings.end, true, false});
  std::stable_sort(all.begin(), all.end(),
                   [](const EventTime& a, const EventTime& b) { return a.t < b.t; });
  for (const EventTime& next : all) {
    const bool same = !out.empty() && next.t <= out.back().t + near;
    if (!same || !(next.discontinuity || out.back().discontinuity)) {
      out.push_back(next);
      continue;
    }
    EventTime& last = out.back();
    if (next.discontinuity) last.t = next.t;
    last.discontinuity = true;
    last.stop |= next.stop;
  }
  return out;
}

double just_before(double discontinuity) {
  return discontinuity * (1 - 16 * std::numeric_limits<double>::epsilon());
}

}  // namespace flexmorph::fem
