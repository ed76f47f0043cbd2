#include "cases/study/compare_cycles.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cases/assembly/build.h"
#include "cases/check/ready.h"
#include "cases/run/run.h"
#include "cases/study/rows.h"
#include "io/plots.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

/// A kind of design cycles: its name and its overrides.
struct Way {
  const char* name;
  std::vector<std::string> changes;
};
// Cycles of equivalent static loads alone are run as corrected cycles without corrections, because
// then J of their design is measured too.
const Way kWays[] = {{"esl", {"cycle.correct=first_order", "cycle.corrections=0"}},
                     {"corrected", {"cycle.correct=first_order"}},
                     {"direct", {"cycle.correct=direct"}}};

const Way& way_called(const std::string& name) {
  const auto found = std::find_if(std::begin(kWays), std::end(kWays),
                                  [&](const Way& w) { return w.name == name; });
  if (found == std::end(kWays))
    throw Error::input("compare: --cycles: '" + name +
                       "' is unknown; the kinds of cycles are: esl, corrected, direct");
  return *found;
}

/// The result of a kind of cycles: its name and the content of run.json.
struct Result {
  std::string name;
  nlohmann::json run;

  double number(const char* table, const char* key) const {
    return run.contains(table) ? run[table].value(key, 0.0) : 0.0;
  }
  /// Returns the curve of the smallest J so far over the CPU time of the corrections [s].
  io::Curve curve() const {
    io::Curve out{.name = name, .markers = true};
    double least = 1e300;
    for (const auto& cycle : run.value("corrected_cycles", nlohmann::json::array())) {
      if (cycle.value("accepted", false)) least = std::min(least, cycle.value("objective", least));
      out.x.push_back(cycle.value("seconds", 0.0));
      out.y.push_back(least);
    }
    return out;
  }
};

/// Columns of compare.csv.
const std::vector<std::string> kColumns = {"cycles",
                                           "status",
                                           "least J met",
                                           "J",
                                           "crisp J",
                                           "KKT residual",
                                           "left [%]",
                                           "motions",
                                           "CPU of correcting [s]",
                                           "CPU of the run [s]"};

/// Returns the headings of the printed table, and a row per kind of cycles in the order of
/// kColumns.
std::vector<std::vector<std::string>> table_of(const std::vector<Result>& results) {
  std::vector<std::vector<std::string>> out = {
      {"cycles", "status", "smallest J", "final J", "final crisp J", "KKT residual",
       "predicted decrease [%]", "motions", "CPU of corrections [s]", "CPU of the run [s]"}};
  for (const Result& r : results) {
    const auto cycles = r.run.value("corrected_cycles", nlohmann::json::array());
    const auto last = [&](const char* key) {
      return cycles.empty() ? 0.0 : cycles.back().value(key, 0.0);
    };
    out.push_back({r.name, r.run.value("status", "missing"),
                   cycles.empty() ? "" : io::to_text(r.curve().y.back(), 6),
                   io::to_text(r.number("certificate", "value"), 6),
                   io::to_text(r.number("certificate", "crisp_value"), 6),
                   io::to_text(r.number("certificate", "kkt"), 3),
                   io::to_text(100 * r.number("certificate", "left"), 3),
                   io::to_text(last("motions")), io::to_text(last("seconds"), 4),
                   io::to_text(r.run.value("seconds_cpu", 0.0), 4)});
  }
  return out;
}

void write(const std::vector<Result>& results, const std::string& directory,
           const std::string& name, const std::string& note) {
  const auto rows = table_of(results);
  std::vector<std::vector<io::Cell>> cells;
  for (size_t i = 1; i < rows.size(); ++i) cells.emplace_back(rows[i].begin(), rows[i].end());
  const io::CsvWriter table(directory + "/compare.csv", kColumns, cells);
  io::write_file(
      directory + "/compare.md",
      "# " + name + "\n\n" + io::markdown_table(rows) +
          "\nThe final J, its KKT residual and the predicted decrease within the move "
          "limit come from the optimality certificate of the final design. All "
          "certificates use one motion. If the corrected cycles do not reduce J of the "
          "crisp outlines on the design mesh of the case, the final design is the design "
          "before them. The CPU time of the corrections does not include the design "
          "under equivalent static loads, with which all runs begin.\n" +
          note);
  io::Figure figure{.title = name,
                    .panels = {{.x = {.label = "CPU time of corrections [s]"},
                                .y = {.label = "smallest J so far"}}}};
  for (const Result& r : results)
    if (io::Curve curve = r.curve(); !curve.x.empty())
      figure.panels.front().curves.push_back(std::move(curve));
  if (!figure.panels.front().curves.empty())
    io::write_file(directory + "/compare.svg", io::plot_svg(figure));
}

}  // namespace

int compare_cycles(const CompareCyclesOptions& wanted) {
  CompareCyclesOptions options = wanted;
  StudyOptions& study = options.study;
  // The overrides may contain keys of corrected cycles, which are valid only with cycle.correct.
  study.overrides.insert(study.overrides.begin(), "cycle.correct=first_order");
  const Scene scene = read_scene(io::CaseFile(find_case(study.case_name), study.overrides));
  if (scene.designs.empty() || scene.domain)
    throw Error::input("case '" + scene.name +
                       "' has no design of a moving body; --cycles needs one");
  if (study.directory.empty()) study.directory = "runs/compare_cycles_" + scene.name;
  study.overrides.insert(study.overrides.begin(), "output.vtk=false");
  if (!scene.certify) study.overrides.emplace_back("certificate.checkpoints=0");
  std::vector<Variant> variants;
  for (const std::string& name : options.ways) {
    const Way& way = way_called(name);
    variants.push_back({way.name, way.changes});
  }
  if (!study.dispatch.collect) check_variants(study, variants);
  if (study.dispatch.prints()) return run_variants(study, variants, {}).exit_code;
  const auto results_of = [&] {
    std::vector<Result> out;
    for (const Variant& v : variants) {
      const std::string text = text_of(folder_of(study, v) + "/run.json");
      out.push_back(
          {v.name, text.empty() ? nlohmann::json::object() : nlohmann::json::parse(text)});
    }
    return out;
  };
  const StudyOutcome outcome =
      run_variants(study, variants, [&](std::span<const VariantResult> rows) {
        write(results_of(), study.directory, scene.title, rows_note(rows));
      });
  print_table(table_of(results_of()), "compare.md");
  print_text(warnings_note(outcome.results));
  print_text(rows_note(outcome.results));
  std::printf("%s/compare.md, .csv, .svg\n", study.directory.c_str());
  return outcome.exit_code;
}

}  // namespace flexmorph::cases
