#include <cmath>

#include "cases/scene/design/goal.h"
#include "cases/scene/design/keys.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/read.h"
#include "cases/scene/tables.h"
#include "io/drawings/exports.h"
#include "io/files.h"
#include "optim/mmc/length_scale/outline_limits.h"

namespace flexmorph::cases {

const io::Key& design_keys::kCells =
    io::key("design", "cells")
        .integers("a number of cells", 1, 100'000, 2, 2)
        .otherwise_as("required unless `cell` is given")
        .description("Number of cells of the design along and across.");

namespace {

using io::any_number;
using io::between;
using io::Key;
using io::not_negative;
using io::positive;
using io::Table;
using io::to_text;

constexpr double kMaxCells = 4e6;
constexpr int kMaxBoxes = 100'000;  // boxes of the initial layout, in each direction

/// Returns the range (0, upper] of a fraction.
io::Quantity fraction(std::string noun, double upper = 1) {
  io::Quantity q = between(std::move(noun), "", 0, upper);
  q.lower_open = true;
  return q;
}

const Key& kBody = io::key("design", "body")
                       .name_of("a body")
                       .otherwise_as("the plate of the [domain]; required without a [domain]")
                       .description("Body that is designed.");
const Key& kCell = io::key("design", "cell")
                       .number(positive("the size of a cell", "m"))
                       .otherwise_as("required unless `cells` is given")
                       .description("Size of a cell; it divides the length and width of the body.");
const Key& kComponents =
    io::key("design", "components")
        .integers("a number of boxes of two components", 1, kMaxBoxes, 2, 2)
        .description("Number of boxes along and across, each with two initial components.");
const Key& kMinThickness =
    io::key("design", "min_thickness")
        .number({.noun = "a smallest half-thickness", .unit = "m", .lower = 0, .lower_open = true})
        .otherwise_as("the size of a cell")
        .description("Lower limit of the half-thickness of components.");
const Key& kMinFeature =
    io::key("design", "min_feature")
        .number(not_negative("a smallest feature", "m"))
        .word("a smallest feature in words", {"twice_min_thickness"})
        .otherwise_as("twice `min_thickness`; 0 for `tdf = \"paper\"`")
        .description("Minimum width of solid features of the union of components; 0: no limit.");
const Key& kMinGap = io::key("design", "min_gap")
                         .number(not_negative("a smallest gap", "m"))
                         .otherwise_as("`min_feature` / 2, at least 2 cells; 0 if it is 0")
                         .description("Minimum width of gaps between components; 0: no limit.");
const Key& kFilletRadius =
    io::key("design", "fillet_radius")
        .number(not_negative("the radius of fillets", "m"))
        .otherwise_as("0.8 `min_feature`")
        .description("Radius of fillets in inner corners of the final, smoothed part; 0: none.");
const Key& kHalfLength = io::key("design", "half_length")
                             .number(positive("a half-length", "m"))
                             .otherwise_as("half of the diagonal of a box")
                             .description("Half-length of the initial components.");
const Key& kHalfThickness = io::key("design", "half_thickness")
                                .number(not_negative("a half-thickness", "m"))
                                .otherwise_as("a value that fills about the allowed volume")
                                .description("Half-thickness of the initial components.");
const Key& kStart = io::key("design", "start")
                        .text("a file of components")
                        .otherwise_as("the boxes of `components`")
                        .description("File of the initial components, such as `components.csv`.");
const Key& kJitter =
    io::key("design", "jitter")
        .number(between("a jitter", "", 0, 1))
        .otherwise(0.0)
        .description("Random change of the initial components, as a fraction of their sizes.");
const Key& kSeed = io::key("design", "seed")
                       .integer("a seed", 0, 1'000'000'000)
                       .otherwise(1)
                       .description("Seed of the random number generator used by `jitter`.");
const Key& kStarts =
    io::key("design", "starts")
        .integer("a number of starts", 1, 100)
        .otherwise(1)
        .description(
            "Number of initial layouts, one given, others random; the best one continues.");
const io::Choice<WantedSymmetry> kSymmetry(
    io::key("design", "symmetry")
        .otherwise("auto")
        .description("Symmetry; `x`: about the middle line parallel to y; `auto`: as the scene and "
                     "the start permit."),
    "a symmetry",
    {{"auto", {}},
     {"none", {.automatic = false}},
     {"x", {.automatic = false, .x = true}},
     {"y", {.automatic = false, .y = true}},
     {"both", {.automatic = false, .x = true, .y = true}}});
const Key& kDespiteLoads =
    io::key("design", "symmetry_despite_loads")
        .boolean()
        .otherwise(false)
        .description("True if `symmetry` is enforced although the loads are not symmetric.");
const io::Choice<TdfSettings::Kind> kTdf(
    io::key("design", "tdf").otherwise("distance").description("Topology description function."),
    "a TDF", {{"distance", TdfSettings::Kind::distance}, {"paper", TdfSettings::Kind::paper}});
const Key& kBand = io::key("design", "band")
                       .numbers(positive("half the width of the band", "cells"))
                       .otherwise(std::vector<double>{2.5, 1.5})
                       .description("Half-widths of the smoothing band, from coarse to fine.");
const Key& kSharpness = io::key("design", "sharpness")
                            .number(positive("a sharpness", "1/cell"))
                            .otherwise(3.75)
                            .description("Sharpness of the smooth maximum that unites components.");
const Key& kErosionWidth =
    io::key("design", "erosion_width")
        .number(between("an erosion", "", 0, 0.5))
        .otherwise_as("0.25; 0 for `tdf = \"paper\"`")
        .description("Erosion in stage 2, as a fraction of `min_feature`; it closes slits.");
const Key& kAlpha = io::key("design", "alpha")
                        .number(fraction("a value of the Heaviside function in the void", 0.5))
                        .otherwise(1e-3)
                        .description("Value of the Heaviside function in the void.");
const Key& kStiffnessVoid = io::key("design", "stiffness_void")
                                .number(fraction("a stiffness scale factor"))
                                .otherwise(1e-4)
                                .description("Stiffness scale factor of the void in motions.");
const Key& kMassVoid = io::key("design", "mass_void")
                           .number(fraction("a mass scale factor"))
                           .otherwise(1e-3)
                           .description("Mass scale factor of the void in motions.");

const io::Choice<bool> kSharesMass(io::key("design", "coupling")
                                       .otherwise("none")
                                       .description("`shared_mass`: one problem with one limit of "
                                                    "the mass for all designs with this setting."),
                                   "a coupling", {{"none", false}, {"shared_mass", true}});

/// Returns the plate of a static scene as a body that does not move.
Body plate_of(const Domain& domain) {
  Body body;
  body.name = domain.name;
  body.length = domain.bounds.upper.x() - domain.bounds.lower.x();
  body.width = domain.bounds.upper.y() - domain.bounds.lower.y();
  return body;
}

Grid read_grid(const Table& t, const Body& body, double end) {
  const double length = body.longest(end);
  Grid grid{.x0 = 0, .y0 = -0.5 * body.width, .width = length, .height = body.width};
  if (t.has(design_keys::kCells) == t.has(kCell))
    t.fail("a design needs either a cell size `cell`, or numbers of cells `cells`");
  if (t.has(design_keys::kCells)) {
    const std::vector<int> cells = t.integers(design_keys::kCells);
    grid.nx = cells[0];
    grid.ny = cells[1];
    if (1.0 * grid.nx * grid.ny > kMaxCells)
      t.fail(design_keys::kCells, "a design has at most " + to_text(kMaxCells, 3) + " cells");
    if (const double ratio = grid.dx() / grid.dy(); ratio < 0.5 || ratio > 2)
      t.fail(design_keys::kCells, "cells have an aspect ratio between 0.5 and 2; these cells are " +
                                      to_text(grid.dx(), 3) + " x " + to_text(grid.dy(), 3) + " m");
    return grid;
  }
  const double cell = t.number(kCell);
  const double nx = length / cell, ny = body.width / cell;
  if (nx * ny > kMaxCells) {
    const double smallest = 1.005 * std::sqrt(length * body.width / kMaxCells);
    t.fail(kCell, to_text(nx * ny, 3) + " cells; a design has at most " + to_text(kMaxCells, 3) +
                      ", which needs a cell of at least " + to_text(smallest, 3) + " [m]");
  }
  if (!is_whole(nx) || !is_whole(ny) || nx < 0.5 || ny < 0.5)
    t.fail(kCell, "a cell divides the longest length " + to_text(length) + " and the width " +
                      to_text(body.width) + " of '" + body.name + "' [m]");
  if (body.flow && !body.flow->motion && !is_whole(body.flow->speed * end / cell))
    t.fail(kCell, "a cell divides the " + to_text(std::abs(body.flow->speed) * end) +
                      " m by which '" + body.name +
                      "' changes its length, so that its root lies on a mesh line");
  grid.nx = static_cast<int>(std::lround(nx));
  grid.ny = static_cast<int>(std::lround(ny));
  return grid;
}

/// Throws for loads on a designed body that equivalent static loads do not include. They include
/// forces at nodes of the design mesh and along the free end; other loads would act in the motion
/// but be missing in the design problem.
void check_loads(const Table& t, const Scene& scene, const BodyDesign& design) {
  const Grid& g = design.grid;
  const auto is_node = [&](const Vec2& point) {
    return is_whole((point.x() - g.x0) / g.dx()) && is_whole((point.y() - g.y0) / g.dy());
  };
  for (const PointMass& mass : scene.point_masses)
    if (mass.body == design.body && !mass.at_end && !is_node(mass.point))
      t.fail(kBody, "a point mass on a designed body is at a node of its design mesh");
  for (const BodyLoad& load : scene.loads) {
    if (load.body != design.body) continue;
    if (load.row->at_point && !is_node(load.point))
      t.fail(kBody, "a force on a designed body acts at a node of its design mesh");
    if (!attached_force(load, scene, 0))
      t.fail(kBody, "a designed body is loaded at points or along its \"free_end\", not by \"" +
                        std::string(load.row->name) + "\"" + (load.turns ? " that turns" : "") +
                        (load.edge.empty() ? "" : " at \"" + load.edge + "\""));
  }
}

/// Reads the smallest widths of material and gaps of the union of components.
MinimumWidths read_widths(const Table& t, const Body& body, const BodyDesign& design) {
  const double thick = std::min(2 * design.min_thickness, 0.5 * body.width);
  const bool paper = design.tdf.kind == TdfSettings::Kind::paper;
  MinimumWidths out;
  if (t.is_string(kMinFeature)) {
    t.choice(kMinFeature);
    out.solid = thick;
  } else {
    out.solid = t.number(kMinFeature.within(0, 0.5 * body.width), paper ? 0.0 : thick);
  }
  // The crisp design on cells does not resolve gaps that are narrower than two cells.
  const double seen = std::min(2 * std::max(design.grid.dx(), design.grid.dy()), 0.5 * body.width);
  out.gap = t.number(kMinGap.within(0, 0.5 * body.width),
                     out.solid > 0 ? std::max(0.5 * out.solid, seen) : 0.0);
  if (paper && out.any())
    t.fail(out.solid > 0 ? kMinFeature : kMinGap,
           "tdf = \"paper\" supports no minimum widths: only 0 is allowed");
  return out;
}

void read_components(const Table& t, const Body& body, BodyDesign& design) {
  const double cell = design.grid.dx();
  const std::vector<int> boxes = t.integers(kComponents);
  design.components = {boxes[0], boxes[1]};
  if (1.0 * boxes[0] * boxes[1] > kMaxBoxes)
    t.fail(kComponents, "a layout has at most " + to_text(kMaxBoxes) + " boxes");
  design.min_thickness =
      t.number(kMinThickness.within(0, 0.5 * body.width), std::min(cell, 0.5 * body.width));

  design.tdf.kind = t.choice(kTdf);
  design.widths = read_widths(t, body, design);

  constexpr double kRadius =
      0.8;  // in widths of `min_feature`: an arc of a quarter of this width turns by 18 degrees
  design.fillet_radius = t.number(kFilletRadius.within(0, 0.5 * body.width),
                                  std::min(kRadius * design.widths.solid, 0.5 * body.width));
  if (design.fillet_radius > 0 && design.widths.solid == 0)
    t.fail(kFilletRadius, "fillets need a minimum width of material: set `min_feature`");

  const double wide = design.grid.width / boxes[0], high = design.grid.height / boxes[1];
  const double diagonal = std::hypot(wide, high);
  design.half_length = t.number(kHalfLength, 0.5 * diagonal);
  // Two bars along the diagonals fill about the allowed volume.
  const double volume = mmc::allowed_volume(design.goal).value_or(0.5);
  const double filling = 0.25 * volume * wide * high / diagonal;
  design.half_thickness = t.number(kHalfThickness.within(design.min_thickness, 0.5 * body.width),
                                   std::max(design.min_thickness, filling));
  if (t.has(kStart)) {
    try {
      design.start = io::read_components_csv(t.path_of(kStart));
    } catch (const Error& error) {
      t.fail(kStart, error.what());
    }
    const Grid& g = design.grid;
    const double near = 1e-9 * (g.width + g.height);
    for (size_t c = 0; c < design.start.size(); ++c) {
      const Vec2 at = design.start[c].center - Vec2(g.x0, g.y0);
      if (at.minCoeff() < -near || at.x() > g.width + near || at.y() > g.height + near)
        t.fail(kStart, "the centre of component " + to_text(static_cast<int>(c + 1)) +
                           " lies in the domain, [" + to_text(g.x0) + ", " +
                           to_text(g.x0 + g.width) + "] x [" + to_text(g.y0) + ", " +
                           to_text(g.y0 + g.height) + "] [m]");
    }
  }
  design.jitter = t.number(kJitter);
  design.seed = t.integer(kSeed);
  design.starts = t.integer(kStarts);
  design.symmetry = t.choice(kSymmetry);
  design.symmetry.despite_loads = t.boolean(kDespiteLoads);
  if (design.symmetry.despite_loads && !design.symmetry.x && !design.symmetry.y)
    t.fail(kDespiteLoads, "this key needs symmetry = \"x\", \"y\" or \"both\"");
}

void read_tdf(const Table& t, BodyDesign& design) {
  const double cell = design.grid.dx();
  const bool paper = design.tdf.kind == TdfSettings::Kind::paper;
  design.band = t.numbers(paper ? kBand.measured_in("") : kBand);
  for (size_t i = 1; i < design.band.size(); ++i)
    if (design.band[i] >= design.band[i - 1]) t.fail(kBand, "half-widths go from coarse to fine");
  design.tdf.sharpness = t.number(kSharpness) / cell;
  // If any width is allowed, the erosion refers to the smallest component.
  const double width = design.widths.solid > 0 ? design.widths.solid : 2 * design.min_thickness;
  design.erosion = t.number(kErosionWidth, paper ? 0.0 : 0.25) * (paper ? 1 : width);
  design.tdf.alpha = t.number(kAlpha);
  design.tdf.min_half_thickness =
      std::max(design.min_thickness, mmc::half_thickness_for(design.widths.solid));
  design.tdf = design.at_band(design.band.size() - 1);
  design.stiffness_void = t.number(kStiffnessVoid);
  design.mass_void = t.number(kMassVoid);
}

/// Reads whether the design problem is solved together with the design problems of other bodies,
/// under one budget of mass.
void read_coupling(const Table& t, BodyDesign& design) {
  design.shares_mass = t.choice(kSharesMass);
  if (design.shares_mass) check_sharing(t, design.goal);
}

/// Reads the design of a static plate, whose grid covers the domain.
BodyDesign read_static_design(const Table& t, const Scene& scene) {
  BodyDesign design;
  const Domain& domain = *scene.domain;
  if (!scene.designs.empty()) t.fail("a static scene has one [[design]]");
  design.body = t.choice(kBody, std::vector<std::string>{domain.name}, domain.name);
  const Body body = plate_of(domain);
  design.grid = read_grid(t, body, 0);
  design.grid.x0 = domain.bounds.lower.x();
  design.grid.y0 = domain.bounds.lower.y();
  design.goal = read_goal(t, plate_of(scene, design));
  if (mmc::has_motion(design.goal)) t.fail("a static plate has no responses of a motion");
  read_coupling(t, design);
  read_components(t, body, design);
  read_tdf(t, design);
  read_regions(t, body, scene, design);
  return design;
}

/// Reads the goals of the design for loads and of the motion itself.
void read_goals(const Table& t, const Scene& scene, BodyDesign& design) {
  const mmc::Goal goal = read_goal(t, plate_of(scene, design));
  design.motion_goal = mmc::goal_of_motion(goal);
  design.asks_motion = mmc::has_motion(goal);
  design.goal = mmc::goal_of_loads(goal);
  if (!mmc::is_held_back(design.goal))
    t.fail(
        "limits of the motion follow a design for static loads, which needs a limit as well: a "
        "largest compliance");
}

}  // namespace

std::vector<std::string> overrides_of_start_files(const Table& root) {
  std::vector<std::string> out;
  if (!root.has(tables::kDesign)) return out;
  const std::vector<Table> designs = root.tables(tables::kDesign);
  for (size_t i = 0; i < designs.size(); ++i)
    if (designs[i].is_string(kStart))
      out.push_back("design." + std::to_string(i) + ".start='" + designs[i].absolute(kStart) + "'");
  return out;
}

const io::Key& design_keys::kCoupling = kSharesMass;

BodyDesign read_design(const Table& t, const Scene& scene) {
  if (scene.domain) return read_static_design(t, scene);
  BodyDesign design;
  design.body = read_flexible(t, kBody, scene);
  if (!scene.body(design.body).row->designable) t.fail(kBody, "beams cannot be designed");
  if (const auto& heat = scene.body(design.body).heat; heat && heat->force)
    t.fail(kBody, "the thermal force needs full material: set body.heat.force = false");
  if (const auto& flow = scene.body(design.body).flow; flow && flow->reservoir != Reservoir::none)
    t.fail(kBody, "the reservoir needs full material: no [[design]] with body.flow.reservoir");
  for (const BodyDesign& other : scene.designs)
    if (other.body == design.body) t.fail(kBody, "this body has a [[design]] already");
  const Body& body = scene.body(design.body);
  const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(),
                                  [&](const Joint& j) { return j.carries(body.name); });
  if (body.in_space() || body.has_eulerian_lines())
    t.fail(kBody,
           "a designed body must be planar and must not have lines whose material coordinate is an "
           "unknown");
  if (!welded)
    design.link = read_link(t, kBody, body, scene);
  else if (t.has(design_keys::kLinkSupport))
    t.fail(design_keys::kLinkSupport,
           "'" + body.name + "' is welded at its root; esl.support defines its support");
  if (!body.has_term([](const fem::TermRow& row) { return row.designable; }))
    t.fail(kBody, "a designed body needs the term \"membrane\"");

  design.grid = read_grid(t, body, scene.time.end);
  read_goals(t, scene, design);
  read_coupling(t, design);
  read_components(t, body, design);
  read_tdf(t, design);
  read_eyes(t, design);
  read_regions(t, body, scene, design);
  check_loads(t, scene, design);
  check_joint_points(t, kBody, scene, design);
  check_pins_solid(t, design);
  return design;
}

}  // namespace flexmorph::cases
