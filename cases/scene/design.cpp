#include <cmath>

#include "cases/scene/goal.h"
#include "cases/scene/read.h"
#include "io/exports.h"
#include "io/files.h"
#include "optim/mmc/clean_up.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::between;
using io::not_negative;
using io::positive;
using io::Table;
using io::to_text;

constexpr double kMostCells = 4e6;
constexpr int kMostBoxes = 100'000;  // of the initial layout, in each direction
constexpr int kMostLoads = 10'000;

/// (lower, upper], the usual range of a fraction.
io::Quantity fraction(std::string noun, double upper = 1) {
  io::Quantity q = between(std::move(noun), "", 0, upper);
  q.lower_open = true;
  return q;
}

/// The plate of a static scene as a body that does not move.
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
  if (t.has("cells") == t.has("cell")) t.fail("a design has cells of the size `cell`, or `cells`");
  if (t.has("cells")) {
    const std::vector<int> cells = t.integers("cells", "a number of cells", 1, 100'000, 2);
    grid.nx = cells[0];
    grid.ny = cells[1];
    if (1.0 * grid.nx * grid.ny > kMostCells)
      t.fail("cells", "at most " + to_text(kMostCells, 3) + " cells");
    if (const double ratio = grid.dx() / grid.dy(); ratio < 0.5 || ratio > 2)
      t.fail("cells", "cells are nearly square; these are " + to_text(grid.dx(), 3) + " x " +
                          to_text(grid.dy(), 3) + " m");
    return grid;
  }
  const double cell = t.number("cell", positive("the size of a cell", "m"));
  const double nx = length / cell, ny = body.width / cell;
  if (nx * ny > kMostCells) {
    const double smallest = 1.005 * std::sqrt(length * body.width / kMostCells);
    t.fail("cell", to_text(nx * ny, 3) + " cells; at most " + to_text(kMostCells, 3) +
                       ", so a cell of at least " + to_text(smallest, 3) + " [m]");
  }
  if (!is_whole(nx) || !is_whole(ny) || nx < 0.5 || ny < 0.5)
    t.fail("cell", "a cell divides the longest length " + to_text(length) + " and the width " +
                       to_text(body.width) + " of '" + body.name + "' [m]");
  if (body.flow && !body.flow->motion && !is_whole(body.flow->speed * end / cell))
    t.fail("cell", "a cell divides the " + to_text(std::abs(body.flow->speed) * end) +
                       " m by which '" + body.name + "' grows, so that its root is a mesh line");
  grid.nx = static_cast<int>(std::lround(nx));
  grid.ny = static_cast<int>(std::lround(ny));
  return grid;
}

bool holds(const Box& box, const Vec2& p) {
  return p.x() >= box.lower.x() && p.x() <= box.upper.x() && p.y() >= box.lower.y() &&
         p.y() <= box.upper.y();
}

int cells_in(const Grid& grid, const std::vector<Box>& boxes) {
  int count = 0;
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j)
      count += std::any_of(boxes.begin(), boxes.end(),
                           [&](const Box& box) { return holds(box, grid.cell_center(i, j)); });
  return count;
}

/// One [[design.solid]] or [[design.void]]: a box, or a strip along an end.
Box read_region(const Table& t, const Grid& grid) {
  if (t.has("box") == t.has("strip")) t.fail("a region has either a `box` or a `strip`");
  const double left = grid.x0, right = grid.x0 + grid.width;
  const double bottom = grid.y0, top = grid.y0 + grid.height;
  if (t.has("strip")) {
    const bool at_end = t.choice<bool>("strip", "a strip lies along an end: it",
                                       {{"free_end", true}, {"root", false}});
    const double wide = grid.dx() * t.integer("cells", "the width of a strip", 1, grid.nx, 2);
    return at_end ? Box{{right - wide, bottom}, {right, top}}
                  : Box{{left, bottom}, {left + wide, top}};
  }
  if (t.has("cells")) t.fail("cells", "only a strip is as wide as a number of cells");
  const std::vector<double> b = t.numbers("box", any_number("x0, y0, x1, y1 of a box", "m"), 4);
  Box box{{b[0], b[1]}, {b[2], b[3]}};
  if (b[0] >= b[2] || b[1] >= b[3])
    t.fail("box", "x0 < x1 and y0 < y1, in the order x0, y0, x1, y1 [m]");
  if (cells_in(grid, {box}) == 0)
    t.fail("box", "a box holds the centre of a cell; the domain is [" + to_text(left) + ", " +
                      to_text(right) + "] x [" + to_text(bottom) + ", " + to_text(top) + "] [m]");
  return box;
}

