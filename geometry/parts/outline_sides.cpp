#include "geometry/parts/outline_sides.h"

#include <algorithm>

#include "geometry/parts/segment.h"

namespace flexmorph {

OutlineSides::OutlineSides(std::span<const Region> regions, const Region& domain)
    : regions_(regions), domain_(rings_of(domain)) {
  for (const Vec2& p : domain.outer) size_ = std::max(size_, p.cwiseAbs().maxCoeff());
  for (const Region& r : regions) {
    add(r.outer);
    for (const auto& hole : r.holes) add(hole);
  }
  number();
}

const OutlineCorner* OutlineSides::corner(const Vec2& p) const {
  const auto found = corners_.find({p.x(), p.y()});
  return found == corners_.end() ? nullptr : &found->second;
}

bool OutlineSides::in_material(const Vec2& p) const {
  return std::any_of(regions_.begin(), regions_.end(),
                     [&](const Region& r) { return contains(r, p); });
}

bool OutlineSides::within(const Vec2& p) const {
  bool inside = false;
  for (const auto& ring : domain_)
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y()))
        inside = !inside;
    }
  return inside;
}

void OutlineSides::add(const std::vector<Vec2>& ring) {
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &p = ring[k], &q = ring[(k + 1) % ring.size()];
    if (p == q) continue;
    const bool border = on_border(p, q);
    OutlineCorner &at_p = corners_[{p.x(), p.y()}], &at_q = corners_[{q.x(), q.y()}];
    at_p.after = (q - p).normalized();
    at_p.border_after = border;
    at_q.before = at_p.after;
    at_q.border_before = border;
    ++at_p.visits;
    ends_.push_back({&at_p, &at_q, border});
  }
}

void OutlineSides::number() {
  for (auto& [at, corner] : corners_) {
    corner.number = points_.size();
    points_.emplace_back(at.first, at.second);
    corner.border = on_border(points_.back(), points_.back());
  }
  std::sort(ends_.begin(), ends_.end(), [](const Side& x, const Side& y) {
    return std::pair(x.from->number, x.to->number) < std::pair(y.from->number, y.to->number);
  });
  for (const Side& side : ends_) {
    sides_.emplace_back(side.from->number, side.to->number);
    borders_.push_back(side.border);
  }
}

bool OutlineSides::on_border(const Vec2& a, const Vec2& b) const {
  for (const auto& ring : domain_)
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 &c = ring[i], &d = ring[(i + 1) % ring.size()];
      if (near_line(a, c, d) && near_line(b, c, d)) return true;
    }
  return false;
}

bool OutlineSides::near_line(const Vec2& p, const Vec2& a, const Vec2& b) const {
  const double near = 1e-12 * size_, x = p.x();
  if (x < std::min(a.x(), b.x()) - near || x > std::max(a.x(), b.x()) + near) return false;
  return distance({a, b}, p) <= near;
}

}  // namespace flexmorph
