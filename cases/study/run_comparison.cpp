#include "cases/study/run_comparison.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/assembly/build.h"
#include "cases/results/schema.h"
#include "cases/scene/tables.h"
#include "cases/study/study_page.h"
#include "cases/study/sweep_motion.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// A run that is compared: its results, the numbers of run.json, and a short name.
struct ComparedRun {
  std::string label;
  VariantResult result;
  nlohmann::json numbers;
};

ComparedRun read_compared(const std::string& folder) {
  std::filesystem::path path = std::filesystem::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const std::string text = text_of(path.string() + "/run.json");
  if (text.empty())
    throw Error::input("report: '" + folder +
                       "' contains no run.json; a folder of a run is needed");
  StudyOptions study;
  study.directory = path.parent_path().string();
  ComparedRun out{path.filename().string(), read_result(study, {path.filename().string(), {}}),
                  nlohmann::json::parse(text)};
  return out;
}

/// Returns a value of run.json as text: numbers with five significant digits.
std::string text_of_json(const nlohmann::json& value) {
  if (value.is_number()) return io::to_text(value.get<double>(), 5);
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  return "";
}

/// Adds a column per quantity that one of the entries has.
/// @param heads  names of the columns, to which "name [unit]" is added
template <class Source>
void add_columns(std::span<const ResultQuantity<Source>> table,
                 const std::vector<nlohmann::json>& entries, Rows& rows) {
  for (const ResultQuantity<Source>& q : table) {
    if (std::none_of(entries.begin(), entries.end(),
                     [&](const nlohmann::json& e) { return e.contains(q.name); }))
      continue;
    const std::string unit = q.unit;
    rows[0].push_back(q.name + (unit.empty() || unit == "-" ? "" : " [" + unit + "]"));
    for (size_t i = 0; i < entries.size(); ++i)
      rows[i + 1].push_back(entries[i].contains(q.name) ? text_of_json(entries[i][q.name]) : "");
  }
}

/// Returns a header and a row per run and designed body, with the numbers of the result schema.
Rows number_rows(const std::vector<ComparedRun>& runs) {
  Rows rows = {{"run", "body", "status", "warnings", "wall time [s]"}};
  std::vector<nlohmann::json> designs, outlines, motions;
  for (const ComparedRun& run : runs) {
    const size_t n = std::max<size_t>(1, run.result.bodies.size());
    for (size_t b = 0; b < n; ++b) {
      const bool designed = b < run.result.bodies.size();
      rows.push_back({run.label, designed ? run.result.bodies[b].body : "", run.result.status,
                      io::to_text(static_cast<int>(run.result.warnings.size())),
                      io::to_text(run.result.seconds_wall, 4)});
      const nlohmann::json results =
          designed ? run.numbers["results"][b] : nlohmann::json::object();
      designs.push_back(results);
      outlines.push_back(results.value("body_fitted", nlohmann::json::object()));
      motions.push_back(run.numbers.value("motion", nlohmann::json::object()));
    }
  }
  add_columns(design_quantities(), designs, rows);
  const size_t before = rows[0].size();
  add_columns(outline_quantities(), outlines, rows);
  for (size_t c = before; c < rows[0].size(); ++c) rows[0][c] = "outline: " + rows[0][c];
  const size_t last = rows[0].size();
  add_columns(motion_quantities(), motions, rows);
  for (size_t c = last; c < rows[0].size(); ++c) rows[0][c] = "motion: " + rows[0][c];
  return rows;
}

/// A key with its values in all runs, "" where a run does not give it, and with its default.
struct ComparedKey {
  std::vector<std::string> values;
  std::string fallback;
};

/// Returns the settings that differ between runs: a row per key, a column per run.
Rows setting_rows(const std::vector<ComparedRun>& runs) {
  std::map<std::string, ComparedKey> keys;
  for (size_t i = 0; i < runs.size(); ++i) {
    try {
      const Scene scene = read_scene(io::CaseFile(runs[i].result.directory + "/case.toml"));
      for (const io::Setting& each : scene.file->values()) {
        if (tables::only_describes(each.path)) continue;
        ComparedKey& key = keys[each.path];
        key.values.resize(runs.size());
        key.values[i] = each.value;
        key.fallback = each.fallback;
      }
    } catch (const Error&) {  // a case of another version has no settings here
    }
  }
  Rows rows = {{"key"}};
  for (const ComparedRun& run : runs) rows[0].push_back(run.label);
  for (const auto& [name, key] : keys) {
    const auto effective = [&](const std::string& value) {
      return value.empty() ? key.fallback : value;
    };
    if (std::ranges::all_of(key.values, [&](const std::string& each) {
          return effective(each) == effective(key.values[0]);
        }))
      continue;
    rows.push_back({name});
    for (const std::string& value : key.values)
      rows.back().push_back(!value.empty()         ? value
                            : key.fallback.empty() ? "not given"
                                                   : key.fallback + " (default)");
  }
  return rows.size() > 1 ? rows : Rows();
}

/// Returns the compliance of the designs of all runs over their iterations.
io::Figure convergence_of(const std::vector<ComparedRun>& runs) {
  io::Figure out;
  out.title = "Convergence";
  std::map<std::string, io::Panel> panels;
  for (size_t i = 0; i < runs.size(); ++i)
    for (const BodyResult& body : runs[i].result.bodies) {
      io::Panel& panel = panels[body.body];
      panel.title = body.body;
      panel.x.label = "iteration";
      panel.y = {"compliance [J]", true, {}, {}};
      io::Curve curve{runs[i].label, {}, body.history_compliance};
      for (size_t k = 0; k < curve.y.size(); ++k) curve.x.push_back(static_cast<double>(k + 1));
      curve.color = i;
      panel.curves.push_back(std::move(curve));
    }
  for (auto& [body, panel] : panels) out.panels.push_back(std::move(panel));
  return out;
}

}  // namespace

std::string compare_runs(const ReportOptions& options) {
  std::vector<ComparedRun> runs;
  std::vector<VariantResult> results;
  std::vector<Motions> motions;
  for (const std::string& folder : options.runs) {
    runs.push_back(read_compared(folder));
    results.push_back(runs.back().result);
    motions.push_back(read_motions(results.back().directory, runs.back().label));
  }
  set_units(motions, results);
  StudyPage page;
  page.title = "Comparison of " + io::to_text(static_cast<int>(runs.size())) +
               (runs.size() == 1 ? " run" : " runs");
  page.rows = number_rows(runs);
  page.settings = setting_rows(runs);
  page.plots = {{"convergence", convergence_of(runs)},
                {"motion", motion_figure("Motion", motions, {})}};
  const std::filesystem::path path = std::filesystem::absolute(options.path).lexically_normal();
  write_study_page(page, results, path.string());
  return "The comparison is written to " + options.path + "\n";
}

}  // namespace flexmorph::cases
