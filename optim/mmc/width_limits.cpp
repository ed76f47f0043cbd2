#include "optim/mmc/width_limits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace flexmorph::mmc {
namespace {

/// Places wider than so many times what is wanted are far from being a limit.
constexpr double kLook = 1.5;
/// Places narrower than this part of what is wanted have no direction.
constexpr double kNoWidth = 1e-3;
constexpr double kScale = 0.01;
/// Outlines whose normals differ by less than this cross nowhere in particular [-], a sine.
constexpr double kCrossing = 0.05;

/// An outline that passes through a contact.
struct Through {
  Vec2 normal{0, 0};    // into the material
  double distance = 0;  // of the contact from the outline, positive in the material [m]
  int component = -1;   // -1: fixed
  std::array<double, Component::kParameters> speed = {};  // of the outline along -normal, by p
};

/// Sides that no component moves.
std::vector<std::array<Vec2, 2>> fixed_sides(const BodyProblem& problem) {
  std::vector<std::vector<Vec2>> rings = rings_of(domain_of(problem));
  rings.insert(rings.end(), problem.solid.begin(), problem.solid.end());
  rings.insert(rings.end(), problem.empty.begin(), problem.empty.end());
  std::vector<std::array<Vec2, 2>> out;
  for (const std::vector<Vec2>& ring : rings)
    for (size_t k = 0; k < ring.size(); ++k) out.push_back({ring[k], ring[(k + 1) % ring.size()]});
  return out;
}

class Contacts {
 public:
  Contacts(const BodyProblem& problem, std::span<const Component> components)
      : components_(components),
        tdf_(problem.stages.back()),
        sides_(fixed_sides(problem)),
        near_(3 * kOutlineTolerance * problem.grid.dx()) {}

  /// Adds s e · (position and speed of the contact at p) to a width.
  void add(const Vec2& p, const Vec2& e, double s, WidthSlope& out) const {
    const std::vector<Through> through = outlines_through(p);
    if (through.empty()) return;
    // e · v = Σ_i k_i n_i · v for all v that the outlines allow.
    std::array<double, 2> share = {through[0].normal.dot(e), 0};
    if (through.size() > 1) {
      Eigen::Matrix2d normals;
      normals << through[0].normal, through[1].normal;
      const Vec2 both = normals.inverse() * e;
      share = {both[0], both[1]};
    }
    for (size_t i = 0; i < through.size(); ++i) {
      const Through& t = through[i];
      if (t.component < 0) continue;
      out.width -= s * share[i] * t.distance;
      for (int q = 0; q < Component::kParameters; ++q)
        out.slope[Component::kParameters * t.component + q] -=
            s * share[i] * t.speed[static_cast<size_t>(q)];
    }
  }

 private:
  /// One outline, or two that cross: what is fixed first, then those nearest.
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
  std::vector<std::array<Vec2, 2>> sides_;
  double near_;
};

/// The narrowest places by what is wanted of them, one for each neighbourhood.
std::vector<NarrowPlace> narrowest(const BodyProblem& problem,
                                   std::span<const Component> components, const Widths& wanted,
                                   size_t most) {
  std::vector<NarrowPlace> all;
  try {
    const auto regions = regions_of(problem, components, kOutlineTolerance * problem.grid.dx());
    all = narrow_places_of(problem, regions, kLook * wanted.largest());
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) throw;
    return {};
  }
  const auto part = [&](const NarrowPlace& p) { return p.width / wanted.of(p); };
  std::erase_if(all,
                [&](const NarrowPlace& p) { return !(part(p) < kLook) || part(p) < kNoWidth; });
  std::stable_sort(all.begin(), all.end(),
                   [&](const auto& p, const auto& q) { return part(p) < part(q); });
  std::vector<NarrowPlace> out;
  for (const NarrowPlace& p : all) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const NarrowPlace& q) {
      return q.solid == p.solid && (q.center - p.center).norm() < wanted.of(p);
    });
    if (!known) out.push_back(p);
    if (out.size() == most) break;
  }
  return out;
}

}  // namespace

WidthSlope width_slope(const BodyProblem& problem, std::span<const Component> components,
                       const NarrowPlace& place) {
  WidthSlope out;
  out.slope.setZero(Component::kParameters * static_cast<Eigen::Index>(components.size()));
  out.width = place.width;
  const Vec2 e = (place.a - place.b).normalized();
  const Contacts contacts(problem, components);
  contacts.add(place.a, e, 1, out);
  contacts.add(place.b, e, -1, out);
  return out;
}

void WidthLimits::evaluate(std::span<const Component> components, VectorXd& g, MatrixXd& dg) {
  g.setConstant(kPlaces, kScale * (1 - kLook));
  dg.setZero(kPlaces, Component::kParameters * static_cast<Eigen::Index>(components.size()));
  Eigen::Index k = 0;
  for (const NarrowPlace& place : narrowest(problem_, components, wanted_, kPlaces)) {
    const WidthSlope w = width_slope(problem_, components, place);
    const double wanted = wanted_.of(place);
    g[k] = kScale * (1 - w.width / wanted);
    dg.row(k++) = -kScale / wanted * w.slope.transpose();
  }
}

}  // namespace flexmorph::mmc
