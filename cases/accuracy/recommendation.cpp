#include "cases/accuracy/recommendation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

std::string percent(double share) { return io::to_text(100 * share, 2) + " %"; }

bool all_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

double worst(const std::vector<double>& errors) {
  return errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
}

/// A depth-first search over the groups for the cheapest choice. Branches whose errors exceed the
/// target are pruned.
struct Search {
  const std::vector<Group>& groups;
  double target;
  LevelChoice now;
  std::optional<LevelChoice> best = {};

  void visit(const std::vector<double>& costs) {
    if (!std::ranges::all_of(now.errors, [&](double error) { return error <= target; })) return;
    const size_t depth = now.picked.size();
    if (depth == groups.size()) {
      now.cost = std::accumulate(costs.begin(), costs.end(), 0.0);
      if (!best || now.cost < best->cost ||
          (now.cost == best->cost && worst(now.errors) < worst(best->errors)))
        best = now;
      return;
    }
    for (size_t k = 0; k < groups[depth].candidates.size(); ++k) {
      const Candidate& candidate = groups[depth].candidates[k];
      if (!all_finite(candidate.errors) || !all_finite(candidate.costs)) continue;
      std::vector<double> next = costs;
      for (size_t p = 0; p < next.size(); ++p) next[p] *= candidate.costs[p];
      const std::vector<double> before = now.errors;
      for (size_t q = 0; q < before.size(); ++q) now.errors[q] += candidate.errors[q];
      now.picked.push_back(k);
      visit(next);
      now.picked.pop_back();
      now.errors = before;
    }
  }
};

/// Tells whether the error of a level in a quantity is reliable enough to recommend the level.
bool is_sound(const AccuracyStudy& study, const RefinementSeries& series, const LevelRun& run,
              size_t q, double target) {
  const RefinementSeries* leader = leader_of(study, series.parameter->group, series.part);
  if (!leader || !series.parameter->is_setting) return false;
  const ExtrapolatedLimit& limit = leader->limits[q];
  if (limit.converged) return run.measured() || run.status == "cut";
  if (!limit.bounded() || !run.measured()) return false;
  if (&series == leader && run.errors[q] == 0) return true;  // its value is taken as the limit
  return kClearance * limit.uncertainty / study.estimates[q].scale <= target;
}

/// Returns the series and the index of the level of a parameter with the given overrides in a
/// subproblem; a null series if there is no such level.
std::pair<const RefinementSeries*, size_t> level_in(const AccuracyStudy& study,
                                                    const Parameter* parameter,
                                                    const std::vector<std::string>& overrides,
                                                    Part part) {
  for (const RefinementSeries& series : study.series)
    for (size_t i = 0; i < series.levels.size(); ++i)
      if (series.parameter == parameter && series.part == part &&
          series.levels[i].level.overrides == overrides)
        return {&series, i};
  return {nullptr, 0};
}

Candidate candidate_of(const AccuracyStudy& study, const Parameter& parameter, const Level& level,
                       double target, const std::vector<bool>& covers) {
  Candidate out{parameter.name + " " + level.name, level.overrides, {}, {}};
  for (size_t q = 0; q < covers.size(); ++q) {
    const Part part = study.parts[q];
    double error = 0;
    if (covers[q] && leader_of(study, parameter.group, part)) {
      const auto [series, i] = level_in(study, &parameter, level.overrides, part);
      const bool sound = series && is_sound(study, *series, series->levels[i], q, target);
      error = sound ? series->levels[i].errors[q] : kUndefined;
    }
    out.errors.push_back(error);
  }
  for (const auto& [part, base] : study.own) {
    double cost = 1;
    if (leader_of(study, parameter.group, part)) {
      const auto [series, i] = level_in(study, &parameter, level.overrides, part);
      cost = series ? series->seconds(i) / base.seconds_cpu : kUndefined;
    }
    out.costs.push_back(cost);
  }
  return out;
}

std::vector<bool> covered(const AccuracyStudy& study, double target) {
  std::vector<bool> out;
  for (const Estimate& each : study.estimates)
    out.push_back(each.has_limit && each.uncertainty <= target);
  return out;
}

