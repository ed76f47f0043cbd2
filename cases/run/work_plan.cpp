#include "cases/run/work_plan.h"

#include <algorithm>
#include <cmath>

#include "cases/assembly/resource_estimate.h"

namespace flexmorph::cases {
namespace {

// Factors between an expected time and the ends of its range: of a phase of a kind that has not run
// on this machine, of a phase whose kind has run, and of a phase whose name has run.
constexpr double kUnmeasured = 1.7, kKindMeasured = 1.5, kMeasured = 1.2;
// Limits of the speed that other kinds of phases suggest.
constexpr double kSlowest = 2;
// Largest ratio of both ends of the expected end of the run while cycles are open.
constexpr double kWidest = 3;
// Part of a phase from which on the range of its duration is at most this factor to both sides of
// its middle [-].
constexpr double kHalf = 0.5, kHalfSpread = 1.1;
// A phase tells its own speed from this time and this fraction on [s, -].
constexpr double kOwnSpeedAfter = 0.5, kOwnSpeedFrom = 0.02;

}  // namespace

WorkPlan::WorkPlan(std::vector<PhaseCost> phases, std::vector<IterationCost> designs, int threads)
    : designs_(std::move(designs)), threads_(std::max(1, threads)) {
  for (PhaseCost& phase : phases) entries_.push_back({std::move(phase)});
}

bool WorkPlan::Entry::tells_its_speed(double now) const {
  return is_running() && now - begin > kOwnSpeedAfter && done > kOwnSpeedFrom * (done + units.most);
}

WorkPlan::Entry* WorkPlan::running(const std::string& name) {
  const auto found = std::ranges::find_if(
      entries_, [&](const Entry& e) { return e.is_running() && e.cost.name == name; });
  return found == entries_.end() ? nullptr : &*found;
}

void WorkPlan::begin(const std::string& name, double now) {
  const auto next = std::ranges::find_if(
      entries_, [&](const Entry& e) { return e.begin < 0 && !e.is_over() && e.cost.name == name; });
  if (next == entries_.end()) return;
  for (Entry& e : entries_) {
    if (&e == &*next) break;
    // Motions of one group may run at the same time.
    const bool beside = threads_ > 1 && e.cost.group > 0 && e.cost.group == next->cost.group;
    if (e.is_over() || (beside && !e.is_running())) continue;
    if (beside && e.units.most > 0) continue;
    if (e.begin < 0) e.begin = now;
    e.end = now;
  }
  next->begin = now;
}

void WorkPlan::advance(const std::string& name, double done, SecondsRange left, double now) {
  Entry* entry = running(name);
  if (!entry) {
    begin(name, now);
    entry = running(name);
  }
  if (!entry) return;
  if (entry->first_time < 0) {
    entry->first_time = now;
    entry->first_done = done;
  }
  entry->done = done;
  entry->units = left;
}

void WorkPlan::iterate(const std::string& body, const Iterations& now_at, double now) {
  if (!running("design")) iterations_.clear();
  iterations_[body] = now_at;
  double done = 0, left = 0;
  for (const IterationCost& design : designs_) {
    const auto found = iterations_.find(design.body);
    const double more = design.with_widths - design.plain;
    if (found == iterations_.end()) {  // a design that follows takes as many iterations
      left += (now_at.done + now_at.most_left) * design.plain +
              (now_at.done_with_widths + now_at.left_with_widths) * more;
      continue;
    }
    const Iterations& of = found->second;
    done += of.done * design.plain + of.done_with_widths * more;
    // Bodies of a shared budget iterate together, all others one after the other.
    if (std::abs(of.done - now_at.done) <= 1)
      left += of.most_left * design.plain + of.left_with_widths * more;
  }
  advance("design", done, {kExpectedPart * left, left}, now);
}

/// Returns the speed of the phases of the kind of an entry or, before one has run, the geometric
/// mean of the speeds of all kinds. Other phases that are running count by their completed units.
WorkPlan::Speed WorkPlan::speed_of(const Entry& entry, double now) const {
  std::map<std::string, SecondsRange> kinds;  // expected and true time of every kind
  bool named = false;
  for (const Entry& e : entries_) {
    if (&e == &entry || !(e.is_over() || e.tells_its_speed(now))) continue;
    // A running phase counts the less the less it has completed.
    const double part = e.is_over() ? 1 : e.completed(),
                 seconds = e.is_over() ? e.end - e.begin : e.at_own_speed(now);
    if (!(part * e.cost.seconds > 0) || !(seconds > 0)) continue;
    SecondsRange& of = kinds[e.cost.kind];
    of.least += part * e.cost.seconds;
    of.most += part * seconds;
    named = named || (e.is_over() && e.cost.name == entry.cost.name);
  }
  if (const auto own = kinds.find(entry.cost.kind); own != kinds.end())
    return {own->second.most / own->second.least, named ? kMeasured : kKindMeasured};
  double mean = 0;
  for (const auto& [kind, of] : kinds)
    mean += std::log(of.most / of.least) / static_cast<double>(kinds.size());
  return {std::clamp(std::exp(mean), 1 / kSlowest, kSlowest), kUnmeasured};
}

SecondsRange WorkPlan::left_of(const Entry& e, double now) const {
  if (e.is_over()) return {};
  const Speed speed = speed_of(e, now);
  const double expected = speed.ratio * e.cost.seconds;
  // Iterations that may end early are part of a measured ratio.
  const double early = e.cost.may_end_early && speed.spread > kMeasured ? kExpectedPart : 1;
  SecondsRange out{early * expected / speed.spread, expected * speed.spread};
  if (!e.is_running()) return out;
  const double elapsed = now - e.begin;
  out.least = std::max(0.0, out.least - elapsed);
  out.most = std::max(0.2 * out.most, out.most - elapsed);
  if (!e.tells_its_speed(now)) return out;
  // The remaining units may be slower or faster than those so far, the less the fewer they are. A
  // phase of the same kind that is over tells what a whole phase takes, and counts the more the
  // less is completed.
  const double done = e.completed(), each = e.at_own_speed(now) / (e.done + e.units.most),
               spread = 1 + 0.2 * (1 - done);
  const double own = speed.spread < kUnmeasured ? done : 1;
  out = {own * each * e.units.least / spread + (1 - own) * out.least,
         own * each * e.units.most * spread + (1 - own) * out.most};
  if (done < kHalf || e.cost.may_end_early) return out;
  const double middle = elapsed + std::sqrt(out.least * out.most);
  return {std::max(out.least, middle / kHalfSpread - elapsed),
          std::min(out.most, middle * kHalfSpread - elapsed)};
}

/// Returns the last cycle that certainly runs: the one that has begun, at least the first.
int WorkPlan::last_certain_cycle() const {
  int out = 1;
  for (const Entry& e : entries_)
    if (e.begin >= 0 && !(e.is_over() && e.end == e.begin)) out = std::max(out, e.cost.cycle);
  return out;
}

SecondsRange WorkPlan::left(double now) const {
  const int certain = last_certain_cycle();
  SecondsRange out;
  // Motions of a group share the threads.
  double group_least = 0, group_most = 0, longest_least = 0, longest_most = 0;
  for (const Entry& e : entries_) {
    const SecondsRange of = left_of(e, now);
    if (e.cost.group > 0) {
      group_least += of.least;
      group_most += of.most;
      longest_least = std::max(longest_least, of.least);
      longest_most = std::max(longest_most, of.most);
      continue;
    }
    // One further cycle is expected at most; more are rare.
    if (e.cost.cycle <= certain) out.least += of.least;
    if (e.cost.cycle <= certain + 1) out.most += of.most;
  }
  out.least += std::max(longest_least, group_least / threads_);
  out.most += std::max(longest_most, group_most / threads_);
  const double least_end = now + out.least, most_end = now + out.most;
  // Few runs take as long as all permitted cycles: all shipped cases need one cycle.
  if (most_end > kWidest * least_end) out.most = kWidest * least_end - now;
  return out;
}

double WorkPlan::completed(double now) const {
  const SecondsRange of = left(now);
  const double middle = 0.5 * (of.least + of.most);
  return now + middle > 0 ? now / (now + middle) : 0;
}

std::string left_text(const SecondsRange& left) {
  if (!(left.most > 0)) return "";
  const std::string least = duration_text(left.least), most = duration_text(left.most);
  if (least == most || left.most < 1.25 * left.least)
    return ", about " + duration_text(std::sqrt(left.least * left.most)) + " left";
  // "30 to 45 s" if both have the same unit.
  const size_t unit = least.rfind(' '), unit_of_most = most.rfind(' ');
  const bool same = unit != std::string::npos && unit_of_most != std::string::npos &&
                    least.substr(unit) == most.substr(unit_of_most);
  return ", " + (same ? least.substr(0, unit) : least) + " to " + most + " left";
}

}  // namespace flexmorph::cases
