#include "cases/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "cases/accuracy/level_rows.h"
#include "cases/accuracy/recommendation.h"
#include "cases/accuracy/report.h"
#include "cases/assembly/build.h"
#include "cases/assembly/resource_estimate.h"
#include "cases/check/ready.h"
#include "cases/run/run.h"
#include "cases/study/rows.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;

const std::vector<std::pair<double, std::string>> kTargets = {
    {1e-2, "1pct"}, {1e-3, "0.1pct"}, {1e-4, "0.01pct"}};
constexpr double kReserve = 0.25;                   // share of the budget for verification
const std::vector<double> kShares = {1, 0.3, 0.1};  // fractions of a target, tried in this order
constexpr double kMotionShare = 0.2;                // factor of the cost exponent, for designs
// Largest ratio of the time limit of a run to its predicted time, and smallest time limit [s].
constexpr double kPatience = 6, kMinTimeLimit = 5;

const char* const kEnded = "ended after";  // message of runs that exceeded their time limit

int unknowns_of(const PreparedCase& prepared, Part part) {
  if (part == Part::motion) return prepared.mechanism().model.n_dofs();
  const Scene& scene = prepared.scene();
  int out = 0;
  for (const BodyDesign& d : scene.designs) out += 2 * (d.grid.nx + 1) * (d.grid.ny + 1);
  return out;
}

/// Tells whether a parameter is requested by its name, or as the leader of a requested parameter.
bool is_wanted(const Parameter& each, const std::vector<std::string>& names) {
  return names.empty() || std::any_of(names.begin(), names.end(), [&](const std::string& name) {
           return name == each.name || parameter(name).group == each.name;
         });
}

/// The accuracy study of a case: it runs the levels and collects their results.
class Measurement {
 public:
  explicit Measurement(const AccuracyOptions& options)
      : options_(options),
        file_(find_case(options.study.case_name), options.study.overrides),
        prepared_(read_scene(file_)),
        scene_(prepared_.scene()),
        budget_(read_duration("--budget", options.budget)),
        rows_(scene_, study_, with_folder(options.study, scene_)) {
    require_buildable(prepared_);
    // The budget chooses levels one after the other. Rows that are run elsewhere have none.
    if (rows_.are_elsewhere()) budget_ = std::numeric_limits<double>::infinity();
    study_.title = "Accuracy of " + scene_.name;
    add_quantities();
    add_series();
  }

  /// Runs, collects or prints the rows of the study.
  /// @return exit code: 0, or 4 if rows are missing
  int run() {
    const Dispatch& dispatch = options_.study.dispatch;
    if (dispatch.prints()) {
      print_rows();
      return 0;
    }
    if (!dispatch.hosts.empty()) rows_.run_known(options_.study.quiet);
    evaluate_rows();
    write();
    return rows_.missing().empty() ? 0 : 4;
  }

 private:
  static StudyOptions with_folder(StudyOptions options, const Scene& scene) {
    if (options.directory.empty()) options.directory = "runs/accuracy_" + scene.name;
    return options;
  }

  /// Measures all levels, and finds the recommendations.
  void evaluate_rows() {
    if (rows_.start_from_optimum()) optimize();
    for (auto& [part, run] : study_.own) {
      measure(part, to_string(part), run, 0);
      if (run.status == kMissing) throw Interrupted();
      if (!run.measured())
        throw Error::numerical("accuracy: the run of the unchanged case failed: " + run.message);
    }
    measure_levels();
    evaluate(study_);
    for (const auto& [target, name] : kTargets)
      study_.recommendations.push_back(recommended(target, name));
  }

  void write() const {
    write_accuracy_csv(study_, path("accuracy.csv"));
    io::write_file(path("accuracy.md"), accuracy_markdown(study_) + origin_note(rows_.results()));
    io::write_file(path("accuracy.svg"), accuracy_svg(study_));
    print_text(accuracy_text(study_) + rows_note(rows_.results(), true) + directory() +
               "/accuracy.md, .csv, .svg, rows.csv");
  }

  /// Prints the command lines of the known rows, and of the runs that verify recommendations if all
  /// levels are measured.
  void print_rows() {
    std::vector<Variant> rows = rows_.known();
    const LevelRows printer = rows_;
    if (rows_.have_results(rows)) {
      options_.study.quiet = true;
      rows_.collect();
      evaluate_rows();
      rows.insert(rows.end(), rows_.missing().begin(), rows_.missing().end());
    }
    printer.print(rows);
  }

  std::string path(const std::string& name) const { return directory() + "/" + name; }
  const std::string& directory() const { return rows_.options().directory; }
  double left() const { return std::max(0.0, budget_ - spent_); }

