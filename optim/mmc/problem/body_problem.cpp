#include "optim/mmc/problem/body_problem.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/cpu_time.h"
#include "geometry/line_gaps.h"
#include "geometry/part_mesh.h"
#include "geometry/smoothing.h"

namespace flexmorph::mmc {
double design_compliance(const BodyProblem& problem, ComplianceEvaluator& loads,
                         const CellFactors& factors) {
  if (compliance_row(problem.goal).per_load)
    return loads.individual(factors.stiffness, factors.mass).maxCoeff();
  return loads.sum(factors.stiffness, factors.mass);
}

Figures further_values(const BodyProblem& problem, std::span<const Component> components,
                       ComplianceEvaluator& loads, const CellFactors& factors) {
  DesignState state(loads);
  Figures out;
  for (const ResponseRow* row : further_rows(problem.goal)) {
    Values values;
    row->make(plate_of(problem))->evaluate({factors, components, state}, values);
    out[key_of(*row)] = values.f.maxCoeff();
  }
  return out;
}

Figures full_values(const BodyProblem& problem, ComplianceEvaluator& loads) {
  const std::vector<Limit>& limits = problem.goal.limits;
  if (std::none_of(limits.begin(), limits.end(), [](const Limit& l) { return l.wants_material(); }))
    return {};
  const Grid& grid = problem.grid;
  const double size = grid.width + grid.height;
  const Component all{
      {grid.x0 + grid.width / 2, grid.y0 + grid.height / 2}, size, 0, size, size, size};
  const CellFactors full = ersatz_of(problem).sharp(fractions_of(problem, {&all, 1}));
  Figures values = further_values(problem, {&all, 1}, loads, full), out;
  values[key_of(compliance_row(problem.goal))] = design_compliance(problem, loads, full);
  for (const Limit& limit : limits)
    if (limit.wants_material()) out[key_of(*limit.row)] = values.at(key_of(*limit.row));
  return out;
}

Plate plate_of(const BodyProblem& p) { return {p.grid, p.section, p.outside}; }

double full_mass_of(const BodyProblem& p) { return plate_of(p).full_mass(); }

Ersatz ersatz_of(const BodyProblem& p) {
  return {p.grid, p.bands.back().alpha, p.solid, p.empty, p.outside};
}

namespace {

void leave_out(const std::vector<signed char>& outside, VectorXd& fractions) {
  for (size_t c = 0; c < outside.size(); ++c)
    if (outside[c]) fractions[static_cast<Eigen::Index>(c)] = 0;
}

}  // namespace

VectorXd fractions_of(const BodyProblem& p, std::span<const Component> components) {
  VectorXd out =
      area_fractions(p.grid, components, p.bands.back().min_half_thickness, p.solid, p.empty);
  leave_out(p.outside, out);
  return out;
}

void update_fractions(const BodyProblem& p, std::span<const Component> components,
                      std::span<const Component> changed, VectorXd& fractions) {
  if (changed.empty()) return;
  const double floor = p.bands.back().min_half_thickness;
  double left = std::numeric_limits<double>::infinity(), right = -left;
  for (const Component& c : changed) {
    const Box box = bounding_box(c, floor, 0);
    left = std::min(left, box.lower.x());
    right = std::max(right, box.upper.x());
  }
  update_area_fractions(p.grid, components, floor, p.solid, p.empty, left, right, fractions);
  leave_out(p.outside, fractions);
}

Region domain_of(const BodyProblem& p) {
  if (!p.domain.outer.empty()) return p.domain;
  const Grid& g = p.grid;
  return {corners_of({{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}}), {}};
}

std::vector<std::vector<Vec2>> fixed_rings(const BodyProblem& p) {
  std::vector<std::vector<Vec2>> out = rings_of(domain_of(p));
  out.insert(out.end(), p.solid.begin(), p.solid.end());
  out.insert(out.end(), p.empty.begin(), p.empty.end());
  return out;
}

namespace {

/// The union of components and further polygons, see regions_of().
std::vector<Region> united(const BodyProblem& p, std::span<const Component> components,
                           std::span<const std::vector<Vec2>> further, double tolerance) {
  std::vector<std::vector<Vec2>> outlines(further.begin(), further.end());
  for (const Component& c : components)
    outlines.push_back(outline_within(c, p.bands.back().min_half_thickness, tolerance));
  outlines.insert(outlines.end(), p.solid.begin(), p.solid.end());
  return unite(outlines, domain_of(p), p.empty);
}

}  // namespace

std::vector<Region> regions_of(const BodyProblem& p, std::span<const Component> components,
                               double tolerance) {
  return united(p, components, {}, tolerance);
}

namespace {

std::vector<Vec2> mirrored(std::vector<Vec2> ring, const Symmetry& line) {
  for (Vec2& p : ring) {
    if (line.x) p.x() = 2 * *line.x - p.x();
    if (line.y) p.y() = 2 * *line.y - p.y();
  }
  if (line.x.has_value() != line.y.has_value()) std::reverse(ring.begin(), ring.end());
  return ring;
}

/// Puts vertices that are on a mirror line but for round-off onto it: nothing between them and the
/// line is left over.
void snap_to_mirrors(const BodyProblem& p, Region& region) {
  constexpr double kRoundOff = 1e-9;  // cells
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

/// The lower, left side of regions and its mirror images.
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

/// The same, or the regions themselves where rounded vertices at the line make a polygon that
/// crosses itself: these are symmetric to the tolerance.
std::vector<Region> symmetric_where_possible(const BodyProblem& p, std::vector<Region> regions) {
  try {
    return made_symmetric(p, regions);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) throw;
    return regions;
  }
}

/// The smoothed regions. What smoothing would make narrower than asked for keeps its shape.
std::vector<Region> smoothed_part(const BodyProblem& p, std::span<const Region> regions,
                                  std::span<const Segment> mirrors, double tolerance) {
  const std::vector<std::vector<Vec2>> fixed = fixed_rings(p);
  std::vector<Region> out = smoothed(regions, fixed, mirrors, {}, p.widths.solid, tolerance);
  std::vector<Vec2> kept;
  for (const NarrowPlace& place : narrow_places_of(p, out, p.widths.largest()))
    if (place.width < p.widths.of(place)) kept.insert(kept.end(), {place.a, place.b});
  if (kept.empty()) return out;
  return smoothed(regions, fixed, mirrors, kept, p.widths.solid, tolerance);
}

/// The lines of symmetry across the domain.
std::vector<Segment> mirror_lines(const BodyProblem& p) {
  const Grid& g = p.grid;
  const Symmetry& symmetry = p.design.symmetry();
  std::vector<Segment> out;
  if (symmetry.x) out.push_back({{*symmetry.x, g.y0}, {*symmetry.x, g.y0 + g.height}});
  if (symmetry.y) out.push_back({{g.x0, *symmetry.y}, {g.x0 + g.width, *symmetry.y}});
  return out;
}

}  // namespace

namespace {

/// The union of components and discs with its fillets, which do not fill void regions.
std::vector<Region> filled(const BodyProblem& p, std::span<const Component> components,
                           std::span<const std::vector<Vec2>> discs, double tolerance) {
  std::vector<Region> out = united(p, components, discs, tolerance);
  if (!(p.fillets.radius > 0)) return out;
  out = with_fillets(out, domain_of(p), p.fillets, tolerance);
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

/// Where material is narrower than asked for, one place for each neighbourhood, narrowest first.
std::vector<NarrowPlace> too_narrow(const BodyProblem& p, std::span<const Region> regions) {
  constexpr double kEnough = 0.99;
  std::vector<NarrowPlace> out;
  for (const NarrowPlace& place : narrow_places_of(p, regions, kEnough * p.widths.solid)) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const NarrowPlace& other) {
      return (other.center - place.center).norm() < p.widths.solid;
    });
    if (place.solid && !known) out.push_back(place);
  }
  return out;
}

