#include "cases/accuracy/study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string percent(double share) { return io::to_text(100 * share, 2) + " %"; }

/// The ladder that has the limit of a group in a part; null where there is none.
const Ladder* leader_of(const AccuracyStudy& study, const std::string& group, Part part) {
  for (const Ladder& ladder : study.ladders)
    if (ladder.leads() && ladder.knob->group == group && ladder.part == part) return &ladder;
  return nullptr;
}

/// Errors of the measured rungs against the limit of their group, and of those cut by the order.
void find_errors(const AccuracyStudy& study, Ladder& ladder, size_t q) {
  const Ladder* leader = leader_of(study, ladder.knob->group, ladder.part);
  if (!leader) return;
  const Limit& limit = leader->limits[q];
  if (!std::isfinite(limit.value)) return;
  const double scale = study.truths[q].scale;
  const Rung* finest = nullptr;
  for (Rung& rung : ladder.rungs)
    if (rung.measured()) {
      rung.errors[q] = std::abs(rung.values[q] - limit.value) / scale;
      finest = &rung;
    }
  if (&ladder != leader || !limit.converged || !std::isfinite(limit.order) || !finest) return;
  for (Rung& rung : ladder.rungs)
    if (rung.status == "cut")
      rung.errors[q] = finest->errors[q] * std::pow(rung.level.h / finest->level.h, limit.order);
}

/// CPU seconds of levels that were cut, as Track::predicted().
void predict_costs(Ladder& ladder) {
  Track track;
  track.cost_exponent = ladder.knob->cost_exponent;
  for (const Rung& rung : ladder.rungs) {
    track.h.push_back(rung.level.h);
    track.seconds.push_back(rung.measured() ? std::optional(rung.seconds_cpu) : std::nullopt);
  }
  for (size_t i = 0; i < ladder.rungs.size(); ++i)
    if (ladder.rungs[i].status == "cut") ladder.rungs[i].predicted_cpu = track.predicted(i);
}

Truth truth_of(const AccuracyStudy& study, size_t q) {
  Truth out = study.truths[q];
  out.value = out.own;
  out.uncertainty = 0;
  for (const Ladder& ladder : study.ladders) {
    if (!ladder.leads() || ladder.part != study.parts[q]) continue;
    const Limit& limit = ladder.limits[q];
    const std::optional<Theory>& theory = ladder.theories[q];
    if (theory && theory->has_no_limit()) out.has_limit = false;
    if (!limit.bounded()) {
      out.unbounded += (out.unbounded.empty() ? "" : ", ") + ladder.knob->name;
      out.uncertainty = std::numeric_limits<double>::infinity();
      continue;
    }
    out.value += limit.value - out.own;
    out.uncertainty += limit.uncertainty / out.scale;
  }
  return out;
}

/// The same level of a knob in the other part, or null.
const Rung* same_level(const AccuracyStudy& study, const Ladder& ladder, const Rung& rung,
                       Part part) {
  for (const Ladder& other : study.ladders)
    if (other.knob == ladder.knob && other.part == part)
      for (const Rung& each : other.rungs)
        if (each.level.overrides == rung.level.overrides) return &each;
  return nullptr;
}

/// Is there a ladder of this group in the part?
bool touches(const AccuracyStudy& study, const std::string& group, Part part) {
  return leader_of(study, group, part) != nullptr;
}

/// May a rung be recommended by its error in this quantity?
bool is_sound(const AccuracyStudy& study, const Ladder& ladder, const Rung& rung, size_t q,
              double promise) {
  const Ladder* leader = leader_of(study, ladder.knob->group, ladder.part);
  if (!leader || !ladder.knob->is_setting) return false;
  const Limit& limit = leader->limits[q];
  if (limit.converged) return rung.measured() || rung.status == "cut";
  if (!limit.bounded() || !rung.measured()) return false;
  // Not converged: the level that stands for the limit; others by their distance from it, where
  // that is known far better than is promised.
  if (&ladder == leader && rung.errors[q] == 0) return true;
  return kClearance * limit.uncertainty / study.truths[q].scale <= promise;
}

