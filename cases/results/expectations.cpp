#include "cases/results/expectations.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "cases/results/limit_points.h"
#include "cases/results/quantities.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

const std::string kLargest = ".largest", kLimit = "limit_load_";

/// None where outlines could not be united.
Features widths_of(const mmc::BodyOutcome& o) { return o.sharp.features.value_or(Features{0, 0}); }

/// Figures of the first design of a run.
const std::vector<std::pair<std::string, std::function<double(const mmc::BodyOutcome&)>>> kFigures =
    {
        {"compliance", [](const mmc::BodyOutcome& o) { return o.compliance; }},
        {"volume", [](const mmc::BodyOutcome& o) { return o.volume; }},
        {"sharp_compliance", [](const mmc::BodyOutcome& o) { return o.sharp.compliance; }},
        {"sharp_volume", [](const mmc::BodyOutcome& o) { return o.sharp.volume; }},
        {"compliance_ratio",
         [](const mmc::BodyOutcome& o) { return o.sharp.compliance / o.uniform_compliance; }},
        {"sharp_ratio",
         [](const mmc::BodyOutcome& o) { return o.sharp.compliance / o.compliance; }},
        {"min_feature", [](const mmc::BodyOutcome& o) { return widths_of(o).solid; }},
        {"min_gap", [](const mmc::BodyOutcome& o) { return widths_of(o).gap; }},
        {"islands", [](const mmc::BodyOutcome& o) { return 1.0 * o.sharp.connectivity.islands; }},
};
const std::string kAmplitude = "amplitude", kDefect = "energy.defect",
                  kMotionRatio = "motion_ratio";

/// Figures of what else its goal speaks of.
std::vector<std::pair<const mmc::Figures*, std::string>> further_of(const mmc::BodyOutcome& o) {
  return {{&o.further, ""}, {&o.sharp.further, "sharp_"}};
}

/// A column of motion.csv or path.csv; null where there is none.
const std::vector<double>* column_of(const MotionRecord& motion, const std::string& name) {
  if (name == "energy.kinetic") return &motion.kinetic;
  if (name == "energy.strain") return &motion.strain;
  if (name == "energy.potential") return &motion.potential;
  if (name == "energy.defect") return &motion.defect;
  for (size_t i = 0; i < motion.bodies.size(); ++i)
    if (name == motion.bodies[i] + ".tip_deflection") return &motion.deflection[i];
  return motion.column(name);
}
const std::vector<double>* column_of(const PathRecord& path, const std::string& name) {
  return name == "energy.strain" ? &path.strain : path.column(name);
}

/// The number of a limit load of a path, from 1 on; 0 for other names.
size_t limit_number(const std::string& name) {
  const std::string digit = name.starts_with(kLimit) ? name.substr(kLimit.size()) : "";
  return digit.size() == 1 && digit[0] >= '1' && digit[0] <= '9'
             ? static_cast<size_t>(digit[0] - '0')
             : 0;
}

std::optional<double> limit_of(const PathRecord& path, size_t number) {
  const std::vector<double> all = limit_loads(path.arc, path.factor);
  return number <= all.size() ? std::optional<double>(all[number - 1]) : std::nullopt;
}

/// The value of a column at the end, or with "<column>.largest" its largest absolute value.
template <class Record>
std::optional<double> value_of(const Record& record, const std::string& name) {
  if (const std::vector<double>* values = column_of(record, name))
    return values->empty() ? std::optional<double>() : values->back();
  if (!name.ends_with(kLargest)) return {};
  const std::vector<double>* values =
      column_of(record, name.substr(0, name.size() - kLargest.size()));
  if (!values || values->empty()) return {};
  double largest = 0;
  for (const double v : *values) largest = std::max(largest, std::abs(v));
  return largest;
}

std::optional<double> find(const RunReport& report, const std::string& name) {
  if (!report.outcomes.empty())
    for (const auto& [figure, value] : kFigures)
      if (figure == name) return value(report.outcomes.front());
  if (!report.outcomes.empty())
    for (const auto& [figures, prefix] : further_of(report.outcomes.front()))
      for (const auto& [figure, value] : *figures)
        if (prefix + figure == name) return value;
  // What a design is judged by; the balance of energy is kept by the motion on the scene's mesh.
  if (const auto& judging = report.judging(); judging && !name.starts_with(kDefect)) {
    if (name == kAmplitude && !judging->amplitude.empty()) return judging->amplitude[0];
    if (const auto& uniform = report.judging_uniform(); uniform && name == kMotionRatio)
      return judging->strain_integral / uniform->strain_integral;
    if (const auto found = value_of(*judging, name)) return found;
  }
  if (report.motion)
    if (const auto found = value_of(*report.motion, name)) return found;
  if (!report.path) return {};
  if (const size_t number = limit_number(name)) return limit_of(*report.path, number);
  return value_of(*report.path, name);
}

std::string words_of(const Expectation& wanted) {
  std::string out;
  const auto add = [&](const std::string& words) { out += (out.empty() ? "" : ", ") + words; };
  if (wanted.value)
    add(io::to_text(*wanted.value, 9) + " within " + io::to_text(wanted.tolerance, 3));
  if (wanted.at_least) add("at least " + io::to_text(*wanted.at_least, 9));
  if (wanted.at_most) add("at most " + io::to_text(*wanted.at_most, 9));
  return out;
}

}  // namespace

std::vector<Expected> judge_expectations(const Scene& scene, const RunReport& report) {
  std::vector<Expected> out;
  for (const auto& [name, wanted] : scene.expect) {
    Expected e;
    e.name = name;
    e.found = find(report, name);
    e.holds = e.found && wanted.holds(*e.found);
    e.words = name + " = " + (e.found ? io::to_text(*e.found, 9) : std::string("nothing")) +
              ": expected " + words_of(wanted);
    out.push_back(std::move(e));
  }
  return out;
}

void check_expectations(const Scene& scene) {
  if (scene.expect.empty()) return;
  std::vector<std::string> known;
  for (const Part part : parts_of(scene)) {
    if (part == Part::design) {
      for (const auto& [figure, value] : kFigures) known.push_back(figure);
      for (const mmc::ResponseRow* row : mmc::further_rows(scene.designs.front().goal))
        for (const char* prefix : {"", "sharp_"}) known.push_back(prefix + mmc::key_of(*row));
      if (!scene.domain) known.insert(known.end(), {kAmplitude, kMotionRatio});
    } else {
      for (const std::string& column : candidates(scene, part)) known.push_back(column);
    }
  }
  const bool turns = scene.statics && scene.statics->path == fem::StaticSettings::Path::arc_length;
  if (turns) known.push_back(kLimit + "1");
  for (const auto& [name, wanted] : scene.expect) {
    if (turns && limit_number(name) > 0) continue;
    const std::string column =
        name.ends_with(kLargest) ? name.substr(0, name.size() - kLargest.size()) : name;
    if (std::find(known.begin(), known.end(), column) != known.end()) continue;
    std::string all;
    for (const std::string& each : known) all += (all.empty() ? "" : ", ") + each;
    throw Error::input(wanted.place + ": expect.\"" + name +
                       "\": a run of this case has no such number; there are: " + all +
                       "; of columns also their largest size, COLUMN.largest (--set expect= "
                       "leaves them out)");
  }
}

}  // namespace flexmorph::cases
