#include "fem/thermal/temperature.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <ranges>

#include "geometry/text.h"

namespace flexmorph::fem {
namespace {

const std::map<std::string, Profile>& table() {
  static const std::map<std::string, Profile> kProfiles = {{"quartic", Profile::quartic},
                                                           {"cosine", Profile::cosine},
                                                           {"quintic", Profile::quintic},
                                                           {"linear", Profile::linear},
                                                           {"step", Profile::step}};
  return kProfiles;
}

void check(const TemperatureRise& r) {
  if (!std::isfinite(r.rise) || !std::isfinite(r.start) || !std::isfinite(r.duration))
    throw Error::input(formatted(
        "temperature: rise = %g K, start = %g s, duration = %g s: these are finite numbers", r.rise,
        r.start, r.duration));
  if (r.profile != Profile::step && !(r.duration > 0))
    throw Error::input(
        formatted("temperature: duration = %g s: the settling time is positive", r.duration));
}

/// Returns the end of the rise; all callers get the identical double.
double end_of(const TemperatureRise& r) { return r.start + r.duration; }

/// Returns s(u) and its derivatives with respect to u in [0, 1].
Motion shape(Profile profile, double u) {
  constexpr double pi = std::numbers::pi;
  switch (profile) {
    case Profile::quartic:
      return {u * u * (6 + u * (-8 + 3 * u)), 12 * u * (1 - u) * (1 - u),
              12 * (1 - u) * (1 - 3 * u)};
    case Profile::cosine:
      return {0.5 * (1 - std::cos(pi * u)), 0.5 * pi * std::sin(pi * u),
              0.5 * pi * pi * std::cos(pi * u)};
    case Profile::quintic:
      return {u * u * u * (10 + u * (-15 + 6 * u)), 30 * u * u * (1 - u) * (1 - u),
              60 * u * (1 - u) * (1 - 2 * u)};
    case Profile::linear:
      return {u, 1, 0};
    case Profile::step:
      break;
  }
  return {1, 0, 0};
}

}  // namespace

Profile profile_of(const std::string& name) {
  const auto row = table().find(name);
  if (row != table().end()) return row->second;
  throw Error::input("temperature profile '" + name + "' is unknown; the available profiles are: " +
                     joined(std::views::keys(table())));
}

std::function<Motion(double t)> make_temperature(const TemperatureRise& rise) {
  check(rise);
  return [r = rise](double t) -> Motion {
    if (r.profile == Profile::step) return {t < r.start ? 0 : r.rise, 0, 0};
    if (t < r.start) return {};
    if (t >= end_of(r)) return {r.rise, 0, 0};
    const Motion s = shape(r.profile, std::min((t - r.start) / r.duration, 1.0));
    return {r.rise * s.value, r.rise * s.rate / r.duration,
            r.rise * s.acceleration / (r.duration * r.duration)};
  };
}

std::vector<double> discontinuities(const TemperatureRise& rise) {
  check(rise);
  switch (rise.profile) {
    case Profile::quartic:  // its acceleration ends at 0
      return {rise.start};
    case Profile::quintic:
      return {};
    case Profile::step:
      return {rise.start};
    default:
      return {rise.start, end_of(rise)};
  }
}

bool accelerates(const TemperatureRise& rise) {
  return rise.rise != 0 && rise.profile != Profile::linear && rise.profile != Profile::step;
}

}  // namespace flexmorph::fem
