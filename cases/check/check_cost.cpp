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

// Rates of one core [operations/s] of motions, of motions on cells, and of factorizations; seconds
// per frame and per point of a frame, per cell of a design and iteration; seconds of the start,
// plots and the report.
constexpr double kMotionRate = 6.5e9, kCellsRate = 3.8e9, kFactorRate = 1.2e10,
                 kFrameSeconds = 1e-3, kPointSeconds = 3e-6;
// Time of a motion on cells with its adjoint computation, divided by the time of the motion.
constexpr double kGradient = 3;
// Seconds per cell of an equivalent static load, which is made while the mechanism moves.
constexpr double kLoadCellSeconds = 2.5e-6;
constexpr double kCellSeconds = 1.5e-6, kStart = 0.25;
// Seconds per component: of the exact outline in an iteration, and of the files of the part.
// Seconds per cell of a frame of a design. Seconds of the verification of an outline: constant, per
// component, and per component and load.
constexpr double kOutlineSeconds = 5e-4, kExportSeconds = 0.015, kFrameCellSeconds = 1e-6,
                 kVerifiedSeconds = 0.3, kVerifiedComponent = 0.02, kVerifiedLoad = 2e-4;

/// Returns the CPU time of a crisp design with its fillets [s].
/// @param n  number of components; fitted to runs with 48, 160 and 400
double crisp_seconds(double n) { return 4e-3 * n + 3.6e-7 * n * n * n; }

/// Returns the CPU time of the constraints of widths in an iteration [s].
/// @param n  number of components; fitted to runs with 48, 64, 144, 160 and 400
double widths_seconds(double n) { return 1.5e-3 * n + 8e-8 * n * n * n; }

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

/// Returns the number of mesh lines of cells that are inserted or removed in a motion.
double line_changes(const Body& body, double end) {
  constexpr int kSamples = 400;
  double sum = 0;
  for (int k = 0; k < kSamples; ++k)
    sum += std::abs(body.length_at(end * (k + 1) / kSamples) - body.length_at(end * k / kSamples));
  return sum / body.cell;
}

/// Returns the CPU time of one motion on the cells of the designs [s].
/// @param parts  elements per cell of the designs in each direction
/// @param cell   size of the elements if they are larger than the cells [m]; 0: not larger
double cells_seconds(const Scene& scene, double steps, int parts, double cell = 0) {
  const Scene cells = on_cells(scene, parts);
  double step = 0;
  for (const BodyDesign& d : cells.designs) {
    const Body& body = cells.body(d.body);
    const auto one =
        body.row->make(body, cells.time.end,
                       {1, 1});  // one element only; its operations do not depend on the mesh
    const ElementOperations each = body.row->operations(body, *one);
    // With material flow, a tangent for every mesh line that is inserted or removed gives the
    // measured times of four shipped cases.
    const double larger = std::max(1.0, cell / body.cell),
                 along = 0.5 * (body.length + body.longest(cells.time.end)) / (larger * body.cell),
                 across = body.elements[1] / larger,
                 band = (std::min(along, across) + 2) * body.dim(),
                 tangents =
                     body.flow ? line_changes(body, cells.time.end) / (larger * steps) : kTangents;
    step += along * across * (kForces * each.force + tangents * each.tangent);
    step += along * across * body.dim() * band * (tangents * kFactor * band + 4 * kSolutions);
  }
  return steps * step / kCellsRate;
}

/// Returns the CPU time of one motion on cells with its adjoint computation [s].
/// @param cell  size of the cells [m]; 0: cells of the designs
/// @param step  time step [s]; 0: step of the scene
double gradient_seconds(const Scene& scene, double cell, double step) {
  const double given = estimate_resources(scene).steps;
  return kGradient * cells_seconds(scene, step > 0 ? scene.time.end / step : given, 1, cell);
}

/// Returns the CPU time of all permitted corrected cycles [s].
double correction_seconds(const Scene& scene) {
  const mmc::CorrectionSettings& c = scene.cycle.correction;
  const double motions =
      (c.max_cycles + 1) * gradient_seconds(scene, scene.cycle.cell, scene.cycle.step);
  if (c.kind == mmc::Correction::direct) return motions;
  double iteration = 0;
  for (const IterationCost& of : iteration_costs(scene)) iteration += of.with_widths;
  return motions + c.max_cycles * c.inner_iterations * iteration;
}

/// Returns the CPU time of all permitted iterations of the designs in one cycle [s].
double design_seconds(const Scene& scene) {
  constexpr double kStages = 3;  // stages with equal shares; the last one constrains widths
  double out = 0;
  const std::vector<IterationCost> costs = iteration_costs(scene);
  for (size_t i = 0; i < costs.size(); ++i) {
    const double mean = costs[i].plain + (costs[i].with_widths - costs[i].plain) / kStages;
    out += mean * scene.optimizer.max_iterations * scene.designs[i].starts;
  }
  return out;
}

/// Returns the CPU time of the equivalent static loads of all designs in one motion [s].
double load_seconds(const Scene& scene) {
  double cells = 0;
  for (const BodyDesign& d : scene.designs) cells += 1.0 * d.grid.nx * d.grid.ny;
  return scene.esl ? scene.esl->count(scene.time.end) * cells * kLoadCellSeconds : 0;
}

/// Returns the CPU time of the files of all parts: smooth outlines, drawings and solids [s].
double export_seconds(const Scene& scene) {
  double out = 0;
  for (const BodyDesign& d : scene.designs) out += d.n_components() * kExportSeconds;
  return out;
}

