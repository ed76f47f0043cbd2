#include "cases/accuracy/budget.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "geometry/base.h"

namespace flexmorph::cases {

double read_budget(const std::string& text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string unit(rest, end);
  double factor = 0;
  if (unit.empty() || unit == "s") factor = 1;
  if (unit == "min") factor = 60;
  if (unit == "h") factor = 3600;
  if (error != std::errc() || factor == 0 || !(number > 0) || !std::isfinite(number))
    throw Error::input("--budget " + text + ": a time such as 120s, 2min or 1h is wanted");
  return number * factor;
}

Budget::Budget(double seconds, std::function<double()> clock)
    : total_(seconds), begin_(clock()), clock_(std::move(clock)) {}

double Budget::left() const { return std::max(0.0, total_ - (clock_() - begin_)); }

double Track::predicted(size_t level) const {
  std::vector<size_t> known;
  for (size_t i = 0; i < h.size(); ++i)
    if (seconds[i]) known.push_back(i);
  if (known.empty()) return first_guess * std::pow(h[level], -cost_exponent);
  const auto distance = [&](size_t i) { return std::abs(std::log(h[i] / h[level])); };
  std::stable_sort(known.begin(), known.end(),
                   [&](size_t a, size_t b) { return distance(a) < distance(b); });
  double exponent = cost_exponent;
  if (known.size() > 1 && h[known[0]] != h[known[1]] && cost_exponent > 0) {
    const double measured =
        std::log(*seconds[known[1]] / *seconds[known[0]]) / std::log(h[known[0]] / h[known[1]]);
    if (std::isfinite(measured))
      exponent = std::clamp(measured, 0.5 * cost_exponent, 2 * cost_exponent);
  }
  return *seconds[known[0]] * std::pow(h[known[0]] / h[level], exponent);
}

std::optional<size_t> Track::next() const {
  const auto open = std::find(closed.begin(), closed.end(), false);
  if (open == closed.end()) return {};
  return static_cast<size_t>(open - closed.begin());
}

std::optional<std::pair<size_t, size_t>> next_level(
    std::vector<Track>& tracks, double left, const std::function<void(size_t, size_t)>& cut) {
  std::optional<std::pair<size_t, size_t>> best;
  double shortest = 0;
  for (size_t t = 0; t < tracks.size(); ++t) {
    const std::optional<size_t> level = tracks[t].next();
    if (!level) continue;
    const double seconds = tracks[t].predicted(*level);
    if (seconds > left) {
      // Finer levels take longer still.
      for (size_t i = *level; i < tracks[t].h.size(); ++i) {
        if (tracks[t].closed[i]) continue;
        tracks[t].closed[i] = true;
        cut(t, i);
      }
      continue;
    }
    const auto measured = static_cast<size_t>(
        std::count_if(tracks[t].seconds.begin(), tracks[t].seconds.end(),
                      [](const std::optional<double>& s) { return s.has_value(); }));
    const double beyond = measured < kEnoughLevels ? 0 : double(measured - kEnoughLevels + 1);
    const double claim = seconds * tracks[t].weight * std::exp2(beyond);
    if (best && claim >= shortest) continue;
    best = {t, *level};
    shortest = claim;
  }
  return best;
}

}  // namespace flexmorph::cases
