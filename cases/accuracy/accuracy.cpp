#include "cases/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

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

const std::vector<std::pair<double, std::string>> kPromises = {
    {1e-2, "1pct"}, {1e-3, "0.1pct"}, {1e-4, "0.01pct"}};
constexpr double kReserve = 0.25;                   // of the budget, for verification
const std::vector<double> kShares = {1, 0.3, 0.1};  // of a promise
constexpr double kMotionShare = 0.2;                // of the time that a design takes
// A run may take so many times what was predicted, and so long in any case [s].
constexpr double kPatience = 6, kLeastLimit = 5;

const char* const kEnded = "ended after";  // the message of runs whose time is up

struct Stopped {};  // by the user

/// A knob of the motion that is turned for the sake of a design.
bool of_motion(const Ladder& ladder) {
  return ladder.part == Part::design &&
         (ladder.knob->group == "elements" || ladder.knob->group == "step");
}

void append(const std::vector<std::string>& more, std::vector<std::string>& out) {
  out.insert(out.end(), more.begin(), more.end());
}

int unknowns_of(const Scene& scene, Part part) {
  if (part == Part::motion) return build_mechanism(scene).model.n_dofs();
  int out = 0;
  for (const BodyDesign& d : scene.designs) out += 2 * (d.grid.nx + 1) * (d.grid.ny + 1);
  return out;
}

/// Runs levels and keeps what they came to.
class Story {
 public:
  explicit Story(const AccuracyOptions& options)
      : options_(options),
        file_(find_case(options.study.case_name), options.study.overrides),
        scene_(read_scene(file_)),
        budget_(read_budget(options.budget), [this] { return spent_; }) {
    build_scene(scene_);
    name_quantities();
    if (options_.study.directory.empty()) options_.study.directory = "runs/accuracy_" + scene_.name;
    study_.case_name = scene_.name;
    study_.title = "Accuracy of " + scene_.name;
    study_.budget = budget_.total();
    for (const Interest& interest : study_.interests)
      references_.push_back(interest.has_reference() ? std::optional(reference_of(interest))
                                                     : std::nullopt);
    plan();
  }

  void go() {
    if (scene_.accuracy->optimized) optimize();
    for (auto& [part, rung] : study_.own) {
      measure(part, to_string(part), rung, 0);
      if (!rung.measured())
        throw Error::numerical("accuracy: the case itself failed: " + rung.message);
    }
    climb();
    evaluate(study_, references_);
    for (const auto& [promise, name] : kPromises)
      study_.recommendations.push_back(recommended(promise, name));
    write();
  }

 private:
  std::string path(const std::string& name) const { return options_.study.directory + "/" + name; }
  std::string case_file(const std::string& name) const {
    return study_.case_name + "_" + name + ".toml";
  }

  void name_quantities() {
    if (!scene_.accuracy)
      throw Error::input(file_.path() +
                         ": an [accuracy] with a `quantity` is missing (or --set "
                         "'accuracy.quantity=\"...\"'); there are: " +
                         all_candidates(scene_));
    for (const Interest& interest : scene_.accuracy->quantities) {
      study_.interests.push_back(interest);
      study_.parts.push_back(part_of(scene_, interest));
    }
  }

  /// Those that the case names. @throws Error (input), with their place, where one is unknown.
  std::vector<std::string> ladders_of_case() const {
    for (const std::string& name : scene_.accuracy->ladders) try {
        knob(name);
      } catch (const Error& error) {
        throw Error::input(scene_.accuracy->place + ": accuracy.ladders: a " + error.what());
      }
    return scene_.accuracy->ladders;
  }

