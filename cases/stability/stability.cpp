#include "cases/stability/stability.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "cases/check/ready.h"
#include "cases/run/run.h"
#include "cases/stability/suites.h"
#include "cases/study/rows.h"
#include "geometry/sanitizers.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kRowsBetweenWrites = 10;
constexpr double kMemoryLimit = 4e9;  // memory limit of a run [bytes]

/// The rows of the report, and the run of each row.
struct Plan {
  std::vector<StabilityRow> rows;
  std::vector<Variant> variants;
};

std::vector<const Suite*> wanted_suites(const StabilityOptions& options) {
  std::vector<const Suite*> out;
  for (const std::string& name : options.suites) out.push_back(&suite(name));
  for (const Suite& each : suites())
    if (options.suites.empty() && !each.on_request) out.push_back(&each);
  return out;
}

/// Adds the rows of one case. A run of the unchanged case precedes the changed runs of a
/// subproblem.
void add_case(const StabilityOptions& options, const std::string& name, Plan& out) {
  const std::string path = find_case(name);
  const Scene scene = read_scene(io::CaseFile(path, options.overrides));
  const auto add = [&](const std::string& suite_name, const std::string& folder,
                       const Perturbation& perturbation) {
    StabilityRow& row = out.rows.emplace_back();
    row.case_name = scene.name;
    row.suite = suite_name;
    row.parameter = perturbation.parameter;
    Variant& variant = out.variants.emplace_back();
    variant.name = scene.name + "/" + folder;
    variant.case_name = name;  // a shipped case may have another path on another machine
    variant.overrides = short_overrides(scene, perturbation.part);
    variant.overrides.insert(variant.overrides.end(), perturbation.overrides.begin(),
                             perturbation.overrides.end());
  };
  std::set<Part> unchanged;
  for (const Suite* each : wanted_suites(options)) {
    size_t count = 0;
    for (const Perturbation& p : each->rows(scene)) {
      if (unchanged.insert(p.part).second)
        add("base", to_string(p.part), {"unchanged", {}, p.part});
      add(each->name, each->name + "_" + std::to_string(++count), p);
    }
  }
}

/// Copies the result of a run that has ended into its row.
void take_result(const VariantResult& result, StabilityRow& row) {
  if (row.has_run || (!result.done() && result.status != "failed")) return;
  row.has_run = true;
  row.exit_code = result.ending.code;
  row.seconds_cpu = std::fmax(result.seconds_cpu, result.ending.seconds);  // one may be NaN
  row.assessment = assess(result);
}

/// Writes the tables of all rows whose runs have ended.
/// @return the rows whose runs have ended
std::vector<StabilityRow> write_tables(const std::string& stem,
                                       const std::vector<StabilityRow>& rows) {
  std::vector<StabilityRow> ran;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(ran),
               [](const StabilityRow& row) { return row.has_run; });
  write_stability_csv(ran, stem + ".csv.tmp");
  std::filesystem::rename(stem + ".csv.tmp", stem + ".csv");
  io::write_file(stem + ".md", stability_markdown(ran));
  io::write_file(stem + ".svg", stability_svg(ran));
  return ran;
}

}  // namespace

int check_stability(const StabilityOptions& options) {
  Plan plan;
  wanted_suites(options);
  for (const std::string& name : options.cases.empty() ? shipped_cases() : options.cases)
    add_case(options, name, plan);
  StudyOptions study;
  study.directory = options.directory;
  study.overrides = options.overrides;
  study.jobs = options.jobs;
  study.quiet = options.quiet;
  study.time_limit = options.timeout;
  if (!kSanitized) study.memory_limit = kMemoryLimit;
  study.arguments = {"--condition"};
  study.keeps_failures = true;
  study.dispatch = options.dispatch;
  if (study.dispatch.prints()) return run_variants(study, plan.variants, {}).exit_code;
  const std::string stem = options.directory + "/stability";
  size_t calls = 0;
  const auto changed = [&](std::span<const VariantResult> results) {
    for (size_t i = 0; i < results.size(); ++i) take_result(results[i], plan.rows[i]);
    if (++calls % kRowsBetweenWrites == 0) write_tables(stem, plan.rows);
  };
  const StudyOutcome outcome = run_variants(study, plan.variants, changed);
  const std::vector<StabilityRow> ran = write_tables(stem, plan.rows);
  print_text(stability_text(ran, !options.quiet) + rows_note(outcome.results, true) + stem +
             ".csv, .md, .svg, rows.csv");
  const bool any_wrong = std::any_of(ran.begin(), ran.end(), [](const StabilityRow& row) {
    return row.assessment.verdict == StabilityVerdict::wrong;
  });
  return outcome.exit_code == 4 ? 4 : any_wrong ? 3 : 0;
}

}  // namespace flexmorph::cases
