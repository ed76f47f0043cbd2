#include <cmath>

#include "cases/scene/design/cells.h"
#include "cases/scene/design/keys.h"
#include "cases/scene/read.h"
#include "cases/scene/tables.h"
#include "geometry/text.h"
#include "io/files.h"

/// Readers of the settings around designs: [esl], [optimizer], [cycle], [verify].
namespace flexmorph::cases {
namespace {

using io::Key;
using io::not_negative;
using io::positive;
using io::Table;
using io::to_text;
using mmc::LoadDefinition;
using mmc::Support;

constexpr int kMaxLoads = 10'000;

const Key& kEvery = io::key("esl", "every")
                        .number(positive("the time between loads", "s"))
                        .description(
                            "Time between equivalent static loads, in which a root moves by a "
                            "whole number of cells.");
const io::Choice<LoadDefinition> kDefinition(
    io::key("esl", "definition")
        .otherwise("inertia")
        .description("Inertia forces that follow the design (`inertia`) or stay (`frozen`), or "
                     "`stiffness` forces."),
    "a definition of the loads",
    {{"inertia", LoadDefinition::inertia},
     {"frozen", LoadDefinition::frozen},
     {"stiffness", LoadDefinition::stiffness}});
const io::Choice<Support> kSupport(
    io::key("esl", "support")
        .otherwise("moving_root")
        .description(
            "Support of plates with a root under the static loads; links use `design.support`."),
    "a support", {{"moving_root", Support::moving_root}, {"far_end", Support::far_end}});
const Key& kCompress =
    io::key("esl", "compress")
        .boolean()
        .otherwise(true)
        .description("True if a smaller basis of the loads is solved where this reduces the work.");

const optim::Settings kSettings;

const Key& kName = io::key("optimizer", "name")
                       .word("an optimizer", optim::optimizer_names)
                       .otherwise(kSettings.name)
                       .description("Optimizer that solves the design problem.");
const Key& kMaxIterations =
    io::key("optimizer", "max_iterations")
        .integer("a number of iterations", 0, 1'000'000)
        .otherwise(kSettings.max_iterations)
        .description(
            "Largest number of iterations of all stages together; 0 evaluates the initial design.");
const Key& kMaxSolves = io::key("optimizer", "max_solves")
                            .integer("a number of state solves", 0, 100'000'000)
                            .otherwise(kSettings.max_evaluations)
                            .description("Largest number of state solves; 0 means no limit.");
const Key& kMoveLimit =
    io::key("optimizer", "move_limit")
        .number({.noun = "a move limit", .lower = 0, .upper = 1, .lower_open = true})
        .otherwise(kSettings.move_limit)
        .description("Largest change of a scaled variable per iteration; 0.05 is about a cell.");
const Key& kKktTolerance =
    io::key("optimizer", "kkt_tolerance")
        .number(not_negative("a tolerance"))
        .otherwise(kSettings.kkt_tolerance)
        .description("KKT residual at which the optimizer stops, if the design is also feasible.");
const Key& kFeasibility =
    io::key("optimizer", "feasibility")
        .number(positive("a tolerance"))
        .otherwise(kSettings.feasibility)
        .description("Largest violation of constraints of a feasible design.");
const Key& kChangeTolerance =
    io::key("optimizer", "change_tolerance")
        .number(not_negative("a tolerance"))
        .otherwise(kSettings.change_tolerance)
        .description(
            "Change of the design below which the optimizer stops after 3 iterations; 0: never.");
const Key& kStagnationIterations = io::key("optimizer", "stagnation_iterations")
                                       .formerly("rest_iterations")
                                       .integer("a number of iterations", 0, 1'000'000)
                                       .otherwise(kSettings.rest.rows)
                                       .description(
                                           "Iterations over which stagnation is tested; 0: neither "
                                           "it nor a plateau ends a stage.");
const Key& kStagnationObjective = io::key("optimizer", "stagnation_objective")
                                      .formerly("rest_objective")
                                      .number(not_negative("a fraction"))
                                      .otherwise(kSettings.rest.objective)
                                      .description(
                                          "Relative change of the objective below which it "
                                          "stagnates (volume: relative to the full plate).");
const Key& kStagnationKkt =
    io::key("optimizer", "stagnation_kkt")
        .formerly("rest_kkt")
        .number(not_negative("a tolerance"))
        .otherwise(kSettings.rest.kkt)
        .description(
            "Largest KKT residual at which an optimization with a stagnating objective stops.");
const Key& kOptions = io::key("optimizer", "options")
                          .table()
                          .otherwise_as("none")
                          .description("Options of the chosen optimizer.");
const Key& kOption =
    io::key("optimizer.options", "*")
        .number(io::any_number("an option"))
        .description(
            "Option NAME of the chosen optimizer; its source file lists names and ranges.");

const Key& kMaxCycles =
    io::key("cycle", "max_cycles")
        .integer("a number of cycles", 1, 1000)
        .otherwise(Cycle().max_cycles)
        .description(
            "Largest number of cycles; each one simulates the designs of the previous cycle.");
const Key& kTolerance = io::key("cycle", "tolerance")
                            .number(not_negative("a tolerance"))
                            .otherwise(Cycle().tolerance)
                            .description(
                                "Cycles have converged if a cycle improves the measure "
                                "`compare_by` by a smaller fraction.");
const Key& kLoadDifference = io::key("cycle", "load_difference")
                                 .number(not_negative("a fraction of the strain energy"))
                                 .otherwise(Cycle().load_difference)
                                 .description(
                                     "Loads have converged if they differ by a smaller fraction "
                                     "from the loads of the new motion.");
const io::Choice<CycleMeasure> kCompareBy(
    io::key("cycle", "compare_by")
        .otherwise("strain_energy")
        .description(
            "Measure that compares cycles: strain energy over time, or the deflection of a point."),
    "a measure of the motion",
    {{"strain_energy", CycleMeasure::strain_energy},
     {"rms", CycleMeasure::rms},
     {"peak_to_peak", CycleMeasure::peak_to_peak},
     {"mean", CycleMeasure::mean}});
const Key& kComparePoint =
    io::key("cycle", "compare_point")
        .name_of("a tip or an observed point")
        .otherwise_as("the only tip or observed point of the designs")
        .description(
            "Point of `compare_by`: BODY for the tip of a body, BODY.NAME for an observed point.");

const Key& kRefine =
    io::key("verify", "refine")
        .integer("a factor of refinement", 2, 100)
        .otherwise_as("required unless `mesh` or `cells` is given")
        .description("Factor by which the number of elements in each direction is multiplied.");
const Key& kCells = io::key("verify", "cells")
                        .integer("a number of elements per cell", 1, 8)
                        .otherwise_as("required unless `mesh` or `refine` is given")
                        .description(
                            "Number of elements per design cell in each direction; cycles are then "
                            "verified as well.");
const Key& kMesh =
    io::key("verify", "mesh")
        .integers("a number of elements", 1, 10'000, 2, 2)
        .otherwise_as("required unless `refine` or `cells` is given")
        .description(
            "Number of elements of the verification along the length at the start, and across.");
const Key& kStep = io::key("verify", "step")
                       .number(positive("a time step", "s"))
                       .otherwise_as("`time.step`")
                       .description("Time step of the verification.");

Esl read_esl(const Table& t, const Scene& scene) {
  Esl esl;
  const double end = scene.time.end;
  esl.every = t.number(kEvery);
  if (esl.every > end * (1 + 1e-9)) t.fail(kEvery, "a time between loads is at most time.end [s]");
  if (end / esl.every > kMaxLoads + 0.5)
    t.fail(kEvery, "a motion has at most " + to_text(kMaxLoads) + " loads");
  mmc::ComplianceSettings& s = esl.settings;
  s.loads = t.choice(kDefinition);
  s.support = t.choice(kSupport);
  if (s.loads == LoadDefinition::inertia && s.support == Support::far_end)
    t.fail(kSupport,
           "\"inertia\" loads need \"moving_root\"; with \"far_end\" the reactions of the root "
           "would depend on the design");
  s.compress = t.boolean(kCompress);
  for (const BodyDesign& design : scene.designs)
    if (design.link && s.loads == LoadDefinition::stiffness)
      t.fail(kDefinition,
             "'" + design.body +
                 "' is a link between two pins, which needs \"inertia\" or \"frozen\" loads");

  // At constant speed the root must be on a mesh line at every load. A root that a drive moves is
  // taken to be on the nearest mesh line.
  for (const BodyDesign& design : scene.designs) {
    const Body& body = scene.body(design.body);
    if (!body.flow || body.flow->speed == 0) continue;
    const double cells = std::abs(body.flow->speed) * esl.every / design.grid.dx();
    if (!is_whole(cells) || cells < 0.5)
      t.fail(kEvery,
             "the root of '" + body.name + "' moves by " + to_text(cells, 4) +
                 " cells between loads, which must be a whole number: `every` is a multiple of " +
                 to_text(design.grid.dx() / std::abs(body.flow->speed), 6) + " [s]");
  }
  return esl;
}

/// Reads the table of options of one optimizer into `s`, whose other settings are set.
void read_options(const Table& t, const Key& table, const Key& one, optim::Settings& s) {
  if (t.has(table)) {
    const Table options = t.table(table);
    for (const std::string& key : options.keys()) s.options[key] = options.number(one.named(key));
  }
  try {
    optim::Settings checked = s;
    checked.max_iterations = std::max(1, s.max_iterations);
    optim::make_optimizer(checked);  // the optimizer checks its options and their ranges
  } catch (const Error& error) {
    const std::string what = error.what();
    for (const auto& [key, value] : s.options)
      if (what.find("option '" + key + "'") != std::string::npos)
        t.table(table).fail(one.named(key), what);
    t.fail(what);
  }
}

optim::Settings read_optimizer(const Table& t) {
  optim::Settings s;
  s.name = t.choice(kName);
  s.max_iterations = t.integer(kMaxIterations);
  s.max_evaluations = t.integer(kMaxSolves);
  s.move_limit = t.number(kMoveLimit);
  s.kkt_tolerance = t.number(kKktTolerance);
  s.feasibility = t.number(kFeasibility);
  s.change_tolerance = t.number(kChangeTolerance);
  s.rest = {.rows = t.integer(kStagnationIterations),
            .objective = t.number(kStagnationObjective),
            .kkt = t.number(kStagnationKkt)};
  // Without limits the first steps of Ipopt are far longer than a component; a moving box limits
  // them. Far from a minimum exact Hessians are indefinite and less useful than quasi-Newton
  // matrices, which do not resolve the ripples due to the grid: the smoothed compliances of the
  // short beam are 82.3 and 78.9.
  if (s.name == "ipopt") {
    s.options.try_emplace("box", 0.1);
    s.options.try_emplace("exact", 0);
  }
  read_options(t, kOptions, kOption, s);
  return s;
}

constexpr const char* kNoHeat = "heated bodies cannot move on cells";
constexpr const char* kNoDiscreteGradient =
    "\"energy_momentum\" cannot be used on cells, because void cells have no discrete gradient";

/// Throws if a body cannot move on cells.
void check_on_cells(const Table& t, const Scene& scene, const Body& body) {
  const std::string name = "'" + body.name + "' ";
  if (body.in_space())
    t.fail(kCells, name + "is in space, but cells have no bending out of the plane");
  if (body.has_eulerian_lines() || !body.lines.empty())
    t.fail(kCells, name +
                       "has given mesh lines ([[body.line]]), but the mesh lines of cells are "
                       "those of the design");
  for (const std::string& term : body.terms)
    if (!fem::term_row(term).on_cells)
      t.fail(kCells, "the term \"" + term + "\" of " + name + "is not implemented for cells");
  if (scene.has_heat()) t.fail(kCells, kNoHeat);
  if (scene.time.integrator == "energy_momentum") t.fail(kCells, kNoDiscreteGradient);
}

Verify read_verify(const Table& t, const Scene& scene) {
  Verify verify;
  if (t.has(kRefine) + t.has(kMesh) + t.has(kCells) > 1)
    t.fail(t.has(kRefine) ? kRefine : kCells,
           "a verification needs exactly one of `mesh`, `refine` and `cells`");
  if (t.has(kRefine)) {
    verify.refine = t.integer(kRefine);
  } else if (t.has(kCells)) {
    verify.cells = t.integer(kCells);
  } else {
    const std::vector<int> mesh = t.integers(kMesh);
    verify.mesh = {mesh[0], mesh[1]};
  }
  if (verify.cells > 0)
    if (const std::string why = unmatched_cells(scene, verify.cells); !why.empty())
      t.fail(kCells, why);
  for (const BodyDesign& design : scene.designs) {
    const Body& body = scene.body(design.body);
    if (verify.mesh &&
        ((*verify.mesh)[0] < body.elements[0] || (*verify.mesh)[1] < body.elements[1]))
      t.fail(kMesh, "the mesh of a verification is at least as fine as the elements of '" +
                        body.name + "'");
    if (verify.cells > 0) check_on_cells(t, scene, body);
  }
  verify.step = t.number(kStep, scene.time.step);
  if (verify.step > scene.time.end) t.fail(kStep, "a time step is at most time.end [s]");
  return verify;
}

/// Reads the point whose deflection compares the cycles: "BODY" for a tip, "BODY.NAME" for an
/// observed point of a designed body.
std::string read_compare_point(const Table& cycle, const Scene& scene) {
  std::vector<std::string> points;
  for (const BodyDesign& design : scene.designs) {
    if (!design.link) points.push_back(design.body);
    for (const Observe& o : scene.observed)
      if (o.body == design.body) points.push_back(o.body + "." + o.name);
  }
  if (points.empty())
    cycle.fail(
        kCompareBy,
        "no design has a tip or an observed point, therefore only \"strain_energy\" is allowed");
  if (cycle.has(kComparePoint)) return cycle.choice(kComparePoint, points);
  if (points.size() > 1)
    cycle.fail(kCompareBy, "this measure needs `compare_point`, one of " + joined(points));
  return points.front();
}

void read_cycle(const Table& cycle, Scene& scene) {
  scene.cycle.max_cycles = cycle.integer(kMaxCycles);
  scene.cycle.tolerance = cycle.number(kTolerance);
  scene.cycle.load_difference = cycle.number(kLoadDifference);
  scene.cycle.compare_by = cycle.choice(kCompareBy);
  if (scene.cycle.compare_by != CycleMeasure::strain_energy)
    scene.cycle.compare_point = read_compare_point(cycle, scene);
  else if (cycle.has(kComparePoint))
    cycle.fail(kComparePoint, "this key has no effect with compare_by = \"strain_energy\"");
}

}  // namespace

void read_designs(const Table& root, Scene& scene) {
  for (const Body& body : scene.bodies) {
    if (!body.on_cells()) continue;
    if (scene.time.integrator == "energy_momentum")
      scene.refuse("time.integrator", kNoDiscreteGradient);
    if (body.heat) scene.refuse("body.heat", kNoHeat);
  }
  if (root.has(tables::kDesign))  // without a design, [optimizer] is an error below
    scene.optimizer = read_optimizer(root.table_or_empty(tables::kOptimizer));
  std::vector<Table> sharing;
  for (const Table& t : root.tables(tables::kDesign)) {
    scene.designs.push_back(read_design(t, scene));
    if (scene.designs.back().shares_mass) sharing.push_back(t);
  }
  if (sharing.size() == 1)
    sharing[0].fail(design_keys::kCoupling,
                    "\"shared_mass\" needs a second [[design]] with \"shared_mass\"");
  if (scene.domain) {
    if (scene.designs.empty()) root.fail(tables::kDesign, "a static scene needs a [[design]]");
    return;
  }
  if (scene.designs.empty()) {
    for (const Key* key :
         {&tables::kOptimizer, &tables::kCycle, &tables::kVerify, &tables::kCertificate})
      if (root.has(*key)) root.table(*key).fail("this table has no effect without a [[design]]");
    if (root.has(tables::kEsl)) scene.esl = read_esl(root.table(tables::kEsl), scene);
    return;
  }
  scene.esl = read_esl(root.table(tables::kEsl), scene);
  const Table cycle = root.table_or_empty(tables::kCycle);
  read_cycle(cycle, scene);
  if (root.has(tables::kVerify)) scene.verify = read_verify(root.table(tables::kVerify), scene);
  read_correction(root, scene);
}

}  // namespace flexmorph::cases
