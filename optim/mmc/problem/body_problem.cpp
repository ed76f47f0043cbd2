#include "optim/mmc/problem/body_problem.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/cpu_time.h"
#include "geometry/parts/line_gaps.h"
#include "geometry/parts/part_mesh.h"
#include "optim/mmc/problem/finished_part.h"

namespace flexmorph::mmc {
double design_compliance(const BodyProblem& problem, ComplianceEvaluator& loads,
                         const CellScaleFactors& factors) {
  if (compliance_row(problem.goal).per_load)
    return loads.individual(factors.stiffness, factors.mass).maxCoeff();
  return loads.sum(factors.stiffness, factors.mass);
}

Figures further_values(const BodyProblem& problem, std::span<const Component> components,
                       ComplianceEvaluator& loads, const CellScaleFactors& factors) {
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
  const CellScaleFactors full = ersatz_of(problem).crisp(fractions_of(problem, {&all, 1}));
  Figures values = further_values(problem, {&all, 1}, loads, full), out;
  values[key_of(compliance_row(problem.goal))] = design_compliance(problem, loads, full);
  for (const Limit& limit : limits)
    if (limit.wants_material()) out[key_of(*limit.row)] = values.at(key_of(*limit.row));
  return out;
}

Plate plate_of(const BodyProblem& p) { return {p.grid, p.section, p.outside}; }

double full_mass_of(const BodyProblem& p) { return plate_of(p).full_mass(); }

double part_mass_of(const BodyProblem& p, double volume) {
  return volume * p.section.density * p.section.thickness * area(domain_of(p));
}

Ersatz ersatz_of(const BodyProblem& p) {
  return {p.grid, p.bands.back().alpha, p.solid, p.empty, p.outside};
}

void leave_out(const std::vector<signed char>& outside, VectorXd& fractions) {
  for (size_t c = 0; c < outside.size(); ++c)
    if (outside[c]) fractions[static_cast<Eigen::Index>(c)] = 0;
}

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

std::vector<Region> regions_of(const BodyProblem& p, std::span<const Component> components,
                               double tolerance, std::span<const std::vector<Vec2>> further) {
  std::vector<std::vector<Vec2>> outlines(further.begin(), further.end());
  for (const Component& c : components)
    outlines.push_back(outline_within(c, p.bands.back().min_half_thickness, tolerance));
  outlines.insert(outlines.end(), p.solid.begin(), p.solid.end());
  return unite(outlines, domain_of(p), p.empty);
}

namespace {

/// Returns true if a point lies on a polygon within a distance `small`.
bool bounds(std::span<const Vec2> polygon, const Vec2& p, double small) {
  for (size_t k = 0; k < polygon.size(); ++k)
    if (distance({polygon[k], polygon[(k + 1) % polygon.size()]}, p) < small) return true;
  return false;
}

/// Returns the supported and loaded cells of the body.
std::vector<HeldOrLoaded> locations_of(const BodyProblem& problem) {
  return problem.locations.empty() ? ends_of(problem.grid) : problem.locations;
}

/// Returns true if one of 4 x 4 points of the cell, its border included, lies in the region.
bool touches(const Grid& grid, const Region& region, int cell) {
  constexpr int kPoints = 4;
  const Vec2 size(grid.dx(), grid.dy());
  const Vec2 corner = grid.cell_center(cell / grid.ny, cell % grid.ny) - 0.5 * size;
  for (int k = 0; k < kPoints * kPoints; ++k) {
    const Vec2 share = Vec2(k % kPoints, k / kPoints) / (kPoints - 1);
    if (contains(region, corner + share.cwiseProduct(size))) return true;
  }
  return false;
}

}  // namespace

namespace {

/// Returns true if a narrow location results from passive regions alone: both of its contacts lie
/// on the outline of one passive region, or on two different borders of the domain or of void
/// regions.
bool is_given(const BodyProblem& problem, const LengthScaleViolation& location) {
  const double small = 1e-6 * problem.grid.dx();
  const auto touches = [&](const std::vector<Vec2>& ring, const Vec2& p) {
    return bounds(ring, p, small);
  };
  const auto within = [&](const std::vector<Vec2>& region) {
    return touches(region, location.a) && touches(region, location.b);
  };
  const auto& regions = location.solid ? problem.solid : problem.empty;
  if (std::any_of(regions.begin(), regions.end(), within)) return true;
  if (!location.solid) return false;
  // A fillet at the end of a narrow solid region: one contact lies on the region, which determines
  // the width there.
  constexpr double kOwnFraction = 0.5;
  const auto own = [&](const std::vector<Vec2>& region) {
    if (!contains({region, {}}, location.center)) return false;
    double near = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < region.size(); ++k)
      near =
          std::min(near, distance({region[k], region[(k + 1) % region.size()]}, location.center));
    return 2 * near >= kOwnFraction * location.width &&
           (touches(region, location.a) || touches(region, location.b));
  };
  if (std::any_of(problem.solid.begin(), problem.solid.end(), own)) return true;
  std::vector<std::vector<Vec2>> rings = rings_of(domain_of(problem));
  rings.insert(rings.end(), problem.empty.begin(), problem.empty.end());
  const auto ring_at = [&](const Vec2& p) {
    return std::find_if(rings.begin(), rings.end(),
                        [&](const std::vector<Vec2>& ring) { return touches(ring, p); });
  };
  const auto a = ring_at(location.a), b = ring_at(location.b);
  return a != rings.end() && b != rings.end() && a != b;
}

/// Returns the gaps between material and the lines that support it, without gaps that end at a
/// passive region.
std::vector<LengthScaleViolation> held_gaps(const BodyProblem& problem,
                                            std::span<const Region> regions, double limit) {
  std::vector<LengthScaleViolation> out = line_gaps(regions, problem.held, limit);
  const double small = 1e-6 * problem.grid.dx();
  const auto ends = [&](const std::vector<Vec2>& region, const Vec2& p) {
    return bounds(region, p, small);
  };
  std::erase_if(out, [&](const LengthScaleViolation& gap) {
    const auto any = [&](const std::vector<std::vector<Vec2>>& of) {
      return std::any_of(of.begin(), of.end(), [&](const auto& r) { return ends(r, gap.b); });
    };
    return any(problem.solid) || any(problem.empty) || !contains(domain_of(problem), gap.a);
  });
  return out;
}

}  // namespace

