#include "cases/stability/stability.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/check/ready.h"
#include "cases/run/progress.h"
#include "cases/run/run.h"
#include "cases/stability/report.h"
#include "cases/study/study.h"
#include "geometry/sanitizers.h"
#include "io/files.h"
#include "io/json.h"
#include "io/output_folder.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The place of a row's files: `stem` is its run folder, and the start of what lies beside.
struct Job {
  size_t row = 0;
  std::string stem, path;              // of the case it runs
  std::vector<std::string> overrides;  // all of them
  std::string key;                     // what it runs, for the next time
  std::optional<Bounds> bounds;
  std::string reference;  // stem of the unperturbed run
  double largest_volume = 1;
};

/// The whole story of a check.
class Check {
 public:
  explicit Check(StabilityOptions options) : options_(std::move(options)) {
    if (options_.directory.empty()) options_.directory = "runs/stability";
    for (const std::string& name : options_.suites) wanted_.push_back(&suite(name));
    for (const Suite& each : suites())
      if (options_.suites.empty() && !each.on_request) wanted_.push_back(&each);
    if (options_.cases.empty()) options_.cases = shipped_cases();
    for (const std::string& name : options_.cases) plan(name);
  }

  int go() {
    std::error_code error;
    fs::create_directories(options_.directory, error);
    if (error) throw Error::input("folder '" + options_.directory + "': " + error.message());
    const io::FolderLock lock(options_.directory);
    prepare();
    for (const Job& job : jobs_) judge_row(job);
    const bool whole = run();
    // Once more: a row may have ended before the one it is measured against.
    for (const Job& job : jobs_) judge_row(job);
    const std::vector<StabilityRow> ran = write();
    std::fputs(stability_text(ran, !options_.quiet).c_str(), stdout);
    std::printf("%s.csv, .md, .svg\n", stem().c_str());
    if (!whole) return 4;
    const auto wrong = std::count_if(ran.begin(), ran.end(), [](const StabilityRow& row) {
      return row.judgement.verdict == Verdict::wrong;
    });
    return wrong > 0 ? 3 : 0;
  }

 private:
  /// Rows of one case, after the unperturbed runs they are measured against.
  void plan(const std::string& name) {
    const std::string path = find_case(name);
    const Scene scene = read_scene(io::CaseFile(path, options_.overrides));
    std::map<Part, size_t> base;
    std::optional<Scene> designed;
    for (const Suite* each : wanted_) {
      if (each->part == Part::design && scene.designs.empty()) continue;
      if (each->part == Part::design && !designed) {
        std::vector<std::string> overrides = options_.overrides;
        for (const std::string& change : short_overrides(scene, Part::design))
          overrides.push_back(change);
        designed = read_scene(io::CaseFile(path, overrides));
      }
      std::map<std::string, int> count;
      for (Perturbation& p : each->rows(each->part == Part::design ? *designed : scene)) {
        if (!base.contains(p.part)) {
          Perturbation as_it_is{"as it is", {}, p.part};
          as_it_is.demand = Demand::runs;
          base[p.part] = jobs_.size();
          add(scene, path, "base", to_string(p.part), as_it_is);
        }
        const std::string stem = each->name + "_" + std::to_string(++count[each->name]);
        const Part part = p.part;
        add(scene, path, each->name, stem, std::move(p));
        jobs_.back().reference = jobs_[base[part]].stem;
      }
    }
  }

  void add(const Scene& scene, const std::string& path, const std::string& suite_name,
           const std::string& stem, Perturbation perturbation) {
    Job& job = jobs_.emplace_back();
    job.row = rows_.size();
    job.stem = options_.directory + "/" + scene.name + "/" + stem;
    job.path = path;
    job.overrides = options_.overrides;
    for (const std::string& change : short_overrides(scene, perturbation.part))
      job.overrides.push_back(change);
    if (perturbation.components)
      job.overrides.push_back("design.0.start='" +
                              fs::absolute(job.stem + ".components.csv").string() + "'");
    job.overrides.insert(job.overrides.end(), perturbation.overrides.begin(),
                         perturbation.overrides.end());
    StabilityRow& row = rows_.emplace_back();
    row.case_name = scene.name;
    row.suite = suite_name;
    row.perturbation = std::move(perturbation);
  }