/// Returns a message on the quantities that a recommendation does not cover, with the reasons.
std::string left_out(const AccuracyStudy& study, const std::vector<bool>& covers) {
  std::string out;
  for (size_t q = 0; q < covers.size(); ++q) {
    if (covers[q]) continue;
    const Estimate& e = study.estimates[q];
    out += (out.empty() ? "" : ", ") + study.interests[q].words() +
           (!e.has_limit           ? ": it has no limit"
            : !e.unbounded.empty() ? ": there is no error bound for " + e.unbounded
                                   : ": the uncertainty of its limit is " + percent(e.uncertainty));
  }
  return out;
}

}  // namespace

std::optional<LevelChoice> cheapest(const std::vector<Group>& groups,
                                    std::span<const double> base_costs,
                                    std::span<const double> uncertainties, double target) {
  Search search{groups, target, {{}, {uncertainties.begin(), uncertainties.end()}, 0}};
  search.visit({base_costs.begin(), base_costs.end()});
  return search.best;
}

std::vector<Group> groups_of(const AccuracyStudy& study, double target) {
  std::vector<Group> out;
  const std::vector<bool> covers = covered(study, target);
  for (const RefinementSeries& series : study.series) {
    const std::string& name = series.parameter->group;
    bool matters = false;
    for (size_t q = 0; q < covers.size(); ++q)
      matters = matters || (covers[q] && leader_of(study, name, study.parts[q]));
    if (!matters) continue;
    auto at = std::find_if(out.begin(), out.end(), [&](const Group& g) { return g.name == name; });
    if (at == out.end()) at = out.insert(at, Group{name, {}});
    for (const LevelRun& run : series.levels) {
      const bool known =
          std::any_of(at->candidates.begin(), at->candidates.end(),
                      [&](const Candidate& c) { return c.overrides == run.level.overrides; });
      if (!known && (run.measured() || run.status == "cut"))
        at->candidates.push_back(candidate_of(study, *series.parameter, run.level, target, covers));
    }
  }
  return out;
}

Recommendation recommend(const AccuracyStudy& study, double target, double share) {
  Recommendation out;
  out.target = target;
  out.covers = covered(study, target);
  std::vector<double> costs, uncertainties;
  for (const auto& [part, run] : study.own) costs.push_back(run.seconds_cpu);
  for (size_t q = 0; q < out.covers.size(); ++q)
    uncertainties.push_back(out.covers[q] ? study.estimates[q].uncertainty : 0);
  if (std::find(out.covers.begin(), out.covers.end(), true) == out.covers.end()) {
    out.sentence = left_out(study, out.covers);
    return out;
  }
  const std::vector<Group> groups = groups_of(study, target);
  const auto choice = cheapest(groups, costs, uncertainties, share * target);
  if (!choice) {
    out.sentence = "no measured or predicted setting reaches the target error";
    return out;
  }
  out.error = worst(choice->errors);
  out.seconds = choice->cost;
  for (size_t g = 0; g < groups.size(); ++g) {
    const Candidate& picked = groups[g].candidates[choice->picked[g]];
    out.names.push_back(picked.name);
    out.overrides.insert(out.overrides.end(), picked.overrides.begin(), picked.overrides.end());
  }
  return out;
}

void verify(const AccuracyStudy& study, const std::vector<double>& values, double seconds_cpu,
            Recommendation& out) {
  out.verified = true;
  out.seconds_cpu = seconds_cpu;
  for (size_t q = 0; q < values.size(); ++q) {
    if (!out.covers[q]) continue;
    const Estimate& estimate = study.estimates[q];
    const double error = std::abs(values[q] - estimate.value) / estimate.scale;
    out.measured_error = std::isnan(error) ? error : std::max(out.measured_error, error);
    if (error <= kTargetFactor * out.target) continue;  // false for NaN
    out.sentence += std::string(out.withdrawn ? "; " : "withdrawn: ") + "the error of " +
                    study.interests[q].words() + " is " + percent(error) +
                    ", the target error is " + percent(out.target) +
                    "; the errors of the parameters do not add up";
    out.withdrawn = true;
  }
  const std::string without = left_out(study, out.covers);
  if (!out.withdrawn) out.sentence = "kept" + (without.empty() ? "" : "; not covered: " + without);
}

}  // namespace flexmorph::cases
