#include "optim/verification/loads.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flexmorph::verification {
namespace {

/// Returns the portion of a segment inside a box; nothing if it is a point or empty.
std::optional<Segment> clipped(const Segment& s, const Box& box) {
  const Vec2 along = s.b - s.a;
  double from = 0, to = 1;
  for (int c = 0; c < 2; ++c) {
    if (along[c] == 0) {
      if (s.a[c] < box.lower[c] || s.a[c] > box.upper[c]) return {};
      continue;
    }
    double enters = (box.lower[c] - s.a[c]) / along[c], leaves = (box.upper[c] - s.a[c]) / along[c];
    if (enters > leaves) std::swap(enters, leaves);
    from = std::max(from, enters);
    to = std::min(to, leaves);
  }
  const double shortest = 1e-6 * (box.upper - box.lower).norm() / along.norm();
  if (to - from <= shortest) return {};
  return Segment{from == 0 ? s.a : Vec2(s.a + from * along),
                 to == 1 ? s.b : Vec2(s.a + to * along)};
}

}  // namespace

Location point_location(const Vec2& point, const Region& border, double reach) {
  Location out;
  const Box box{point - Vec2::Constant(reach), point + Vec2::Constant(reach)};
  out.area = corners_of(box);
  double near = INFINITY;
  for (const std::vector<Vec2>& ring : rings_of(border))
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Segment side{ring[k], ring[(k + 1) % ring.size()]};
      near = std::min(near, distance(side, point));
      if (const auto part = clipped(side, box)) out.lines.push_back(*part);
    }
  // A point counts as a point of the border within half of the reach, because its position is only
  // given to a fraction of a cell.
  if (near > 0.5 * reach) out.lines.clear();
  return out;
}

Location box_location(const Box& box) {
  const Vec2 size = box.upper - box.lower;
  if (size.minCoeff() > 0) return {{}, corners_of(box)};
  return {{{box.lower, box.upper}}, {}};
}

Location border_location(const std::vector<Vec2>& ring) {
  Location out;
  for (std::size_t k = 0; k < ring.size(); ++k)
    out.lines.push_back({ring[k], ring[(k + 1) % ring.size()]});
  return out;
}

int Loads::add(Location location) {
  locations.push_back(std::move(location));
  return static_cast<int>(locations.size()) - 1;
}

}  // namespace flexmorph::verification