  void add_quantities() {
    if (!scene_.accuracy)
      throw Error::input(file_.path() +
                         ": the case needs an [accuracy] with a `quantity` (or --set "
                         "'accuracy.quantity=\"...\"'); possible quantities: " +
                         all_candidates(prepared_));
    for (const Interest& interest : scene_.accuracy->quantities) {
      study_.interests.push_back(interest);
      study_.parts.push_back(part_of(prepared_, interest));
      study_.references.push_back(interest.has_reference() ? std::optional(reference_of(interest))
                                                           : std::nullopt);
      study_.own[study_.parts.back()];
    }
  }

  /// Returns the names of parameters from the options or, without them, from the case.
  /// @throws Error (input), with location, for an unknown name
  std::vector<std::string> wanted_names() const {
    for (const std::string& name : options_.refinements) parameter(name);
    if (!options_.refinements.empty()) return options_.refinements;
    for (const std::string& name : scene_.accuracy->refinements) try {
        parameter(name);
      } catch (const Error& error) {
        throw Error::input(scene_.accuracy->location + ": accuracy.refinements: " + error.what());
      }
    return scene_.accuracy->refinements;
  }

  /// Adds the series of the requested parameters for the subproblems of the quantities.
  void add_series() {
    const std::vector<std::string> names = wanted_names();
    for (const Parameter& each : parameters()) {
      if (!is_wanted(each, names)) continue;
      const size_t before = study_.series.size();
      std::string why;
      for (const auto& [part, run] : study_.own) {
        const std::string reason = each.absent(scene_, part);
        if (reason.empty())
          add_series(each, part);
        else
          why = reason;
      }
      if (study_.series.size() == before) study_.absent.emplace_back(each.name, why);
    }
    if (study_.series.empty())
      throw Error::input("accuracy: no requested refinement applies to this case: " +
                         study_.absent.front().first + " (" + study_.absent.front().second + ")");
  }

  void add_series(const Parameter& each, Part part) {
    RefinementSeries& series = study_.series.emplace_back();
    series.parameter = &each;
    series.part = part;
    for (const Interest& q : study_.interests)
      series.theories.push_back(each.theory(scene_, part, q.name));
    for (Level& level : each.levels(scene_, file_)) {
      LevelRun& run = series.levels.emplace_back();
      run.level = std::move(level);
      try {
        run.unknowns = unknowns_of(
            PreparedCase(read_scene(case_of(rows_.options(), rows_.row(part, "", run.level)))),
            part);
      } catch (const Error& error) {
        run.status = "refused";
        run.message = error.what();
      }
    }
  }

  /// Optimizes the case. All levels then analyse the optimized designs.
  void optimize() {
    const VariantResult result = rows_.result_of(LevelRows::optimization(), 0, false);
    if (result.status == kMissing) throw Interrupted();
    if (!result.done())
      throw Error::numerical("accuracy: the optimization failed: " + result.message);
    spent_ += result.seconds_cpu;
    rows_.take_optimum();
    if (!options_.study.quiet)
      print_text("optimization: " + io::to_text(result.seconds_cpu, 3) + " CPU s");
  }

  /// Measures a level by a run, or reads the results of an earlier run of the level.
  /// @param limit     limit of the CPU time [s]; 0 means no limit
  /// @param verifies  true if the run verifies a recommendation
  void measure(Part part, const std::string& name, LevelRun& run, double limit,
               bool verifies = false) {
    const VariantResult result = rows_.result_of(rows_.row(part, name, run.level), limit, verifies);
    run.values.assign(study_.interests.size(), std::numeric_limits<double>::quiet_NaN());
    run.status = result.done() ? "measured" : result.status == kMissing ? kMissing : "failed";
    run.message = result.message;
    run.seconds_cpu = result.seconds_cpu;
    run.memory = result.peak_memory_bytes;
    // The time of an earlier run counts too, so that a repeated study measures the same levels.
    const bool ended = result.message.starts_with(kEnded);
    if (ended || std::isfinite(result.seconds_cpu)) spent_ += ended ? limit : result.seconds_cpu;
    for (size_t q = 0; result.done() && q < study_.interests.size(); ++q)
      if (study_.parts[q] == part)
        run.values[q] = value_in(result.directory, study_.interests[q], part);
    if (options_.study.quiet) return;
    print_text("run " + std::to_string(++n_runs_) + ", " + name + " " + run.level.name + ": " +
               run.status + ", " + io::to_text(run.seconds_cpu, 3) + " CPU s" +
               (std::isfinite(budget_) ? "; remaining budget " + duration_text(left()) : ""));
  }

