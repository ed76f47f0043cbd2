#include "cases/scene/design/goal.h"

#include <algorithm>
#include <cmath>

#include "cases/scene/design/keys.h"
#include "cases/scene/scene.h"
#include "geometry/parts/picture.h"
#include "io/files.h"
#include "optim/mmc/problem/shared_problem.h"

namespace flexmorph::cases {

const io::Key& design_keys::kMaxVolume =
    io::key("design", "max_volume")
        .number({.noun = "a volume fraction", .lower = 0, .upper = 1, .lower_open = true})
        .otherwise_as("required unless a [[design.constraint]] is given")
        .when("the compliance or a response of the motion is minimized")
        .description("Largest volume fraction of the material, solid regions included.");

namespace {

using design_keys::kMaxVolume;
using io::Key;
using io::Table;
using io::to_text;
using mmc::ResponseRow;

/// Returns the values of a member of all rows of the table of responses, each once.
std::vector<std::string> all_of(std::string_view ResponseRow::*member) {
  std::vector<std::string> out;
  for (const ResponseRow* row : mmc::responses()) {
    const std::string each(row->*member);
    if (!each.empty() && std::find(out.begin(), out.end(), each) == out.end()) out.push_back(each);
  }
  return out;
}

/// Returns the names of responses that depend on loads (that do not), for messages: "volume",
/// "mass".
std::string names_of_rows(bool with_loads) {
  std::string out;
  for (const std::string& name : all_of(&ResponseRow::name))
    if ((mmc::find_response(name, "sum")->needs_state()) == with_loads)
      out += (out.empty() ? "\"" : ", \"") + name + "\"";
  return out;
}

std::vector<std::string> row_names() { return all_of(&ResponseRow::name); }
std::vector<std::string> ways_of_loads() { return all_of(&ResponseRow::loads); }

const Key& kMinimize = io::key("design", "minimize")
                           .word("an objective", row_names)
                           .otherwise("compliance")
                           .description("Response that the design minimizes.");
const Key& kLoads = io::key("design", "loads")
                        .word("a combination of loads", ways_of_loads)
                        .otherwise("sum")
                        .description(
                            "Combination of loads: weighted sum of compliances (`sum`) or largest "
                            "compliance (`worst`).");
const Key& kMaxCompliance = io::key("design", "max_compliance")
                                .number(io::positive("a compliance", "J"))
                                .otherwise_as("required unless a [[design.constraint]] is given")
                                .when("a response that grows with the material is minimized")
                                .description("Largest compliance.");
const Key& kObjective =
    io::key("design", "objective")
        .tables_of()
        .otherwise_as("none")
        .when("`minimize` is a response of the motion")
        .description(
            "A further response of the motion that is added to the objective with a weight.");
const Key& kAdded = io::key("design.objective", "response")
                        .word("a response", row_names)
                        .description("Response of the motion that is added to the objective.");
const Key& kWeight =
    io::key("design.objective", "weight")
        .number(io::positive("a weight"))
        .otherwise(1.0)
        .description(
            "Weight per unit of the added response; the response of `minimize` has the weight 1.");
const Key& kConstraint =
    io::key("design", "constraint")
        .tables_of()
        .otherwise_as("none")
        .description("A further limit, or a limit in place of `max_volume` or `max_compliance`.");
const Key& kResponse = io::key("design.constraint", "response")
                           .word("a response", row_names)
                           .description("Response that is limited.");
const Key& kItsLoads = io::key("design.constraint", "loads")
                           .word("a combination of loads", ways_of_loads)
                           .otherwise_as("the value of `design.loads`")
                           .when("`response = \"compliance\"`")
                           .description("Combination of loads in the limited compliance.");
const Key& kAtMost =
    io::key("design.constraint", "at_most")
        .number(io::positive("a response"))
        .otherwise_as("no upper limit")
        .description(
            "Upper limit of the response, in its unit; at most the value of the full plate.");
const Key& kAtLeast =
    io::key("design.constraint", "at_least")
        .number(io::not_negative("a response"))
        .otherwise_as("no lower limit")
        .when("the response does not depend on loads")
        .description(
            "Lower limit of the response, in its unit; at most the value of the full plate. 0: no "
            "limit.");

const ResponseRow& read_row(const Table& t, const Key& key, const std::string& loads,
                            const mmc::Plate& plate) {
  const std::string name = t.choice(key);
  const ResponseRow& row = *mmc::find_response(name, loads);
  if (row.full && !(row.full(plate) > 0))
    t.fail(key, "this response needs a density of the plate: set domain.density [kg/m^3]");
  return row;
}

/// Rounds to twelve digits, so that the exact mass of a full plate, such as 2 kg, is a valid limit.
double without_round_off(double value) {
  const double scale = std::pow(10, 12 - std::ceil(std::log10(value)));
  return std::round(value * scale) / scale;
}

/// Reads a bound on a response. The value of a full plate is its upper limit.
void read_limit(const Table& t, const Key& key, const ResponseRow& row, const mmc::Plate& plate,
                mmc::Goal& goal) {
  Key of_row = key.measured_in(std::string(row.unit));
  if (row.full) of_row = of_row.within(0, without_round_off(row.full(plate)));
  const bool at_least = key.name == kAtLeast.name;
  const double value = t.number(of_row);
  if (at_least && value == 0) return;
  goal.limits.emplace_back(row, value, at_least, plate);
  goal.limits.back().key_path = t.path() + "." + key.name;
}

std::string noun_of(const ResponseRow& row) { return std::string("a ").append(row.words); }

/// Reads one [[design.objective]].
void read_addend(const Table& t, const std::string& loads, const mmc::Plate& plate,
                 mmc::Goal& goal) {
  if (!goal.objective->of_motion)
    t.fail("only responses of the motion can be added, but `minimize` is the " +
           std::string(goal.objective->words));
  if (!t.has(kAdded)) t.fail(kAdded, "an added objective needs a `response`");
  const ResponseRow& row = read_row(t, kAdded, loads, plate);
  if (!row.of_motion) t.fail(kAdded, "an added objective is a response of the motion");
  const auto is_row = [&](const mmc::Addend& a) { return a.row == &row; };
  if (&row == goal.objective || std::any_of(goal.addends.begin(), goal.addends.end(), is_row))
    t.fail(kAdded, "this response is part of the objective already");
  goal.addends.push_back({&row, t.number(kWeight)});
}

/// Reads one [[design.constraint]].
void read_constraint(const Table& t, const std::string& design_loads, const mmc::Plate& plate,
                     mmc::Goal& goal) {
  const std::string loads = t.has(kItsLoads) ? t.choice(kItsLoads) : design_loads;
  if (!t.has(kResponse)) t.fail(kResponse, "a constraint needs a `response`");
  const ResponseRow& row = read_row(t, kResponse, loads, plate);
  if (t.has(kItsLoads) && !row.needs_state())
    t.fail(kItsLoads, "only " + names_of_rows(true) + " combines loads");
  const auto is_row = [&](const mmc::Addend& a) { return a.row == &row; };
  if (&row == goal.objective || std::any_of(goal.addends.begin(), goal.addends.end(), is_row))
    t.fail(kResponse, "a minimized response has no limit");
  if (const auto rows = mmc::rows_of(goal); std::find(rows.begin(), rows.end(), &row) != rows.end())
    t.fail(kResponse, "the " + std::string(row.words) + " has a limit already");
  if (!t.has(kAtMost) && !t.has(kAtLeast))
    t.fail("a constraint needs `at_most`, `at_least` or both");
  if (t.has(kAtLeast) && row.falls_with_material())
    t.fail(kAtLeast, "only " + names_of_rows(false) + " has a lower limit");
  for (const Key* key : {&kAtMost, &kAtLeast})
    if (t.has(*key)) read_limit(t, key->called(noun_of(row)), row, plate, goal);
  if (t.has(kAtMost) && t.has(kAtLeast) && goal.limits.back().at_least &&
      goal.limits.back().value > goal.limits[goal.limits.size() - 2].value)
    t.fail(kAtLeast, "a lower limit is at most `at_most`");
}

/// Reads max_volume or max_compliance; one of them is required unless there are constraints.
void read_shorthand(const Table& t, const std::string& loads, const mmc::Plate& plate,
                    mmc::Goal& goal) {
  const bool wanted = t.tables(kConstraint).empty();
  const bool stiffest = goal.objective->falls_with_material();
  const Key& refused = stiffest ? kMaxCompliance : kMaxVolume;
  if (stiffest && (wanted || t.has(kMaxVolume)))
    read_limit(t, kMaxVolume, mmc::kVolume, plate, goal);
  if (!stiffest && (wanted || t.has(kMaxCompliance)))
    read_limit(t, kMaxCompliance, *mmc::find_response("compliance", loads), plate, goal);
  if (t.has(refused))
    t.fail(refused, "only minimize = " + names_of_rows(!stiffest) + " allows a largest " +
                        (stiffest ? "compliance" : "volume"));
}

std::string with_unit(const mmc::Limit& limit) {
  return to_text(limit.value) + (limit.row->unit.empty() ? "" : " ") + std::string(limit.row->unit);
}

}  // namespace

mmc::Plate plate_of(const Scene& scene, const BodyDesign& design) {
  if (!scene.domain) {
    const Body& b = scene.body(design.body);
    return {design.grid, {b.thickness, b.youngs_modulus, b.poisson_ratio, b.density}, {}};
  }
  const Domain& d = *scene.domain;
  mmc::Plate out{design.grid, {d.thickness, d.youngs_modulus, d.poisson_ratio, d.density}, {}};
  if (!d.shape.outer.empty()) out.outside = cells_outside(design.grid, d.shape);
  return out;
}

mmc::Goal read_goal(const Table& t, const mmc::Plate& plate) {
  const std::string loads = t.choice(kLoads);
  mmc::Goal goal;
  goal.objective = &read_row(t, kMinimize, loads, plate);
  for (const Table& addend : t.tables(kObjective)) read_addend(addend, loads, plate, goal);
  read_shorthand(t, loads, plate, goal);
  for (const Table& constraint : t.tables(kConstraint))
    read_constraint(constraint, loads, plate, goal);
  if (!mmc::is_held_back(goal))
    t.fail(goal.objective->needs_state()
               ? "the full plate is the stiffest design: the case needs a [[design.constraint]] "
                 "with `at_most` of " +
                     names_of_rows(false)
               : "the empty plate has the least " + std::string(goal.objective->words) +
                     ": the case needs a [[design.constraint]] with `at_most` of " +
                     names_of_rows(true) + " or `at_least` of " + names_of_rows(false));
  return goal;
}

void check_sharing(const Table& t, const mmc::Goal& goal) {
  if (!goal.objective->needs_state())
    t.fail(design_keys::kCoupling,
           "\"shared_mass\" needs minimize = \"compliance\", because designs share the material "
           "that max_volume allows");
  if (goal.objective->per_load)
    t.fail(
        design_keys::kCoupling,
        "\"shared_mass\" needs loads = \"sum\", because the compliances of all bodies are added");
  try {
    mmc::shared_limit(goal);
  } catch (const Error& error) {
    t.fail(design_keys::kCoupling, error.what());
  }
}

std::string limit_text(const mmc::Goal& goal) {
  std::string out;
  for (const mmc::Limit& limit : goal.limits)
    out += (out.empty() ? "" : ", ") + std::string(limit.row->words) +
           (limit.at_least ? " at least " : " at most ") + with_unit(limit);
  return out;
}

std::string goal_text(const mmc::Goal& goal) {
  std::string under, with;
  for (const mmc::Limit& limit : goal.limits) {
    std::string& out = limit.at_least ? with : under;
    out += (out.empty() ? (limit.at_least ? " with " : " under ") : " and ") + noun_of(*limit.row) +
           (limit.at_least ? " of at least " : " of ") + with_unit(limit);
  }
  return mmc::objective_text(goal) + under + with;
}

std::vector<const ResponseRow*> further_rows(const Scene& scene) {
  std::vector<const ResponseRow*> out;
  for (const BodyDesign& d : scene.designs)
    for (const ResponseRow* row : mmc::further_rows(d.goal))
      if (std::find(out.begin(), out.end(), row) == out.end()) out.push_back(row);
  return out;
}

}  // namespace flexmorph::cases
