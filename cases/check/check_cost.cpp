#include "cases/check/check_cost.h"

#include <algorithm>
#include <cmath>

#include "cases/assembly/resource_estimate.h"
#include "cases/scene/elements/row.h"

namespace flexmorph::cases {
namespace {

// Of Newton's method: evaluations of the force in a step, the energies counted as one more, and
// tangents; where material flows a tangent is soon out of date.
constexpr double kForces = 7, kSolutions = 5, kTangents = 0.1, kTangentsOfFlow = 0.4;
constexpr double kStaticIterations = 3;  // of a step of a path, each with a tangent of its own

// Sparse solvers copy, order and scatter more than they multiply: per n b² of a band b.
constexpr double kFactor = 6;

// Of a moving element: its matrices, with those of its neighbours where they are alike; its power.
constexpr double kRefresh = 1e6, kPower = 3e5;
// Of a Gauss point of an element in a body with free lines, tables and forces.
constexpr double kFreePoint = 1e4;
// Of a rigid body, a joint row or a spring.
constexpr double kRigid = 1e3;

/// Gauss points of an element.
double points_of(const Body& body) {
  const double n = body.number("bending_points");
  return 49 + n * n;
}

// Of one core: operations of a motion, of dense and sparse factors; seconds of a frame with its
// points, of a cell of a design in an iteration; of the start, plots and the report.
constexpr double kMotionRate = 5e9, kFactorRate = 1.2e10, kFrameSeconds = 1e-3,
                 kPointSeconds = 2e-7;
constexpr double kCellSeconds = 1.5e-6, kStart = 0.1;

}  // namespace

StepOperations step_operations(const Scene& scene, const Mechanism& mechanism) {
  StepOperations out;
  const auto times = [&](double in_time) { return scene.statics ? kStaticIterations : in_time; };
  for (const Body& body : scene.bodies) {
    const fem::Body& built = mechanism.model.body(body.name);
    const fem::Element& element = *built.element;
    const double n = element.n_elements(),
                 tangents = times(body.flow ? kTangentsOfFlow : kTangents);
    const ElementOperations each = body.row->operations(body, element);
    out.forces +=
        times(kForces) * n * (body.has_free_lines() ? kFreePoint * points_of(body) : each.force);
    out.tangents += tangents * n * each.tangent;
    // Nodes in order along the shorter side: a band of one row of them and a bit.
    const double vectors = element.n_shapes() / (body.row->across ? 4.0 : 2.0);
    const double across = body.row->across ? std::min(body.elements[0], body.elements[1]) + 2 : 1;
    const double band = across * vectors * element.dim();
    out.solver += built.n_dofs() * band * (tangents * kFactor * band + 4 * times(kSolutions));
    if (body.flow)
      out.flow += kRefresh * (body.is_even() ? body.elements[0] : 1) + body.elements[1] * kPower;
  }
  const auto rows = static_cast<double>(4 * scene.rigid_bodies.size() + scene.springs.size()) +
                    mechanism.model.n_constraints();
  out.forces += times(kForces) * kRigid * rows;
  return out;
}

namespace {

double design_operations(const Scene& scene, const BodyDesign& d) {
  const Grid& g = d.grid;
  const double n = 2.0 * (g.nx + 1) * (g.ny + 1);
  if (scene.domain) {
    // Nested dissection: of the order n^1.5, each load twice through the factor.
    const double loads = static_cast<double>(scene.domain->loads.size());
    return 10 * std::pow(n, 1.5) + loads * 4 * n * 24 * std::log2(1.0 + std::min(g.nx, g.ny));
  }
  // Natural order from the free end: a band of ny + 2 nodes.
  const double band = 2.0 * g.ny + 5, loads = scene.esl->count(scene.time.end);
  return n * band * (band + 3 * loads);
}

/// Of motions on the cells of the designs: one a cycle, at most, and that with uniform material.
double cells_seconds(const Scene& scene, const Extent& extent) {
  const Scene cells = on_cells(scene, scene.verify->cells);
  double step = 0;
  for (const BodyDesign& d : cells.designs) {
    const Body& body = cells.body(d.body);
    const auto one = body.row->make(body, cells.time.end, {1, 1});  // a few cells, not all
    const ElementOperations each = body.row->operations(body, *one);
    const double along = 0.5 * (body.length + body.longest(cells.time.end)) / body.cell,
                 across = body.elements[1], band = (std::min(along, across) + 2) * body.dim(),
                 tangents = body.flow ? kTangentsOfFlow : kTangents;
    step += along * across * (kForces * each.force + tangents * each.tangent);
    step += along * across * body.dim() * band * (tangents * kFactor * band + 4 * kSolutions);
  }
  return extent.steps * step * (scene.cycle.max_cycles + 1) / kMotionRate;
}

}  // namespace

double expected_seconds(const Scene& scene, const Mechanism* mechanism) {
  const Extent extent = extent_of(scene);
  double out = kStart;
  if (mechanism != nullptr) {
    const double step = scene.time.integrator == "minimal_coordinates"
                            ? kRigid * 1e2
                            : step_operations(scene, *mechanism).total();
    // A finer mesh in the two motions of the verification; one motion per cycle for the loads.
    const double finer = !scene.verify || scene.judges_on_cells() ? 0
                         : scene.verify->mesh                     ? 4
                                              : std::pow(scene.verify->refine, 2);
    const double cycles = extent.iterations > 0 ? scene.cycle.max_cycles + 2 : 1;
    out += extent.steps * step * (cycles + 2 * finer) / kMotionRate;
    if (scene.judges_on_cells()) out += cells_seconds(scene, extent);
    out += extent.frames * kFrameSeconds * static_cast<double>(scene.bodies.size());
  }
  for (const BodyDesign& d : scene.designs) {
    const double iterations = extent.iterations / static_cast<double>(scene.designs.size());
    const double cells = 1.0 * d.grid.nx * d.grid.ny;
    out += iterations * (design_operations(scene, d) / kFactorRate + cells * kCellSeconds);
    if (mechanism != nullptr) out += extent.frames * cells * kPointSeconds;
  }
  return out;
}

}  // namespace flexmorph::cases
