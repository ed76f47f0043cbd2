#include "optim/mmc/renewed_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "optim/mmc/clean_up.h"

namespace flexmorph::mmc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Joining.
/// What all joints together, and one of them, may cost in compliance times volume [-].
constexpr double kPriceOfAll = 5e-3, kPriceOfOne = 1e-3;
/// Area that is not what it was, as a part of the joined component's [-].
constexpr double kOther = 0.2;
/// cos of the angle that axes and their joint may have.
constexpr double kStraight = 0.95;

// Bearing.
/// A new bar has to lessen compliance times volume by this part.
constexpr double kGain = 2e-3;
/// So many bars are put there at most, after so many tries each.
constexpr int kMostBars = 6, kTries = 8;
/// Bars as long as this part of the larger side of the grid, or longer than this, are not looked
/// at.
constexpr double kShortest = 0.04, kLongest = 0.5;
/// Loads that are asked where bars are missed.
constexpr int kLoads = 12;
/// A bar crosses void along so much of its length.
constexpr double kThroughVoid = 0.5;
constexpr double kHollow = 0.1;  // area fraction of void

/// A component as seen from one of its ends.
struct Ended {
  Vec2 far, near;   ///< tips [m]
  double far_half;  ///< half-thickness at the far tip [m]
  Vec2 along() const { return (near - far).normalized(); }
};

Ended seen_to(const Component& c, bool first_is_near) {
  const Vec2 half = c.half_length * Vec2(std::cos(c.angle), std::sin(c.angle));
  if (first_is_near) return {c.center + half, c.center - half, c.c2};
  return {c.center - half, c.center + half, c.c1};
}

/// Half-thickness of a component beside a point.
double half_beside(const Component& c, const Vec2& p, double floor) {
  const Vec2 axis(std::cos(c.angle), std::sin(c.angle));
  return profile(c, std::clamp((p - c.center).dot(axis), -c.half_length, c.half_length), floor).g;
}

/// One component from the far tip of one to that of the other; nothing where they do not lie end to
/// end.
std::optional<Component> joined(const Component& a, bool a_first, const Component& b, bool b_first,
                                double floor) {
  const Ended from = seen_to(a, a_first), to = seen_to(b, b_first);
  const double thick = a.c3 + b.c3;
  if ((from.near - to.near).norm() > std::max(thick, std::min(a.half_length, b.half_length)))
    return {};
  const Vec2 across = to.far - from.far;
  const Vec2 e = across.normalized();
  if (from.along().dot(e) < kStraight || to.along().dot(-e) < kStraight) return {};
  Component out;
  out.center = 0.5 * (from.far + to.far);
  out.half_length = 0.5 * across.norm();
  if (out.half_length <= std::max(a.half_length, b.half_length)) return {};
  out.angle = std::atan2(across.y(), across.x());
  out.c1 = from.far_half;
  out.c2 = to.far_half;
  const double of_a = (out.center - a.center).norm() / a.half_length;
  const double of_b = (out.center - b.center).norm() / b.half_length;
  out.c3 = half_beside(of_a < of_b ? a : b, out.center, floor);
  return out;
}

/// The parts without two, and with another one.
std::vector<Component> replaced(const UnderRepair& design, size_t i, size_t j, const Component& c) {
  std::vector<Component> out = design.parts;
  out[i] = c;
  out.erase(out.begin() + static_cast<std::ptrdiff_t>(j));
  return out;
}

/// Joins one component to the one with which it comes closest to what both were.
bool join(UnderRepair& design, size_t i, double& merit, double most) {
  const BodyProblem& problem = design.problem();
  const double floor = problem.stages.back().min_half_thickness;
  const VectorXd before = design.fractions(design.parts);
  double least = kInfinity;
  std::vector<Component> best;
  for (size_t j = 0; j < design.parts.size(); ++j) {
    if (j == i) continue;
    for (const bool i_first : {true, false})
      for (const bool j_first : {true, false}) {
        std::optional<Component> one =
            joined(design.parts[i], i_first, design.parts[j], j_first, floor);
        if (!one) continue;
        const double area = fractions_of(problem, {&*one, 1}).sum();
        if (area == 0) continue;  // outside
        const double more = design.fractions(replaced(design, i, j, *one)).sum() - before.sum();
        // What fills notches is taken off the thickness.
        for (double* c : {&one->c1, &one->c2, &one->c3})
          *c = std::max(*c * (1 - more / area), problem.design.scale().min_thickness);
        std::vector<Component> now = replaced(design, i, j, *one);
        const double other = (design.fractions(now) - before).cwiseAbs().sum();
        if (other > kOther * area || other >= least) continue;
        least = other;
        best = std::move(now);
      }
  }
  if (best.empty()) return false;
  const double lowest = std::min(most, merit * (1 + kPriceOfOne));
  const double found = design.merit(best, lowest);
  if (!(found < lowest)) return false;
  design.parts = std::move(best);
  design.patch.assign(design.parts.size(), false);
  merit = found;
  return true;
}

/// Displacements of some loads, by nodes.
struct Motions {
  const Grid& grid;
  std::vector<VectorXd> u;