/// The largest error of a level and all finer ones: where values cross their limit, a coarse level
/// is not better than the next.
void cover(Ladder& ladder, size_t q) {
  if (!ladder.knob->is_ladder) return;
  double largest = 0;
  for (size_t i = ladder.rungs.size(); i-- > 0;) {
    double& error = ladder.rungs[i].errors[q];
    if (!std::isfinite(error)) continue;
    largest = error = std::max(error, largest);
  }
}

Candidate candidate_of(const AccuracyStudy& study, const Ladder& ladder, const Rung& rung,
                       double promise, const std::vector<bool>& covers) {
  Candidate out{ladder.knob->name + " " + rung.level.name, rung.level.overrides, {}, {}};
  for (size_t q = 0; q < study.interests.size(); ++q) {
    const Part part = study.parts[q];
    if (!covers[q] || !touches(study, ladder.knob->group, part)) {
      out.errors.push_back(0);
      continue;
    }
    const Rung* own = part == ladder.part ? &rung : same_level(study, ladder, rung, part);
    const auto home =
        std::find_if(study.ladders.begin(), study.ladders.end(),
                     [&](const Ladder& l) { return l.knob == ladder.knob && l.part == part; });
    const bool sound =
        own && home != study.ladders.end() && is_sound(study, *home, *own, q, promise);
    out.errors.push_back(sound ? own->errors[q] : kNone);
  }
  for (const auto& [part, base] : study.own) {
    if (!touches(study, ladder.knob->group, part)) {
      out.costs.push_back(1);
      continue;
    }
    const Rung* own = part == ladder.part ? &rung : same_level(study, ladder, rung, part);
    const double seconds = !own ? kNone : own->measured() ? own->seconds_cpu : own->predicted_cpu;
    out.costs.push_back(seconds / base.seconds_cpu);
  }
  return out;
}

/// Quantities that a promise is not about, and why.
std::string left_out(const AccuracyStudy& study, const Recommendation& r) {
  std::string out;
  for (size_t q = 0; q < r.covers.size(); ++q) {
    if (r.covers[q]) continue;
    const Truth& t = study.truths[q];
    out += (out.empty() ? "" : ", ") + study.interests[q].words() +
           (!t.has_limit           ? ": it has no limit"
            : !t.unbounded.empty() ? ": nothing bounds the error of " + t.unbounded
                                   : ": its limit is known to " + percent(t.uncertainty) + " only");
  }
  return out;
}

}  // namespace

size_t Ladder::count(const std::string& status) const {
  return static_cast<size_t>(
      std::count_if(rungs.begin(), rungs.end(), [&](const Rung& r) { return r.status == status; }));
}

void evaluate(AccuracyStudy& study, const std::vector<std::optional<double>>& references) {
  const size_t n = study.interests.size();
  study.truths.assign(n, {});
  for (size_t q = 0; q < n; ++q) {
    Truth& truth = study.truths[q];
    truth.own = study.own.at(study.parts[q]).values[q];
    truth.scale = study.interests[q].scale.value_or(std::abs(truth.own));
    truth.reference = references[q];
    if (!(truth.scale > 0))
      throw Error::input("accuracy: " + study.interests[q].words() +
                         " is 0: its errors need a `scale`");
  }
  for (Ladder& ladder : study.ladders) {
    ladder.limits.assign(n, {});
    for (Rung& rung : ladder.rungs) rung.errors.assign(n, kNone);
    for (size_t q = 0; q < n; ++q) {
      Limit& limit = ladder.limits[q];
      limit.value = limit.order = limit.uncertainty = kNone;
      if (study.parts[q] != ladder.part || !ladder.knob->is_ladder) continue;
      std::vector<LevelValue> values;
      for (const Rung& rung : ladder.rungs)
        if (rung.measured()) values.push_back({rung.level.h, rung.values[q]});
      limit = limit_of(values, ladder.knob->approach, ladder.theories[q], study.truths[q].scale);
    }
    predict_costs(ladder);
  }
  for (Ladder& ladder : study.ladders)
    for (size_t q = 0; q < n; ++q)
      if (study.parts[q] == ladder.part) {
        find_errors(study, ladder, q);
        cover(ladder, q);
      }
  for (size_t q = 0; q < n; ++q) study.truths[q] = truth_of(study, q);
}