  /// Files that rows start from, and what is known of their scenes.
  void prepare() {
    for (Job& job : jobs_) {
      StabilityRow& row = rows_[job.row];
      const Perturbation& p = row.perturbation;
      fs::create_directories(fs::path(job.stem).parent_path());
      if (p.components) io::write_file(job.stem + ".components.csv", *p.components);
      if (!p.appended.empty()) {
        io::write_file(job.stem + ".toml", whole_text(job.path) + p.appended);
        job.path = job.stem + ".toml";
      }
      job.key = p.components.value_or("");
      try {
        const io::CaseFile file(job.path, job.overrides);
        job.key += file.text();
        const Scene scene = read_scene(file);
        job.bounds = bounds_of(scene);
        if (scene.designs.size() == 1)
          job.largest_volume = mmc::allowed_volume(scene.designs.front().goal).value_or(1);
        // A design that is analysed as it starts has not been asked for a volume yet.
        if (scene.optimizer.max_iterations == 0) job.largest_volume = 1;
      } catch (const Error&) {  // the run will say so
        for (const std::string& change : job.overrides) job.key += change + "\n";
      }
      const json known = json::parse(text_of(job.stem + ".json"), nullptr, false);
      if (!known.is_object() || known.value("key", "") != job.key) continue;
      row.ending = {known.value("exit_code", -1), known.value("signal", 0),
                    known.value("over_time", false), known.value("seconds_cpu", 0.0)};
      row.ran = true;
    }
  }

  /// A case for another folder: files it names are found from there, too.
  static std::string whole_text(const std::string& path) {
    const std::vector<std::string> overrides = overrides_of_files(io::CaseFile(path));
    return io::CaseFile(path, overrides).text();
  }

  bool run() {
    std::vector<Child> children;
    std::vector<const Job*> of;
    for (const Job& job : jobs_) {
      if (rows_[job.row].ran) continue;
      // Only what an earlier run of this row has left.
      io::remove_listed(job.stem);
      Child& child = children.emplace_back();
      child.words = {"run", job.path, "-o", job.stem, "--quiet", "--threads", "1", "--condition"};
      for (const std::string& change : job.overrides) {
        child.words.emplace_back("--set");
        child.words.push_back(change);
      }
      child.log = job.stem + ".log";
      of.push_back(&job);
    }
    ChildLimits limits;
    limits.seconds = options_.timeout;
    if (!kSanitized) limits.memory = 4e9;
    const auto begin = std::chrono::steady_clock::now();
    size_t done = 0;
    const auto ended = [&](size_t i, const Ending& ending) {
      if (ending.interrupted) return;  // says nothing about the row
      StabilityRow& row = rows_[of[i]->row];
      row.ending = ending;
      row.ran = true;
      nlohmann::ordered_json out;
      out["exit_code"] = ending.code;
      out["signal"] = ending.signal;
      out["over_time"] = ending.over_time;
      out["seconds_cpu"] = ending.seconds;
      out["key"] = of[i]->key;
      io::write_file(of[i]->stem + ".json", io::json_text(out));
      judge_row(*of[i]);
      if (++done % kBatch == 0) write();
      if (options_.quiet) return;
      const double part = static_cast<double>(done) / static_cast<double>(children.size());
      const double seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      std::printf("%zu/%zu %s %s, %s: exit %d, %s s%s\n", done, children.size(),
                  row.case_name.c_str(), row.suite.c_str(), row.perturbation.parameter.c_str(),
                  ending.code, io::to_text(ending.seconds, 2).c_str(),
                  part < 1 ? time_left(seconds, part).c_str() : "");
      std::fflush(stdout);
    };
    return run_children(children, options_.jobs, limits, {.ended = ended});
  }

  void judge_row(const Job& job) {
    StabilityRow& row = rows_[job.row];
    if (!row.ran) return;
    Evidence e;
    e.folder = job.stem;
    e.words = text_of(job.stem + ".log");
    e.path = job.path;
    e.ending = row.ending;
    e.row = &row.perturbation;
    e.bounds = job.bounds;
    e.reference = job.reference;
    e.largest_volume = job.largest_volume;
    row.judgement = judge(e);
  }

  std::string stem() const { return options_.directory + "/stability"; }

  /// The tables as far as they are known. @return the rows in them
  std::vector<StabilityRow> write() const {
    std::vector<StabilityRow> ran;
    std::copy_if(rows_.begin(), rows_.end(), std::back_inserter(ran),
                 [](const StabilityRow& row) { return row.ran; });
    write_stability_csv(ran, stem() + ".csv.tmp");
    fs::rename(stem() + ".csv.tmp", stem() + ".csv");
    io::write_file(stem() + ".md", stability_markdown(ran));
    io::write_file(stem() + ".svg", stability_svg(ran));
    return ran;
  }

  static constexpr size_t kBatch = 10;  // rows between two writes of the tables
  StabilityOptions options_;
  std::vector<const Suite*> wanted_;
  std::vector<Job> jobs_;
  std::vector<StabilityRow> rows_;
};

}  // namespace

int check_stability(const StabilityOptions& options) { return Check(options).go(); }

}  // namespace flexmorph::cases