std::vector<LengthScaleViolation> length_scale_violations_of(const BodyProblem& problem,
                                                             std::span<const Region> regions,
                                                             double limit) {
  std::vector<LengthScaleViolation> out =
      length_scale_violations(regions, domain_of(problem), limit);
  std::erase_if(out,
                [&](const LengthScaleViolation& location) { return is_given(problem, location); });
  const std::vector<LengthScaleViolation> to_held = held_gaps(problem, regions, limit);
  out.insert(out.end(), to_held.begin(), to_held.end());
  std::stable_sort(out.begin(), out.end(),
                   [](const LengthScaleViolation& x, const LengthScaleViolation& y) {
                     return x.width < y.width;
                   });
  return out;
}

Features features_of(const BodyProblem& problem, std::span<const Region> regions) {
  Features out = smallest_features(
      regions, domain_of(problem),
      [&](const LengthScaleViolation& location) { return !is_given(problem, location); });
  for (const LengthScaleViolation& gap : held_gaps(problem, regions, out.gap))
    out.gap = std::min(out.gap, gap.width);
  return out;
}

std::optional<double> given_width_of(const BodyProblem& problem, std::span<const Region> regions) {
  constexpr double kWidthTolerance = 0.98;  // Polygons lie up to 0.01 cells within round outlines.
  const Region domain = domain_of(problem);
  // Without these, is_given() holds nowhere, and the medial axis need not be computed again.
  const bool can_be_given =
      !problem.solid.empty() || !problem.empty.empty() || !domain.holes.empty();
  if (!(problem.widths.solid > 0) || !can_be_given) return {};
  std::optional<double> out;
  for (const LengthScaleViolation& location :
       length_scale_violations(regions, domain, kWidthTolerance * problem.widths.solid))
    if (location.solid && is_given(problem, location) && !(out && *out <= location.width))
      out = location.width;
  return out;
}

Connectivity connectivity_of(const BodyProblem& problem, std::span<const Region> regions) {
  const std::vector<HeldOrLoaded> locations = locations_of(problem);
  std::vector<std::vector<bool>> touched;
  for (const Region& region : regions) {
    std::vector<bool>& piece = touched.emplace_back();
    for (const HeldOrLoaded& location : locations)
      piece.push_back(std::any_of(location.cells.begin(), location.cells.end(),
                                  [&](int cell) { return touches(problem.grid, region, cell); }));
  }
  return flexmorph::connectivity_of(touched, locations);
}

namespace {

/// Adds the results that follow from the outline of a part. Returns false where its widths cannot
/// be computed.
bool add_outline(const BodyProblem& problem, const FinishedPart& part, CrispDesign& out) {
  try {
    out.widened = part.widened;
    out.volume = area(part.regions) / area(domain_of(problem));
    for (const ResponseRow* row : further_rows(problem.goal))
      if (row->even) out.further[key_of(*row)] = out.volume * row->full(plate_of(problem));
    out.connectivity = connectivity_of(problem, part.regions);
    out.features = features_of(problem, part.regions);
    out.given_width = given_width_of(problem, part.regions);
    return true;
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) throw;
    return false;
  }
}

}  // namespace

CrispDesign crisp_design(const BodyProblem& problem, std::span<const Component> components,
                         ComplianceEvaluator& loads) {
  CrispDesign out;
  double clock = thread_seconds();
  const std::optional<FinishedPart> part = part_where_united(problem, components);
  out.seconds_outlines = thread_seconds() - clock;
  out.fractions =
      part ? part_fractions(problem, components, *part) : fractions_of(problem, components);
  const Ersatz ersatz = ersatz_of(problem);
  out.volume = out.fractions.sum() / ersatz.n_domain_cells();
  const CellScaleFactors crisp = ersatz.crisp(out.fractions);
  out.compliance = design_compliance(problem, loads, crisp);
  out.further = further_values(problem, components, loads, crisp);
  clock = thread_seconds();
  if (!part || !add_outline(problem, *part, out))
    out.connectivity = connectivity(problem.grid, out.fractions, problem.locations);
  out.seconds_outlines += thread_seconds() - clock;
  return out;
}

fem::ScaleFactors dynamic_factors(const BodyProblem& problem,
                                  std::span<const Component> components) {
  CellScaleFactors f = Ersatz::dynamic(part_fractions(problem, components), problem.stiffness_void,
                                       problem.mass_void);
  return {problem.grid, std::move(f.stiffness), std::move(f.mass)};
}

}  // namespace flexmorph::mmc
