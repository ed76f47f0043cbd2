#include "optim/mmc/turnover.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flexmorph::mmc {
namespace {

/// A change of density no larger than the density of the void is no trace.
constexpr double kTrace = 1e-3;
/// How far the halves of a component reach over its middle, in parts of its half-length.
constexpr double kOverlap = 0.1;

}  // namespace

std::string to_string(ComponentEvent::Kind kind) {
  switch (kind) {
    case ComponentEvent::Kind::outside:
      return "dropped, outside";
    case ComponentEvent::Kind::hidden:
      return "dropped, hidden";
    case ComponentEvent::Kind::split:
      return "split";
    case ComponentEvent::Kind::restored:
      return "restored";
  }
  return {};
}

std::vector<Component> split(const Component& c, double min_half_thickness) {
  const Vec2 axis(std::cos(c.angle), std::sin(c.angle));
  const auto thickness = [&](double x) { return profile(c, x, min_half_thickness).g; };
  // From one tip over the middle.
  const double half = 0.5 * (1 + kOverlap) * c.half_length, shift = c.half_length - half;
  const double over = kOverlap * c.half_length;
  Component first = c, second = c;
  first.half_length = second.half_length = half;
  first.center -= shift * axis;
  first.c2 = thickness(over);
  first.c3 = thickness(-shift);
  second.center += shift * axis;
  second.c1 = thickness(-over);
  second.c3 = thickness(shift);
  return {first, second};
}

Turnover::Turnover(const Grid& grid, const TdfSettings& tdf, const Ersatz& ersatz,
                   double min_half_length)
    : tdf_(grid, tdf), shaped_(ersatz.shaped_nodes()), min_half_length_(min_half_length) {}

bool Turnover::outside(const Component& c) {
  tdf_.evaluate({&c, 1});
  return tdf_.influence(shaped_).front() <= kTrace;
}

/// Takes out one after the other: two that hide each other must not both go.
void Turnover::drop(std::vector<int>& places, const std::vector<bool>& suspects) {
  for (bool found = true; found && next_.size() > 1;) {
    found = false;
    tdf_.evaluate(next_);
    const std::vector<double> influence = tdf_.influence(shaped_);
    for (size_t c = 0; c < next_.size() && !found; ++c) {
      if (influence[c] > kTrace || !suspects[static_cast<size_t>(places[c])]) continue;
      const auto kind =
          outside(next_[c]) ? ComponentEvent::Kind::outside : ComponentEvent::Kind::hidden;
      events_.push_back({kind, places[c], static_cast<int>(next_.size()) - 1});
      next_.erase(next_.begin() + static_cast<std::ptrdiff_t>(c));
      places.erase(places.begin() + static_cast<std::ptrdiff_t>(c));
      found = true;
    }
  }
}

/// Splits the longest components until there are `count` again.
void Turnover::refill(int count) {
  const double thinnest = tdf_.settings().min_half_thickness;
  while (min_half_length_ > 0 && static_cast<int>(next_.size()) < count) {
    const auto longest = std::max_element(
        next_.begin(), next_.end(),
        [](const Component& a, const Component& b) { return a.half_length < b.half_length; });
    const std::vector<Component> halves = split(*longest, thinnest);
    if (halves.front().half_length < min_half_length_) return;
    const int place = static_cast<int>(longest - next_.begin());
    *longest = halves[0];
    next_.push_back(halves[1]);
    events_.push_back({ComponentEvent::Kind::split, place, static_cast<int>(next_.size())});
  }
}

bool Turnover::look(const std::vector<Component>& components) {
  events_.clear();
  next_ = components;
  tdf_.evaluate(components);
  const std::vector<double> influence = tdf_.influence(shaped_);
  std::vector<bool> dead(components.size());
  for (size_t c = 0; c < dead.size(); ++c) dead[c] = influence[c] <= kTrace;
  const bool comparable = dead_.size() == dead.size();
  dead_.swap(dead);
  if (!comparable) return false;
  std::vector<bool> suspects(dead.size());
  for (size_t c = 0; c < dead.size(); ++c) suspects[c] = dead[c] && dead_[c];
  if (std::none_of(suspects.begin(), suspects.end(), [](bool s) { return s; })) return false;
  std::vector<int> places(components.size());
  std::iota(places.begin(), places.end(), 0);
  drop(places, suspects);
  if (events_.empty()) return false;
  refill(static_cast<int>(components.size()));
  dead_.clear();
  return true;
}

}  // namespace flexmorph::mmc
