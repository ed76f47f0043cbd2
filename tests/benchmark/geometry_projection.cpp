#include "tests/benchmark/geometry_projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "fem/solve/static_solver.h"
#include "geometry/parts/part_mesh.h"

namespace flexmorph::benchmark {
namespace {

constexpr double kRadius = 0.5, kMinimum = 1e-6;
constexpr double kAggregation = 10, kSaturation = 100, kStiffnessPower = 3;
constexpr double kOutline = 1e-3;  // allowed deviation of outlines [m]

/// Returns the fraction of a disc that is inside of a straight line at a distance from its centre.
double part_inside(double outside) {
  const double t = std::clamp(outside / kRadius, -1.0, 1.0);
  return kMinimum + (1 - kMinimum) * (std::acos(t) - t * std::sqrt(1 - t * t)) / std::numbers::pi;
}

double element_part(const ProjectedFeature& feature, const Vec2& center) {
  const double g = kRadius / std::numbers::sqrt3;
  double sum = 0;
  for (const double x : {-g, g})
    for (const double y : {-g, g}) sum += part_inside(feature.outside(center + Vec2(x, y)));
  return 0.25 * sum;
}

/// Returns log(mean exp(k z))/k.
double aggregated(const VectorXd& z) {
  const double largest = z.maxCoeff();
  return largest + std::log((kAggregation * (z.array() - largest)).exp().mean()) / kAggregation;
}

double saturated(double y, double full) {
  const auto s = [](double t) {
    return -std::log(std::exp(-kSaturation) + 1 / (std::exp(kSaturation * t) + 1)) / kSaturation;
  };
  return (s(y / full) - s(0)) / (1 - s(0));
}

double distance_to(std::span<const std::vector<Vec2>> rings, const Vec2& point) {
  double out = INFINITY;
  for (const std::vector<Vec2>& ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k)
      out = std::min(out, distance(Segment{ring[k], ring[(k + 1) % ring.size()]}, point));
  return out;
}

ProjectedFeature feature_of(std::vector<Region> regions) {
  std::vector<std::vector<Vec2>> rings;
  for (const Region& r : regions)
    for (std::vector<Vec2>& ring : rings_of(r)) rings.push_back(std::move(ring));
  return {[regions = std::move(regions), rings = std::move(rings)](const Vec2& p) {
    const bool inside = std::any_of(regions.begin(), regions.end(),
                                    [&](const Region& r) { return contains(r, p); });
    return inside ? -distance_to(rings, p) : distance_to(rings, p);
  }};
}

}  // namespace

ProjectedFeature round_bar(const Vec2& center, double length, double thickness, double angle,
                           double mass) {
  const Vec2 half = 0.5 * length * Vec2(std::cos(angle), std::sin(angle));
  const Segment axis{center - half, center + half};
  return {[=](const Vec2& p) { return distance(axis, p) - 0.5 * thickness; }, mass};
}

ProjectedFeature feature_of(const Component& component, double min_half_thickness) {
  return feature_of({Region{outline_within(component, min_half_thickness, kOutline), {}}});
}

ProjectedFeature feature_of(std::span<const Component> components, double min_half_thickness,
                            const Box& box) {
  std::vector<std::vector<Vec2>> outlines;
  for (const Component& c : components)
    outlines.push_back(outline_within(c, min_half_thickness, kOutline));
  const Vec2 beyond = Vec2::Constant(4 * kRadius);
  return feature_of(unite(outlines, Box{box.lower - beyond, box.upper + beyond}));
}

ProjectedElements project(const Grid& grid, std::span<const ProjectedFeature> features) {
  const auto n = static_cast<Eigen::Index>(features.size());
  VectorXd one = VectorXd::Zero(n);
  one[0] = 1;
  const double full = aggregated(one);
  ProjectedElements out{VectorXd(grid.n_cells()), VectorXd(grid.n_cells())};
  VectorXd stiffness(n), density(n);
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j) {
      for (Eigen::Index f = 0; f < n; ++f) {
        const ProjectedFeature& feature = features[static_cast<std::size_t>(f)];
        const double part = element_part(feature, grid.cell_center(i, j));
        stiffness[f] = part * std::pow(feature.mass, kStiffnessPower);
        density[f] = part * feature.mass;
      }
      out.stiffness[grid.cell(i, j)] = saturated(aggregated(stiffness), full);
      out.density[grid.cell(i, j)] = saturated(aggregated(density), full);
    }
  return out;
}

double short_cantilever(const Grid& grid, const VectorXd& stiffness) {
  std::vector<fem::HeldUnknown> held;
  for (int j = 0; j <= grid.ny; ++j)
    for (int c = 0; c < 2; ++c) held.push_back({grid.node(0, j), c});
  const fem::PlaneSection section{1, 1, 0.3, 0};
  fem::StaticSolver solver(grid, section, held);
  solver.factorize(stiffness);
  MatrixXd load = MatrixXd::Zero(1, solver.n_unknowns());
  const int loaded = solver.row(grid.node(grid.nx, grid.ny / 2), 1);
  load(0, loaded) = -1;
  solver.solve(load);
  return -load(0, loaded);
}

}  // namespace flexmorph::benchmark
