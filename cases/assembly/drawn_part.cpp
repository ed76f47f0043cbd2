#include "cases/assembly/drawn_part.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "geometry/parts/part_mesh.h"
#include "geometry/text.h"
#include "io/drawings/drawing.h"
#include "io/drawings/step_reader.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using Ring = std::vector<Vec2>;

/// Fractions of the domain's size: the distance within which points are moved onto borders, this
/// distance for sides along borders, the permitted extension of an outline beyond the domain, and
/// the smallest permitted size of an outline.
constexpr double kRounding = 1e-9, kArcTolerance = 1e-5, kOverhang = 2e-3, kMinHoleArea = 0.05;

Region domain_of(const Scene& scene, const BodyDesign& design) {
  if (scene.domain && !scene.domain->shape.outer.empty()) return scene.domain->shape;
  const Grid& g = design.grid;
  return {corners_of({{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}}), {}};
}

/// Returns the layers of a drawing that can contain outlines, and appends notes about layers of
/// dimensions and texts, which are ignored.
std::vector<std::string> outline_layers(const std::string& path, std::vector<std::string>& notes) {
  std::vector<std::string> all = io::layers_of_dxf(path), out;
  const auto has = [&](const char* name) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  if (has("OUTLINE")) {
    out.emplace_back("OUTLINE");
    if (has("HOLES")) out.emplace_back("HOLES");
    return out;
  }
  for (const std::string& name : all) {
    if (io::is_annotation_layer(name))
      notes.push_back(path + ": the layer '" + name + "' of dimensions or texts is ignored");
    else if (name != "DOMAIN" && name != "SUPPORTS" && name != "LOADS")
      out.push_back(name);
  }
  return out;
}

double thickness_of(const Scene& scene, const BodyDesign& design) {
  return scene.domain ? scene.domain->thickness : scene.body(design.body).thickness;
}

io::DrawnOutlines read_rings(const std::string& path, double thickness) {
  std::string type = std::filesystem::path(path).extension().string();
  std::transform(type.begin(), type.end(), type.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (type == ".step" || type == ".stp") return {io::read_step_outline(path, thickness), {}};
  if (type != ".dxf") throw Error::input(path + ": a part is a .dxf, .step or .stp file");
  std::vector<std::string> notes;
  io::DrawingSettings settings;
  settings.needs_unit = "set $INSUNITS in the drawing";
  settings.layers = outline_layers(path, notes);
  try {
    io::DrawnOutlines out = io::read_drawing(path, settings);
    out.notes.insert(out.notes.begin(), notes.begin(), notes.end());
    return out;
  } catch (const Error& error) {
    if (settings.layers.empty()) throw;
    throw Error::input(std::string(error.what()) + " (read from the layers " +
                       joined(settings.layers) + ")");
  }
}

std::string box_text(const Box& box) {
  const auto point = [](const Vec2& p) {
    return "(" + io::to_text(p.x(), 6) + ", " + io::to_text(p.y(), 6) + ")";
  };
  return "from " + point(box.lower) + " to " + point(box.upper) + " m";
}

Box box_of(const std::vector<Ring>& rings) {
  Ring all;
  for (const Ring& ring : rings) all.insert(all.end(), ring.begin(), ring.end());
  return bounds_of(all);
}

/// Refuses outlines that extend beyond the domain or are far smaller than it, which usually have a
/// wrong unit.
void check_size(const std::vector<Ring>& rings, const Region& domain, const std::string& body) {
  const Box part = box_of(rings), box = bounds_of(domain.outer);
  const double size = (box.upper - box.lower).maxCoeff();
  const double beyond =
      std::max((box.lower - part.lower).maxCoeff(), (part.upper - box.upper).maxCoeff());
  const std::string found = "its outline extends " + box_text(part) + ", the design domain of '" +
                            body + "' extends " + box_text(box);
  if (beyond > kOverhang * size)
    throw Error::input(found +
                       "; a part lies within the domain, in the coordinates of the exported design "
                       "and in the unit of the file");
  if ((part.upper - part.lower).maxCoeff() < kMinHoleArea * size)
    throw Error::input(found + "; the outline is too small: check the unit of the file");
}

/// Moves points that nearly lie on a border onto the border: points that differ by rounding, and
/// sides that were drawn along the border.
class Snap {
 public:
  Snap(const Region& domain, const BodyDesign& design) {
    const Box box = bounds_of(domain.outer);
    size_ = (box.upper - box.lower).maxCoeff();
    std::vector<Ring> rings = rings_of(domain);
    rings.insert(rings.end(), design.solid.begin(), design.solid.end());
    rings.insert(rings.end(), design.empty.begin(), design.empty.end());
    for (const Ring& ring : rings)
      for (std::size_t k = 0; k < ring.size(); ++k)
        borders_.push_back({ring[k], ring[(k + 1) % ring.size()]});
  }

  /// Returns a ring with its points moved onto the borders, without points that then coincide.
  Ring operator()(const Ring& ring) const {
    const std::size_t n = ring.size();
    std::vector<bool> along(n, false);
    for (std::size_t k = 0; k < n; ++k)
      if (runs_along(ring[k], ring[(k + 1) % n])) along[k] = along[(k + 1) % n] = true;
    Ring out;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 at = nearest(ring[k], size_ * (along[k] ? kArcTolerance : kRounding));
      if (out.empty() || at != out.back()) out.push_back(at);
    }
    while (out.size() > 1 && out.back() == out.front()) out.pop_back();
    return out;
  }

 private:
  bool runs_along(const Vec2& a, const Vec2& b) const {
    const double near = kArcTolerance * size_;
    if ((b - a).norm() < 20 * near) return false;
    return std::any_of(borders_.begin(), borders_.end(), [&](const Segment& s) {
      return distance(s, a) < near && distance(s, b) < near;
    });
  }

  Vec2 nearest(const Vec2& p, double near) const {
    std::optional<Vec2> on_side;
    double least = near;
    for (const Segment& s : borders_) {
      if ((s.a - p).norm() < near) return s.a;
      const Vec2 side = s.b - s.a;
      const double t = side.dot(p - s.a) / side.squaredNorm();
      Vec2 at = s.a + t * side;
      // Coordinates on sides that are parallel to an axis are exact.
      if (side.x() == 0) at.x() = s.a.x();
      if (side.y() == 0) at.y() = s.a.y();
      if (t > 0 && t < 1 && (at - p).norm() < least) {
        least = (at - p).norm();
        on_side = at;
      }
    }
    return on_side.value_or(p);
  }

  double size_ = 0;
  std::vector<Segment> borders_;
};

