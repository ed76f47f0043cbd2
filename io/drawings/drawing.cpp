#include "io/drawings/drawing.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "geometry/components/outline.h"
#include "geometry/parts/segment.h"
#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::io {
namespace drawing {

Curve line(const Vec2& from, const Vec2& to) {
  // At t = 1 the sum would have round-off; the ends must be exact.
  return {[from, to](double t) { return t == 1 ? to : Vec2(from + t * (to - from)); }, true};
}

Curve arc(const Vec2& center, const Vec2& major, const Vec2& minor, double from, double to) {
  return {[=](double t) -> Vec2 {
            const double angle = from + t * (to - from);
            return center + std::cos(angle) * major + std::sin(angle) * minor;
          },
          false};
}

void Ignored::add(const std::string& one, const std::string& many, const std::string& location) {
  auto kind =
      std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& k) { return k.one == one; });
  if (kind == kinds_.end()) kind = kinds_.insert(kind, {one, many, location, 0});
  ++kind->count;
}

std::vector<std::string> Ignored::notes() const {
  std::vector<std::string> out;
  for (const Kind& kind : kinds_) {
    const bool one = kind.count == 1;
    const std::string at = kind.location.empty() ? "" : one ? ", at " : ", the first one at ";
    out.push_back(to_text(kind.count) + " " + (one ? kind.one + " is" : kind.many + " are") +
                  " ignored" + at + kind.location);
  }
  return out;
}

}  // namespace drawing

