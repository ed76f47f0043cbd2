#include "cases/assembly/build.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "cases/assembly/static_conditions.h"

namespace flexmorph::cases {
fem::PlaneSection section_of(const Body& body) {
  return {body.thickness, body.youngs_modulus, body.poisson_ratio, body.density};
}

std::vector<fem::AttachedMass> attached_masses(const Scene& scene, const std::string& name) {
  std::vector<fem::AttachedMass> out;
  for (const PointMass& m : scene.point_masses)
    if (m.body == name) out.push_back({m.mass, m.point});
  return out;
}

std::vector<fem::AttachedJoint> attached_joints(const Scene& scene, const std::string& name) {
  std::vector<fem::AttachedJoint> out;
  for (const Joint& j : scene.joints) {
    if (j.body == name && j.edge == "free_end")
      out.push_back({j.name, {scene.body(name).longest(scene.time.end), 0}, true});
    if (const auto point = j.point_on(name)) out.push_back({j.name, *point, j.joins_edges()});
  }
  return out;
}

std::vector<fem::AttachedForce> applied_forces(const Scene& scene, const std::string& name,
                                               double t) {
  std::vector<fem::AttachedForce> out;
  for (const size_t i : ordered_loads(scene))
    if (const BodyLoad& load = scene.loads[i]; load.body == name)
      if (const auto force = attached_force(load, scene, t)) out.push_back(*force);
  return out;
}

namespace {

/// Smallest relative perturbation (`jitter`) of further starts.
constexpr double kFurtherJitter = 0.1;

/// Perturbs every component at random by up to `jitter` times a unit, which is the half-length for
/// positions and lengths, one radian for angles, and the half-thickness itself for
/// half-thicknesses. The result depends only on the components, `jitter` and `seed`.
void shake(std::vector<Component>& components, double jitter, int seed) {
  if (jitter == 0) return;
  std::mt19937 engine(static_cast<unsigned>(seed));
  // std::uniform_real_distribution is not used, because it differs between standard libraries.
  const auto draw = [&] {
    return jitter * (2 * (static_cast<double>(engine()) / 4294967295.0) - 1);
  };
  for (Component& c : components) {
    const double size = c.half_length;
    c.center += size * Vec2(draw(), draw());
    c.half_length += size * draw();
    c.angle += draw();
    for (double* thickness : {&c.c1, &c.c2, &c.c3}) *thickness *= 1 + draw();
  }
}

/// Returns the cells at the two pins of a link (a body of a mechanism between two pins): the cells
/// of the eye around a bore, or without a bore the cells around the node of the pin. The first pin
/// counts as a support and the second pin as a load.
std::vector<HeldOrLoaded> pin_locations(const Link& link, const Grid& g) {
  std::vector<HeldOrLoaded> out = {{"first pin", true, {}}, {"second pin", false, {}}};
  for (size_t k = 0; k < 2; ++k) {
    if (link.bores[k] > 0) {
      const double round = mmc::kOutlineTolerance * g.dx();
      out[k].cells = cells_within(g, {circle_within(link.pins[k], link.eyes[k], round),
                                      {circle_within(link.pins[k], link.bores[k], round)}});
      continue;
    }
    const int node = fem::node_at(g, link.pins[k]), i = node / (g.ny + 1), j = node % (g.ny + 1);
    for (const int ci : {i - 1, i})
      for (const int cj : {j - 1, j})
        if (ci >= 0 && ci < g.nx && cj >= 0 && cj < g.ny) out[k].cells.push_back(g.cell(ci, cj));
  }
  return out;
}

std::vector<HeldOrLoaded> locations_of(const Scene& scene, const BodyDesign& design,
                                       std::span<const signed char> outside) {
  if (scene.domain) return static_locations(scene, design.grid, outside);
  return design.link ? pin_locations(*design.link, design.grid) : std::vector<HeldOrLoaded>{};
}

mmc::ComplianceSettings settings_of(const Scene& scene, const BodyDesign& design) {
  mmc::ComplianceSettings out = scene.esl ? scene.esl->settings : mmc::ComplianceSettings{};
  if (design.link) out.support = design.link->support;
  return out;
}

/// Returns the supported edges of a static plate, or the root line of a moving plate at its
/// greatest length; nothing for a link.
std::vector<Segment> held_lines(const Scene& scene, const BodyDesign& design) {
  const Grid& grid = design.grid;
  if (design.link) return {};
  if (!scene.domain) return {{{grid.x0, grid.y0}, {grid.x0, grid.y0 + grid.height}}};
  std::vector<Segment> out;
  for (const PlaneSupport& s : scene.domain->supports)
    if (s.location.kind == NodeRegion::Kind::edge)
      out.push_back({s.location.box.lower, s.location.box.upper});
  return out;
}

/// Fillings of corners and gaps that are narrower than this fraction of the minimum width are
/// removed.
constexpr double kThinnestFilling = 0.9;

/// Returns the bores in the eyes of a link as counterclockwise polygons [m].
std::vector<std::vector<Vec2>> bores_of(const BodyDesign& design) {
  std::vector<std::vector<Vec2>> out;
  if (!design.link) return out;
  for (size_t k = 0; k < 2; ++k)
    if (design.link->bores[k] > 0)
      out.push_back(circle_within(design.link->pins[k], design.link->bores[k],
                                  mmc::kOutlineTolerance * design.grid.dx()));
  return out;
}

/// Returns the grid of a link as a region with the bores of its eyes as holes; empty without bores.
Region with_bores(const BodyDesign& design) {
  const Grid& g = design.grid;
  Region out{corners_of({{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}}), bores_of(design)};
  if (out.holes.empty()) return {};
  for (std::vector<Vec2>& bore : out.holes) std::reverse(bore.begin(), bore.end());
  return out;
}

/// Returns the initial design of an optimization. A design that is only evaluated keeps the
/// components of its file unchanged, because an optimized design has components that are shorter
/// than the lower bound of a start.
mmc::Design design_of(const Scene& scene, const Grid& grid, const std::vector<Component>& layout,
                      const mmc::DesignScale& scale, const mmc::Symmetry& symmetry) {
  if (scene.optimizer.max_iterations == 0)
    return mmc::Design(grid, {}, scale, symmetry).with(layout);
  return mmc::Design(grid, layout, scale, symmetry);
}

}  // namespace

std::vector<mmc::BodyProblem> build_problems(const Scene& scene) {
  std::vector<mmc::BodyProblem> out;
  for (const BodyDesign& d : scene.designs) {
    const Grid& g = d.grid;
    mmc::DesignScale scale;
    scale.half_length = d.half_length;
    scale.min_thickness = std::max(d.min_thickness, mmc::half_thickness_for(d.widths.solid));
    scale.max_thickness = std::max({0.3 * g.height, 1.5 * scale.min_thickness, d.half_thickness});
    auto layout = d.start.empty()
                      ? crossing_layout(g.x0, g.y0, g.width, g.height, d.components[0],
                                        d.components[1], d.half_thickness, d.half_length)
                      : d.start;
    std::vector<TdfSettings> bands;
    for (size_t i = 0; i < d.band.size(); ++i) bands.push_back(d.at_band(i));
    const mmc::Plate plate = plate_of(scene, d);
    const mmc::Symmetry symmetry = symmetry_of(scene, d, plate.outside, layout);
    layout = mmc::one_side(layout, symmetry);
    std::vector<mmc::Design> further;
    for (int k = 1; k < d.starts; ++k) {
      std::vector<Component> moved = layout;
      // The offset keeps these seeds apart from those of a study, which are consecutive.
      shake(moved, std::max(d.jitter, kFurtherJitter), d.seed + 1'000'003 * k);
      further.emplace_back(g, moved, scale, symmetry);
    }
    shake(layout, d.jitter, d.seed);
    out.push_back({.body = d.body,
                   .grid = g,
                   .section = plate.section,
                   .design = design_of(scene, g, layout, scale, symmetry),
                   .further_starts = std::move(further),
                   .solid = d.solid,
                   .empty = d.empty,
                   .bands = bands,
                   .erosion = d.erosion,
                   .goal = d.goal,
                   .motion_goal = d.motion_goal,
                   .stiffness_void = d.stiffness_void,
                   .mass_void = d.mass_void,
                   .compliance = settings_of(scene, d),
                   .domain = scene.domain ? scene.domain->shape : with_bores(d),
                   .outside = plate.outside,
                   .locations = locations_of(scene, d, plate.outside),
                   .held = held_lines(scene, d),
                   .widths = d.widths,
                   .fillets = {d.fillet_radius, kThinnestFilling * d.widths.solid},
                   .bores = bores_of(d),
                   .export_tolerance = export_tolerance(scene, d),
                   .shares_mass = d.shares_mass,
                   .part = d.part});
  }
  return out;
}

std::vector<double> load_times(const Scene& scene) {
  std::vector<double> out;
  if (scene.esl)
    for (int i = 1; i <= scene.esl->count(scene.time.end); ++i) out.push_back(i * scene.esl->every);
  return out;
}

Scene read_scene(const io::CaseFile& file) { return read_scene(file, follow_trajectory); }

}  // namespace flexmorph::cases