  Vec2 at(size_t load, const Vec2& p) const {
    const double s = std::clamp((p.x() - grid.x0) / grid.dx(), 0.0, grid.nx - 1e-9);
    const double t = std::clamp((p.y() - grid.y0) / grid.dy(), 0.0, grid.ny - 1e-9);
    const int i = static_cast<int>(s), j = static_cast<int>(t);
    const auto node = [&](int a, int b) -> Vec2 {
      return u[load].segment<2>(2 * grid.node(i + a, j + b));
    };
    const double x = s - i, y = t - j;
    return (1 - x) * ((1 - y) * node(0, 0) + y * node(0, 1)) +
           x * ((1 - y) * node(1, 0) + y * node(1, 1));
  }
  /// Σ (e · Δu)² / L, L the distance: what a bar would take, up to its stiffness.
  double taken(const Vec2& a, const Vec2& b) const {
    const Vec2 e = (b - a).normalized();
    double out = 0;
    for (size_t l = 0; l < u.size(); ++l) {
      const double longer = e.dot(at(l, b) - at(l, a));
      out += longer * longer;
    }
    return out / (b - a).norm();
  }
};

/// Where bars may begin and end: tips and middles of components, as far as they are material.
std::vector<Vec2> joints_of(const UnderRepair& design, const VectorXd& fractions) {
  const Grid& g = design.problem().grid;
  std::vector<Vec2> out;
  for (const Component& c : design.parts) {
    const Vec2 half = c.half_length * Vec2(std::cos(c.angle), std::sin(c.angle));
    for (const Vec2& p : {Vec2(c.center - half), c.center, Vec2(c.center + half)}) {
      const auto i = static_cast<int>(std::floor((p.x() - g.x0) / g.dx()));
      const auto j = static_cast<int>(std::floor((p.y() - g.y0) / g.dy()));
      if (i < 0 || j < 0 || i >= g.nx || j >= g.ny) continue;
      if (fractions[g.cell(i, j)] > 1 - kHollow) out.push_back(p);
    }
  }
  return out;
}

/// Does a bar cross void?
bool crosses_void(const Grid& g, const VectorXd& fractions, const Vec2& a, const Vec2& b) {
  const int n = std::max(2, static_cast<int>((b - a).norm() / g.dx()));
  int hollow = 0;
  for (int k = 0; k <= n; ++k) {
    const Vec2 p = a + (b - a) * k / n;
    const int i = std::clamp(static_cast<int>((p.x() - g.x0) / g.dx()), 0, g.nx - 1);
    const int j = std::clamp(static_cast<int>((p.y() - g.y0) / g.dy()), 0, g.ny - 1);
    hollow += fractions[g.cell(i, j)] < kHollow;
  }
  return hollow > kThroughVoid * n;
}

/// The bars that promise most, the best one first.
std::vector<std::pair<Vec2, Vec2>> promising(const UnderRepair& design, const Motions& motions,
                                             const VectorXd& fractions) {
  const Grid& g = design.problem().grid;
  const double side = std::max(g.width, g.height);
  const std::vector<Vec2> joints = joints_of(design, fractions);
  std::vector<std::pair<double, std::pair<Vec2, Vec2>>> all;
  for (size_t i = 0; i < joints.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const double length = (joints[i] - joints[j]).norm();
      if (length < kShortest * side || length > kLongest * side) continue;
      if (!crosses_void(g, fractions, joints[i], joints[j])) continue;
      // By volume, which its length is proportional to.
      all.emplace_back(-motions.taken(joints[i], joints[j]) / length,
                       std::pair(joints[i], joints[j]));
    }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::pair<Vec2, Vec2>> out;
  for (const auto& [worth, bar] : all) {
    const auto near = [&](const std::pair<Vec2, Vec2>& other) {
      const double apart = 2 * design.problem().design.scale().min_thickness;
      return ((bar.first - other.first).norm() < apart &&
              (bar.second - other.second).norm() < apart) ||
             ((bar.first - other.second).norm() < apart &&
              (bar.second - other.first).norm() < apart);
    };
    if (std::any_of(out.begin(), out.end(), near)) continue;
    out.push_back(bar);
    if (out.size() == kTries) break;
  }
  return out;
}

bool bear_part(UnderRepair& design, double& merit) {
  const VectorXd fractions = design.fractions(design.parts);
  const Motions motions{design.problem().grid, design.displacements(kLoads)};
  double lowest = merit * (1 - kGain);
  std::optional<Component> best;
  for (const auto& [a, b] : promising(design, motions, fractions)) {
    Component bar;
    bar.center = 0.5 * (a + b);
    bar.half_length = 0.5 * (b - a).norm();
    bar.angle = std::atan2(b.y() - a.y(), b.x() - a.x());
    bar.c1 = bar.c2 = bar.c3 = std::max(design.problem().design.scale().min_thickness,
                                        half_thickness_for(design.wanted().solid));
    std::vector<Component> with = design.parts;
    with.push_back(bar);
    const double found = design.merit(with, lowest);
    if (!(found < lowest)) continue;
    lowest = found;
    best = bar;
  }
  if (!best) return false;
  design.parts.push_back(*best);
  design.patch.push_back(false);
  merit = lowest;
  return true;
}

}  // namespace

int join_parts(UnderRepair& design) {
  design.count_islands();
  double merit = design.merit(design.parts);
  const double most = merit * (1 + kPriceOfAll);
  int n = 0;
  for (size_t i = 0; i < design.parts.size(); ++i)
    while (design.goes_on() && i < design.parts.size() && join(design, i, merit, most)) ++n;
  return n;
}

int bear_parts(UnderRepair& design) {
  design.count_islands();
  double merit = design.merit(design.parts);
  int n = 0;
  while (design.goes_on() && n < kMostBars && bear_part(design, merit)) ++n;
  return n;
}

}  // namespace flexmorph::mmc