bool overlap(const Box& a, const Box& b, double margin) {
  return (a.upper.array() > b.lower.array() + margin).all() &&
         (b.upper.array() > a.lower.array() + margin).all();
}

void read_regions(const Table& t, const Body& body, const Scene& scene, BodyDesign& design) {
  const Grid& grid = design.grid;
  const double small = 1e-6 * grid.dx();
  for (const Table& region : t.tables("solid")) design.solid.push_back(read_region(region, grid));
  for (const Table& region : t.tables("void")) {
    design.empty.push_back(read_region(region, grid));
    for (const Box& solid : design.solid)
      if (overlap(solid, design.empty.back(), small))
        region.fail("a region cannot be solid and void at once");
  }
  const double filled = cells_in(grid, design.solid) / double(grid.n_cells());
  if (const auto allowed = mmc::allowed_volume(design.goal); allowed && filled >= *allowed) {
    const std::string words = "the solid regions alone fill " + to_text(filled, 3);
    if (t.has("max_volume")) t.fail("max_volume", words + " of the domain");
    t.fail(words + " of the domain, and " + to_text(*allowed, 3) + " is allowed");
  }

  // Without material under it the mass would end up in the void (optim/README.md, Passive regions).
  const Vec2 end(grid.x0 + grid.width, grid.y0 + 0.5 * grid.height);
  const auto carries = [&](const Box& box) {
    return holds(box, end - Vec2(2 * grid.dx() - small, grid.dy() - small)) &&
           holds(box, end - Vec2(small, -grid.dy() + small));
  };
  for (const PointMass& mass : scene.point_masses)
    if (mass.body == body.name && std::none_of(design.solid.begin(), design.solid.end(), carries))
      t.fail("the point mass at the free end of '" + body.name +
             "' needs solid material: [[design.solid]] with strip = \"free_end\", cells = 2");
  const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
    return j.body == body.name && j.edge == "free_end";
  });
  const int strip = 2 * grid.ny;  // cells of the last two columns, each of which must be solid
  int solid = 0;
  for (int i = std::max(0, grid.nx - 2); i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j)
      solid += std::any_of(design.solid.begin(), design.solid.end(),
                           [&](const Box& box) { return holds(box, grid.cell_center(i, j)); });
  if (welded && solid < strip)
    t.fail("the welded free end of '" + body.name +
           "' needs solid material: [[design.solid]] with strip = \"free_end\", cells = 2");
}

/// Loads that equivalent static loads know: forces at nodes of the design mesh, and along the free
/// end. Others would act in the motion and be missing in the design problem.
void check_loads(const Table& t, const Scene& scene, const BodyDesign& design) {
  const Grid& g = design.grid;
  for (const BodyLoad& load : scene.loads) {
    if (load.body != design.body) continue;
    const bool at_node =
        is_whole((load.point.x() - g.x0) / g.dx()) && is_whole((load.point.y() - g.y0) / g.dy());
    if (load.row->at_point && !at_node)
      t.fail("body", "a force on a designed body acts at a node of its design mesh");
    if (!attached_force(load, scene))
      t.fail("body", "a designed body is loaded at points or along its \"free_end\", not by \"" +
                         std::string(load.row->name) + "\"" +
                         (load.edge.empty() ? "" : " at \"" + load.edge + "\""));
  }
}

/// A width, or the word for that of the thinnest component.
double read_min_feature(const Table& t, const Body& body, double min_thickness) {
  if (t.has("min_feature") && t.is_string("min_feature"))
    return t.choice<double>("min_feature", "a smallest feature in words",
                            {{"twice_min_thickness", 2 * min_thickness}});
  io::Quantity width = between("a smallest feature", "m", 0, 0.5 * body.width);
  return t.number("min_feature", width, 0.0);
}