  /// Measures levels, beginning with short runs, until the budget is used.
  void measure_levels() {
    for (RefinementSeries& series : study_.series) {
      const LevelRun& own = study_.own.at(series.part);
      const std::string& group = series.parameter->group;
      const bool of_motion = group == "elements" || group == "step";
      // Most of the run time of a design is spent on its load sets, not on the motion that supplies
      // them, so parameters of the motion change the run time less.
      series.cost_factor = series.part == Part::design && of_motion ? kMotionShare : 1;
      series.first_guess = own.seconds_cpu;
      for (LevelRun& run : series.levels) {
        if (!run.is_case()) continue;
        LevelRun copy = own;
        copy.level = run.level;
        copy.unknowns = run.unknowns;
        run = std::move(copy);
      }
    }
    const double reserve = options_.verify && std::isfinite(budget_) ? kReserve * budget_ : 0;
    while (const auto next = next_level(study_.series, left() - reserve)) {
      RefinementSeries& series = study_.series[next->first];
      const double limit = std::max(kMinTimeLimit, kPatience * series.seconds(next->second));
      measure(series.part, LevelRows::name_of(series, next->second), series.levels[next->second],
              std::min(limit, std::max(1.0, left())));
    }
  }

  /// Returns the recommendation for a target. Errors of parameters do not always add up, so
  /// settings for a fraction of the target are tried if the first recommendation is withdrawn.
  Recommendation recommended(double target, const std::string& name) {
    const std::string file = scene_.name + "_" + name + ".toml";
    fs::remove(path(file));  // file of an earlier study
    Recommendation first;
    for (size_t attempt = 0; attempt < kShares.size(); ++attempt) {
      Recommendation r = recommend(study_, target, kShares[attempt]);
      if (attempt > 0 && (r.names.empty() || r.overrides == first.overrides)) break;
      if (!r.names.empty() && options_.verify)
        run_recommended(attempt == 0 ? name : name + "_" + std::to_string(attempt + 1), r);
      else if (!r.names.empty())
        r.sentence = "not verified";
      // After a withdrawn attempt, another recommendation is valid only if a run has verified it.
      const bool stands = !r.withdrawn && (attempt == 0 || r.verified);
      if (stands && !r.names.empty()) write_case(file, r);
      if (stands && !r.withdrawn) return r;
      if (attempt == 0) first = std::move(r);
    }
    return first;
  }

  void run_recommended(const std::string& name, Recommendation& r) {
    if (r.seconds > left()) {
      r.sentence = "not verified: the run would take about " + io::to_text(r.seconds, 2) +
                   " s, the remaining budget is " + io::to_text(left(), 2) + " s";
      return;
    }
    std::vector<double> values(study_.interests.size());
    double seconds = 0;
    for (const auto& [part, own] : study_.own) {
      LevelRun run;
      run.level.overrides = r.overrides;
      measure(part, to_string(part) + "_" + name, run,
              std::isfinite(left()) ? std::max(1.0, left()) : 0, true);
      if (run.status == kMissing) {
        r.sentence = "not verified: the run with these settings is missing";
        return;
      }
      if (!run.measured()) {
        r.withdrawn = !run.message.starts_with(kEnded);
        r.sentence = r.withdrawn ? "withdrawn: the run with these settings failed: " + run.message
                                 : "not verified: the run with these settings was " + run.message;
        return;
      }
      seconds += run.seconds_cpu;
      for (size_t q = 0; q < values.size(); ++q)
        if (study_.parts[q] == part) values[q] = run.values[q];
    }
    verify(study_, values, seconds, r);
  }

  /// Writes the case with the recommended settings. The paths of files in the case become absolute,
  /// so that the case can be read from its new folder.
  void write_case(const std::string& file, Recommendation& r) const {
    std::vector<std::string> overrides = r.overrides;
    for (std::string& each : overrides_of_files(file_)) overrides.push_back(std::move(each));
    // The mesh of [verify] is finer than the mesh of the case, but perhaps not finer than the
    // recommended mesh, so [verify] is removed.
    if (scene_.verify && std::any_of(r.overrides.begin(), r.overrides.end(), [](const auto& each) {
          return each.find(".elements=") != std::string::npos;
        }))
      overrides.emplace_back("verify=");
    const io::CaseFile changed = case_of(rows_.options(), {"", overrides});
    try {
      read_scene(changed);
    } catch (const Error& error) {
      r.withdrawn = true;
      r.sentence = std::string("withdrawn: the complete case is invalid with these settings: ") +
                   error.what();
      return;
    }
    r.file = file;
    io::write_file(path(file), changed.text());
  }

  AccuracyOptions options_;
  io::CaseFile file_;
  PreparedCase prepared_;
  const Scene& scene_;
  double budget_ = 0, spent_ = 0;  // allowed and used CPU time of all runs [s]
  int n_runs_ = 0;
  AccuracyStudy study_;
  LevelRows rows_;
};

}  // namespace

int accuracy_case(const AccuracyOptions& options) {
  Measurement measurement(options);
  try {
    return measurement.run();
  } catch (const Interrupted&) {
    return 4;
  }
}

}  // namespace flexmorph::cases