/// The same with discs where material is narrow, as fillings beside holes can be.
FinishedPart widened(const BodyProblem& p, std::span<const Component> components,
                     double tolerance) {
  constexpr int kRounds = 3;
  constexpr double kNarrowest = 0.5, kDisc = 1.02;  // smallest widths
  constexpr std::size_t kMost = 6;
  std::vector<std::vector<Vec2>> discs;
  FinishedPart out{filled(p, components, {}, tolerance), 0};
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<NarrowPlace> narrow = too_narrow(p, out.regions);
    if (narrow.empty()) break;
    out.has_widths = narrow.size() <= kMost && narrow[0].width >= kNarrowest * p.widths.solid;
    if (!out.has_widths) break;
    for (const NarrowPlace& place : narrow)
      discs.push_back(circle_within(place.center, 0.5 * kDisc * p.widths.solid, tolerance));
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

VectorXd cells_of(const BodyProblem& p, std::vector<Region> regions) {
  for (const std::vector<Vec2>& bore : p.bores) regions.push_back({bore, {}});
  VectorXd out = area_fractions(p.grid, regions);
  leave_out(p.outside, out);
  return out;
}

/// Is the part more than the union of the components?
bool is_finished(const BodyProblem& p) { return p.part || p.fillets.radius > 0; }

}  // namespace