std::string ring_text(const Ring& ring) {
  return "the closed curve that begins at (" + io::to_text(ring.front().x(), 6) + ", " +
         io::to_text(ring.front().y(), 6) + ") m";
}

bool are_apart(const Box& a, const Box& b) {
  return (a.upper.array() < b.lower.array()).any() || (b.upper.array() < a.lower.array()).any();
}

/// A ring of a drawing with the indices of the rings that enclose it.
struct Nested {
  Ring ring;
  Box box;
  double size = 0;  ///< Area [m²].
  std::vector<std::size_t> within;
};

/// Returns the rings of a drawing with the rings that enclose each of them.
/// @throws Error (input) for rings that cross themselves or each other
std::vector<Nested> nested(const std::vector<Ring>& rings) {
  std::vector<Nested> out;
  for (const Ring& ring : rings) {
    const Region alone = region_of({ring});
    out.push_back({alone.outer, bounds_of(ring), area(alone), {}});
  }
  constexpr double kContactArea = 1e-6;  // relative tolerance of areas, in the smaller area
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t j = 0; j < out.size(); ++j) {
      const bool smaller = out[i].size < out[j].size || (out[i].size == out[j].size && i > j);
      if (i == j || !smaller || are_apart(out[i].box, out[j].box)) continue;
      const double shared = area(unite({&out[i].ring, 1}, {out[j].ring, {}}, {}));
      if (shared < kContactArea * out[i].size) continue;
      if (shared < (1 - kContactArea) * out[i].size)
        throw Error::input(ring_text(out[i].ring) + " crosses another closed curve");
      out[i].within.push_back(j);
    }
  return out;
}

/// Returns the connected regions of material: outer rings, which are enclosed by an even number of
/// rings, with their holes. A region that the domain does not clip keeps the order of its points in
/// the drawing, because meshes depend on this order.
std::vector<Region> pieces_of(const std::vector<Nested>& all, const Region& domain) {
  std::vector<Region> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].within.size() % 2 != 0) continue;
    Region drawn{all[i].ring, {}};
    for (const Nested& hole : all)
      if (hole.within.size() == all[i].within.size() + 1 &&
          std::find(hole.within.begin(), hole.within.end(), i) != hole.within.end())
        drawn.holes.emplace_back(hole.ring.rbegin(), hole.ring.rend());
    std::vector<Region> clipped = unite({&drawn.outer, 1}, domain, drawn.holes);
    constexpr double kSamePoint = 1e-12;
    if (clipped.size() == 1 && clipped[0].holes.size() == drawn.holes.size() &&
        std::abs(area(clipped) - area(drawn)) <= kSamePoint * area(drawn))
      clipped = {drawn};
    for (Region& piece : clipped) out.push_back(std::move(piece));
  }
  return out;
}

/// Returns the area that rings enclose by the even-odd rule [m²].
double area_of(const std::vector<Nested>& all) {
  double out = 0;
  for (const Nested& n : all) out += n.within.size() % 2 == 0 ? n.size : -n.size;
  return out;
}

}  // namespace

DrawnPart read_part(const std::string& path, const Scene& scene, const BodyDesign& design) {
  io::DrawnOutlines outlines = read_rings(path, thickness_of(scene, design));
  std::vector<Ring>& rings = outlines.rings;
  const Region domain = domain_of(scene, design);
  try {
    check_size(rings, domain, design.body);
    const Snap snap(domain, design);
    for (Ring& ring : rings) ring = snap(ring);
    std::erase_if(rings, [](const Ring& ring) { return ring.size() < 3; });
    const std::vector<Nested> all = nested(rings);
    std::vector<Region> out = pieces_of(all, domain);
    const double drawn = area_of(all), lost = drawn - area(out);
    if (!(lost < kOverhang * drawn))
      throw Error::input(io::to_text(100 * lost / drawn, 3) + " % of its area of " +
                         io::to_text(drawn, 4) + " m2 lie outside of the design domain of '" +
                         design.body + "'");
    return {std::move(out), std::move(outlines.notes)};
  } catch (const Error& error) {
    throw Error::input(path + ": " + error.what());
  }
}

}  // namespace flexmorph::cases
