#include "cases/run/work_plan.h"

#include <algorithm>
#include <cmath>

#include "cases/assembly/resource_estimate.h"

namespace flexmorph::cases {
namespace {

// Factors between an expected time and the ends of its range: of a phase whose name has not run on
// this machine, before and after other phases have run, and of a phase whose name has run.
constexpr double kUnmeasured = 1.7, kOthersMeasured = 1.5, kMeasured = 1.2;
// Largest ratio of both ends of the expected end of the run while cycles are open.
constexpr double kWidest = 3;
// A phase tells its own speed from this time and this fraction on [s, -].
constexpr double kOwnSpeedAfter = 0.5, kOwnSpeedFrom = 0.02;

}  // namespace

WorkPlan::WorkPlan(std::vector<PhaseCost> phases, std::vector<IterationCost> designs, int threads)
    : designs_(std::move(designs)), threads_(std::max(1, threads)) {
  for (PhaseCost& phase : phases) entries_.push_back({std::move(phase)});
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
    const bool beside = e.cost.group > 0 && e.cost.group == next->cost.group;
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

/// Returns the speed of the phases with the name of `cost` or, before one has run, of all phases.
WorkPlan::Speed WorkPlan::speed_of(const PhaseCost& cost) const {
  double own = 0, own_expected = 0, all = 0, all_expected = 0;
  for (const Entry& e : entries_) {
    if (!e.is_over() || e.end - e.begin <= 0) continue;
    all += e.end - e.begin;
    all_expected += e.cost.seconds;
    if (e.cost.name != cost.name) continue;
    own += e.end - e.begin;
    own_expected += e.cost.seconds;
  }
  if (own > 0 && own_expected > 0) return {own / own_expected, kMeasured};
  if (all > kOwnSpeedAfter && all_expected > 0)
    return {std::clamp(all / all_expected, 0.2, 5.0), kOthersMeasured};
  return {1, kUnmeasured};
}

SecondsRange WorkPlan::left_of(const Entry& e, double now) const {
  if (e.is_over()) return {};
  const Speed speed = speed_of(e.cost);
  const double expected = speed.ratio * e.cost.seconds;
  // Iterations that may end early are part of a measured ratio.
  const double early = e.cost.may_end_early && speed.spread > kMeasured ? kExpectedPart : 1;
  SecondsRange out{early * expected / speed.spread, expected * speed.spread};
  if (!e.is_running()) return out;
  const double elapsed = now - e.begin, all = e.done + e.units.most;
  if (e.done > 0 && elapsed > kOwnSpeedAfter && e.done > kOwnSpeedFrom * all) {
    // The remaining units may be slower or faster than those so far, the less the fewer they are.
    const double each = elapsed / e.done, spread = 1 + 0.2 * e.units.most / all;
    return {each * e.units.least / spread, each * e.units.most * spread};
  }
  out.least = std::max(0.0, out.least - elapsed);
  out.most = std::max(0.2 * out.most, out.most - elapsed);
  return out;
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
