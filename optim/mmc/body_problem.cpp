#include "optim/mmc/body_problem.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace flexmorph::mmc {
namespace {

std::vector<Vec2> corners_of(const Box& b) {
  return {b.lower, {b.upper.x(), b.lower.y()}, b.upper, {b.lower.x(), b.upper.y()}};
}

}  // namespace

double judged_compliance(const BodyProblem& problem, LoadResponse& loads,
                         const CellFactors& factors) {
  if (problem.goal.over == Goal::Over::worst)
    return loads.individual(factors.stiffness, factors.mass).maxCoeff();
  LoadResponse::Value value;
  loads.evaluate(factors.stiffness, factors.mass, value);
  return value.f;
}

Ersatz ersatz_of(const BodyProblem& p) {
  return {p.grid, p.stages.back().alpha, p.solid, p.empty, p.outside};
}

VectorXd fractions_of(const BodyProblem& p, std::span<const Component> components) {
  VectorXd out =
      area_fractions(p.grid, components, p.stages.back().min_half_thickness, p.solid, p.empty);
  for (size_t c = 0; c < p.outside.size(); ++c)
    if (p.outside[c]) out[static_cast<Eigen::Index>(c)] = 0;
  return out;
}

std::vector<Vec2> domain_of(const BodyProblem& p) {
  if (!p.domain.empty()) return p.domain;
  const Grid& g = p.grid;
  return corners_of({{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}});
}

std::vector<Region> regions_of(const BodyProblem& p, std::span<const Component> components,
                               double tolerance) {
  std::vector<std::vector<Vec2>> outlines, voids;
  for (const Component& c : components)
    outlines.push_back(outline_within(c, p.stages.back().min_half_thickness, tolerance));
  for (const Box& b : p.solid) outlines.push_back(corners_of(b));
  for (const Box& b : p.empty) voids.push_back(corners_of(b));
  return unite(outlines, domain_of(p), voids);
}

namespace {

/// Is the point on the boundary of the box?
bool bounds(const Box& box, const Vec2& p, double small) {
  const auto within = [&](double margin) {
    return (p.array() > box.lower.array() - margin).all() &&
           (p.array() < box.upper.array() + margin).all();
  };
  return within(small) && !within(-small);
}

std::optional<Features> measured(const BodyProblem& problem,
                                 std::span<const Component> components) {
  try {
    return features_of(problem,
                       regions_of(problem, components, kOutlineTolerance * problem.grid.dx()));
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::input) throw;
    return {};
  }
}

}  // namespace

std::vector<NarrowPlace> narrow_places_of(const BodyProblem& problem,
                                          std::span<const Region> regions, double limit) {
  std::vector<NarrowPlace> out = narrow_places(regions, domain_of(problem), limit);
  const double small = 1e-6 * problem.grid.dx();
  std::erase_if(out, [&](const NarrowPlace& place) {
    return place.solid &&
           std::any_of(problem.solid.begin(), problem.solid.end(), [&](const Box& box) {
             return bounds(box, place.a, small) && bounds(box, place.b, small);
           });
  });
  return out;
}

Features features_of(const BodyProblem& problem, std::span<const Region> regions) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Features out{kInfinity, kInfinity};
  for (const NarrowPlace& p : narrow_places_of(problem, regions, kInfinity)) {
    double& smallest = p.solid ? out.solid : out.gap;
    smallest = std::min(smallest, p.width);
  }
  return out;
}

SharpDesign sharp_design(const BodyProblem& problem, std::span<const Component> components,
                         LoadResponse& loads) {
  SharpDesign out;
  out.fractions = fractions_of(problem, components);
  const Ersatz ersatz = ersatz_of(problem);
  out.volume = out.fractions.sum() / ersatz.n_domain_cells();
  out.connectivity = connectivity(problem.grid, out.fractions, problem.places);
  out.compliance = judged_compliance(problem, loads, ersatz.sharp(out.fractions));
  out.features = measured(problem, components);
  return out;
}

fem::Factors dynamic_factors(const BodyProblem& problem, std::span<const Component> components) {
  CellFactors f =
      Ersatz::dynamic(fractions_of(problem, components), problem.stiffness_void, problem.mass_void);
  return {problem.grid, std::move(f.stiffness), std::move(f.mass)};
}

}  // namespace flexmorph::mmc
