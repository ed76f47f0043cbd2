#include "cases/run/motions.h"

#include <filesystem>

#include "fem/dynamics/side_by_side.h"
#include "geometry/cpu_time.h"
#include "io/files.h"
#include "optim/mmc/compliance_evaluator.h"

namespace flexmorph::cases {

namespace {

const char *const kCheckpoint = ".checkpoint", *const kVerified = "motion_verified.csv",
                  *const kJudged = "motion_judged.csv";

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

void forget_motions(const FilesOf& files_of) {
  std::error_code none;
  for (const std::string& path : files_of(kCheckpoint)) {
    std::filesystem::remove(path, none);
    std::filesystem::remove(path + ".tmp", none);  // of a kill while it was written
  }
  for (const std::string& path : files_of(kJudged)) std::filesystem::remove(path, none);
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

  /// @param out    what becomes of it
  /// @param loads  likewise of the loads it was asked for, if any
  void add(std::string name, double cost, MotionWishes wishes, std::optional<MotionRecord>& out,
           std::vector<fem::EslSets>* loads = nullptr) {
    wishes.phase = name;
    wishes.way = way_of(progress_, scene_, name);
    keep_going(wishes, report_, progress_, wishes.table);
    jobs_.push_back(
        {std::move(name), cost,
         [this, wishes = std::move(wishes), &out, loads](const std::function<bool()>& others) {
           MotionWishes mine = wishes;
           mine.go_on = [this, &others] { return go_on_() && others(); };
           MotionOutcome found = run_motion(scene_, mine, folder_);
           out = std::move(found.record);
           if (loads) *loads = std::move(found.loads);
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

MeshChoice verified_mesh(const Verify& verify) {
  return {verify.mesh, verify.refine, verify.step, verify.cells};
}

/// ½ F · u of every load of the sharp design over the strain energy of the motion with it.
EnergyComparison compared(const mmc::BodyProblem& problem, const fem::EslSets& loads) {
  const mmc::CellFactors sharp =
      mmc::ersatz_of(problem).sharp(mmc::fractions_of(problem, problem.design.components()));
  const VectorXd each = std::make_unique<mmc::ComplianceEvaluator>(
                            loads, problem.section, problem.compliance, sharp.stiffness, sharp.mass)
                            ->individual(sharp.stiffness, sharp.mass);
  EnergyComparison out;
  out.body = problem.body;
  double largest = 0;
  for (const fem::EslSet& set : loads.sets) largest = std::max(largest, set.strain_energy);
  for (size_t l = 0; l < loads.sets.size(); ++l) {
    const fem::EslSet& set = loads.sets[l];
    if (set.strain_energy > EnergyComparison::kLeast * largest)
      out.add(set.time, 0.5 * each[static_cast<Eigen::Index>(l)] / set.strain_energy);
  }
  return out;
}

}  // namespace

std::vector<EnergyComparison> compared_energies(std::span<const mmc::BodyProblem> problems,
                                                std::span<const fem::EslSets> loads) {
  std::vector<EnergyComparison> out;
  for (size_t i = 0; i < loads.size(); ++i) out.push_back(compared(problems[i], loads[i]));
  return out;
}

CycleMotions::CycleMotions(const Scene& scene, bool condition, std::function<bool()> go_on,
                           RunFolder& folder, Progress& progress, RunReport& report)
    : scene_(scene),
      condition_(condition),
      go_on_(std::move(go_on)),
      folder_(folder),
      progress_(progress),
      report_(report) {}

namespace {

/// Links between two pins have no tip.
std::string deflection_words(const MotionRecord& record) {
  if (record.amplitude.empty()) return "";
  return ", largest tip deflection " + io::to_text(record.amplitude[0], 4) + " m";
}

}  // namespace

MotionOutcome CycleMotions::run(MotionWishes& wishes, const std::string& table) {
  wishes.go_on = go_on_;
  wishes.way = way_of(progress_, scene_, wishes.phase);
  // Of all cycles, until the run is done: their designs come back from their evaluations.
  keep_going(wishes, report_, progress_, table);
  progress_.begin(wishes.phase);
  const double begin = cpu_seconds();
  MotionOutcome motion = run_motion(scene_, wishes, folder_);
  report_.seconds_motion += cpu_seconds() - begin;
  progress_.say(wishes.phase + ": " + std::to_string(motion.record.result.counts.steps) +
                " steps, " + std::to_string(motion.record.result.events.size()) +
                " changes of the mesh" + deflection_words(motion.record));
  return motion;
}

std::vector<fem::EslSets> CycleMotions::loads(std::span<const fem::Factors> factors) {
  const bool analysed = scene_.optimizer.max_iterations == 0;  // as they start: this says all
  MotionWishes wishes;
  wishes.factors.assign(factors.begin(), factors.end());
  wishes.loads = true;
  wishes.condition = condition_ && analysed;
  if (!report_.motion && report_.cycles == 0)
    wishes.say = [&](const std::string& words) { progress_.say(words); };
  MotionOutcome motion = run(wishes, "motion_" + io::to_text(++n_loads_) + ".csv");
  if (analysed) report_.motion = motion.record;
  return std::move(motion.loads);
}

mmc::VerificationMotion CycleMotions::judge() {
  if (!scene_.judges_on_cells()) return {};
  return [this](std::span<const fem::Factors> factors) { return on_cells(factors); };
}

double CycleMotions::on_cells(std::span<const fem::Factors> factors) {
  MotionWishes wishes;
  wishes.factors.assign(factors.begin(), factors.end());
  wishes.phase = "motion on cells";
  wishes.mesh = verified_mesh(*scene_.verify);
  wishes.balance = false;
  wishes.table = kJudged;
  judged_ = run(wishes, "motion_judged_" + io::to_text(++n_judged_) + ".csv").record;
  return judged_->strain_integral;
}

void CycleMotions::keep_judged() {
  if (!judged_) return;
  report_.verified = std::move(judged_);
  judged_.reset();
  std::filesystem::rename(folder_.file(kJudged), folder_.file(kVerified));
}

void judge_by_motion(const Scene& scene, bool condition, std::function<bool()> go_on,
                     RunFolder& folder, Progress& progress, RunReport& report) {
  Motions motions(scene, std::move(go_on), folder, progress, report);
  const std::vector<fem::Factors> designed = final_factors(report.problems),
                                  uniform = uniform_factors(report.problems);
  const bool on_cells = scene.judges_on_cells();
  std::vector<fem::EslSets> loads;
  MotionWishes wishes;
  wishes.condition = condition;
  wishes.factors = designed;
  wishes.loads = !on_cells;
  wishes.frames_every = scene.output.vtk ? scene.output.motion_every : 0;
  wishes.moments = moments_of(scene);
  motions.add("motion with the design", 1, wishes, report.motion, &loads);
  wishes = {};
  wishes.factors = uniform;
  wishes.table = "motion_uniform.csv";
  motions.add("motion with uniform material", 1, wishes, report.uniform_motion);
  if (scene.verify) {
    progress.say("verification on " + scene.verify->words());
    // A finer mesh, and in all likelihood shorter steps; cells are hundreds of times as many.
    const double finer = on_cells ? 100 : 4;
    wishes.mesh = verified_mesh(*scene.verify);
    wishes.balance = false;
    wishes.table = "motion_verified_uniform.csv";
    motions.add("verification with uniform material", finer, wishes, report.verified_uniform);
    if (!report.verified) {
      wishes.factors = designed;
      wishes.table = kVerified;
      motions.add("verification with the design", finer, wishes, report.verified);
    }
  }
  progress.begin(scene.verify ? "verification" : "motion with the design");
  motions.run();
  report.energies = compared_energies(report.problems, loads);
}

}  // namespace flexmorph::cases