VectorXd part_fractions(const BodyProblem& p, std::span<const Component> components) {
  if (!is_finished(p)) return fractions_of(p, components);
  return cells_of(p, part_of(p, components, kOutlineTolerance * p.grid.dx()));
}

namespace {

/// Is the point on the polygon?
bool bounds(std::span<const Vec2> polygon, const Vec2& p, double small) {
  for (size_t k = 0; k < polygon.size(); ++k)
    if (distance({polygon[k], polygon[(k + 1) % polygon.size()]}, p) < small) return true;
  return false;
}

/// What holds and what loads the body.
std::vector<HeldOrLoaded> places_of(const BodyProblem& problem) {
  return problem.places.empty() ? ends_of(problem.grid) : problem.places;
}

/// Has the cell material of the region? Looked at in 4 x 4 points, its border included.
bool touches(const Grid& grid, const Region& region, int cell) {
  constexpr int kPoints = 4;
  const Vec2 size(grid.dx(), grid.dy());
  const Vec2 corner = grid.cell_center(cell / grid.ny, cell % grid.ny) - 0.5 * size;
  for (int k = 0; k < kPoints * kPoints; ++k) {
    const Vec2 share(k % kPoints / (kPoints - 1.0), k / kPoints / (kPoints - 1.0));
    if (contains(region, corner + share.cwiseProduct(size))) return true;
  }
  return false;
}

}  // namespace

namespace {

/// Do passive regions make the place by themselves? Both its contacts are on the outline of one, or
/// void that is given is on both sides of the material.
bool is_given(const BodyProblem& problem, const NarrowPlace& place) {
  const double small = 1e-6 * problem.grid.dx();
  const auto touches = [&](const std::vector<Vec2>& ring, const Vec2& p) {
    return bounds(ring, p, small);
  };
  const auto within = [&](const std::vector<Vec2>& region) {
    return touches(region, place.a) && touches(region, place.b);
  };
  const auto& regions = place.solid ? problem.solid : problem.empty;
  if (std::any_of(regions.begin(), regions.end(), within)) return true;
  if (!place.solid) return false;
  // A fillet at the end of a narrow solid region: the region has its width there.
  constexpr double kOwn = 0.5;
  const auto own = [&](const std::vector<Vec2>& region) {
    if (!contains({region, {}}, place.center)) return false;
    double near = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < region.size(); ++k)
      near = std::min(near, distance({region[k], region[(k + 1) % region.size()]}, place.center));
    return 2 * near >= kOwn * place.width && (touches(region, place.a) || touches(region, place.b));
  };
  if (std::any_of(problem.solid.begin(), problem.solid.end(), own)) return true;
  std::vector<std::vector<Vec2>> rings = rings_of(domain_of(problem));
  rings.insert(rings.end(), problem.empty.begin(), problem.empty.end());
  const auto ring_at = [&](const Vec2& p) {
    return std::find_if(rings.begin(), rings.end(),
                        [&](const std::vector<Vec2>& ring) { return touches(ring, p); });
  };
  const auto a = ring_at(place.a), b = ring_at(place.b);
  return a != rings.end() && b != rings.end() && a != b;
}

