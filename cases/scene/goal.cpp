#include "cases/scene/goal.h"

#include <algorithm>
#include <cmath>

#include "cases/scene/scene.h"
#include "geometry/picture.h"
#include "io/files.h"
#include "optim/mmc/shared_problem.h"

namespace flexmorph::cases {
namespace {

using io::Table;
using io::to_text;
using mmc::ResponseRow;

/// What rows of the table have in this place, each once.
std::vector<std::string> all_of(std::string_view ResponseRow::*member) {
  std::vector<std::string> out;
  for (const ResponseRow* row : mmc::responses()) {
    const std::string each(row->*member);
    if (!each.empty() && std::find(out.begin(), out.end(), each) == out.end()) out.push_back(each);
  }
  return out;
}

/// "volume", "mass": names of rows that have loads, or have none, for messages.
std::string names_of_rows(bool with_loads) {
  std::string out;
  for (const std::string& name : all_of(&ResponseRow::name))
    if ((mmc::find_response(name, "sum")->needs_state()) == with_loads)
      out += (out.empty() ? "\"" : ", \"") + name + "\"";
  return out;
}

const ResponseRow& read_row(const Table& t, const std::string& key, const std::string& noun,
                            const std::string& loads, const mmc::Plate& plate) {
  const std::string name = t.choice(key, noun, all_of(&ResponseRow::name), "compliance");
  const ResponseRow& row = *mmc::find_response(name, loads);
  if (row.full && !(row.full(plate) > 0))
    t.fail(key, "a plate without a density has none: domain.density [kg/m^3]");
  return row;
}

/// To twelve digits: a full plate of 2 kg may be asked for.
double without_round_off(double value) {
  const double scale = std::pow(10, 12 - std::ceil(std::log10(value)));
  return std::round(value * scale) / scale;
}

/// A bound on a response: what a full plate has is the most there can be.
void read_limit(const Table& t, const std::string& key, const std::string& noun,
                const ResponseRow& row, const mmc::Plate& plate, mmc::Goal& goal) {
  const std::string unit(row.unit);
  io::Quantity quantity = io::positive(noun, unit);
  if (row.full) {
    quantity = io::between(noun, unit, 0, without_round_off(row.full(plate)));
    quantity.lower_open = true;
  }
  goal.limits.emplace_back(row, t.number(key, quantity), key == "at_least", plate);
}

std::string noun_of(const ResponseRow& row) { return std::string("a ").append(row.words); }

/// One [[design.constraint]].
void read_constraint(const Table& t, const std::string& design_loads, const mmc::Plate& plate,
                     mmc::Goal& goal) {
  const std::string loads =
      t.choice("loads", "a way to put loads together", all_of(&ResponseRow::loads), design_loads);
  if (!t.has("response")) t.fail("response", "a constraint is one on a `response`");
  const ResponseRow& row = read_row(t, "response", "a response", loads, plate);
  if (t.has("loads") && !row.needs_state())
    t.fail("loads", "only " + names_of_rows(true) + " puts loads together");
  if (&row == goal.objective) t.fail("response", "what is minimized has no limit");
  if (const auto rows = mmc::rows_of(goal); std::find(rows.begin(), rows.end(), &row) != rows.end())
    t.fail("response", "the " + std::string(row.words) + " has a limit already");
  if (!t.has("at_most") && !t.has("at_least"))
    t.fail("a constraint has `at_most`, `at_least` or both");
  if (t.has("at_least") && row.needs_state())
    t.fail("at_least", "only " + names_of_rows(false) + " has a lower limit");
  for (const char* key : {"at_most", "at_least"})
    if (t.has(key)) read_limit(t, key, noun_of(row), row, plate, goal);
  if (t.has("at_most") && t.has("at_least") &&
      goal.limits.back().value > goal.limits[goal.limits.size() - 2].value)
    t.fail("at_least", "no more than `at_most`");
}

/// max_volume and max_compliance: one of them, unless there are constraints.
void read_shorthand(const Table& t, const std::string& loads, const mmc::Plate& plate,
                    mmc::Goal& goal) {
  const bool wanted = t.tables("constraint").empty();
  const bool stiffest = goal.objective->needs_state();
  const char* const refused = stiffest ? "max_compliance" : "max_volume";
  if (stiffest && (wanted || t.has("max_volume")))
    read_limit(t, "max_volume", "a volume fraction", mmc::kVolume, plate, goal);
  if (!stiffest && (wanted || t.has("max_compliance")))
    read_limit(t, "max_compliance", "a compliance", *mmc::find_response("compliance", loads), plate,
               goal);
  if (t.has(refused))
    t.fail(refused, "only minimize = " + names_of_rows(!stiffest) + " has a largest " +
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
  if (!d.polygon.empty()) out.outside = cells_outside(design.grid, d.polygon);
  return out;
}

mmc::Goal read_goal(const Table& t, const mmc::Plate& plate) {
  const std::string loads = t.choice("loads", "a way to put loads together",
                                     all_of(&ResponseRow::loads), std::string("sum"));
  mmc::Goal goal;
  goal.objective = &read_row(t, "minimize", "an objective", loads, plate);
  read_shorthand(t, loads, plate, goal);
  for (const Table& constraint : t.tables("constraint"))
    read_constraint(constraint, loads, plate, goal);
  if (!mmc::is_held_back(goal))
    t.fail(goal.objective->needs_state()
               ? "a full plate is the stiffest: a [[design.constraint]] with `at_most` of " +
                     names_of_rows(false) + " says what it may have"
               : "nothing at all has the least " + std::string(goal.objective->words) +
                     ": a [[design.constraint]] says what is wanted, `at_most` of " +
                     names_of_rows(true) + " or `at_least` of " + names_of_rows(false));
  return goal;
}

void check_sharing(const Table& t, const mmc::Goal& goal) {
  if (!goal.objective->needs_state())
    t.fail("coupling",
           "only with minimize = \"compliance\": what is shared is what max_volume allows");
  if (goal.objective->per_load)
    t.fail("coupling", "only with loads = \"sum\": compliances of all bodies are added");
  try {
    mmc::shared_limit(goal);
  } catch (const Error& error) {
    t.fail("coupling", error.what());
  }
}

std::string limit_words(const mmc::Goal& goal) {
  std::string out;
  for (const mmc::Limit& limit : goal.limits)
    out += (out.empty() ? "" : ", ") + std::string(limit.row->words) +
           (limit.at_least ? " at least " : " at most ") + with_unit(limit);
  return out;
}

std::string goal_words(const mmc::Goal& goal) {
  std::string under, with;
  for (const mmc::Limit& limit : goal.limits) {
    std::string& out = limit.at_least ? with : under;
    out += (out.empty() ? (limit.at_least ? " with " : " under ") : " and ") + noun_of(*limit.row) +
           (limit.at_least ? " of at least " : " of ") + with_unit(limit);
  }
  return std::string(goal.objective->words) + under + with;
}

std::vector<const ResponseRow*> further_rows(const Scene& scene) {
  std::vector<const ResponseRow*> out;
  for (const BodyDesign& d : scene.designs)
    for (const ResponseRow* row : mmc::further_rows(d.goal))
      if (std::find(out.begin(), out.end(), row) == out.end()) out.push_back(row);
  return out;
}

}  // namespace flexmorph::cases
