#include "cases/accuracy/level_rows.h"

#include <algorithm>

#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"
#include "cases/study/rows.h"
#include "io/files.h"
#include "io/output_folder.h"

namespace flexmorph::cases {

LevelRows::LevelRows(const Scene& scene, const AccuracyStudy& study, const StudyOptions& options)
    : scene_(scene), study_(study), options_(options) {
  options_.quiet = true;
  options_.keeps_failures = are_elsewhere();  // refused levels have no folder there
}

bool LevelRows::are_elsewhere() const {
  const Dispatch& dispatch = options_.dispatch;
  return dispatch.collect || dispatch.prints() || !dispatch.hosts.empty();
}

bool LevelRows::start_from_optimum() const {
  return scene_.accuracy->optimized && study_.own.contains(Part::design);
}

Variant LevelRows::optimization() {
  return {"optimized",
          {"output.vtk=false", "output.plots=false", "output.crisp_every=0", "verify="}};
}

void LevelRows::take_optimum() {
  starts_.clear();
  for (size_t i = 0; i < scene_.designs.size(); ++i)
    starts_.push_back("design." + std::to_string(i) + ".start='" +
                      folder_of(options_, optimization()) + "/" +
                      components_name(scene_, scene_.designs[i].body) + "'");
}

Variant LevelRows::row(Part part, const std::string& name, const Level& level) const {
  Variant out{name, lean_overrides(scene_, part)};
  if (const auto last = last_time(); part == Part::motion && last)
    out.overrides.push_back("time.end=" + io::to_text(*last));
  for (const auto& more :
       {part == Part::design ? starts_ : std::vector<std::string>(), level.overrides})
    out.overrides.insert(out.overrides.end(), more.begin(), more.end());
  return out;
}

std::string LevelRows::name_of(const RefinementSeries& series, size_t level) {
  return to_string(series.part) + "_" + series.parameter->name + "_" + std::to_string(level + 1);
}

/// Returns the last time at which a quantity of the motion is needed, if it is before the end of
/// the motion. A start from a static hub has no such time, because the default duration of its
/// spin-up depends on the end time.
std::optional<double> LevelRows::last_time() const {
  if (scene_.domain || scene_.statics || scene_.time.start == Start::hub_at_rest) return {};
  double out = 0;
  for (size_t q = 0; q < study_.interests.size(); ++q) {
    if (study_.parts[q] != Part::motion) continue;
    if (study_.interests[q].at != Interest::At::time) return {};
    out = std::max(out, study_.interests[q].time);
  }
  return out > 0 && out < scene_.time.end ? std::optional(out) : std::nullopt;
}

VariantResult LevelRows::result_of(const Variant& row, double limit, bool verifies) {
  VariantResult out;
  if (are_elsewhere() && !verifies) {
    make_folder(options_.directory);
    io::require_study_folder(options_.directory);
    out = collected_row(options_, row);
  } else {
    StudyOptions options = options_;
    options.time_limit = limit;
    const StudyOutcome outcome = run_rows(options, {&row, 1}, [](auto) {});
    if (outcome.exit_code == 4 && !are_elsewhere()) throw Interrupted();
    out = outcome.results.front();
  }
  results_.push_back(out);
  std::vector<VariantResult> rows = results_;  // in an order that depends on measured times
  std::ranges::sort(rows, {}, &VariantResult::name);
  write_rows(rows, options_.directory + "/rows.csv");
  if (out.done() || out.status == "failed") return out;
  missing_.push_back(row);
  out.status = kMissing;
  return out;
}

std::vector<Variant> LevelRows::known() {
  std::vector<Variant> out;
  bool has_designs = true;
  if (start_from_optimum()) {
    out.push_back(optimization());
    has_designs = read_result(options_, out.back()).done();
    if (has_designs) take_optimum();
  }
  for (const auto& [part, run] : study_.own)
    if (has_designs || part != Part::design) out.push_back(row(part, to_string(part), {}));
  for (const RefinementSeries& series : study_.series)
    for (size_t level = 0; level < series.levels.size(); ++level)
      if (const LevelRun& run = series.levels[level];
          run.status == "open" && !run.is_case() && (has_designs || series.part != Part::design))
        out.push_back(row(series.part, name_of(series, level), run.level));
  return out;
}

void LevelRows::run_known(bool quiet) {
  StudyOptions options = options_;
  options.quiet = quiet;
  const auto run = [&](const std::vector<Variant>& rows) {
    if (run_variants(options, rows, [](auto) {}).exit_code == 4) throw Interrupted();
  };
  const std::vector<Variant> rows = known();
  run(rows);
  if (const std::vector<Variant> all = known(); all.size() > rows.size()) run(all);
}

bool LevelRows::have_results(const std::vector<Variant>& rows) const {
  return std::all_of(rows.begin(), rows.end(), [&](const Variant& row) {
    return is_answered(options_, row, read_result(options_, row));
  });
}

void LevelRows::print(const std::vector<Variant>& rows) const { run_variants(options_, rows, {}); }

}  // namespace flexmorph::cases
