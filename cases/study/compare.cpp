#include "cases/study/compare.h"

#include <algorithm>
#include <cstdio>

#include "cases/check/ready.h"
#include "cases/run/run.h"
#include "cases/study/compare_report.h"
#include "cases/study/rows.h"
#include "geometry/text.h"
#include "io/tables.h"
#include "optim/optimizer.h"

namespace flexmorph::cases {
namespace {

/// Returns the names of the compared optimizers.
/// @throws Error (input) for an unknown name, or a repeated one.
std::vector<std::string> optimizers_of(const CompareOptions& options) {
  std::vector<std::string> known = optim::optimizer_names();
  if (options.optimizers.empty()) return known;
  for (const std::string& name : options.optimizers) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error::input("compare: --optimizers: '" + name +
                         "' is unknown; the optimizers are: " + joined(known));
    if (std::count(options.optimizers.begin(), options.optimizers.end(), name) > 1)
      throw Error::input("compare: --optimizers: '" + name + "' appears more than once");
  }
  return options.optimizers;
}

/// Returns the overrides of the case for an optimizer. Without a budget, the optimizer of the case
/// has no overrides, so that its run gives the same design and verdict as `flexmorph run`. The
/// other optimizers may use the same number of state solves.
/// @param budget  number of state solves; 0 means the iterations of the case + 1
std::vector<std::string> changes_for(const std::string& optimizer, const optim::Settings& own,
                                     int budget) {
  std::vector<std::string> out = {"optimizer.name=" + optimizer};
  if (budget == 0 && optimizer == own.name) return out;
  const std::string solves = std::to_string(budget > 0 ? budget : own.max_iterations + 1);
  out.push_back("optimizer.max_iterations=" + solves);
  out.push_back("optimizer.max_solves=" + solves);
  return out;
}

/// Returns the plan of the runs, and sets the folder of the study if none is given.
Comparison plan(CompareOptions& options) {
  StudyOptions& study = options.study;
  Comparison out;
  out.case_name = study.case_name;
  out.optimizers = optimizers_of(options);
  out.starts = options.starts;
  const Scene scene = read_scene(io::CaseFile(find_case(study.case_name), study.overrides));
  if (scene.designs.empty())
    throw Error::input("case '" + scene.name + "' has no [[design]]; `compare` needs a design");
  out.table.names = {"run", "optimizer", "start"};
  if (study.directory.empty()) study.directory = "runs/compare_" + scene.name;
  // VTK files of every iteration of every run are rarely needed. --set output.vtk=true enables
  // them.
  study.overrides.insert(study.overrides.begin(), "output.vtk=false");
  for (const std::string& optimizer : out.optimizers)
    for (int start = 1; start <= options.starts; ++start) {
      Variant v{optimizer + "_" + std::to_string(start),
                changes_for(optimizer, scene.optimizer, options.budget)};
      for (size_t d = 0; start > 1 && d < scene.designs.size(); ++d) {
        const std::string key = "design." + std::to_string(d);
        v.overrides.push_back(key + ".jitter=" + io::to_text(options.jitter));
        v.overrides.push_back(key + ".seed=" + std::to_string(start - 1));
      }
      out.table.values.push_back({v.name, optimizer, std::to_string(start)});
      for (const BodyDesign& d : scene.designs) out.table.goals.push_back(d.goal);
      out.variants.push_back(std::move(v));
    }
  return out;
}

}  // namespace

int compare_case(const CompareOptions& wanted) {
  CompareOptions options = wanted;
  const Comparison comparison = plan(options);
  const std::string& directory = options.study.directory;
  if (!options.study.dispatch.collect) check_variants(options.study, comparison.variants);
  if (options.study.dispatch.prints())
    return run_variants(options.study, comparison.variants, {}).exit_code;
  const StudyOutcome outcome = run_variants(
      options.study, comparison.variants,
      [&](std::span<const VariantResult> runs) { write_comparison(comparison, runs, directory); });
  print_table(summary_of(comparison, outcome.results), "compare.md");
  print_text(warnings_note(outcome.results));
  print_text(convergence_note(outcome.results));
  print_text(rows_note(outcome.results));
  print_text(directory + ": compare.html, compare.md, compare.csv, compare.svg, rows.csv\n");
  return outcome.exit_code;
}

}  // namespace flexmorph::cases