void read_components(const Table& t, const Body& body, BodyDesign& design) {
  const double cell = design.grid.dx();
  const std::vector<int> boxes =
      t.integers("components", "a number of boxes of two components", 1, kMostBoxes, 2);
  design.components = {boxes[0], boxes[1]};
  if (1.0 * boxes[0] * boxes[1] > kMostBoxes)
    t.fail("components", "at most " + to_text(kMostBoxes) + " boxes");
  io::Quantity half_width = between("a half-thickness", "m", 0, 0.5 * body.width);
  half_width.lower_open = true;
  half_width.noun = "a smallest half-thickness fits into the width: it";
  design.min_thickness = t.number("min_thickness", half_width, std::min(cell, 0.5 * body.width));

  design.min_feature = read_min_feature(t, body, design.min_thickness);

  const double wide = design.grid.width / boxes[0], high = design.grid.height / boxes[1];
  const double diagonal = std::hypot(wide, high);
  design.half_length = t.number("half_length", positive("a half-length", "m"), 0.5 * diagonal);
  // Two bars along the diagonals fill about the allowed volume.
  const double volume = mmc::allowed_volume(design.goal).value_or(0.5);
  const double filling = 0.25 * volume * wide * high / diagonal;
  half_width.lower = design.min_thickness;
  half_width.lower_open = false;
  half_width.noun = "a half-thickness";
  design.half_thickness =
      t.number("half_thickness", half_width, std::max(design.min_thickness, filling));
  if (t.has("start")) {
    const std::string path = t.string("start", "a file of components");
    try {
      design.start = io::read_components_csv(path);
    } catch (const Error& error) {
      t.fail("start", error.what());
    }
    const Grid& g = design.grid;
    const double near = 1e-9 * (g.width + g.height);
    for (size_t c = 0; c < design.start.size(); ++c) {
      const Vec2 at = design.start[c].center - Vec2(g.x0, g.y0);
      if (at.minCoeff() < -near || at.x() > g.width + near || at.y() > g.height + near)
        t.fail("start", "the centre of component " + to_text(static_cast<int>(c + 1)) +
                            " lies in the domain, [" + to_text(g.x0) + ", " +
                            to_text(g.x0 + g.width) + "] x [" + to_text(g.y0) + ", " +
                            to_text(g.y0 + g.height) + "] [m]");
    }
  }
  design.jitter = t.number("jitter", between("a jitter", "", 0, 1), 0.0);
  design.seed = t.integer("seed", "a seed", 0, 1'000'000'000, 1);
  design.drop_every = t.integer("drop_every", "a number of iterations", 0, 1'000'000, 25);
  design.refill = t.boolean("refill", false);
}

void read_tdf(const Table& t, BodyDesign& design) {
  const double cell = design.grid.dx();
  using Kind = TdfSettings::Kind;
  design.tdf.kind = t.choice<Kind>(
      "tdf", "a TDF", {{"distance", Kind::distance}, {"paper", Kind::paper}}, Kind::distance);
  const bool paper = design.tdf.kind == Kind::paper;
  design.band = t.numbers("band", positive("half the width of the band", paper ? "" : "cells"), 0,
                          std::vector<double>{1.5});
  for (size_t i = 1; i < design.band.size(); ++i)
    if (design.band[i] >= design.band[i - 1]) t.fail("band", "bands go from coarse to fine");
  design.tdf.sharpness = t.number("sharpness", positive("a sharpness", "1/cell"), 3.75) / cell;
  design.tdf.erosion =
      t.number("erosion", not_negative("an erosion", paper ? "" : "cells"), paper ? 0.0 : 0.5) *
      (paper ? 1 : cell);
  io::Quantity small = fraction("the Heaviside function of the void", 0.5);
  design.tdf.alpha = t.number("alpha", small, 1e-3);
  design.tdf.min_half_thickness =
      std::max(design.min_thickness, mmc::half_thickness_for(design.min_feature));
  design.tdf = design.stage(design.band.size() - 1);
  design.stiffness_void = t.number("stiffness_void", fraction("a stiffness factor"), 1e-4);
  design.mass_void = t.number("mass_void", fraction("a mass factor"), 1e-3);
}

/// Is the design solved with those of other bodies, under one budget of mass?
void read_coupling(const Table& t, BodyDesign& design) {
  design.shares_mass =
      t.choice<bool>("coupling", "a coupling", {{"none", false}, {"shared_mass", true}}, false);
  if (design.shares_mass) check_sharing(t, design.goal);
}

/// The design of a plate at rest: its grid lies where the domain does.
BodyDesign read_static_design(const Table& t, const Scene& scene) {
  BodyDesign design;
  const Domain& domain = *scene.domain;
  if (!scene.designs.empty()) t.fail("a static scene has one [[design]]");
  design.body = t.choice("body", "a body", std::vector<std::string>{domain.name}, domain.name);
  const Body body = plate_of(domain);
  design.grid = read_grid(t, body, 0);
  design.grid.x0 = domain.bounds.lower.x();
  design.grid.y0 = domain.bounds.lower.y();
  design.goal = read_goal(t, plate_of(scene, design));
  read_coupling(t, design);
  read_components(t, body, design);
  read_tdf(t, design);
  read_regions(t, body, scene, design);
  return design;
}

BodyDesign read_design(const Table& t, const Scene& scene) {
  if (scene.domain) return read_static_design(t, scene);
  BodyDesign design;
  design.body = t.choice("body", "a body", names_of(scene.bodies));
  if (scene.body(design.body).is_beam()) t.fail("body", "plates are designed, beams are not");
  if (const auto& heat = scene.body(design.body).heat; heat && heat->force)
    t.fail("body", "the thermal force is that of full material: body.heat.force = false");
  for (const BodyDesign& other : scene.designs)
    if (other.body == design.body) t.fail("body", "this body has a [[design]] already");
  const Body& body = scene.body(design.body);
  const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(),
                                  [&](const Joint& j) { return j.carries(body.name); });
  if (body.in_space() || body.has_free_lines())
    t.fail("body", "a designed body lives in the plane and has no free lines");
  if (!welded)
    t.fail("body", "a designed body is welded to a hub or a rigid body at its root: see [[joint]]");
  if (!body.has_term([](const fem::TermRow& row) { return row.designable; }))
    t.fail("body", "a designed body has the term \"membrane\"");

  design.grid = read_grid(t, body, scene.time.end);
  design.goal = read_goal(t, plate_of(scene, design));
  read_coupling(t, design);
  read_components(t, body, design);
  read_tdf(t, design);
  read_regions(t, body, scene, design);
  check_loads(t, scene, design);
  return design;
}

