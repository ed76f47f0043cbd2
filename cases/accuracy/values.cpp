#include "cases/accuracy/values.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "cases/study/study.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Tells whether the quantity is a number of run.json.
bool is_of_run(const Scene& scene, const std::string& name) {
  return name.starts_with(scene.statics ? "static." : "motion.");
}

/// Returns the value at `at` of the Lagrange polynomial through rows first .. first + count - 1.
double interpolated(const std::vector<double>& x, const std::vector<double>& y, size_t first,
                    size_t count, double at) {
  double out = 0;
  for (size_t i = first; i < first + count; ++i) {
    double weight = 1;
    for (size_t j = first; j < first + count; ++j)
      if (j != i) weight *= (at - x[j]) / (x[i] - x[j]);
    out += weight * y[i];
  }
  return out;
}

/// Returns the largest absolute value: the extremum of a parabola through the largest row and its
/// neighbours.
double largest_size(const std::vector<double>& x, const std::vector<double>& y) {
  size_t top = 0;
  for (size_t i = 0; i < y.size(); ++i)
    if (std::abs(y[i]) > std::abs(y[top])) top = i;
  const double peak = std::abs(y[top]);
  if (top == 0 || top + 1 == y.size()) return peak;
  // Newton's form of the parabola about the largest row: y = y₀ + s (x - x₀) + c (x - x₀)(x - x₋).
  const double hm = x[top] - x[top - 1], hp = x[top + 1] - x[top];
  const double left = (peak - std::abs(y[top - 1])) / hm,
               right = (std::abs(y[top + 1]) - peak) / hp;
  const double c = (right - left) / (hm + hp), slope = left + c * hm;
  return c < 0 ? peak - slope * slope / (4 * c) : peak;
}

/// Returns the value of a column of a table. A mesh change produces two rows at one time, of which
/// the second row is used.
double column_value(const io::CsvTable& table, const std::string& abscissa,
                    const Interest& interest) {
  const std::vector<double> x = table.numbers(abscissa), y = table.numbers(interest.name);
  std::vector<double> locations, values;
  for (size_t i = 0; i < x.size(); ++i) {
    if (!locations.empty() && x[i] <= locations.back()) {
      values.back() = y[i];
      continue;
    }
    locations.push_back(x[i]);
    values.push_back(y[i]);
  }
  return locations.empty() ? kUndefined : value_at(locations, values, interest);
}

/// Returns the number of a JSON object at a dotted path; NaN if there is none.
double json_value(const nlohmann::json& run, const std::string& path) {
  const nlohmann::json* here = &run;
  for (size_t begin = 0; begin <= path.size();) {
    const size_t dot = std::min(path.find('.', begin), path.size());
    // Names of columns may contain dots, so the whole remaining path may be one key.
    if (const std::string rest = path.substr(begin); here->is_object() && here->contains(rest)) {
      here = &(*here)[rest];
      break;
    }
    const std::string key = path.substr(begin, dot - begin);
    if (!here->is_object() || !here->contains(key)) return kUndefined;
    here = &(*here)[key];
    begin = dot + 1;
  }
  return here->is_number() ? here->get<double>() : kUndefined;
}

/// Returns a number of the first design, or of the design of a named body ("arm.volume"); NaN if
/// there is none.
double design_value(const nlohmann::json& run, const std::string& name) {
  const size_t dot = name.find('.');
  const std::string body = dot == std::string::npos ? "" : name.substr(0, dot);
  const std::string figure = dot == std::string::npos ? name : name.substr(dot + 1);
  for (const nlohmann::json& each : run.value("results", nlohmann::json::array()))
    if (body.empty() || each.value("body", "") == body) return json_value(each, figure);
  return kUndefined;
}

}  // namespace

Part part_of(const PreparedCase& prepared, const Interest& interest) {
  const Scene& scene = prepared.scene();
  for (const Part part : parts_of(scene)) {
    const bool known = holds(candidates(prepared, part), interest.name) ||
                       (part == Part::motion && is_of_run(scene, interest.name));
    if (!known) continue;
    if (interest.at != Interest::At::end &&
        (part == Part::design || is_of_run(scene, interest.name)))
      scene.refuse("accuracy.at", "the quantity \"" + interest.name +
                                      "\" is one number per run; `at` is only for columns");
    const double end = scene.statics ? scene.statics->to : scene.time.end;
    if (interest.at == Interest::At::time && interest.time > end * (1 + 1e-9))
      scene.refuse("accuracy.at", "the time " + io::to_text(interest.time) + " of \"" +
                                      interest.name + "\" is after the end of the run, " +
                                      io::to_text(end));
    return part;
  }
  scene.refuse(
      "accuracy.quantity",
      "\"" + interest.name + "\": this case has no quantity with this name; possible quantities: " +
          all_candidates(prepared) + ", and numbers of run.json such as motion.constraint_drift");
}

double value_at(const std::vector<double>& x, const std::vector<double>& y,
                const Interest& interest) {
  if (x.empty()) return kUndefined;
  if (interest.at == Interest::At::max) return largest_size(x, y);
  if (interest.at == Interest::At::end) return y.back();
  const double t = interest.time, near = 1e-9 * std::max(std::abs(x.back()), std::abs(t));
  if (t < x.front() - near || t > x.back() + near) return kUndefined;
  const auto above = static_cast<size_t>(std::lower_bound(x.begin(), x.end(), t) - x.begin());
  for (const size_t i : {above, above - 1})
    if (i < x.size() && std::abs(x[i] - t) <= near) return y[i];
  const size_t count = std::min<size_t>(4, x.size());
  const size_t first = std::min(above > 1 ? above - 2 : 0, x.size() - count);
  return interpolated(x, y, first, count, t);
}

double value_in(const std::string& folder, const Interest& interest, Part part) {
  double out = kUndefined;
  const nlohmann::json run = nlohmann::json::parse(text_of(folder + "/run.json"), nullptr, false);
  if (part == Part::design) {
    if (run.is_object()) out = design_value(run, interest.name);
  } else {
    const bool path = std::filesystem::exists(folder + "/path.csv");
    const io::CsvTable table = io::read_csv(folder + (path ? "/path.csv" : "/motion.csv"));
    if (holds(table.columns, interest.name))
      out = column_value(table, path ? "load_factor" : "time", interest);
    else if (run.is_object())
      out = json_value(run, interest.name);
  }
  if (!std::isfinite(out))
    throw Error::numerical(folder + ": the results have no value of " + interest.words());
  return out;
}

double reference_of(const Interest& interest) {
  if (interest.value) return *interest.value;
  const io::CsvTable table = io::read_csv(interest.file);
  if (!holds(table.columns, interest.name))
    throw Error::input(interest.file + ": the file has no column " + interest.name);
  const double out = column_value(table, table.columns.front(), interest);
  if (!std::isfinite(out))
    throw Error::input(interest.file + ": the file has no value of " + interest.words());
  return out;
}

}  // namespace flexmorph::cases
