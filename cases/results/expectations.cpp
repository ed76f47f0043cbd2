#include "cases/results/expectations.h"

#include <algorithm>

#include "cases/results/limit_points.h"
#include "cases/results/quantities.h"
#include "cases/results/schema.h"
#include "geometry/text.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

const std::string kLargest = ".largest", kLimit = "limit_load_";

const std::string kAmplitude = "amplitude", kMotionRatio = "motion_ratio";

/// Returns the number of a value; nothing if the value is not a number. An unknown width is 0.
std::optional<double> number_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* number = std::get_if<int>(&value)) return *number;
  if (std::holds_alternative<std::nullptr_t>(value)) return 0;  // the outlines could not be united
  return {};
}

/// Tells whether [expect] may contain this number of a design.
bool can_be_expected(const ResultQuantity<mmc::BodyOutcome>& q) {
  static const std::string kNames[] = {"compliance",   "volume",      "crisp_compliance",
                                       "crisp_volume", "islands",     "compliance_ratio",
                                       "crisp_ratio",  "min_feature", "min_gap"};
  return std::find(std::begin(kNames), std::end(kNames), q.name) != std::end(kNames);
}

/// Returns the number n of a limit load from its name, "limit_load_n", n = 1..9; 0 for other names.
size_t limit_number(const std::string& name) {
  const std::string digit = name.starts_with(kLimit) ? name.substr(kLimit.size()) : "";
  return digit.size() == 1 && digit[0] >= '1' && digit[0] <= '9'
             ? static_cast<size_t>(digit[0] - '0')
             : 0;
}

std::optional<double> limit_of(const PathRecord& path, size_t number) {
  const std::vector<double> all = limit_loads(path.arc, path.table.at(kFactorColumn));
  return number <= all.size() ? std::optional<double>(all[number - 1]) : std::nullopt;
}

/// Returns the last value of a column, or for the name "<column>.largest" its largest absolute
/// value; nothing if there is no such column.
std::optional<double> value_of(const Series& table, const std::string& name) {
  if (const std::vector<double>* values = table.find(name))
    return values->empty() ? std::optional<double>() : values->back();
  if (!name.ends_with(kLargest)) return {};
  const std::vector<double>* values = table.find(name.substr(0, name.size() - kLargest.size()));
  if (!values || values->empty()) return {};
  return largest_size(*values);
}

/// Returns a number of the outcome of a design; nothing for an unknown name.
std::optional<double> design_value(const mmc::BodyOutcome& o, const std::string& name) {
  for (const ResultQuantity<mmc::BodyOutcome>& q : design_quantities())
    if (name == q.name && can_be_expected(q)) return number_of(q.value(o));
  for (const auto& [figures, prefix] :
       {std::pair{&o.further, std::string()}, {&o.crisp.further, std::string("crisp_")}})
    for (const auto& [figure, value] : *figures)
      if (prefix + figure == name) return value;
  return {};
}

/// Returns a number of the motion by which designs are assessed; nothing for an unknown name. The
/// error of the energy balance comes from the motion on the mesh of the scene, because only this
/// motion computes it.
std::optional<double> motion_value(const MotionResults& motions, const std::string& name) {
  if (const auto& assessed = motions.assessed();
      assessed && !name.starts_with(kEnergyErrorColumn)) {
    const std::vector<size_t> tips = assessed->table.of_group(ColumnGroup::deflection);
    if (name == kAmplitude && !tips.empty())
      return largest_size(assessed->table.values[tips.front()]);
    if (const auto& uniform = motions.assessed_uniform(); uniform && name == kMotionRatio)
      return assessed->strain_integral() / uniform->strain_integral();
    if (const auto found = value_of(assessed->table, name)) return found;
  }
  if (!motions.motion) return {};
  return value_of(motions.motion->table, name);
}

std::optional<double> find(const RunResult& result, const std::string& name) {
  if (!result.design.outcomes.empty())
    if (const auto found = design_value(result.design.outcomes.front(), name)) return found;
  if (const auto found = motion_value(result.motions, name)) return found;
  if (!result.path) return {};
  if (const size_t number = limit_number(name)) return limit_of(*result.path, number);
  return value_of(result.path->table, name);
}

std::string text_of(const Expectation& wanted) {
  std::string out;
  const auto add = [&](const std::string& words) { out += (out.empty() ? "" : ", ") + words; };
  if (wanted.value)
    add(io::to_text(*wanted.value, 9) + " within " + io::to_text(wanted.tolerance, 3));
  if (wanted.at_least) add("at least " + io::to_text(*wanted.at_least, 9));
  if (wanted.at_most) add("at most " + io::to_text(*wanted.at_most, 9));
  return out;
}

}  // namespace

std::vector<Expected> compare_expectations(const Scene& scene, const RunResult& result) {
  std::vector<Expected> out;
  for (const auto& [name, wanted] : scene.expect) {
    Expected e;
    e.name = name;
    e.found = find(result, name);
    e.holds = e.found && wanted.holds(*e.found);
    e.words = name + " = " + (e.found ? io::to_text(*e.found, 9) : std::string("not computed")) +
              ": expected " + text_of(wanted);
    out.push_back(std::move(e));
  }
  return out;
}

void check_expectations(const PreparedCase& prepared) {
  const Scene& scene = prepared.scene();
  if (scene.expect.empty()) return;
  std::vector<std::string> known;
  for (const Part part : parts_of(scene)) {
    if (part == Part::design) {
      for (const ResultQuantity<mmc::BodyOutcome>& q : design_quantities())
        if (can_be_expected(q)) known.emplace_back(q.name);
      for (const mmc::ResponseRow* row : mmc::further_rows(scene.designs.front().goal))
        for (const char* prefix : {"", "crisp_"}) known.push_back(prefix + mmc::key_of(*row));
      if (!scene.domain) known.insert(known.end(), {kAmplitude, kMotionRatio});
    } else {
      for (const std::string& column : candidates(prepared, part)) known.push_back(column);
    }
  }
  const bool turns = scene.statics && scene.statics->path == fem::StaticSettings::Path::arc_length;
  if (turns) known.push_back(kLimit + "1");
  for (const auto& [name, wanted] : scene.expect) {
    if (turns && limit_number(name) > 0) continue;
    const std::string column =
        name.ends_with(kLargest) ? name.substr(0, name.size() - kLargest.size()) : name;
    if (std::find(known.begin(), known.end(), column) != known.end()) continue;
    throw Error::input(
        wanted.location + ": expect.\"" + name +
        "\": a run of this case has no number with this name; possible names: " + joined(known) +
        "; COLUMN.largest is the largest absolute value of a column (--set expect= "
        "removes all expectations)");
  }
}

}  // namespace flexmorph::cases