Esl read_esl(const Table& t, const Scene& scene) {
  Esl esl;
  const double end = scene.time.end;
  esl.every = t.number("every", positive("the time between loads", "s"));
  if (esl.every > end * (1 + 1e-9)) t.fail("every", "the first load is no later than time.end [s]");
  if (end / esl.every > kMostLoads + 0.5)
    t.fail("every", "at most " + to_text(kMostLoads) + " loads");
  using mmc::LoadDefinition;
  using mmc::Support;
  mmc::ComplianceSettings& s = esl.settings;
  s.loads = t.choice<LoadDefinition>("definition", "a definition of the loads",
                                     {{"inertia", LoadDefinition::inertia},
                                      {"frozen", LoadDefinition::frozen},
                                      {"stiffness", LoadDefinition::stiffness}},
                                     LoadDefinition::inertia);
  s.support = t.choice<Support>(
      "support", "a support",
      {{"moving_root", Support::moving_root}, {"far_end", Support::far_end}}, Support::moving_root);
  if (s.loads == LoadDefinition::inertia && s.support == Support::far_end)
    t.fail("support",
           "\"inertia\" loads need \"moving_root\": at the far end the reactions of the root would "
           "have to follow the design");
  s.compress = t.boolean("compress", true);

  // A root that drives move at will is taken to be on the nearest mesh line.
  for (const BodyDesign& design : scene.designs) {
    const Body& body = scene.body(design.body);
    if (!body.flow || body.flow->speed == 0) continue;
    const double cells = std::abs(body.flow->speed) * esl.every / design.grid.dx();
    if (!is_whole(cells) || cells < 0.5)
      t.fail("every", "the root of '" + body.name + "' moves by " + to_text(cells, 4) +
                          " cells between loads; a whole number is needed, so a multiple of " +
                          to_text(design.grid.dx() / std::abs(body.flow->speed), 6) + " [s]");
  }
  return esl;
}

