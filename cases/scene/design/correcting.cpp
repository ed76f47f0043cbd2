#include <cmath>

#include "cases/scene/design/cells.h"
#include "cases/scene/read.h"
#include "cases/scene/tables.h"
#include "io/files.h"
#include "optim/mmc/problem/motion_response.h"

/// Readers of the settings of corrected cycles, which follow the cycles of equivalent static loads,
/// and of the optimality certificate.
namespace flexmorph::cases {
namespace {

using io::Key;
using io::positive;
using io::Table;
using io::to_text;
using mmc::Correction;

const io::Choice<Correction> kCorrect(
    io::key("cycle", "correct")
        .otherwise("none")
        .description("Correction of designs: cycles with the gradient of the motion, or directly "
                     "by the optimizer."),
    "a correction",
    {{"none", Correction::none},
     {"first_order", Correction::first_order},
     {"direct", Correction::direct}});
const Key& kCorrections = io::key("cycle", "corrections")
                              .integer("a number of cycles", 0, 100'000)
                              .otherwise_as("20; for `direct`, `optimizer.max_iterations`")
                              .description(
                                  "Largest number of corrected cycles or `direct` iterations; 0 "
                                  "only evaluates the objective.");
const Key& kKktReduction =
    io::key("cycle", "kkt_reduction")
        .formerly("kkt_part")
        .number(io::between("a fraction", "", 0, 1))
        .otherwise(mmc::CorrectionSettings().kkt_reduction)
        .description(
            "The correction ends at this fraction of the first KKT residual of the motion.");
const Key& kRadius =
    io::key("cycle", "radius")
        .number(positive("a radius"))
        .otherwise(mmc::CorrectionSettings().radius)
        .description("First radius of the trust region of corrected cycles, in scaled variables.");
const Key& kInner =
    io::key("cycle", "inner_iterations")
        .integer("a number of iterations", 1, 100'000)
        .otherwise(mmc::CorrectionSettings().inner_iterations)
        .description("Largest number of iterations in the static problem of a corrected cycle.");

const Key& kSecants =
    io::key("cycle", "secants")
        .integer("a number of pairs", 0, 1000)
        .otherwise(mmc::CorrectionSettings().secants)
        .description(
            "Number of pairs of designs whose gradients estimate the curvature; 0 uses none.");

const std::vector<std::string> kTables = {"cycle", "certificate"};
const Key& kCell = io::shared_key(kTables, "cell")
                       .number(positive("the size of a cell", "m"))
                       .otherwise_as("the cells of the designs")
                       .description(
                           "Cell size of motions with gradient: a whole multiple of the cell size "
                           "of the designs.");
const Key& kStep = io::shared_key(kTables, "step")
                       .number(positive("a time step", "s"))
                       .otherwise_as("`time.step`")
                       .description("Time step of motions with gradient.");
const Key& kCheckpoints = io::shared_key(kTables, "checkpoints")
                              .integer("a number of checkpoints", 0, 10'000)
                              .otherwise(0)
                              .description(
                                  "Number of checkpoints; they save memory and cost one more "
                                  "motion. 0 stores all states.");

/// Returns the reason why the motion of the scene has no exact gradient; empty if it has one.
std::string no_gradient_because(const Scene& scene) {
  const TimeSpan& time = scene.time;
  if (time.tolerance) return "adaptive time steps depend on the design (time.step)";
  if (time.integrator != "generalized_alpha")
    return "\"" + time.integrator +
           "\" does not provide it, use \"generalized_alpha\" (time.integrator)";
  if (scene.in_space()) return "it is not implemented for bodies in space";
  if (scene.has_eulerian_lines())
    return "the times at which meshes with free material lines change depend on the design "
           "([[body.line]])";
  if (scene.has_heat()) return "it is not implemented for heated bodies ([body.heat])";
  if (std::string why = unmatched_cells(scene, 1); !why.empty()) return why;
  for (const BodyDesign& design : scene.designs) {
    const Body& body = scene.body(design.body);
    if (!body.lines.empty()) return "'" + body.name + "' has given mesh lines ([[body.line]])";
    for (const std::string& term : body.terms)
      if (!fem::term_row(term).on_cells)
        return "the term \"" + term + "\" is not implemented for cells";
  }
  return {};
}

/// Reads cell, time step and number of checkpoints of a motion with its gradient.
template <class To>
void read_motion_keys(const Table& t, const Scene& scene, To& out) {
  out.step = t.number(kStep, scene.time.step);
  if (out.step > scene.time.end) t.fail(kStep, "a time step is at most time.end [s]");
  out.checkpoints = t.integer(kCheckpoints);
  if (!t.has(kCell)) return;
  out.cell = t.number(kCell);
  const auto cells_in = [&](const BodyDesign& design) {
    return static_cast<int>(std::lround(out.cell / design.grid.dx()));
  };
  for (const BodyDesign& design : scene.designs) {
    constexpr double kCellTolerance = 1e-3;  // relative: sides need not be equal, nor round numbers
    const Grid& g = design.grid;
    const int n = cells_in(design);
    if (n < 1 || std::abs(out.cell / (n * g.dx()) - 1) > kCellTolerance || g.nx % n != 0 ||
        g.ny % n != 0)
      t.fail(kCell, "a cell is a whole multiple of the cells of '" + design.body + "' (" +
                        to_text(g.dx(), 6) + " m) that divides its length and its width");
    if (n != cells_in(scene.designs.front()))
      t.fail(kCell, "a cell is one multiple of the cells of all designs; it differs for '" +
                        design.body + "' (" + to_text(g.dx(), 6) + " m)");
  }
}

std::vector<mmc::MotionRow> rows_minimized(const BodyDesign& design) {
  const mmc::Goal* goal = &design.motion_goal;
  return mmc::motion_objectives({&goal, 1});
}

/// Throws if a goal needs something that the scene does not have, or if two designs give different
/// weights to the same response of the mechanism.
void check_goals(const Table& cycle, const Scene& scene) {
  for (const BodyDesign& design : scene.designs) {
    std::vector<const mmc::ResponseRow*> rows = mmc::rows_of(design.motion_goal);
    for (const mmc::Addend& addend : design.motion_goal.addends) rows.push_back(addend.row);
    const bool asks = std::any_of(rows.begin(), rows.end(), [](const mmc::ResponseRow* r) {
      return r->name == "trajectory_error";
    });
    if (asks && !scene.trajectory) cycle.fail("\"trajectory_error\" needs a [trajectory]");
    const bool deflects = std::any_of(rows.begin(), rows.end(), [](const mmc::ResponseRow* r) {
      return r->name == "deflection";
    });
    if (deflects && design.link)
      cycle.fail("\"deflection\" needs a free end, but '" + design.body +
                 "' is a link between two pins");
  }
  // A response of the whole mechanism counts once, even if several designs name it.
  for (const BodyDesign& design : scene.designs)
    for (const mmc::MotionRow& row : rows_minimized(design))
      for (const BodyDesign& other : scene.designs)
        for (const mmc::MotionRow& row_of_other : rows_minimized(other))
          if (!row.row->of_body && row.same_as(row_of_other) && row.weight != row_of_other.weight)
            cycle.fail("\"" + std::string(row.row->name) +
                       "\" is a response of the whole mechanism, therefore its weight is equal in "
                       "all designs");
}

}  // namespace

void read_correction(const Table& root, Scene& scene) {
  const Table cycle = root.table_or_empty(tables::kCycle);
  mmc::CorrectionSettings& s = scene.cycle.correction;
  s.kind = cycle.choice(kCorrect);
  s.optimizer = scene.optimizer;
  s.optimizer.rest.rows = 0;
  const bool corrects = s.kind != Correction::none;
  const std::string why = no_gradient_because(scene);
  if (corrects && !why.empty()) cycle.fail(kCorrect, "the motion has no exact gradient: " + why);
  if (corrects) {
    if (s.kind == Correction::direct) s.max_cycles = scene.optimizer.max_iterations;
    s.max_cycles = cycle.integer(kCorrections, s.max_cycles);
    s.kkt_reduction = cycle.number(kKktReduction);
    s.radius = cycle.number(kRadius);
    s.inner_iterations = cycle.integer(kInner);
    s.secants = cycle.integer(kSecants);
    read_motion_keys(cycle, scene, scene.cycle);
  } else {
    for (const Key* key : {&kCorrections, &kKktReduction, &kRadius, &kInner, &kSecants, &kCell,
                           &kStep, &kCheckpoints})
      if (cycle.has(*key)) cycle.fail(*key, "this key has no effect without `correct`");
    for (const BodyDesign& design : scene.designs)
      if (design.asks_motion)
        cycle.fail(kCorrect,
                   "[[design]] '" + design.body +
                       "' uses responses of the motion, which need \"first_order\" or \"direct\"");
  }
  check_goals(cycle, scene);
  if (!root.has(tables::kCertificate)) return;
  const Table t = root.table(tables::kCertificate);
  if (!why.empty()) t.fail("the motion has no exact gradient: " + why);
  read_motion_keys(t, scene, scene.certify.emplace());
}

}  // namespace flexmorph::cases
