#include "cases/accuracy/study.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flexmorph::cases {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

/// Computes the errors of the levels of a series against the limit of the group. Errors of levels
/// that were cut by the budget are predicted by the order of convergence.
void find_errors(const AccuracyStudy& study, RefinementSeries& series, size_t q) {
  const RefinementSeries* leader = leader_of(study, series.parameter->group, series.part);
  if (!leader || !std::isfinite(leader->limits[q].value)) return;
  const ExtrapolatedLimit& limit = leader->limits[q];
  const auto error_of = [&](const LevelRun& run) {
    return std::abs(run.values[q] - limit.value) / study.estimates[q].scale;
  };
  const LevelRun* finest = nullptr;
  for (const LevelRun& run : series.levels)
    if (run.measured()) finest = &run;
  const bool extrapolates =
      finest && &series == leader && limit.converged && std::isfinite(limit.order);
  double largest = 0;
  for (size_t i = series.levels.size(); i-- > 0;) {
    LevelRun& run = series.levels[i];
    double error = kUndefined;
    if (run.measured())
      error = error_of(run);
    else if (run.status == "cut" && extrapolates)
      error = error_of(*finest) * std::pow(run.level.h / finest->level.h, limit.order);
    if (!std::isfinite(error)) continue;
    // If the values cross the limit, the error of a coarse level may be small by chance. It is set
    // to the largest error of the finer levels.
    largest = std::max(largest, error);
    run.errors[q] = series.parameter->has_limit ? largest : error;
  }
}

void find_limits(AccuracyStudy& study, RefinementSeries& series) {
  series.limits.assign(study.interests.size(), {});
  for (LevelRun& run : series.levels) run.errors.assign(study.interests.size(), kUndefined);
  for (size_t q = 0; q < study.interests.size(); ++q) {
    ExtrapolatedLimit& limit = series.limits[q];
    limit.value = limit.order = limit.uncertainty = kUndefined;
    if (study.parts[q] != series.part || !series.parameter->has_limit) continue;
    std::vector<LevelValue> values;
    for (const LevelRun& run : series.levels)
      if (run.measured()) values.push_back({run.level.h, run.values[q]});
    limit =
        limit_of(values, series.parameter->approach, series.theories[q], study.estimates[q].scale);
  }
}

/// Adds the differences between the limits of all groups and the value of the case.
void add_limits(const AccuracyStudy& study, size_t q, Estimate& out) {
  out.value = out.own;
  for (const RefinementSeries& series : study.series) {
    if (!series.leads() || series.part != study.parts[q]) continue;
    const ExtrapolatedLimit& limit = series.limits[q];
    const std::optional<Theory>& theory = series.theories[q];
    if (theory && theory->has_no_limit()) out.has_limit = false;
    if (!limit.bounded()) {
      out.unbounded += (out.unbounded.empty() ? "" : ", ") + series.parameter->name;
      out.uncertainty = std::numeric_limits<double>::infinity();
      continue;
    }
    out.value += limit.value - out.own;
    out.uncertainty += limit.uncertainty / out.scale;
  }
}

}  // namespace

size_t RefinementSeries::count(const std::string& status) const {
  return static_cast<size_t>(std::ranges::count(levels, status, &LevelRun::status));
}

double RefinementSeries::seconds(size_t level) const {
  if (levels[level].measured()) return levels[level].seconds_cpu;
  const auto h = [&](size_t i) { return levels[i].level.h; };
  const double guessed = cost_factor * parameter->cost_exponent;
  std::vector<size_t> known;
  for (size_t i = 0; i < levels.size(); ++i)
    if (levels[i].measured()) known.push_back(i);
  if (known.empty()) return first_guess * std::pow(h(level), -guessed);
  const auto distance = [&](size_t i) { return std::abs(std::log(h(i) / h(level))); };
  std::stable_sort(known.begin(), known.end(),
                   [&](size_t a, size_t b) { return distance(a) < distance(b); });
  const double nearest = levels[known[0]].seconds_cpu;
  double exponent = guessed;
  if (known.size() > 1 && h(known[0]) != h(known[1]) && guessed > 0) {
    const double measured =
        std::log(levels[known[1]].seconds_cpu / nearest) / std::log(h(known[0]) / h(known[1]));
    if (std::isfinite(measured)) exponent = std::clamp(measured, 0.5 * guessed, 2 * guessed);
  }
  return nearest * std::pow(h(known[0]) / h(level), exponent);
}

const RefinementSeries* leader_of(const AccuracyStudy& study, const std::string& group, Part part) {
  const auto at =
      std::find_if(study.series.begin(), study.series.end(), [&](const RefinementSeries& s) {
        return s.leads() && s.parameter->group == group && s.part == part;
      });
  return at == study.series.end() ? nullptr : &*at;
}

std::optional<std::pair<size_t, size_t>> next_level(std::vector<RefinementSeries>& all,
                                                    double left) {
  std::optional<std::pair<size_t, size_t>> best;
  double shortest = 0;
  for (size_t s = 0; s < all.size(); ++s) {
    std::vector<LevelRun>& levels = all[s].levels;
    const auto open = std::ranges::find(levels, std::string("open"), &LevelRun::status);
    if (open == levels.end()) continue;
    const auto level = static_cast<size_t>(open - levels.begin());
    const double seconds = all[s].seconds(level);
    if (seconds > left) {
      for (auto at = open; at != levels.end(); ++at)
        if (at->status == "open") at->status = "cut";
      continue;
    }
    const size_t measured = all[s].count("measured");
    const double beyond =
        measured < kEnoughLevels ? 0 : static_cast<double>(measured - kEnoughLevels + 1);
    const double claim = seconds * (all[s].leads() ? 1 : 4) * std::exp2(beyond);
    if (best && claim >= shortest) continue;
    best = {s, level};
    shortest = claim;
  }
  return best;
}

void evaluate(AccuracyStudy& study) {
  study.estimates.assign(study.interests.size(), {});
  for (size_t q = 0; q < study.interests.size(); ++q) {
    Estimate& estimate = study.estimates[q];
    estimate.own = study.own.at(study.parts[q]).values[q];
    estimate.scale = study.interests[q].scale.value_or(std::abs(estimate.own));
    if (!(estimate.scale > 0))
      throw Error::input("accuracy: " + study.interests[q].words() +
                         " is 0, so relative errors need a `scale`");
  }
  for (RefinementSeries& series : study.series) find_limits(study, series);
  for (RefinementSeries& series : study.series)
    for (size_t q = 0; q < study.parts.size(); ++q)
      if (study.parts[q] == series.part) find_errors(study, series, q);
  for (size_t q = 0; q < study.parts.size(); ++q) add_limits(study, q, study.estimates[q]);
}

}  // namespace flexmorph::cases