optim::Settings read_optimizer(const Table& t) {
  optim::Settings s;
  s.name = t.choice("name", "an optimizer", optim::optimizer_names(), s.name);
  // 0: the design is analysed as it starts.
  s.max_iterations = t.integer("max_iterations", "a number of iterations", 0, 1'000'000, 300);
  s.max_evaluations = t.integer("max_solves", "a number of state solves", 0, 100'000'000, 0);
  s.move_limit = t.number("move_limit", fraction("a move limit"), s.move_limit);
  s.kkt_tolerance = t.number("kkt_tolerance", not_negative("a tolerance"), s.kkt_tolerance);
  s.feasibility = t.number("feasibility", positive("a tolerance"), s.feasibility);
  s.change_tolerance =
      t.number("change_tolerance", not_negative("a tolerance"), s.change_tolerance);
  if (t.has("options")) {
    const Table options = t.table("options");
    for (const std::string& key : options.keys())
      s.options[key] = options.number(key, any_number("an option"));
  }
  // Ipopt's first steps are far longer than a component; in a moving box they are not.
  if (s.name == "ipopt") s.options.try_emplace("box", 0.1);
  try {
    optim::Settings checked = s;
    checked.max_iterations = std::max(1, s.max_iterations);
    optim::make_optimizer(checked);  // only it knows its options and their ranges
  } catch (const Error& error) {
    const std::string what = error.what();
    for (const auto& [key, value] : s.options)
      if (what.find("option '" + key + "'") != std::string::npos)
        t.table("options").fail(key, what);
    t.fail(what);
  }
  return s;
}

Verify read_verify(const Table& t, const Scene& scene) {
  Verify verify;
  verify.refine = t.integer("refine", "a number of parts of an element", 2, 100, 1);
  if (t.has("refine") && t.has("mesh")) t.fail("refine", "a finer run has a `mesh` or `refine`");
  std::vector<int> mesh;
  if (!t.has("refine")) {
    mesh = t.integers("mesh", "a number of elements", 1, 10'000, 2);
    verify.mesh = {mesh[0], mesh[1]};
  }
  for (const BodyDesign& design : scene.designs) {
    const Body& body = scene.body(design.body);
    if (verify.mesh && (mesh[0] < body.elements[0] || mesh[1] < body.elements[1]))
      t.fail("mesh", "a finer mesh than the elements of '" + body.name + "'");
  }
  verify.step = t.number("step", positive("a time step", "s"), scene.time.step);
  if (verify.step > scene.time.end) t.fail("step", "a time step is no longer than time.end [s]");
  return verify;
}

}  // namespace

void read_designs(const Table& root, Scene& scene) {
  std::vector<Table> sharing;
  for (const Table& t : root.tables("design")) {
    scene.designs.push_back(read_design(t, scene));
    if (scene.designs.back().shares_mass) sharing.push_back(t);
  }
  if (sharing.size() == 1)
    sharing[0].fail("coupling", "no other [[design]] has \"shared_mass\" to share with");
  if (scene.domain) {
    if (scene.designs.empty()) root.fail("design", "a static scene has a [[design]]");
    if (root.has("optimizer")) scene.optimizer = read_optimizer(root.table("optimizer"));
    return;
  }
  if (scene.designs.empty()) {
    for (const char* key : {"optimizer", "cycle", "verify"})
      if (root.has(key)) root.table(key).fail("without a [[design]] this does nothing");
    if (root.has("esl")) scene.esl = read_esl(root.table("esl"), scene);
    return;
  }
  scene.esl = read_esl(root.table("esl"), scene);
  if (root.has("optimizer")) scene.optimizer = read_optimizer(root.table("optimizer"));
  if (root.has("cycle")) {
    const Table t = root.table("cycle");
    scene.cycle.max_cycles = t.integer("max_cycles", "a number of cycles", 1, 1000, 1);
    scene.cycle.tolerance = t.number("tolerance", not_negative("a tolerance"), 0.01);
  }
  if (root.has("verify")) scene.verify = read_verify(root.table("verify"), scene);
}

}  // namespace flexmorph::cases
