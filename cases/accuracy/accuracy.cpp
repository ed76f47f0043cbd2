#include "cases/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "cases/accuracy/recommendation.h"
#include "cases/accuracy/report.h"
#include "cases/assembly/build.h"
#include "cases/assembly/resource_estimate.h"
#include "cases/check/ready.h"
#include "cases/output/run_folder.h"
#include "cases/run/run.h"
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
        budget_(read_duration("--budget", options.budget)) {
    require_buildable(prepared_);
    runs_.directory =
        options.study.directory.empty() ? "runs/accuracy_" + scene_.name : options.study.directory;
    runs_.case_name = options.study.case_name;
    runs_.overrides = options.study.overrides;
    runs_.threads = options.study.threads;
    runs_.quiet = true;
    study_.title = "Accuracy of " + scene_.name;
    add_quantities();
    add_series();
  }

  void run() {
    if (scene_.accuracy->optimized && study_.own.contains(Part::design)) optimize();
    for (auto& [part, run] : study_.own) {
      measure(part, to_string(part), run, 0);
      if (!run.measured())
        throw Error::numerical("accuracy: the run of the unchanged case failed: " + run.message);
    }
    measure_levels();
    evaluate(study_);
    for (const auto& [target, name] : kTargets)
      study_.recommendations.push_back(recommended(target, name));
    write_accuracy_csv(study_, path("accuracy.csv"));
    io::write_file(path("accuracy.md"), accuracy_markdown(study_));
    io::write_file(path("accuracy.svg"), accuracy_svg(study_));
    print_text(accuracy_text(study_) + runs_.directory + "/accuracy.md, .csv, .svg");
  }

 private:
  std::string path(const std::string& name) const { return runs_.directory + "/" + name; }
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
            PreparedCase(read_scene(case_of(runs_, variant(part, "", run.level)))), part);
      } catch (const Error& error) {
        run.status = "refused";
        run.message = error.what();
      }
    }
  }

  /// Optimizes the case. All levels then analyse the optimized designs.
  void optimize() {
    const Variant one{
        "optimized", {"output.vtk=false", "output.plots=false", "output.crisp_every=0", "verify="}};
    const VariantResult result = result_of(one);
    if (!result.done())
      throw Error::numerical("accuracy: the optimization failed: " + result.message);
    spent_ += result.seconds_cpu;
    const std::string folder = fs::absolute(result.directory).string();
    for (size_t i = 0; i < scene_.designs.size(); ++i)
      starts_.push_back("design." + std::to_string(i) + ".start='" + folder + "/" +
                        components_name(scene_, scene_.designs[i].body) + "'");
    if (!options_.study.quiet)
      print_text("optimization: " + io::to_text(result.seconds_cpu, 3) + " CPU s");
  }

  VariantResult result_of(const Variant& variant) const {
    const StudyOutcome outcome = run_variants(runs_, {&variant, 1}, [](auto) {});
    if (outcome.exit_code == 4) throw Interrupted();
    return outcome.results.front();
  }

  Variant variant(Part part, const std::string& name, const Level& level) const {
    Variant out{name, lean_overrides(scene_, part)};
    if (const auto last = last_time(); part == Part::motion && last)
      out.overrides.push_back("time.end=" + io::to_text(*last));
    for (const auto& more :
         {part == Part::design ? starts_ : std::vector<std::string>(), level.overrides})
      out.overrides.insert(out.overrides.end(), more.begin(), more.end());
    return out;
  }

  /// Returns the last time at which a quantity of the motion is needed, if it is before the end of
  /// the motion. A start from a static hub has no such time, because the default duration of its
  /// spin-up depends on the end time.
  std::optional<double> last_time() const {
    if (scene_.domain || scene_.statics || scene_.time.start == Start::hub_at_rest) return {};
    double out = 0;
    for (size_t q = 0; q < study_.interests.size(); ++q) {
      if (study_.parts[q] != Part::motion) continue;
      if (study_.interests[q].at != Interest::At::time) return {};
      out = std::max(out, study_.interests[q].time);
    }
    return out > 0 && out < scene_.time.end ? std::optional(out) : std::nullopt;
  }

  /// Measures a level by a run, or reads the results of an earlier run of the level.
  /// @param limit  limit of the CPU time [s]; 0 means no limit
  void measure(Part part, const std::string& name, LevelRun& run, double limit) {
    runs_.time_limit = limit;
    const VariantResult result = result_of(variant(part, name, run.level));
    runs_.time_limit = 0;
    run.values.assign(study_.interests.size(), std::numeric_limits<double>::quiet_NaN());
    run.status = result.done() ? "measured" : "failed";
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
               run.status + ", " + io::to_text(run.seconds_cpu, 3) + " CPU s; remaining budget " +
               duration_text(left()));
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
    const double reserve = options_.verify ? kReserve * budget_ : 0;
    while (const auto next = next_level(study_.series, left() - reserve)) {
      RefinementSeries& series = study_.series[next->first];
      const double limit = std::max(kMinTimeLimit, kPatience * series.seconds(next->second));
      const std::string name = to_string(series.part) + "_" + series.parameter->name + "_" +
                               std::to_string(next->second + 1);
      measure(series.part, name, series.levels[next->second],
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
      measure(part, to_string(part) + "_" + name, run, std::max(1.0, left()));
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
    const io::CaseFile changed = case_of(runs_, {"", overrides});
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
  StudyOptions runs_;
  double budget_ = 0, spent_ = 0;  // allowed and used CPU time of all runs [s]
  int n_runs_ = 0;
  std::vector<std::string> starts_;  // overrides that set the starts of the designs
  AccuracyStudy study_;
};

}  // namespace

int accuracy_case(const AccuracyOptions& options) {
  Measurement measurement(options);
  try {
    measurement.run();
  } catch (const Interrupted&) {
    return 4;
  }
  return 0;
}

}  // namespace flexmorph::cases
