#include "cases/run/motions.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "fem/dynamics/parallel_jobs.h"
#include "geometry/cpu_time.h"
#include "io/files.h"

namespace flexmorph::cases {

namespace {

const char *const kCheckpoint = ".checkpoint", *const kVerified = "motion_verified.csv",
                  *const kOnCells = "motion_on_cells.csv";
constexpr int kAnimatedFrames = 151;  // of the animation of a motion in the report

std::vector<fem::ScaleFactors> uniform_factors(std::span<const mmc::BodyProblem> problems) {
  std::vector<fem::ScaleFactors> out;
  for (const mmc::BodyProblem& p : problems) {
    const double volume = mmc::allowed_volume(p.goal).value_or(0.5);
    const VectorXd even = VectorXd::Constant(p.grid.n_cells(), volume);
    out.push_back({p.grid, even, even});
  }
  return out;
}

std::vector<fem::ScaleFactors> final_factors(std::span<const mmc::BodyProblem> problems) {
  std::vector<fem::ScaleFactors> out;
  for (const mmc::BodyProblem& p : problems)
    out.push_back(mmc::dynamic_factors(p, p.design.components()));
  return out;
}

/// Returns a function of the time that tells which part of the work of a motion on cells is done, 0
/// to 1: the cost of a step grows with the number of cells to the power of 1.38 (tests/README.md,
/// Dynamics).
std::function<double(double)> work_on_cells(const Scene& scene) {
  constexpr int kSamples = 200;
  constexpr double kPower = 1.38;
  const double end = scene.time.end;
  std::vector<double> sums = {0};
  for (int k = 0; k < kSamples; ++k) {
    double cost = 0;
    for (const BodyDesign& d : scene.designs)
      cost += std::pow(scene.body(d.body).length_at(end * (k + 0.5) / kSamples), kPower);
    sums.push_back(sums.back() + cost);
  }
  return [sums, end](double t) {
    const double at = std::clamp(t / end, 0.0, 1.0) * kSamples;
    const auto k = std::min(static_cast<size_t>(at), sums.size() - 2);
    return std::lerp(sums[k], sums[k + 1], at - static_cast<double>(k)) / sums.back();
  };
}

/// Reports to the display of a run how far a motion is.
/// @param part  part of the work that is done at a time, 0 to 1
std::function<void(double)> reporter(const RunContext& run, const std::string& phase,
                                     std::function<double(double)> part) {
  return [&run, phase, part = std::move(part), end = run.scene().time.end](double t) {
    run.progress.way(phase, part(t),
                     "t = " + io::to_text(t, 4) + " of " + io::to_text(end, 4) + " s");
  };
}

/// Sets the mesh and the time step of the verification in a request.
void set_verified(const RunContext& run, MotionRequest& request) {
  const Verify& verify = *run.scene().verify;
  request.mesh = {verify.mesh, verify.refine, verify.cells};
  request.step = verify.step;
  request.balance = false;
  if (verify.cells > 0) request.reached = reporter(run, request.phase, work_on_cells(run.scene()));
}

/// Returns the number by which cycles are compared; smaller is better.
double measure_of(const Cycle& cycle, const MotionRecord& record) {
  if (cycle.compare_by == CycleMeasure::strain_energy) return record.strain_integral();
  const std::vector<double>* tip = record.table.find(cycle.compare_point + kDeflectionEnding);
  const Variation point = variation_of(
      record.time(), tip ? *tip : record.table.at(cycle.compare_point + kAcrossEnding));
  switch (cycle.compare_by) {
    case CycleMeasure::rms:
      return point.rms;
    case CycleMeasure::peak_to_peak:
      return point.peak_to_peak;
    default:
      return std::abs(point.mean);
  }
}

/// Returns a message on the largest tip deflection; empty without a tip, because a body between two
/// pins has none.
std::string deflection_text(const MotionRecord& record) {
  const std::vector<size_t> tips = record.table.of_group(ColumnGroup::deflection);
  if (tips.empty()) return "";
  return ", largest tip deflection " +
         io::to_text(largest_size(record.table.values[tips.front()]), 4) + " m";
}

}  // namespace

MotionRequest resumable_request(const RunContext& run, const std::string& phase,
                                const std::string& table) {
  MotionRequest out;
  out.phase = phase;
  out.table = table;
  out.keep_running = run.keep_running;
  const double end = run.scene().time.end;
  out.reached = reporter(run, phase, [end](double t) { return t / end; });
  out.checkpoint = table.substr(0, table.rfind('.')) + kCheckpoint;
  out.resume = run.resume;
  out.resumed = [&run](const std::string& words) { run.progress.say(words); };
  return out;
}

MotionRequest result_request(const RunContext& run, const std::string& phase) {
  constexpr int kSnapshots = 4;
  MotionRequest out = resumable_request(run, phase, "motion.csv");
  const Output& output = run.scene().output;
  out.frames_every = output.vtk ? output.motion_every : 0;
  const bool in_space =
      std::ranges::any_of(run.scene().bodies, [](const Body& body) { return body.in_space(); });
  out.snapshots = output.plots && !in_space ? kSnapshots : 0;
  out.animated = output.plots ? kAnimatedFrames : 0;
  out.condition = run.condition;
  return out;
}

void remove_checkpoints(const FilesOf& files_of) {
  std::error_code none;
  for (const std::string& path : files_of(kCheckpoint)) {
    std::filesystem::remove(path, none);
    std::filesystem::remove(path + ".tmp", none);  // exists if the run was killed while writing
  }
  for (const std::string& path : files_of(kOnCells)) std::filesystem::remove(path, none);
}

std::string mesh_text(const Scene& scene, const fem::MotionResult& result) {
  const auto is_even = [](const Body& body) { return body.has_uniform_mesh(); };
  if (result.events.empty() && std::ranges::any_of(scene.bodies, is_even)) return "uniform mesh";
  return std::to_string(result.events.size()) +
         (result.events.size() == 1 ? " mesh change" : " mesh changes");
}

MotionOutcome CycleMotions::run_one(const MotionRequest& request) {
  run_.progress.begin(request.phase);
  const double begin = cpu_seconds();
  MotionOutcome motion = run_motion(run_.prepared, request, run_.folder);
  seconds_ += cpu_seconds() - begin;
  const fem::MotionResult& result = motion.record.result;
  run_.progress.say(request.phase + ": " + std::to_string(result.counts.steps) + " time steps, " +
                    mesh_text(run_.prepared.scene(), result) + deflection_text(motion.record));
  return motion;
}

mmc::CycleMotion CycleMotions::loads(std::span<const fem::ScaleFactors> factors) {
  // If nothing is optimized, the motion that supplies the loads is also the motion with the design.
  const bool analysed = run_.scene().optimizer.max_iterations == 0;
  const bool first = ++n_loads_ == 1;
  MotionRequest request = analysed ? result_request(run_, "motion with the design")
                                   : resumable_request(run_, "motion", "motion.csv");
  // Every cycle has its own checkpoint. A resumed run restores the designs of earlier cycles from
  // the stored evaluations.
  request.checkpoint = "motion_" + io::to_text(n_loads_) + kCheckpoint;
  request.factors.assign(factors.begin(), factors.end());
  request.loads = true;
  if (first) request.say = [this](const std::string& words) { run_.progress.say(words); };
  MotionOutcome motion = run_one(request);
  const double measure = measure_of(run_.scene().cycle, motion.record);
  if (analysed) results_.motion = std::move(motion.record);
  return {std::move(motion.loads), measure};
}

mmc::VerificationMotion CycleMotions::verify() {
  if (!run_.scene().verifies_on_cells()) return {};
  return [this](std::span<const fem::ScaleFactors> factors) { return measure_on_cells(factors); };
}

double CycleMotions::measure_on_cells(std::span<const fem::ScaleFactors> factors) {
  MotionRequest request = resumable_request(run_, "motion on cells", kOnCells);
  request.checkpoint = "motion_on_cells_" + io::to_text(++n_assessed_) + kCheckpoint;
  request.factors.assign(factors.begin(), factors.end());
  set_verified(run_, request);
  last_on_cells_ = run_one(request).record;
  return measure_of(run_.scene().cycle, *last_on_cells_);
}

void CycleMotions::keep_assessed() {
  if (!last_on_cells_) return;
  results_.verified = std::move(last_on_cells_);
  last_on_cells_.reset();
  if (run_.folder)
    std::filesystem::rename(run_.folder->file(kOnCells), run_.folder->file(kVerified));
}

namespace {

/// A motion that is independent of the motions computed at the same time.
struct IndependentMotion {
  double cost;  ///< Relative CPU time [-].
  MotionRequest request;
  std::optional<MotionRecord>* record;  ///< Receives the record of the motion.
  std::vector<fem::EslSets>* loads = nullptr;
};

/// Computes motions at the same time, as far as the number of threads allows.
/// @throws as fem::side_by_side(); Interrupted
void run_side_by_side(const RunContext& run, const std::vector<IndependentMotion>& motions) {
  std::vector<fem::Job> jobs;
  for (const IndependentMotion& motion : motions)
    jobs.push_back(
        {motion.request.phase, motion.cost, [&run, &motion](const std::function<bool()>& others) {
           MotionRequest request = motion.request;
           request.keep_running = [&] { return run.keep_running() && others(); };
           MotionOutcome found = run_motion(run.prepared, request, run.folder);
           *motion.record = std::move(found.record);
           if (motion.loads) *motion.loads = std::move(found.loads);
         }});
  fem::side_by_side(run.threads, jobs);
}

}  // namespace

std::vector<fem::EslSets> assess_by_motion(const RunContext& run,
                                           std::span<const mmc::BodyProblem> problems,
                                           std::vector<fem::EslSets> loads,
                                           MotionResults& motions) {
  const Scene& scene = run.scene();
  const bool on_cells = scene.verifies_on_cells();
  std::vector<IndependentMotion> all;
  if (!motions.motion) {
    MotionRequest designed = result_request(run, "motion with the design");
    designed.factors = final_factors(problems);
    designed.loads = true;
    all.push_back({1, designed, &motions.motion, &loads});
  }
  if (run.uniform) {
    MotionRequest request =
        resumable_request(run, "motion with uniform material", "motion_uniform.csv");
    request.factors = uniform_factors(problems);
    request.animated = scene.output.plots ? kAnimatedFrames : 0;
    all.push_back({1, request, &motions.uniform});
  }
  if (scene.verify) {
    run.progress.say("The designs are verified on " + scene.verify->words() + ".");
    // Estimated cost relative to the mesh of the case: [verify] has a finer mesh and usually
    // shorter steps; a mesh of cells has hundreds of times as many elements.
    const double finer = on_cells ? 100 : 4;
    if (run.uniform) {
      MotionRequest request = resumable_request(run, "verification with uniform material",
                                                "motion_verified_uniform.csv");
      request.factors = uniform_factors(problems);
      set_verified(run, request);
      all.push_back({finer, request, &motions.verified_uniform});
    }
    if (!motions.verified) {
      MotionRequest designed = resumable_request(run, "verification with the design", kVerified);
      designed.factors = final_factors(problems);
      set_verified(run, designed);
      all.push_back({finer, designed, &motions.verified});
    }
  }
  run.progress.begin(scene.verify ? "verification" : "motion with the design");
  run_side_by_side(run, all);
  return loads;
}

}  // namespace flexmorph::cases
