#include "geometry/parts/feature.h"

#include <CGAL/Mpzf.h>
#include <CGAL/Segment_Delaunay_graph_2.h>
#include <CGAL/Segment_Delaunay_graph_filtered_traits_2.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/crossings.h"
#include "geometry/parts/outline_sides.h"
#include "geometry/parts/segment.h"

namespace flexmorph {
namespace {

/// Vertices and faces of the graph, numbered in the order of their creation. CGAL then orders their
/// handles by this number (Time_stamper.h) instead of by address. This is needed because the graph
/// iterates over sets and maps of handles when it creates and recycles faces (CGAL 5.5,
/// add_bogus_vertices(), retriangulate_conflict_region()). With an order by address, the location
/// of faces, the first vertex of a face, and thus the round-off of its center would depend on the
/// heap.
template <class Base>
class Numbered : public Base {
 public:
  template <class Structure>
  struct Rebind_TDS {
    using Other = Numbered<typename Base::template Rebind_TDS<Structure>::Other>;
  };
  using Has_timestamp = CGAL::Tag_true;

  using Base::Base;
  Numbered() = default;
  // A copy gets its own number, because no two elements of a graph may have equal numbers.
  Numbered(const Numbered& other) : Base(other) {}
  Numbered& operator=(const Numbered& other) {
    Base::operator=(other);
    return *this;
  }

  std::size_t time_stamp() const { return number_; }
  void set_time_stamp(std::size_t number) { number_ = number; }

 private:
  std::size_t number_ = std::numeric_limits<std::size_t>::max();  // no number yet
};

using Kernel = CGAL::Simple_cartesian<double>;
/// Traits for sides that may cross: rational numbers decide where floating-point filters cannot.
using Crossing = CGAL::Segment_Delaunay_graph_filtered_traits_2<Kernel>;
/// Traits for sides that do not cross: exact sums and products of doubles decide; the results are
/// equal, and the graph is several times faster.
using Apart = CGAL::Segment_Delaunay_graph_filtered_traits_without_intersections_2<
    Kernel, CGAL::Field_with_sqrt_tag, CGAL::Simple_cartesian<CGAL::Mpzf>,
    CGAL::Integral_domain_without_division_tag>;
template <class Traits>
using Storage = CGAL::Segment_Delaunay_graph_storage_traits_2<Traits>;
template <class Traits>
using Graph = CGAL::Segment_Delaunay_graph_2<
    Traits, Storage<Traits>,
    CGAL::Triangulation_data_structure_2<
        Numbered<CGAL::Segment_Delaunay_graph_vertex_base_2<Storage<Traits>>>,
        Numbered<CGAL::Segment_Delaunay_graph_face_base_2<Traits>>>>;

/// Flanks whose contacts are within this angle of opposite form a bar [rad].
constexpr double kNearlyOpposite = std::numbers::pi / 6;
/// Corresponding angle for a flank and the border [rad]: a bar that the border cuts at a larger
/// angle is not a wedge.
constexpr double kWedge = std::numbers::pi / 12;
/// Sides within this angle of each other are parallel [rad].
constexpr double kParallel = 1e-6;
/// Relative round-off of distances between contacts.
constexpr double kRoundOff = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Vec2 vec(const Kernel::Point_2& p) { return {p.x(), p.y()}; }

/// A vertex or a side of the outlines that a disc touches.
struct Contact {
  bool is_side = false;
  Vec2 a{0, 0}, b{0, 0};  // a side keeps the material on its left
  bool border = false;
  bool known = true;  // false for vertices that CGAL created where rounded sides cross

  Vec2 nearest(const Vec2& p) const { return is_side ? nearest_on({a, b}, p) : a; }
};

/// Tells which locations count.
using Counts = std::function<bool(const LengthScaleViolation&)>;

template <class Traits>
class MedialAxis {
 public:
  MedialAxis(const OutlineSides& outlines, double limit)
      : outlines_(outlines), limit_(limit), bounds_{limit, limit} {
    std::vector<Kernel::Point_2> points;
    for (const Vec2& p : outlines.points()) points.emplace_back(p.x(), p.y());
    graph_.insert_segments(points.begin(), points.end(), outlines.sides().begin(),
                           outlines.sides().end());
    for (size_t k = 0; k < outlines.sides().size(); ++k) {
      const auto& [p, q] = outlines.sides()[k];
      const Vec2 &a = outlines.points()[p], &b = outlines.points()[q];
      sides_[key(a, b)] = {true, a, b, outlines.on_border(k), true};
    }
  }

