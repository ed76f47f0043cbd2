#include "cases/run/motions.h"

#include <filesystem>

#include "fem/dynamics/side_by_side.h"
#include "io/files.h"

namespace flexmorph::cases {

namespace {

const char* const kCheckpoint = ".checkpoint";

std::vector<fem::Factors> uniform_factors(const std::vector<mmc::BodyProblem>& problems) {
  std::vector<fem::Factors> out;
  for (const mmc::BodyProblem& p : problems) {
    const double volume = mmc::allowed_volume(p.goal).value_or(0.5);
    const VectorXd even = VectorXd::Constant(p.grid.n_cells(), volume);
    out.push_back({p.grid, even, even});
  }
  return out;
}

std::vector<fem::Factors> final_factors(const std::vector<mmc::BodyProblem>& problems) {
  std::vector<fem::Factors> out;
  for (const mmc::BodyProblem& p : problems)
    out.push_back(mmc::dynamic_factors(p, p.design.components()));
  return out;
}

}  // namespace

int moments_of(const Scene& scene) { return scene.is_mechanism() && scene.output.plots ? 4 : 0; }

std::function<void(double)> way_of(Progress& progress, const Scene& scene,
                                   const std::string& phase) {
  return [&progress, phase, end = scene.time.end](double t) {
    progress.way(phase, t / end, "t = " + io::to_text(t, 4) + " of " + io::to_text(end, 4) + " s");
  };
}

void keep_going(MotionWishes& wishes, const RunReport& report, Progress& progress,
                const std::string& table) {
  wishes.checkpoint = table.substr(0, table.rfind('.')) + kCheckpoint;
  wishes.resume = report.resumed;
  wishes.resumed = [&progress](const std::string& words) { progress.say(words); };
}

void forget_motions(RunFolder& folder) {
  for (const std::string& path : folder.files_of(kCheckpoint)) {
    std::error_code none;
    std::filesystem::remove(path, none);
    std::filesystem::remove(path + ".tmp", none);  // of a kill while it was written
  }
}

namespace {

/// Motions that do not need each other, at the same time where there are threads for it.
class Motions {
 public:
  Motions(const Scene& scene, std::function<bool()> go_on, RunFolder& folder, Progress& progress,
          const RunReport& report)
      : scene_(scene),
        go_on_(std::move(go_on)),
        folder_(folder),
        progress_(progress),
        report_(report) {}

  /// @param out  what becomes of it
  void add(std::string name, double cost, MotionWishes wishes, std::optional<MotionRecord>& out) {
    wishes.phase = name;
    wishes.way = way_of(progress_, scene_, name);
    keep_going(wishes, report_, progress_, wishes.table);
    jobs_.push_back({std::move(name), cost,
                     [this, wishes = std::move(wishes), &out](const std::function<bool()>& others) {
                       MotionWishes mine = wishes;
                       mine.go_on = [this, &others] { return go_on_() && others(); };
                       out = run_motion(scene_, mine, folder_).record;
                     }});
  }
  /// @throws as fem::side_by_side(); Interrupted
  void run() const { fem::side_by_side(report_.threads, jobs_); }

 private:
  const Scene& scene_;
  std::function<bool()> go_on_;
  RunFolder& folder_;
  Progress& progress_;
  const RunReport& report_;
  std::vector<fem::Job> jobs_;
};

}  // namespace

void judge_by_motion(const Scene& scene, bool condition, std::function<bool()> go_on,
                     RunFolder& folder, Progress& progress, RunReport& report) {
  Motions motions(scene, std::move(go_on), folder, progress, report);
  const std::vector<fem::Factors> designed = final_factors(report.problems),
                                  uniform = uniform_factors(report.problems);
  MotionWishes wishes;
  wishes.condition = condition;
  wishes.factors = designed;
  wishes.frames_every = scene.output.vtk ? scene.output.motion_every : 0;
  wishes.moments = moments_of(scene);
  motions.add("motion with the design", 1, wishes, report.motion);
  wishes = {};
  wishes.factors = uniform;
  wishes.table = "motion_uniform.csv";
  motions.add("motion with uniform material", 1, wishes, report.uniform_motion);
  if (scene.verify) {
    progress.say("verification on " + scene.verify->words());
    // A finer mesh, and in all likelihood shorter steps.
    constexpr double kFiner = 4;
    wishes.mesh = {scene.verify->mesh, scene.verify->refine, scene.verify->step,
                   scene.verify->cells};
    wishes.balance = false;
    wishes.table = "motion_verified_uniform.csv";
    motions.add("verification with uniform material", kFiner, wishes, report.verified_uniform);
    wishes.factors = designed;
    wishes.table = "motion_verified.csv";
    motions.add("verification with the design", kFiner, wishes, report.verified);
  }
  progress.begin(scene.verify ? "verification" : "motion with the design");
  motions.run();
}

}  // namespace flexmorph::cases
