#include "fem/dynamics/mesh_changes/landings.h"

#include <algorithm>
#include <limits>

#include "fem/dynamics/motion.h"

namespace flexmorph::fem {

std::vector<Landing> landings(const MotionSettings& settings, double near) {
  std::vector<Landing> all, out;
  if (!settings.adaptive)
    for (const double t : settings.stops) all.push_back({t, true, false});
  for (const double t : settings.kinks)
    if (t > near && t < settings.end - near) all.push_back({t, false, true});
  all.push_back({settings.end, true, false});
  std::stable_sort(all.begin(), all.end(),
                   [](const Landing& a, const Landing& b) { return a.t < b.t; });
  for (const Landing& next : all) {
    const bool same = !out.empty() && next.t <= out.back().t + near;
    if (!same || !(next.kink || out.back().kink)) {
      out.push_back(next);
      continue;
    }
    Landing& last = out.back();
    if (next.kink) last.t = next.t;
    last.kink = true;
    last.stop |= next.stop;
  }
  return out;
}

double just_before(double kink) { return kink * (1 - 16 * std::numeric_limits<double>::epsilon()); }

}  // namespace flexmorph::fem