  std::vector<LengthScaleViolation> locations() {
    find();
    std::sort(found_.begin(), found_.end(),
              [](const LengthScaleViolation& x, const LengthScaleViolation& y) {
                return x.width < y.width;
              });
    return std::move(found_);
  }

  /// Returns the smallest widths of places() that count. A disc that is larger than one found
  /// before is not tested for being empty.
  Features smallest(const Counts& counts) {
    counts_ = &counts;
    find();
    return {bounds_[1], bounds_[0]};
  }

 private:
  using G = Graph<Traits>;
  using Site = typename G::Site_2;
  using Vertex = typename G::Vertex_handle;
  using Key = std::array<double, 4>;

  void find() {
    corners();
    for (auto e = graph_.finite_edges_begin(); e != graph_.finite_edges_end(); ++e) {
      const Contact p = contact(e->first->vertex(G::cw(e->second))->site());
      const Contact q = contact(e->first->vertex(G::ccw(e->second))->site());
      if (p.known && q.known) neck(p, q, *e);
    }
    for (auto f = graph_.finite_faces_begin(); f != graph_.finite_faces_end(); ++f) vertex(f);
  }

  static Key key(const Vec2& a, const Vec2& b) {
    const bool ordered = std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
    const Vec2 &p = ordered ? a : b, &q = ordered ? b : a;
    return {p.x(), p.y(), q.x(), q.y()};
  }

  Contact contact(const Site& site) const {
    Contact c;
    if (site.is_point()) {
      c.a = c.b = vec(site.point());
      const OutlineCorner* corner = outlines_.corner(c.a);
      c.known = corner != nullptr;
      c.border = c.known && corner->border;
      return c;
    }
    const auto side = sides_.find(key(vec(site.segment().source()), vec(site.segment().target())));
    if (side != sides_.end()) return side->second;
    c.known = false;
    return c;
  }

  /// Returns true if a disc around `center` that touches the contact lies in the material.
  bool in_material(const Contact& c, const Vec2& center) const {
    if (c.is_side) return cross(c.b - c.a, center - c.a) > 0;
    const OutlineCorner& corner = *outlines_.corner(c.a);
    if (corner.visits > 1) return outlines_.in_material(center);
    // in the material a disc touches reflex vertices only
    return cross(corner.before, corner.after) < 0;
  }

  /// Adds vertices at which the width is 0: vertices that two outlines share, and very crisp
  /// corners.
  void corners() {
    for (const auto& [at, corner] : outlines_.corners()) {
      const Vec2 p(at.first, at.second);
      const double turn =
          std::atan2(cross(corner.before, corner.after), corner.before.dot(corner.after));
      const bool crisp = corner.visits == 1 && std::numbers::pi - turn < kNearlyOpposite &&
                         turn > 0 && !corner.border_before && !corner.border_after;
      if (corner.visits > 1 || crisp) add({LengthScaleViolation::Kind::neck, true, 0, p, p, p});
    }
  }

  /// Adds the disc between the opposite contacts of an edge of the medial axis if it is empty.
  void neck(const Contact& p, const Contact& q, const typename G::Edge& edge) {
    Vec2 a = p.a, b = q.a;
    if (p.is_side && q.is_side) {
      const std::optional<std::pair<Vec2, Vec2>> between = parallel_contacts(p, q, edge);
      if (!between) return;
      std::tie(a, b) = *between;
    } else if (p.is_side || q.is_side) {
      const Contact &side = p.is_side ? p : q, &point = p.is_side ? q : p;
      const Vec2 along = (side.b - side.a);
      const double t = (point.a - side.a).dot(along) / along.squaredNorm();
      if (!(t > 0 && t < 1)) return;
      a = point.a;
      b = side.a + t * along;
    }
    const double width = (a - b).norm();
    if (!(width < limit_) || width == 0) return;
    const Vec2 center = 0.5 * (a + b);
    if (!(width < bounds_[in_material(p, center)]) || !empty(center, 0.5 * width)) return;
    report(LengthScaleViolation::Kind::neck, p,
           {LengthScaleViolation::Kind::neck, true, width, center, a, b});
  }

  /// Returns the contacts on two parallel sides in the middle of their edge of the medial axis.
  std::optional<std::pair<Vec2, Vec2>> parallel_contacts(const Contact& p, const Contact& q,
                                                         const typename G::Edge& edge) const {
    const Vec2 d = (p.b - p.a).normalized(), e = (q.b - q.a).normalized();
    if (std::abs(cross(d, e)) > kParallel || d.dot(e) > 0) return {};
    const auto other = edge.first->neighbor(edge.second);
    if (graph_.is_infinite(edge.first) || graph_.is_infinite(other)) return {};
    const Vec2 middle = 0.5 * (vec(graph_.primal(edge.first)) + vec(graph_.primal(other)));
    return std::pair(p.nearest(middle), q.nearest(middle));
  }

