#include "optim/mmc/problem/finished_part.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/parts/smoothing.h"

namespace flexmorph::mmc {
namespace {

std::vector<Vec2> mirrored(std::vector<Vec2> ring, const Symmetry& line) {
  for (Vec2& p : ring) {
    if (line.x) p.x() = 2 * *line.x - p.x();
    if (line.y) p.y() = 2 * *line.y - p.y();
  }
  if (line.x.has_value() != line.y.has_value()) std::reverse(ring.begin(), ring.end());
  return ring;
}

/// Moves vertices that differ from a mirror line by round-off onto the line, so that no slivers
/// remain between them and the line.
void snap_to_mirrors(const BodyProblem& p, Region& region) {
  constexpr double kRoundOff = 1e-9;  // [cells]
  const Symmetry& symmetry = p.design.symmetry();
  const double near = kRoundOff * p.grid.dx();
  const auto snap = [&](std::vector<Vec2>& ring) {
    for (Vec2& v : ring) {
      if (symmetry.x && std::abs(v.x() - *symmetry.x) < near) v.x() = *symmetry.x;
      if (symmetry.y && std::abs(v.y() - *symmetry.y) < near) v.y() = *symmetry.y;
    }
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  };
  snap(region.outer);
  for (std::vector<Vec2>& hole : region.holes) snap(hole);
}

/// Returns the union of the lower (left) side of regions and its mirror images.
std::vector<Region> made_symmetric(const BodyProblem& p, std::span<const Region> regions) {
  const Symmetry& symmetry = p.design.symmetry();
  const Grid& g = p.grid;
  const Box all{{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}};
  Box side = all;
  if (symmetry.x) side.upper.x() = *symmetry.x;
  if (symmetry.y) side.upper.y() = *symmetry.y;
  const std::vector<std::vector<Vec2>> half = {corners_of(side)};
  std::vector<Symmetry> images = {{}};
  if (symmetry.x) images.push_back({symmetry.x, {}});
  if (symmetry.y) images.push_back({{}, symmetry.y});
  if (symmetry.x && symmetry.y) images.push_back(symmetry);
  std::vector<Region> pieces;
  for (Region region : regions) {
    snap_to_mirrors(p, region);
    for (const Region& piece : unite(half, region, {})) pieces.push_back(piece);
  }
  std::vector<std::vector<Vec2>> outer, holes;
  for (const Region& piece : pieces)
    for (const Symmetry& line : images) {
      outer.push_back(mirrored(piece.outer, line));
      for (const std::vector<Vec2>& hole : piece.holes) holes.push_back(mirrored(hole, line));
    }
  return unite(outer, {corners_of(all), {}}, holes);
}

/// Returns made_symmetric(), or the unchanged regions where rounded vertices at the mirror line
/// lead to a polygon that crosses itself. The unchanged regions are symmetric within the tolerance.
std::vector<Region> symmetric_where_possible(const BodyProblem& p, std::vector<Region> regions) {
  try {
    return made_symmetric(p, regions);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) throw;
    return regions;
  }
}

/// Returns the smoothed regions. Locations that smoothing would make narrower than the minimum
/// width keep their shape.
std::vector<Region> smoothed_part(const BodyProblem& p, std::span<const Region> regions,
                                  std::span<const Segment> mirrors, double tolerance) {
  const std::vector<std::vector<Vec2>> fixed = fixed_rings(p);
  std::vector<Region> out = smoothed(regions, fixed, mirrors, {}, p.widths.solid, tolerance);
  std::vector<Vec2> kept;
  for (const LengthScaleViolation& location :
       length_scale_violations_of(p, out, p.widths.largest()))
    if (location.width < p.widths.of(location)) kept.insert(kept.end(), {location.a, location.b});
  if (kept.empty()) return out;
  return smoothed(regions, fixed, mirrors, kept, p.widths.solid, tolerance);
}

/// Returns the symmetry lines, cut at the borders of the domain.
std::vector<Segment> mirror_lines(const BodyProblem& p) {
  const Grid& g = p.grid;
  const Symmetry& symmetry = p.design.symmetry();
  std::vector<Segment> out;
  if (symmetry.x) out.push_back({{*symmetry.x, g.y0}, {*symmetry.x, g.y0 + g.height}});
  if (symmetry.y) out.push_back({{g.x0, *symmetry.y}, {g.x0 + g.width, *symmetry.y}});
  return out;
}

/// Returns the union of components and discs with fillets. Fillets do not extend into void regions.
std::vector<Region> filled(const BodyProblem& p, std::span<const Component> components,
                           std::span<const std::vector<Vec2>> discs, double tolerance) {
  std::vector<Region> out =
      with_fillets(regions_of(p, components, tolerance, discs), domain_of(p), p.fillets, tolerance);
  if (p.empty.empty()) return out;
  std::vector<Region> clipped;
  for (const Region& piece : out) {
    const std::vector<std::vector<Vec2>> outer = {piece.outer};
    std::vector<std::vector<Vec2>> voids = p.empty;
    voids.insert(voids.end(), piece.holes.begin(), piece.holes.end());
    for (Region& left : unite(outer, domain_of(p), voids)) clipped.push_back(std::move(left));
  }
  return clipped;
}

/// Returns the violations of the minimum width of material, narrowest first: one for each
/// neighbourhood of the size of that width.
std::vector<LengthScaleViolation> too_narrow(const BodyProblem& p,
                                             std::span<const Region> regions) {
  constexpr double kWidthTolerance = 0.99;
  std::vector<LengthScaleViolation> out;
  for (const LengthScaleViolation& location :
       length_scale_violations_of(p, regions, kWidthTolerance * p.widths.solid)) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const LengthScaleViolation& other) {
      return (other.center - location.center).norm() < p.widths.solid;
    });
    if (location.solid && !known) out.push_back(location);
  }
  return out;
}