namespace {

using drawing::Curve;
using drawing::Drawing;
using drawing::Path;
using Ring = std::vector<Vec2>;

std::string words(const Vec2& p) {
  return formatted("(%s, %s)", to_text(p.x(), 6).c_str(), to_text(p.y(), 6).c_str());
}

/// Returns the larger side of the bounding box of points on all curves.
double size_of(const Drawing& d) {
  constexpr int kPoints = 16;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec2 lower(kInfinity, kInfinity), upper(-kInfinity, -kInfinity);
  for (const Path& path : d.paths)
    for (const Curve& c : path.curves)
      for (int k = 0; k <= kPoints; ++k) {
        const Vec2 p = c.at(k / double(kPoints));
        if (!(p.cwiseAbs().maxCoeff() < 1e30))
          throw Error::input("a coordinate is not a finite number below 1e30");
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
      }
  return (upper - lower).maxCoeff();
}

/// Appends points of a curve except its last one, so many that the sides are within the tolerance.
/// The test uses three points between the ends of each side.
void flatten(const Curve& curve, double tolerance, Ring& out) {
  constexpr int kMinPoints = 8, kMaxPoints = 1 << 14;
  int n = curve.straight ? 1 : kMinPoints;
  for (bool fine = curve.straight; !fine && n < kMaxPoints;) {
    double off = 0;
    for (int k = 0; k < n; ++k) {
      const Vec2 a = curve.at(k / double(n)), b = curve.at((k + 1) / double(n));
      for (const double share : {0.25, 0.5, 0.75}) {
        const Vec2 to = curve.at((k + share) / n) - a, side = b - a;
        const double t =
            side.squaredNorm() > 0 ? std::clamp(to.dot(side) / side.squaredNorm(), 0.0, 1.0) : 0.0;
        off = std::max(off, (to - t * side).norm());
      }
    }
    fine = off <= tolerance;
    if (!fine) n *= 2;
  }
  for (int k = 0; k < n; ++k) out.push_back(curve.at(k / double(n)));
}

Path reversed(Path path) {
  std::reverse(path.curves.begin(), path.curves.end());
  for (Curve& c : path.curves) c.at = [at = std::move(c.at)](double t) { return at(1 - t); };
  return path;
}

/// Removes paths all of whose points are within a distance.
void drop_points(Drawing& d, double distance) {
  constexpr int kSamples = 8;
  std::erase_if(d.paths, [&](const Path& path) {
    const Vec2 begin = path.begin();
    for (const Curve& curve : path.curves)
      for (int k = 0; k <= kSamples; ++k)
        if (!((curve.at(k / double(kSamples)) - begin).cwiseAbs().maxCoeff() <= distance))
          return false;
    if (path.curves.size() == 1 && path.curves[0].straight)
      d.ignored.add("line of no length", "lines of no length", words(begin));
    else
      d.ignored.add("curve of no size", "curves of no size", words(begin));
    return true;
  });
}

void ignore_twin(Drawing& d, const Vec2& begin) {
  d.ignored.add("curve that is drawn twice", "curves that are drawn twice", words(begin));
}

/// Removes open paths that are drawn twice, in the same or in the opposite direction.
void drop_equal_paths(Drawing& d, std::vector<Path>& open, double near) {
  constexpr int kSamples = 4;  // points of each curve, beside its begin
  std::vector<Ring> points;
  for (const Path& path : open) {
    Ring& all = points.emplace_back(Ring{path.begin()});
    for (const Curve& curve : path.curves)
      for (int k = 1; k <= kSamples; ++k) all.push_back(curve.at(k / double(kSamples)));
  }
  const auto meet = [&](const Vec2& a, const Vec2& b) { return (a - b).norm() <= near; };
  const auto equal = [&](const Ring& a, const Ring& b) {
    return a.size() == b.size() && (std::equal(a.begin(), a.end(), b.begin(), meet) ||
                                    std::equal(a.begin(), a.end(), b.rbegin(), meet));
  };
  std::vector<Path> kept;
  std::vector<const Ring*> seen;
  for (size_t i = 0; i < open.size(); ++i) {
    if (std::any_of(seen.begin(), seen.end(),
                    [&](const Ring* r) { return equal(*r, points[i]); })) {
      ignore_twin(d, open[i].begin());
      continue;
    }
    seen.push_back(&points[i]);
    kept.push_back(std::move(open[i]));
  }
  open = std::move(kept);
}

/// Joins open paths end to end to closed paths.
void close_chains(Drawing& d, double near) {
  std::vector<Path> open;
  const auto meet = [&](const Vec2& a, const Vec2& b) { return (a - b).norm() <= near; };
  std::erase_if(d.paths, [&](Path& path) {
    if (path.closed || meet(path.begin(), path.end())) return false;
    open.push_back(std::move(path));
    return true;
  });
  constexpr size_t kMaxOpenCurves = 10'000;  // each is compared with all others
  if (open.size() > kMaxOpenCurves)
    throw Error::input("there are more than " + to_text(static_cast<long long>(kMaxOpenCurves)) +
                       " lines and arcs to be joined; draw the outlines as polylines");
  drop_equal_paths(d, open, near);
  while (!open.empty()) {
    Path chain = std::move(open.back());
    open.pop_back();
    while (!meet(chain.begin(), chain.end())) {
      const Vec2 end = chain.end();
      const auto joins = [&](const Path& p) { return meet(p.begin(), end) || meet(p.end(), end); };
      const auto next = std::find_if(open.begin(), open.end(), joins);
      if (next == open.end())
        throw Error::input("a curve is open: it ends at " + words(end) +
                           ", where no other curve begins; an outline is a closed curve");
      if (std::find_if(next + 1, open.end(), joins) != open.end())
        throw Error::input("more than two curves meet at " + words(end));
      Path piece = meet(next->begin(), end) ? std::move(*next) : reversed(std::move(*next));
      open.erase(next);
      for (Curve& c : piece.curves) chain.curves.push_back(std::move(c));
    }
    d.paths.push_back(std::move(chain));
  }
}

/// Points that are closer than this fraction of the tolerance are merged.
constexpr double kSamePoint = 1e-4;

Ring ring_of(const Path& path, double tolerance) {
  Ring all, ring;
  for (const Curve& c : path.curves) flatten(c, tolerance, all);
  all.push_back(path.end());
  const double same = kSamePoint * tolerance;
  for (const Vec2& p : all)
    if (ring.empty() || (p - ring.back()).norm() > same) ring.push_back(p);
  // The end of the last curve coincides with the start of the first one.
  if (ring.size() > 1 && (ring.back() - ring.front()).norm() <= tolerance) ring.pop_back();
  while (ring.size() > 1 && (ring.back() - ring.front()).norm() <= same) ring.pop_back();
  return ring;
}

/// Returns true if every point of a ring is within a distance of the other ring.
bool lies_on(const Ring& ring, const Ring& other, double near) {
  return std::all_of(ring.begin(), ring.end(), [&](const Vec2& p) {
    for (size_t k = 0; k < other.size(); ++k)
      if (distance(Segment{other[k], other[(k + 1) % other.size()]}, p) <= near) return true;
    return false;
  });
}

/// Removes rings that are drawn twice.
void drop_equal_rings(Drawing& d, std::vector<Ring>& rings, double tolerance) {
  const double near = 2 * tolerance;  // both rings are within the tolerance of their curves
  std::vector<Box> boxes;
  std::vector<size_t> order;
  for (const Ring& ring : rings) {
    order.push_back(order.size());
    boxes.push_back(bounds_of(ring));
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t i, size_t j) { return boxes[i].lower.x() < boxes[j].lower.x(); });
  const auto meet = [&](const Vec2& a, const Vec2& b) { return (a - b).norm() <= near; };
  const auto equal = [&](size_t i, size_t j) {
    const Ring &a = rings[i], &b = rings[j];
    if (!meet(boxes[i].lower, boxes[j].lower) || !meet(boxes[i].upper, boxes[j].upper))
      return false;
    if (a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), meet)) return true;
    return lies_on(a, b, near) && lies_on(b, a, near);
  };
  std::vector<bool> twice(rings.size(), false);
  for (size_t m = 0; m < order.size(); ++m)
    for (size_t n = m + 1; n < order.size(); ++n) {
      const size_t i = order[m], j = order[n];
      if (boxes[j].lower.x() - boxes[i].lower.x() > near) break;
      if (!twice[i] && !twice[j] && equal(i, j)) twice[std::max(i, j)] = true;
    }
  for (size_t i = rings.size(); i-- > 0;) {
    if (!twice[i]) continue;
    ignore_twin(d, rings[i].front());
    rings.erase(rings.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace

DrawnOutlines drawing::closed_rings(Drawing d, double unit) {
  drop_points(d, 0);
  const double tolerance = d.paths.empty() ? 0 : kDrawingTolerance * size_of(d);
  drop_points(d, tolerance);
  if (d.paths.empty()) {
    std::string why = "it contains no closed curve";
    for (const std::string& note : d.ignored.notes()) why += "; " + note;
    throw Error::input(why);
  }
  close_chains(d, tolerance);
  std::vector<Ring> rings;
  for (const Path& p : d.paths) {
    rings.push_back(ring_of(p, tolerance));
    if (rings.back().size() < 3)
      throw Error::input("the curve that begins at " + words(p.begin()) + " has no area");
  }
  drop_equal_rings(d, rings, tolerance);
  for (Ring& ring : rings)
    for (Vec2& v : ring) v *= unit;
  return {std::move(rings), d.ignored.notes()};
}

std::vector<std::string> layers_of_dxf(const std::string& path) {
  const std::string text = read_regular_file(path, "a drawing");
  try {
    return drawing::dxf_layers(text);
  } catch (const Error& error) {
    throw Error::input(path + ": " + error.what());
  }
}

DrawnOutlines read_drawing(const std::string& path, const DrawingSettings& settings) {
  std::string type = std::filesystem::path(path).extension().string();
  std::transform(type.begin(), type.end(), type.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (type != ".dxf" && type != ".svg")
    throw Error::input(path + ": a drawing is a .dxf or .svg file");
  const std::string text = read_regular_file(path, "a drawing");
  try {
    if (type == ".svg" && !settings.layers.empty())
      throw Error::input("layers are given, but only DXF files have layers");
    Drawing d = type == ".dxf" ? drawing::read_dxf(text, settings.layers) : drawing::read_svg(text);
    const std::optional<double> unit = settings.unit ? settings.unit : d.unit;
    if (!unit) throw Error::input("it contains no unit of length: " + settings.needs_unit);
    DrawnOutlines out = drawing::closed_rings(std::move(d), *unit);
    for (std::string& note : out.notes) note = path + ": " + note;
    return out;
  } catch (const Error& error) {
    throw Error::input(path + ": " + error.what());
  }
}

}  // namespace flexmorph::io