  /// Ladders of the parts that quantities belong to, with the knobs that lead their groups.
  void plan() {
    std::vector<std::string> wanted = options_.ladders;
    if (wanted.empty()) wanted = ladders_of_case();
    if (wanted.empty()) wanted = knob_names();
    for (const std::string& name : wanted) knob(name);
    const auto is_wanted = [&](const Knob& each) {
      return std::any_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
        return name == each.name || knob(name).group == each.name;
      });
    };
    for (const Part part : {Part::motion, Part::design}) {
      if (std::find(study_.parts.begin(), study_.parts.end(), part) == study_.parts.end()) continue;
      study_.own[part];
    }
    for (const Knob& each : knobs()) {
      if (!is_wanted(each)) continue;
      std::string why;
      bool present = false;
      for (const auto& [part, rung] : study_.own) {
        const std::string reason = each.absent(scene_, part);
        if (!reason.empty()) {
          why = reason;
          continue;
        }
        present = true;
        Ladder& ladder = study_.ladders.emplace_back();
        ladder.knob = &each;
        ladder.part = part;
        for (const Interest& q : study_.interests)
          ladder.theories.push_back(each.theory(scene_, part, q.name));
        for (Level& level : each.levels(scene_, file_)) prepare(level, ladder);
      }
      if (!present) study_.absent.emplace_back(each.name, why);
    }
    if (study_.ladders.empty())
      throw Error::input("accuracy: none of these ladders is one of this case: " +
                         study_.absent.front().first + " (" + study_.absent.front().second + ")");
  }

  /// A level that the scene refuses is none.
  void prepare(Level& level, Ladder& ladder) {
    Rung rung;
    rung.level = std::move(level);
    try {
      const Scene scene = read_scene(case_of(options_.study, variant(ladder.part, "", rung.level)));
      rung.unknowns = unknowns_of(scene, ladder.part);
    } catch (const Error& error) {
      rung.status = "refused";
      rung.message = error.what();
    }
    ladder.rungs.push_back(std::move(rung));
  }

  /// The result of the case's own optimization is what the levels analyse.
  void optimize() {
    if (!study_.own.contains(Part::design)) return;
    StudyOptions quiet = options_.study;
    quiet.quiet = true;
    const Variant one{
        "optimized", {"output.vtk=false", "output.plots=false", "output.sharp_every=0", "verify="}};
    const StudyOutcome outcome = run_variants(quiet, {&one, 1}, [](auto) {});
    if (outcome.exit_code == 4) throw Stopped();
    const VariantResult& result = outcome.results.front();
    if (!result.done())
      throw Error::numerical("accuracy: the optimization failed: " + result.message);
    spent_ += result.seconds_cpu;
    const std::string folder = fs::absolute(folder_of(quiet, one)).string();
    for (size_t i = 0; i < scene_.designs.size(); ++i)
      design_.push_back("design." + std::to_string(i) + ".start='" + folder + "/" +
                        components_name(scene_, scene_.designs[i].body) + "'");
    if (!options_.study.quiet)
      std::printf("optimized: %s CPU s\n", io::to_text(result.seconds_cpu, 3).c_str());
  }

  Variant variant(Part part, const std::string& name, const Level& level) const {
    Variant out{name, lean_overrides(scene_, part)};
    if (const auto last = last_time(); part == Part::motion && last)
      out.overrides.push_back("time.end=" + io::to_text(*last));
    if (part == Part::design) append(design_, out.overrides);
    append(level.overrides, out.overrides);
    return out;
  }

  /// Nobody looks at a motion after the last time that is asked for. (The default of a spin-up
  /// depends on the end.)
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

  /// One run, or what an earlier one has left. It is ended after `limit` seconds; 0: never.
  void measure(Part part, const std::string& name, Rung& rung, double limit) {
    StudyOptions quiet = options_.study;
    quiet.quiet = true;
    quiet.time_limit = limit;
    const Variant one = variant(part, name, rung.level);
    const StudyOutcome outcome = run_variants(quiet, {&one, 1}, [](auto) {});
    if (outcome.exit_code == 4) throw Stopped();
    const VariantResult& result = outcome.results.front();
    rung.values.assign(study_.interests.size(), std::numeric_limits<double>::quiet_NaN());
    rung.status = result.done() ? "measured" : "failed";
    rung.message = result.message;
    rung.seconds_cpu = result.seconds_cpu;
    // What an earlier study left counts as if it were run: the same levels are reached again.
    const bool ended = result.message.starts_with(kEnded);
    if (ended || std::isfinite(result.seconds_cpu)) spent_ += ended ? limit : result.seconds_cpu;
    rung.seconds_wall = result.seconds_wall;
    rung.memory = result.peak_memory_bytes;
    for (size_t q = 0; result.done() && q < study_.interests.size(); ++q)
      if (study_.parts[q] == part)
        rung.values[q] = value_in(folder_of(quiet, one), study_.interests[q], part);
    if (options_.study.quiet) return;
    // How many runs there will be shows as they end; what is left of the budget ends them.
    std::printf("run %d, %s %s: %s, %s CPU s; at most %s left\n", ++runs_, name.c_str(),
                rung.level.name.c_str(), rung.status.c_str(),
                io::to_text(rung.seconds_cpu, 3).c_str(),
                duration_text(std::max(0.0, budget_.left())).c_str());
    std::fflush(stdout);
  }

  /// Measures levels, short ones first, as far as the budget goes.
  void climb() {
    std::vector<Track> tracks;
    for (Ladder& ladder : study_.ladders) {
      Track& track = tracks.emplace_back();
      // A design takes its time with the loads, not with the motion they come from.
      track.cost_exponent = ladder.knob->cost_exponent * (of_motion(ladder) ? kMotionShare : 1);
      track.weight = ladder.leads() ? 1 : 4;
      track.first_guess = study_.own.at(ladder.part).seconds_cpu;
      for (Rung& rung : ladder.rungs) {
        if (rung.is_own()) take_own(ladder, rung);
        track.h.push_back(rung.level.h);
        track.seconds.push_back(rung.measured() ? std::optional(rung.seconds_cpu) : std::nullopt);
        track.closed.push_back(rung.status != "open");
      }
    }
    const auto cut = [&](size_t t, size_t i) { study_.ladders[t].rungs[i].status = "cut"; };
    const double reserve = options_.verify ? kReserve * budget_.total() : 0;
    while (const auto next = next_level(tracks, budget_.left() - reserve, cut)) {
      const auto [t, i] = *next;
      Ladder& ladder = study_.ladders[t];
      Rung& rung = ladder.rungs[i];
      const double limit = std::max(kLeastLimit, kPatience * tracks[t].predicted(i));
      const std::string name =
          to_string(ladder.part) + "_" + ladder.knob->name + "_" + std::to_string(i + 1);
      measure(ladder.part, name, rung, std::min(limit, std::max(1.0, budget_.left())));
      tracks[t].closed[i] = true;
      if (rung.measured()) tracks[t].seconds[i] = rung.seconds_cpu;
    }
  }

  void take_own(const Ladder& ladder, Rung& rung) const {
    const Level level = rung.level;
    const int unknowns = rung.unknowns;
    rung = study_.own.at(ladder.part);
    rung.level = level;
    rung.unknowns = unknowns;
  }

  /// Knobs that do not add up: settings whose errors are a part of the promise are tried, too.
  Recommendation recommended(double promise, const std::string& name) {
    fs::remove(path(case_file(name)));  // what an earlier study promised may not hold any more
    Recommendation first;
    for (size_t attempt = 0; attempt < kShares.size(); ++attempt) {
      Recommendation r = recommend(study_, promise, kShares[attempt]);
      if (attempt > 0 && (!r.choice || r.overrides == first.overrides)) break;
      if (r.choice && options_.verify)
        verify(r, attempt == 0 ? name : name + "_" + std::to_string(attempt + 1));
      else if (r.choice)
        r.sentence = "not verified";
      // Once a promise was broken, only a run can restore it.
      const bool stands = !r.withdrawn && (attempt == 0 || r.verified);
      if (stands && r.choice) write_case(r, name);
      if (stands && !r.withdrawn) return r;
      if (attempt == 0) first = std::move(r);
    }
    return first;
  }

  void verify(Recommendation& r, const std::string& name) {
    if (r.choice->cost > budget_.left()) {
      r.sentence = "not verified: it would take about " + io::to_text(r.choice->cost, 2) +
                   " s, the budget leaves " + io::to_text(budget_.left(), 2);
      return;
    }
    std::vector<double> values(study_.interests.size());
    double seconds = 0;
    for (const auto& [part, own] : study_.own) {
      Rung rung;
      rung.level.overrides = r.overrides;
      measure(part, to_string(part) + "_" + name, rung, std::max(1.0, budget_.left()));
      if (rung.message.starts_with(kEnded)) {
        r.sentence = "not verified: its run was " + rung.message;
        return;
      }
      if (!rung.measured()) {
        r.withdrawn = true;
        r.sentence = "withdrawn: its run failed: " + rung.message;
        return;
      }
      seconds += rung.seconds_cpu;
      for (size_t q = 0; q < values.size(); ++q)
        if (study_.parts[q] == part) values[q] = rung.values[q];
    }
    judge(r, study_, values, seconds);
  }

  /// The case with these settings; files it names are found from the new place, too.
  void write_case(Recommendation& r, const std::string& name) const {
    StudyOptions study = options_.study;
    std::vector<std::string> overrides = r.overrides;
    for (std::string& each : overrides_of_files(file_)) overrides.push_back(std::move(each));
    // A finer run of the final design is finer than the elements of the case, not than these.
    const auto is_mesh = [](const std::string& each) {
      return each.find(".elements=") != std::string::npos;
    };
    if (scene_.verify && std::any_of(r.overrides.begin(), r.overrides.end(), is_mesh))
      overrides.emplace_back("verify=");
    const io::CaseFile changed = case_of(study, {"", overrides});
    try {
      read_scene(changed);  // what is recommended can be run
    } catch (const Error& error) {
      r.withdrawn = true;
      r.sentence = std::string("withdrawn: the whole case refuses it: ") + error.what();
      return;
    }
    r.file = case_file(name);
    io::write_file(path(r.file), changed.text());
  }

  void write() const {
    write_accuracy_csv(study_, path("accuracy.csv"));
    io::write_file(path("accuracy.md"), accuracy_markdown(study_));
    io::write_file(path("accuracy.svg"), accuracy_svg(study_));
    std::fputs(accuracy_text(study_).c_str(), stdout);
    std::printf("%s/accuracy.md, .csv, .svg\n", options_.study.directory.c_str());
  }

  AccuracyOptions options_;
  io::CaseFile file_;
  Scene scene_;
  int runs_ = 0;
  double spent_ = 0;                 // CPU seconds of all runs
  std::vector<std::string> design_;  // overrides that say where the designs start
  Budget budget_;
  AccuracyStudy study_;
  std::vector<std::optional<double>> references_;
};

}  // namespace

int accuracy_case(const AccuracyOptions& options) {
  Story story(options);
  try {
    story.go();
  } catch (const Stopped&) {
    return 4;
  }
  return 0;
}

}  // namespace flexmorph::cases