/// Returns true if the components satisfy the minimum width except for a few small violations.
/// Violations in fillings of gaps and corners do not count, because widening corrects them.
bool has_nearly_widths(std::span<const LengthScaleViolation> narrow,
                       std::span<const Region> union_of_all, double wanted) {
  constexpr double kNarrowest = 0.5;
  constexpr int kMaxRounds = 6;
  const auto is_of_components = [&](const LengthScaleViolation& location) {
    return std::any_of(union_of_all.begin(), union_of_all.end(),
                       [&](const Region& piece) { return contains(piece, location.center); });
  };
  int few = 0;
  for (const LengthScaleViolation& location : narrow) {
    if (!is_of_components(location)) continue;
    if (location.width < kNarrowest * wanted || ++few > kMaxRounds) return false;
  }
  return true;
}

/// Returns the union of the components with fillets, and with discs where it is narrower than the
/// minimum width, which happens for fillings beside holes and across gaps.
FinishedPart widened(const BodyProblem& p, std::span<const Component> components,
                     double tolerance) {
  constexpr int kRounds = 3;
  constexpr double kDisc = 1.02;  // diameter of a disc [minimum widths]
  std::vector<std::vector<Vec2>> discs;
  std::optional<std::vector<Region>> bare;  // the union without fillets
  FinishedPart out{filled(p, components, {}, tolerance), 0};
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<LengthScaleViolation> narrow = too_narrow(p, out.regions);
    if (narrow.empty()) break;
    if (!bare) bare = regions_of(p, components, tolerance);
    out.has_widths = has_nearly_widths(narrow, *bare, p.widths.solid);
    if (!out.has_widths) break;
    for (const LengthScaleViolation& location : narrow)
      discs.push_back(circle_within(location.center, 0.5 * kDisc * p.widths.solid, tolerance));
    out = {filled(p, components, discs, tolerance), static_cast<int>(discs.size())};
  }
  return out;
}

}  // namespace

FinishedPart finished_part(const BodyProblem& p, std::span<const Component> components,
                           double tolerance) {
  if (p.part) return {*p.part, 0};
  if (!(p.fillets.radius > 0)) return {regions_of(p, components, tolerance), 0};
  FinishedPart out = widened(p, components, tolerance);
  const std::vector<Segment> mirrors = mirror_lines(p);
  if (!mirrors.empty()) out.regions = symmetric_where_possible(p, std::move(out.regions));
  if (!out.has_widths) return out;
  out.regions = smoothed_part(p, out.regions, mirrors, tolerance);
  if (!mirrors.empty()) out.regions = symmetric_where_possible(p, std::move(out.regions));
  return out;
}

std::vector<Region> part_of(const BodyProblem& p, std::span<const Component> components,
                            double tolerance) {
  return finished_part(p, components, tolerance).regions;
}

namespace {

/// Returns true if the finished part differs from the union of the components.
bool is_finished(const BodyProblem& p) { return p.part || p.fillets.radius > 0; }

double fine(const BodyProblem& p) { return kOutlineTolerance * p.grid.dx(); }

}  // namespace

std::optional<FinishedPart> part_where_united(const BodyProblem& p,
                                              std::span<const Component> components) {
  try {
    return finished_part(p, components, fine(p));
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input || is_finished(p)) throw;
    return {};
  }
}

VectorXd part_fractions(const BodyProblem& p, std::span<const Component> components) {
  if (!is_finished(p)) return fractions_of(p, components);
  return part_fractions(p, components, finished_part(p, components, fine(p)));
}

VectorXd part_fractions(const BodyProblem& p, std::span<const Component> components,
                        const FinishedPart& part) {
  if (!is_finished(p)) return fractions_of(p, components);
  std::vector<Region> filled = part.regions;
  for (const std::vector<Vec2>& bore : p.bores) filled.push_back({bore, {}});
  VectorXd out = area_fractions(p.grid, filled);
  leave_out(p.outside, out);
  return out;
}

}  // namespace flexmorph::mmc
