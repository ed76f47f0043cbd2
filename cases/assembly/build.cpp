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
  for (const BodyLoad& load : scene.loads)
    if (load.body == name)
      if (const auto force = attached_force(load, scene, t)) out.push_back(*force);
  return out;
}

namespace {

/// Jitter of further starts, at least.
constexpr double kFurtherJitter = 0.1;

/// Moves every component at random: places and lengths by up to `jitter` of the half-length, angles
/// of a radian, half-thicknesses of themselves. The same seed gives the same start.
void shake(std::vector<Component>& components, double jitter, int seed) {
  if (jitter == 0) return;
  std::mt19937 engine(static_cast<unsigned>(seed));
  // Not std::uniform_real_distribution, which differs between standard libraries.
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

/// Cells at the pins of a link: those of their eyes, or those around the node of the pin. One pin
/// counts as its support, the other one as its load.
std::vector<HeldOrLoaded> pin_places(const Link& link, const Grid& g) {
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

std::vector<HeldOrLoaded> places_of(const Scene& scene, const BodyDesign& design,
                                    std::span<const signed char> outside) {
  if (scene.domain) return static_places(scene, design.grid, outside);
  return design.link ? pin_places(*design.link, design.grid) : std::vector<HeldOrLoaded>{};
}

mmc::ComplianceSettings settings_of(const Scene& scene, const BodyDesign& design) {
  mmc::ComplianceSettings out = scene.esl ? scene.esl->settings : mmc::ComplianceSettings{};
  if (design.link) out.support = design.link->support;
  return out;
}

/// Edges that hold a plate at rest; of a moving one its root line at the longest.
std::vector<Segment> held_lines(const Scene& scene, const BodyDesign& design) {
  const Grid& grid = design.grid;
  if (design.link) return {};
  if (!scene.domain) return {{{grid.x0, grid.y0}, {grid.x0, grid.y0 + grid.height}}};
  std::vector<Segment> out;
  for (const PlaneSupport& s : scene.domain->supports)
    if (s.place.kind == Place::Kind::edge) out.push_back({s.place.box.lower, s.place.box.upper});
  return out;
}

/// Fillings of corners and gaps that are narrower than this part of the smallest feature stay away.
constexpr double kThinnestFilling = 0.9;

/// The bores in the eyes of a link, counterclockwise.
std::vector<std::vector<Vec2>> bores_of(const BodyDesign& design) {
  std::vector<std::vector<Vec2>> out;
  if (!design.link) return out;
  for (size_t k = 0; k < 2; ++k)
    if (design.link->bores[k] > 0)
      out.push_back(circle_within(design.link->pins[k], design.link->bores[k],
                                  mmc::kOutlineTolerance * design.grid.dx()));
  return out;
}

/// The plate of a link without the bores in its eyes; empty where it has none.
Region with_bores(const BodyDesign& design) {
  const Grid& g = design.grid;
  Region out{corners_of({{g.x0, g.y0}, {g.x0 + g.width, g.y0 + g.height}}), bores_of(design)};
  if (out.holes.empty()) return {};
  for (std::vector<Vec2>& bore : out.holes) std::reverse(bore.begin(), bore.end());
  return out;
}

/// The design that an optimization starts from. A design that is only evaluated stays as its file
/// says: a delivered one has parts that are shorter than those of a start.
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
      // Far from the seeds that a study would count through.
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
                   .places = places_of(scene, d, plate.outside),
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
