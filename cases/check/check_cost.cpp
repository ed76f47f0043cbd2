#include "cases/check/check_cost.h"

#include <algorithm>
#include <cmath>

#include "cases/assembly/resource_estimate.h"
#include "cases/scene/elements/row.h"

namespace flexmorph::cases {
namespace {

// Mean numbers per time step of Newton's method: evaluations of the force (the evaluation of the
// energies counts as one), linear solutions, and tangents. With material flow a tangent is outdated
// sooner.
constexpr double kForces = 7, kSolutions = 5, kTangents = 0.1, kTangentsOfFlow = 0.4;
constexpr double kStaticIterations = 3;  // per step of a static path, each with a new tangent

// Operations of a sparse factorization divided by n b², for n unknowns and the bandwidth b.
// Copying, ordering and scattering cost more than the multiplications.
constexpr double kFactor = 6;

// Operations of the matrices of a moving element, which equal elements across share, and of the
// power of a moving element.
constexpr double kRefresh = 1e6, kPower = 3e5;
// Operations per Gauss point of an element in a body with free lines: shape functions and forces.
constexpr double kFreePoint = 1e4;
// Operations per rigid body, constraint row or spring.
constexpr double kRigid = 1e3;

/// Returns the number of Gauss points of an element.
double points_of(const Body& body) {
  const double n = body.number("bending_points");
  return 49 + n * n;
}

// Rates of one core [operations/s] of motions and of factorizations; seconds per frame and per
// point of a frame, per cell of a design and iteration; seconds of the start, plots and the report.
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
    out.forces += times(kForces) * n *
                  (body.has_eulerian_lines() ? kFreePoint * points_of(body) : each.force);
    out.tangents += tangents * n * each.tangent;
    // Nodes are numbered along the shorter side, so that the bandwidth is about one row of nodes.
    const double vectors = element.n_shapes() / (body.row->across ? 4.0 : 2.0);
    const double across = body.row->across ? std::min(body.elements[0], body.elements[1]) + 2 : 1;
    const double band = across * vectors * element.dim();
    out.solver += built.n_dofs() * band * (tangents * kFactor * band + 4 * times(kSolutions));
    if (body.flow)
      out.flow +=
          kRefresh * (body.has_uniform_mesh() ? body.elements[0] : 1) + body.elements[1] * kPower;
  }
  const auto rows = static_cast<double>(4 * scene.rigid_bodies.size() + scene.springs.size()) +
                    mechanism.model.n_constraints();
  out.forces += times(kForces) * kRigid * rows;
  return out;
}

namespace {

/// Returns the estimated operations of one factorization and solution of a design problem.
double design_operations(const Scene& scene, const BodyDesign& d) {
  const Grid& g = d.grid;
  const double n = 2.0 * (g.nx + 1) * (g.ny + 1);
  if (scene.domain) {
    // Nested dissection takes O(n^1.5) operations; each load is solved with both triangular
    // factors.
    const double loads = static_cast<double>(scene.domain->loads.size());
    return 10 * std::pow(n, 1.5) + loads * 4 * n * 24 * std::log2(1.0 + std::min(g.nx, g.ny));
  }
  // Nodes are in natural order from the free end, so that the bandwidth is ny + 2 nodes.
  const double band = 2.0 * g.ny + 5, loads = scene.esl->count(scene.time.end);
  return n * band * (band + 3 * loads);
}

/// Returns the CPU time of motions on the cells of the designs [s]: at most one motion per cycle,
/// and the motion with uniform material.
double cells_seconds(const Scene& scene, const ResourceEstimate& resource_estimate) {
  const Scene cells = on_cells(scene, scene.verify->cells);
  double step = 0;
  for (const BodyDesign& d : cells.designs) {
    const Body& body = cells.body(d.body);
    const auto one =
        body.row->make(body, cells.time.end,
                       {1, 1});  // one element only; its operations do not depend on the mesh
    const ElementOperations each = body.row->operations(body, *one);
    const double along = 0.5 * (body.length + body.longest(cells.time.end)) / body.cell,
                 across = body.elements[1], band = (std::min(along, across) + 2) * body.dim(),
                 tangents = body.flow ? kTangentsOfFlow : kTangents;
    step += along * across * (kForces * each.force + tangents * each.tangent);
    step += along * across * body.dim() * band * (tangents * kFactor * band + 4 * kSolutions);
  }
  return resource_estimate.steps * step * (scene.cycle.max_cycles + 1) / kMotionRate;
}

}  // namespace

double expected_seconds(const Scene& scene, const Mechanism* mechanism) {
  const ResourceEstimate resource_estimate = estimate_resources(scene);
  double out = kStart;
  if (mechanism != nullptr) {
    const double step = scene.time.integrator == "minimal_coordinates"
                            ? kRigid * 1e2
                            : step_operations(scene, *mechanism).total();
    // The verification computes two motions on a finer mesh; each cycle computes one for the loads.
    const double finer = !scene.verify || scene.verifies_on_cells() ? 0
                         : scene.verify->mesh                       ? 4
                                              : std::pow(scene.verify->refine, 2);
    const double cycles = resource_estimate.iterations > 0 ? scene.cycle.max_cycles + 2 : 1;
    out += resource_estimate.steps * step * (cycles + 2 * finer) / kMotionRate;
    if (scene.verifies_on_cells()) out += cells_seconds(scene, resource_estimate);
    out += resource_estimate.frames * kFrameSeconds * static_cast<double>(scene.bodies.size());
  }
  for (const BodyDesign& d : scene.designs) {
    const double iterations =
        resource_estimate.iterations / static_cast<double>(scene.designs.size());
    const double cells = 1.0 * d.grid.nx * d.grid.ny;
    out += iterations * (design_operations(scene, d) / kFactorRate + cells * kCellSeconds);
    if (mechanism != nullptr) out += resource_estimate.frames * cells * kPointSeconds;
  }
  return out;
}

}  // namespace flexmorph::cases