  bool empty(const Vec2& center, double radius) {
    const auto nearest = graph_.nearest_neighbor({center.x(), center.y()}, hint_);
    if (nearest == Vertex()) return false;
    hint_ = nearest;
    const Site& site = nearest->site();
    const Vec2 at =
        site.is_point()
            ? vec(site.point())
            : nearest_on({vec(site.segment().source()), vec(site.segment().target())}, center);
    return (center - at).norm() >= radius * (1 - kRoundOff);
  }

  /// Evaluates a vertex of the medial axis, which is the center of a disc with three contacts.
  void vertex(const typename G::Finite_faces_iterator& face) {
    const Vec2 center = vec(graph_.primal(face));
    std::array<Contact, 3> contacts;
    std::array<Vec2, 3> at;
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<size_t>(k);
      contacts[i] = contact(face->vertex(k)->site());
      if (!contacts[i].known) return;
      at[i] = contacts[i].nearest(center);
      const double radius = (center - at[i]).norm();
      low = std::min(low, radius);
      high = std::max(high, radius);
    }
    if (!(2 * low < limit_) || low == 0 || high - low > 1e-6 * high) return;
    const double angle[3] = {opening(center, at[1], at[2]), opening(center, at[2], at[0]),
                             opening(center, at[0], at[1])};
    const auto widest = static_cast<size_t>(std::max_element(angle, angle + 3) - angle);
    const size_t i = (widest + 1) % 3, j = (widest + 2) % 3;
    LengthScaleViolation location{
        LengthScaleViolation::Kind::blob, true, 2 * low, center, at[i], at[j]};
    // The contacts surround the center if the angles between them add up to the full circle.
    if (angle[0] + angle[1] + angle[2] > 2 * std::numbers::pi - kParallel &&
        angle[widest] < std::numbers::pi - kParallel)
      report(location.kind, contacts[i], location);
    const bool border = contacts[i].border || contacts[j].border;
    if (angle[widest] < std::numbers::pi - (border ? kWedge : kNearlyOpposite)) return;
    location.kind = LengthScaleViolation::Kind::bar;
    report(location.kind, contacts[i], location);
  }

  static double opening(const Vec2& center, const Vec2& a, const Vec2& b) {
    const Vec2 u = a - center, v = b - center;
    return std::atan2(std::abs(cross(u, v)), u.dot(v));
  }

  void report(LengthScaleViolation::Kind kind, const Contact& c, LengthScaleViolation location) {
    location.solid = in_material(c, location.center);
    if (!location.solid &&
        (kind == LengthScaleViolation::Kind::bar || !outlines_.within(location.center)))
      return;
    add(location);
  }
  void add(const LengthScaleViolation& location) {
    double& bound = bounds_[location.solid];
    if (!(location.width < bound)) return;
    if (counts_ == nullptr) {
      found_.push_back(location);
    } else if (!*counts_ || (*counts_)(location)) {
      bound = location.width;
    }
  }

  const OutlineSides& outlines_;
  double limit_;
  std::array<double, 2> bounds_;  // of void and of material: only smaller widths are searched
  const Counts* counts_ = nullptr;
  G graph_;
  Vertex hint_;
  std::map<Key, Contact> sides_;
  std::vector<LengthScaleViolation> found_;
};

}  // namespace

std::vector<LengthScaleViolation> length_scale_violations(std::span<const Region> regions,
                                                          const Region& domain, double limit) {
  const OutlineSides outlines(regions, domain);
  if (outlines.sides().empty()) return {};
  if (sides_cross(outlines.points(), outlines.sides()))
    return MedialAxis<Crossing>(outlines, limit).locations();
  return MedialAxis<Apart>(outlines, limit).locations();
}

Features smallest_features(std::span<const Region> regions, const Region& domain,
                           const std::function<bool(const LengthScaleViolation&)>& counts) {
  const OutlineSides outlines(regions, domain);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (outlines.sides().empty()) return {kInfinity, kInfinity};
  if (sides_cross(outlines.points(), outlines.sides()))
    return MedialAxis<Crossing>(outlines, kInfinity).smallest(counts);
  return MedialAxis<Apart>(outlines, kInfinity).smallest(counts);
}

}  // namespace flexmorph
