#include "optim/mmc/length_scale/outline_limits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/parts/simplified.h"
#include "geometry/parts/smoothing.h"

namespace flexmorph::mmc {
namespace {

/// Ratio of a width to the required width from which on a narrow place gives no constraint.
constexpr double kSearchWidth = 1.5;
/// Fraction of the required width below which a narrow place has no gradient.
constexpr double kNoWidth = 1e-3;
/// kScale is the factor of the relative width error in g. kAim is the ratio of the width in the
/// constraint to the required width. Settings::feasibility = 1e-5 tolerates a relative width error
/// of 3e-3.
constexpr double kScale = 0.003, kAim = 1.002;
/// Sine of the angle between two normals below which two outlines have no well-defined crossing
/// [-].
constexpr double kCrossing = 0.05;

/// An outline through a contact.
struct Through {
  Vec2 normal{0, 0};    // into the material
  double distance = 0;  // of the contact from the outline, positive inside [m]
  int component = -1;   // index; -1: a fixed outline
  std::array<double, Component::kParameters> speed = {};  // of the outline along -normal
};

/// Returns the sides that no component moves.
std::vector<Segment> fixed_sides(const BodyProblem& problem) {
  return sides_of(fixed_rings(problem));
}

class Contacts {
 public:
  Contacts(const BodyProblem& problem, std::span<const Component> components)
      : components_(components),
        tdf_(problem.bands.back()),
        sides_(fixed_sides(problem)),
        near_(3 * kOutlineTolerance * problem.grid.dx()) {
    for (const Component& c : components)
      boxes_.push_back(bounding_box(c, tdf_.min_half_thickness, near_));
  }

  /// Adds s e · (correction and velocity of the contact at p) to a width and its gradient.
  void add(const Vec2& p, const Vec2& e, double s, WidthGradient& out) const {
    for (const Share& share : shares_at(p, e)) {
      const Through& t = share.of;
      if (t.component < 0) continue;
      out.width -= s * share.part * t.distance;
      for (int q = 0; q < Component::kParameters; ++q)
        out.slope[Component::kParameters * t.component + q] -=
            s * share.part * t.speed[static_cast<size_t>(q)];
    }
  }

  /// Adds the contribution of the contact at p to the motion of the disc along the material. The
  /// last disc of an end moves in this way together with the components.
  /// @param along  unit vector along the material
  /// @param rate   derivative of the width by a motion of all outlines along the material [-]
  /// @param slide  velocity of the disc along the material by the parameters of components (7 N)
  void add_slide(const Vec2& p, const Vec2& e, double s, const Vec2& along, double& rate,
                 VectorXd& slide) const {
    const std::vector<Share> shares = shares_at(p, e);
    for (const Share& share : shares) {
      rate += s * share.part * share.of.normal.dot(along);
      if (share.of.component < 0) continue;
      const Component& c = components_[static_cast<size_t>(share.of.component)];
      const Vec2 axis(std::cos(c.angle), std::sin(c.angle)), arm = p - c.center;
      const double part = 0.5 / static_cast<double>(shares.size());
      const auto first = Component::kParameters * static_cast<Eigen::Index>(share.of.component);
      slide[first] += part * along.x();
      slide[first + 1] += part * along.y();
      slide[first + 2] += part * along.dot(axis) * axis.dot(arm) / c.half_length;
      slide[first + 3] += part * along.dot(Vec2(-arm.y(), arm.x()));
    }
  }

 private:
  /// An outline through a contact, and its coefficient in e · v = Σ part n · v, which holds for all
  /// velocities v of the contact that the outlines allow.
  struct Share {
    Through of;
    double part = 0;
  };
  std::vector<Share> shares_at(const Vec2& p, const Vec2& e) const {
    const std::vector<Through> through = outlines_through(p);
    if (through.empty()) return {};
    if (through.size() == 1) return {{through[0], through[0].normal.dot(e)}};
    Eigen::Matrix2d normals;
    normals << through[0].normal, through[1].normal;
    const Vec2 both = normals.inverse() * e;
    return {{through[0], both[0]}, {through[1], both[1]}};
  }

  /// Returns one outline, or two that cross: fixed outlines first, then the nearest ones.
  std::vector<Through> outlines_through(const Vec2& p) const {
    std::vector<Through> found;
    for (size_t c = 0; c < components_.size(); ++c) add_component(static_cast<int>(c), p, found);
    for (const auto& [a, b] : sides_) add_side(a, b, p, found);
    std::stable_sort(found.begin(), found.end(), [](const Through& x, const Through& y) {
      const bool fixed_x = x.component < 0, fixed_y = y.component < 0;
      return fixed_x != fixed_y ? fixed_x : std::abs(x.distance) < std::abs(y.distance);
    });
    std::vector<Through> out;
    for (const Through& t : found) {
      if (out.size() == 2) break;
      const auto across = [&](const Through& o) {
        return std::abs(o.normal.x() * t.normal.y() - o.normal.y() * t.normal.x());
      };
      if (out.empty() || across(out[0]) > kCrossing) out.push_back(t);
    }
    return out;
  }

  void add_component(int index, const Vec2& p, std::vector<Through>& found) const {
    const Box& box = boxes_[static_cast<size_t>(index)];
    if ((p.array() < box.lower.array()).any() || (p.array() > box.upper.array()).any()) return;
    const Component& c = components_[static_cast<size_t>(index)];
    Through t;
    const double phi = component_tdf(c, tdf_, p.x(), p.y(), t.speed.data());
    const Vec2 gradient(-t.speed[0], -t.speed[1]);  // φ depends on X - X0
    const double size = gradient.norm();
    if (!(size > 0) || !(std::abs(phi) < near_ * size)) return;
    t.normal = gradient / size;
    t.distance = phi / size;
    t.component = index;
    for (double& each : t.speed) each /= size;
    found.push_back(t);
  }