/// Returns the CPU time of the verification of all outlines by triangles [s].
double outline_seconds(const Scene& scene) {
  double out = 0;
  for (const BodyDesign& d : scene.designs) {
    const double loads = scene.domain ? static_cast<double>(scene.domain->loads.size())
                                      : scene.esl->count(scene.time.end);
    out += kVerifiedSeconds + d.n_components() * (kVerifiedComponent + loads * kVerifiedLoad);
  }
  return out;
}

}  // namespace

std::vector<IterationCost> iteration_costs(const Scene& scene) {
  std::vector<IterationCost> out;
  for (const BodyDesign& d : scene.designs) {
    const double cells = 1.0 * d.grid.nx * d.grid.ny, components = d.n_components();
    IterationCost& of = out.emplace_back();
    of.body = d.body;
    of.plain = design_operations(scene, d) / kFactorRate + cells * kCellSeconds +
               components * kOutlineSeconds;
    if (scene.output.crisp_every > 0)
      of.plain += crisp_seconds(components) / scene.output.crisp_every;
    if (scene.output.vtk && scene.output.design_every > 0)
      of.plain += cells * kFrameCellSeconds / scene.output.design_every;
    of.with_widths = of.plain + (d.widths.any() ? widths_seconds(components) : 0);
  }
  return out;
}

std::vector<PhaseCost> phase_costs(const Scene& scene, const Mechanism* mechanism) {
  const ResourceEstimate resources = estimate_resources(scene);
  double motion = 0, frames = 0;
  if (mechanism != nullptr) {
    const double step = scene.time.integrator == "minimal_coordinates"
                            ? kRigid * 1e2
                            : step_operations(scene, *mechanism).total();
    motion = resources.steps * step / kMotionRate;
    frames = resources.frames * kFrameSeconds *
             static_cast<double>(scene.bodies.size() + scene.rigid_bodies.size());
    for (const BodyDesign& d : scene.designs)
      frames += resources.frames * d.grid.nx * d.grid.ny * kPointSeconds;
  }
  if (scene.designs.empty())
    return {
        {.name = scene.statics ? "statics" : "motion",
         .kind = "motion",
         .seconds = motion + frames,
         .may_end_early = scene.statics && scene.statics->path != fem::StaticSettings::Path::load}};
  const PhaseCost design{
      .name = "design", .kind = "design", .seconds = design_seconds(scene), .may_end_early = true};
  const PhaseCost outlines{
      .name = "verification of outlines", .kind = "outlines", .seconds = outline_seconds(scene)};
  const PhaseCost exports{
      .name = "files of the parts", .kind = "files", .seconds = export_seconds(scene)};
  if (scene.domain) return {design, exports, outlines};

  const bool on_cells = scene.verifies_on_cells();
  double finer = 0;  // of a motion on the mesh of the verification
  if (scene.verify) {
    const bool adaptive = scene.time.tolerance && scene.verify->step == scene.time.step;
    const double steps = adaptive ? resources.steps : scene.time.end / scene.verify->step;
    finer = on_cells ? cells_seconds(scene, steps, scene.verify->cells)
            : scene.verify->mesh
                ? 4 * motion * steps / resources.steps
                : std::pow(scene.verify->refine, 2) * motion * steps / resources.steps;
  }
  const int cycles = scene.optimizer.max_iterations > 0 ? scene.cycle.max_cycles : 1;
  const char* const kind_of_finer = on_cells ? "motion on cells" : "motion";
  const PhaseCost loaded{
      .name = "motion", .kind = "motion", .seconds = motion + load_seconds(scene)};
  std::vector<PhaseCost> out = {loaded};
  for (int cycle = 1; cycle <= cycles; ++cycle) {
    const auto add = [&](PhaseCost phase) {
      phase.cycle = cycle;
      out.push_back(phase);
    };
    add(design);
    add(exports);
    if (cycles == 1) break;
    if (on_cells) add({.name = "motion on cells", .kind = kind_of_finer, .seconds = finer});
    // The loads of the motion with the designs decide whether another cycle follows.
    if (!on_cells || cycle < cycles) add(loaded);
  }
  if (scene.cycle.correction.kind != mmc::Correction::none)
    out.push_back({.name = "corrected cycles",
                   .kind = "gradients",
                   .seconds = correction_seconds(scene),
                   .may_end_early = true});
  out.push_back(outlines);
  const auto add = [&](const char* name, const char* kind, double seconds) {
    out.push_back({.name = name, .kind = kind, .seconds = seconds, .group = 1});
  };
  add("motion with the design", "motion", motion + frames);
  add("motion with uniform material", "motion", motion);
  if (scene.verify) add("verification with uniform material", kind_of_finer, finer);
  if (scene.verify && !(on_cells && cycles > 1))
    add("verification with the design", kind_of_finer, finer);
  if (scene.certify)
    out.push_back({.name = "certificate",
                   .kind = "gradients",
                   .seconds = gradient_seconds(scene, scene.certify->cell, scene.certify->step)});
  return out;
}

ExpectedSeconds expected_seconds(const Scene& scene, const Mechanism* mechanism) {
  ExpectedSeconds out{kStart, kStart};
  for (const PhaseCost& phase : phase_costs(scene, mechanism)) {
    out.most += phase.seconds;
    if (phase.cycle <= 1) out.one_cycle += phase.seconds;
  }
  return out;
}

}  // namespace flexmorph::cases