/// Gaps to held lines, but those that a passive region leaves.
std::vector<NarrowPlace> held_gaps(const BodyProblem& problem, std::span<const Region> regions,
                                   double limit) {
  std::vector<NarrowPlace> out = line_gaps(regions, problem.held, limit);
  const double small = 1e-6 * problem.grid.dx();
  const auto ends = [&](const std::vector<Vec2>& region, const Vec2& p) {
    return bounds(region, p, small);
  };
  std::erase_if(out, [&](const NarrowPlace& gap) {
    const auto any = [&](const std::vector<std::vector<Vec2>>& of) {
      return std::any_of(of.begin(), of.end(), [&](const auto& r) { return ends(r, gap.b); });
    };
    return any(problem.solid) || any(problem.empty) || !contains(domain_of(problem), gap.a);
  });
  return out;
}

}  // namespace

std::vector<NarrowPlace> narrow_places_of(const BodyProblem& problem,
                                          std::span<const Region> regions, double limit) {
  std::vector<NarrowPlace> out = narrow_places(regions, domain_of(problem), limit);
  std::erase_if(out, [&](const NarrowPlace& place) { return is_given(problem, place); });
  const std::vector<NarrowPlace> to_held = held_gaps(problem, regions, limit);
  out.insert(out.end(), to_held.begin(), to_held.end());
  std::stable_sort(out.begin(), out.end(),
                   [](const NarrowPlace& x, const NarrowPlace& y) { return x.width < y.width; });
  return out;
}

Features features_of(const BodyProblem& problem, std::span<const Region> regions) {
  Features out = smallest_features(regions, domain_of(problem), [&](const NarrowPlace& place) {
    return !is_given(problem, place);
  });
  for (const NarrowPlace& gap : held_gaps(problem, regions, out.gap))
    out.gap = std::min(out.gap, gap.width);
  return out;
}

Connectivity connectivity_of(const BodyProblem& problem, std::span<const Region> regions) {
  const std::vector<HeldOrLoaded> places = places_of(problem);
  std::vector<std::vector<bool>> touched;
  for (const Region& region : regions) {
    std::vector<bool>& piece = touched.emplace_back();
    for (const HeldOrLoaded& place : places)
      piece.push_back(std::any_of(place.cells.begin(), place.cells.end(),
                                  [&](int cell) { return touches(problem.grid, region, cell); }));
  }
  return flexmorph::connectivity_of(touched, places);
}

SharpDesign sharp_design(const BodyProblem& problem, std::span<const Component> components,
                         ComplianceEvaluator& loads) {
  SharpDesign out;
  const double tolerance = kOutlineTolerance * problem.grid.dx();
  double clock = thread_seconds();
  FinishedPart part;
  if (is_finished(problem)) part = finished_part(problem, components, tolerance);
  out.seconds_outlines = thread_seconds() - clock;
  out.fractions =
      is_finished(problem) ? cells_of(problem, part.regions) : fractions_of(problem, components);
  out.widened = part.widened;
  const Ersatz ersatz = ersatz_of(problem);
  out.volume = out.fractions.sum() / ersatz.n_domain_cells();
  const CellFactors sharp = ersatz.sharp(out.fractions);
  out.compliance = design_compliance(problem, loads, sharp);
  out.further = further_values(problem, components, loads, sharp);
  clock = thread_seconds();
  try {
    const std::vector<Region> regions =
        is_finished(problem) ? std::move(part.regions) : regions_of(problem, components, tolerance);
    out.volume = area(regions) / area(domain_of(problem));
    for (const ResponseRow* row : further_rows(problem.goal))
      if (row->even) out.further[key_of(*row)] = out.volume * row->full(plate_of(problem));
    out.connectivity = connectivity_of(problem, regions);
    out.features = features_of(problem, regions);
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) throw;
    out.connectivity = connectivity(problem.grid, out.fractions, problem.places);
  }
  out.seconds_outlines += thread_seconds() - clock;
  return out;
}

fem::Factors dynamic_factors(const BodyProblem& problem, std::span<const Component> components) {
  CellFactors f = Ersatz::dynamic(part_fractions(problem, components), problem.stiffness_void,
                                  problem.mass_void);
  return {problem.grid, std::move(f.stiffness), std::move(f.mass)};
}

}  // namespace flexmorph::mmc
