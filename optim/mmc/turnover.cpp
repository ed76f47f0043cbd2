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
                   double min_half_length, size_t images)
    : tdf_(grid, tdf),
      shaped_(ersatz.shaped_nodes()),
      min_half_length_(min_half_length),
      images_(images) {}

/// In the order of Design: images after all that they are images of.
std::vector<Component> Turnover::listed(const std::vector<Group>& groups) const {
  std::vector<Component> out;
  for (size_t k = 0; k < images_; ++k)
    for (const Group& group : groups) out.push_back(group[k]);
  return out;
}

bool Turnover::outside(const Group& group) {
  tdf_.evaluate(group);
  const std::vector<double> influence = tdf_.influence(shaped_);
  return std::all_of(influence.begin(), influence.end(), [](double i) { return i <= kTrace; });
}

/// Are all images of a component without a trace, also when all are gone? (On the line of symmetry
/// they hide each other.)
/// @param influence  of listed(groups_)
bool Turnover::hidden(size_t c, const std::vector<double>& influence) {
  for (size_t k = 0; k < images_; ++k)
    if (influence[k * groups_.size() + c] > kTrace) return false;
  if (images_ == 1) return true;
  const VectorXd before = tdf_.density();
  std::vector<Group> others = groups_;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(c));
  tdf_.evaluate(listed(others));
  return (tdf_.density() - before).cwiseAbs().maxCoeff() <= kTrace;
}

/// Takes out one after the other: two that hide each other must not both go.
void Turnover::drop(std::vector<int>& places, const std::vector<bool>& suspects) {
  for (bool found = true; found && groups_.size() > 1;) {
    found = false;
    tdf_.evaluate(listed(groups_));
    const std::vector<double> influence = tdf_.influence(shaped_);
    for (size_t c = 0; c < groups_.size() && !found; ++c) {
      if (!suspects[static_cast<size_t>(places[c])] || !hidden(c, influence)) continue;
      const auto kind =
          outside(groups_[c]) ? ComponentEvent::Kind::outside : ComponentEvent::Kind::hidden;
      groups_.erase(groups_.begin() + static_cast<std::ptrdiff_t>(c));
      events_.push_back({kind, places[c], static_cast<int>(groups_.size() * images_)});
      places.erase(places.begin() + static_cast<std::ptrdiff_t>(c));
      found = true;
    }
  }
}

/// Splits the longest components until there are `count` again, images not counted.
void Turnover::refill(size_t count) {
  const double thinnest = tdf_.settings().min_half_thickness;
  while (min_half_length_ > 0 && groups_.size() < count) {
    const auto longest =
        std::max_element(groups_.begin(), groups_.end(), [](const Group& a, const Group& b) {
          return a.front().half_length < b.front().half_length;
        });
    Group others;
    Group halved;
    for (const Component& c : *longest) {
      const std::vector<Component> halves = split(c, thinnest);
      halved.push_back(halves[0]);
      others.push_back(halves[1]);
    }
    if (halved.front().half_length < min_half_length_) return;
    const int place = static_cast<int>(longest - groups_.begin());
    *longest = halved;
    groups_.push_back(others);
    events_.push_back(
        {ComponentEvent::Kind::split, place, static_cast<int>(groups_.size() * images_)});
  }
}

bool Turnover::look(const std::vector<Component>& components) {
  events_.clear();
  next_ = components;
  tdf_.evaluate(components);
  const std::vector<double> influence = tdf_.influence(shaped_);
  const size_t n = components.size() / images_;
  std::vector<bool> dead(n, true);
  for (size_t c = 0; c < components.size(); ++c)
    if (influence[c] > kTrace) dead[c % n] = false;
  const bool comparable = dead_.size() == dead.size();
  dead_.swap(dead);
  if (!comparable) return false;
  std::vector<bool> suspects(n);
  for (size_t c = 0; c < n; ++c) suspects[c] = dead[c] && dead_[c];
  if (std::none_of(suspects.begin(), suspects.end(), [](bool s) { return s; })) return false;
  groups_.assign(n, {});
  for (size_t c = 0; c < components.size(); ++c) groups_[c % n].push_back(components[c]);
  std::vector<int> places(n);
  std::iota(places.begin(), places.end(), 0);
  drop(places, suspects);
  if (events_.empty()) return false;
  refill(n);
  next_ = listed(groups_);
  dead_.clear();
  return true;
}

}  // namespace flexmorph::mmc