std::vector<Group> groups_of(const AccuracyStudy& study, double promise) {
  std::vector<Group> out;
  const std::vector<bool> covers = covered(study, promise);
  for (const Ladder& ladder : study.ladders) {
    bool matters = false;
    for (size_t q = 0; q < covers.size(); ++q)
      matters = matters || (covers[q] && touches(study, ladder.knob->group, study.parts[q]));
    if (!matters) continue;
    auto at = std::find_if(out.begin(), out.end(),
                           [&](const Group& g) { return g.name == ladder.knob->group; });
    if (at == out.end()) at = out.insert(at, Group{ladder.knob->group, {}});
    for (const Rung& rung : ladder.rungs) {
      if (!rung.measured() && rung.status != "cut") continue;
      Candidate candidate = candidate_of(study, ladder, rung, promise, covers);
      const bool known =
          std::any_of(at->candidates.begin(), at->candidates.end(),
                      [&](const Candidate& c) { return c.overrides == candidate.overrides; });
      if (!known) at->candidates.push_back(std::move(candidate));
    }
  }
  return out;
}

std::vector<bool> covered(const AccuracyStudy& study, double promise) {
  std::vector<bool> out;
  for (const Truth& truth : study.truths)
    out.push_back(truth.has_limit && truth.uncertainty <= promise);
  return out;
}

Recommendation recommend(const AccuracyStudy& study, double promise, double share) {
  Recommendation r;
  r.promise = promise;
  r.covers = covered(study, promise);
  std::vector<double> costs, uncertainties;
  for (const auto& [part, rung] : study.own) costs.push_back(rung.seconds_cpu);
  for (size_t q = 0; q < study.truths.size(); ++q)
    uncertainties.push_back(r.covers[q] ? study.truths[q].uncertainty : 0);
  if (std::find(r.covers.begin(), r.covers.end(), true) == r.covers.end()) {
    r.sentence = left_out(study, r);
    return r;
  }
  const std::vector<Group> groups = groups_of(study, promise);
  r.choice = cheapest(groups, costs, uncertainties, share * promise);
  if (!r.choice) {
    r.sentence = "no setting among those measured or predicted reaches it";
    return r;
  }
  for (size_t g = 0; g < groups.size(); ++g) {
    const Candidate& picked = groups[g].candidates[r.choice->picked[g]];
    r.names.push_back(picked.name);
    r.overrides.insert(r.overrides.end(), picked.overrides.begin(), picked.overrides.end());
  }
  return r;
}

void judge(Recommendation& r, const AccuracyStudy& study, const std::vector<double>& values,
           double seconds_cpu) {
  r.verified = true;
  r.seconds_cpu = seconds_cpu;
  r.sentence.clear();
  for (size_t q = 0; q < values.size(); ++q) {
    const Truth& truth = study.truths[q];
    r.found.push_back(std::abs(values[q] - truth.value) / truth.scale);
    if (!r.covers[q] || r.found[q] <= kPromiseFactor * r.promise) continue;  // NaN is not
    r.withdrawn = true;
    r.sentence += (r.sentence.empty() ? "withdrawn: " : "; ") + study.interests[q].words() +
                  " is off by " + percent(r.found[q]) + " where " + percent(r.promise) +
                  " was promised, so the knobs do not add up";
  }
  const std::string without = left_out(study, r);
  if (!r.withdrawn) r.sentence = "kept" + (without.empty() ? "" : "; not of " + without);
}

}  // namespace flexmorph::cases