  void add_side(const Vec2& a, const Vec2& b, const Vec2& p, std::vector<Through>& found) const {
    const Vec2 along = (b - a).normalized(), normal(-along.y(), along.x());
    const double at = along.dot(p - a), far = near_ / 3;
    if (at < -far || at > (b - a).norm() + far || std::abs(normal.dot(p - a)) > 1e-3 * far) return;
    found.push_back({normal, 0, -1, {}});
  }

  std::span<const Component> components_;
  TdfSettings tdf_;
  std::vector<Segment> sides_;
  double near_;
  std::vector<Box> boxes_;
};

/// Returns the narrowest places relative to the required widths, one for each neighbourhood.
/// @param regions  union of the components
/// @param part     union with its fillets; gaps that the fillets fill do not count
/// @param most     largest number of places
std::vector<LengthScaleViolation> narrowest(const BodyProblem& problem,
                                            std::span<const Region> regions,
                                            std::span<const Region> part,
                                            const MinimumWidths& wanted, size_t most) {
  std::vector<LengthScaleViolation> all =
      length_scale_violations_of(problem, regions, kSearchWidth * wanted.largest());
  const auto share = [&](const LengthScaleViolation& p) { return p.width / wanted.of(p); };
  std::erase_if(all, [&](const LengthScaleViolation& p) { return !(share(p) < kSearchWidth); });
  std::stable_sort(all.begin(), all.end(),
                   [&](const auto& p, const auto& q) { return share(p) < share(q); });
  const auto is_filled = [&](const LengthScaleViolation& p) {
    return !p.solid && std::any_of(part.begin(), part.end(),
                                   [&](const Region& piece) { return contains(piece, p.center); });
  };
  std::vector<LengthScaleViolation> out;
  for (const LengthScaleViolation& p : all) {
    if (is_filled(p)) continue;
    const bool known = std::any_of(out.begin(), out.end(), [&](const LengthScaleViolation& q) {
      return q.solid == p.solid && (q.center - p.center).norm() < wanted.of(p);
    });
    if (!known) out.push_back(p);
    if (out.size() == most) break;
  }
  return out;
}

/// Ratio of the smallest thickness of components to the smallest feature. It exceeds 1 because
/// their ends are round and outlines have a tolerance.
constexpr double kAllowance = 1.06;

}  // namespace

namespace {

BodyProblem with_fewer_sides(const BodyProblem& problem) {
  BodyProblem out = problem;
  const double tolerance = kOutlineTolerance * problem.grid.dx();
  if (!out.domain.outer.empty()) out.domain.outer = simplified(out.domain.outer, tolerance);
  for (auto* rings : {&out.domain.holes, &out.solid, &out.empty})
    for (std::vector<Vec2>& ring : *rings) ring = simplified(ring, tolerance);
  return out;
}

}  // namespace

double half_thickness_for(double min_feature) { return 0.5 * kAllowance * min_feature; }

namespace {

WidthGradient width_gradient_at(const Contacts& contacts, size_t n,
                                const LengthScaleViolation& location) {
  WidthGradient out;
  out.slope.setZero(Component::kParameters * static_cast<Eigen::Index>(n));
  out.width = location.width;
  const Vec2 e = (location.a - location.b).normalized();
  contacts.add(location.a, e, 1, out);
  contacts.add(location.b, e, -1, out);
  if (location.kind != LengthScaleViolation::Kind::bar) return out;
  const Vec2 along(-e.y(), e.x());
  double rate = 0;
  VectorXd slide = VectorXd::Zero(out.slope.size());
  contacts.add_slide(location.a, e, 1, along, rate, slide);
  contacts.add_slide(location.b, e, -1, along, rate, slide);
  out.slope -= rate * slide;
  return out;
}

}  // namespace

WidthGradient width_gradient(const BodyProblem& problem, std::span<const Component> components,
                             const LengthScaleViolation& location) {
  return width_gradient_at(Contacts(problem, components), components.size(), location);
}

OutlineLimits::OutlineLimits(const BodyProblem& problem, const MinimumWidths& wanted)
    : problem_(with_fewer_sides(problem)),
      wanted_(wanted),
      domain_area_(area(domain_of(problem_))) {}

void OutlineLimits::evaluate(std::span<const Component> components, Values& out) {
  const std::vector<Region> regions =
      regions_of(problem_, components, kOutlineTolerance * problem_.grid.dx());
  const double tolerance = kOutlineTolerance * problem_.grid.dx();
  std::vector<Region> part =
      with_fillets(regions, domain_of(problem_), problem_.fillets, tolerance);
  if (problem_.fillets.radius > 0)
    part = smoothed(part, fixed_rings(problem_), {}, {}, problem_.widths.solid, tolerance, false);
  out.volume = area(part) / domain_area_;
  out.g.setConstant(count(), kScale * (1 - kSearchWidth));
  out.dg.setZero(count(), Component::kParameters * static_cast<Eigen::Index>(components.size()));
  if (!wanted_.any()) return;
  const Contacts contacts(problem_, components);
  Eigen::Index k = 0;
  for (const LengthScaleViolation& location :
       narrowest(problem_, regions, part, wanted_, kLocations)) {
    WidthGradient w = width_gradient_at(contacts, components.size(), location);
    if (location.width < kNoWidth * wanted_.of(location)) w.slope.setZero();
    const double wanted = kAim * wanted_.of(location);
    out.g[k] = kScale * (1 - w.width / wanted);
    out.dg.row(k++) = -kScale / wanted * w.slope.transpose();
  }
}

}  // namespace flexmorph::mmc
