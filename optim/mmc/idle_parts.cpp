#include "optim/mmc/idle_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace flexmorph::mmc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kIdleDensity = 0.2;
/// An end that is cut changes by half a cell or more.
constexpr double kLeastCut = 0.5;

/// Is there anything so idle under the component? If not, nothing of it is idle, whatever else is
/// there; and it is asked of one component, not of all.
bool may_be_idle(const Component& c, const UnderRepair& design) {
  const VectorXd own = fractions_of(design.problem(), {&c, 1});
  return (own.array() > 0 && design.density().array() <= kIdleDensity).any();
}

/// Has the area so little energy? Of nothing there is none.
bool idle(const VectorXd& area, const VectorXd& density) {
  return density.dot(area) <= kIdleDensity * area.sum();
}

/// A component from t1 to t2 of its axis, [-1, 1] is all of it: the same profile.
Component section(const Component& c, double t1, double t2, double min_half_thickness) {
  const auto half = [&](double t) { return profile(c, t * c.half_length, min_half_thickness).g; };
  const Vec2 axis(std::cos(c.angle), std::sin(c.angle));
  const double middle = 0.5 * (t1 + t2);
  Component out = c;
  out.center += middle * c.half_length * axis;
  out.half_length *= 0.5 * (t2 - t1);
  out.c1 = half(t1);
  out.c2 = half(t2);
  out.c3 = half(middle);
  return out;
}

/// What a cut may not make worse.
struct Standing {
  VectorXd fractions;
  double narrowest, merit;

  explicit Standing(UnderRepair& design) {
    design.count_islands();
    fractions = design.fractions(design.parts);
    narrowest = design.smallest(design.places());
    merit = design.merit(design.parts);
  }
};

/// The longest idle end that may go.
bool cut_stub(UnderRepair& design, size_t k, bool first, const Standing& before) {
  const double floor = design.problem().stages.back().min_half_thickness;
  const Component whole = design.parts[k];
  const auto part = [&](double from, double to) {  // of the component, from that end
    return first ? section(whole, 2 * from - 1, 2 * to - 1, floor)
                 : section(whole, 1 - 2 * to, 1 - 2 * from, floor);
  };
  std::vector<Component> shorter;  // ever more
  for (const double left : {0.8, 0.6, 0.4, 0.2}) {
    if (!may_be_idle(part(0, 1 - left), design)) break;
    design.parts[k] = part(1 - left, 1);
    const VectorXd lost = before.fractions - design.fractions(design.parts);
    if (lost.sum() < kLeastCut) continue;
    if (!idle(lost, design.density())) break;  // from the tip on
    shorter.push_back(design.parts[k]);
  }
  for (auto cut = shorter.rbegin(); cut != shorter.rend(); ++cut) {
    design.parts[k] = *cut;
    if (design.merit(design.parts, before.merit) == kInfinity ||
        design.smallest(design.places()) < before.narrowest)
      continue;
    // Where the end carried after all, what is left of the cut is bridged by cells only.
    design.look_at_energy();
    if (design.torn_gaps().empty()) return true;
    break;
  }
  design.parts[k] = whole;
  if (!shorter.empty()) design.look_at_energy();
  return false;
}

}  // namespace

int drop_idle(UnderRepair& design) {
  design.look_at_energy();
  design.count_islands();
  const VectorXd fractions = design.fractions(design.parts);
  std::vector<std::pair<double, size_t>> candidates;
  for (size_t k = 0; k < design.parts.size(); ++k) {
    const VectorXd own = fractions - design.fractions(design.less(k));
    if (idle(own, design.density())) candidates.emplace_back(design.density().dot(own), k);
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> gone(design.parts.size(), false);
  std::vector<Component> left = design.parts;
  double lowest = design.merit(left);
  int n = 0;
  for (const auto& [energy, k] : candidates) {
    if (!design.goes_on()) break;
    gone[k] = true;
    std::vector<Component> without;
    for (size_t i = 0; i < design.parts.size(); ++i)
      if (!gone[i]) without.push_back(design.parts[i]);
    const double now = design.merit(without, std::nextafter(lowest, kInfinity));
    gone[k] = now <= lowest;
    if (!gone[k]) continue;
    lowest = now;
    left = std::move(without);
    ++n;
  }
  design.parts = std::move(left);
  design.patch.assign(design.parts.size(), false);
  return n;
}

int cut_stubs(UnderRepair& design) {
  design.look_at_energy();
  Standing now(design);
  int n = 0;
  for (size_t k = 0; k < design.parts.size(); ++k)
    for (const bool first : {true, false}) {
      if (!design.goes_on()) return n;
      if (!cut_stub(design, k, first, now)) continue;
      now.fractions = design.fractions(design.parts);
      now.merit = design.merit(design.parts);
      ++n;
    }
  return n;
}

}  // namespace flexmorph::mmc
