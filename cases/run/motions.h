#pragma once

#include "cases/results/run_result.h"
#include "cases/run/motion_run.h"
#include "cases/run/run_context.h"

/// The motions of a run: those that make loads, and those that designs are assessed by.
namespace flexmorph::cases {

/// The request of a motion with the callbacks of a run: progress on the screen, interruption, and a
/// checkpoint, "NAME.checkpoint" of the table "NAME.csv", that is kept until the run is done.
MotionRequest resumable_request(const RunContext& run, const std::string& phase,
                                const std::string& table);

/// The request of the motion with the result of a run: frames, snapshots and condition as the case
/// and the options want them.
MotionRequest result_request(const RunContext& run, const std::string& phase);

/// Says what the meshes of a motion did: "16 changes of the mesh", or "even mesh" where bodies flow
/// and nothing changed.
std::string mesh_words(const Scene& scene, const fem::MotionResult& result);

/// Paths of the files that a run made in its folder, by the ending of their names.
using FilesOf = std::function<std::vector<std::string>(const std::string& ending)>;

/// Removes checkpoints, and tables of cycles that did not improve the design, of a run whose
/// results are all written.
void remove_checkpoints(const FilesOf& files_of);

/// The motions of the cycles of a run: those that make loads, on the elements of the case, and
/// those on the cells of the designs, where the case verifies on cells.
class CycleMotions {
 public:
  explicit CycleMotions(const RunContext& run) : run_(run) {}

  /// Computes the loads of all designs, and the measure of the motion. @throws as run_motion()
  mmc::CycleMotion loads(std::span<const fem::Factors> factors);
  /// The motion on cells that compares cycles; empty where the motions that make loads do.
  mmc::VerificationMotion judge();
  /// Keeps the last motion on cells, with its table, as that of the best design so far.
  void keep_assessed();

  /// The motion with the design of a run that optimizes nothing; the motion on cells of the best
  /// design.
  MotionResults take_results() { return std::move(results_); }
  /// CPU seconds of all motions so far.
  double seconds() const { return seconds_; }

 private:
  double measure_on_cells(std::span<const fem::Factors> factors);
  MotionOutcome run_one(const MotionRequest& request);

  const RunContext& run_;
  int n_loads_ = 0, n_assessed_ = 0;
  double seconds_ = 0;
  MotionResults results_;
  std::optional<MotionRecord> last_on_cells_;
};

/// Computes the motions that assess designs: with the design, with uniform material of the same
/// volume, and both on the mesh of [verify]. Those that `motions` holds already are kept.
/// @param loads    of the last motion of the cycles
/// @param motions  receives them as far as they were computed
/// @return loads of the motion with the design
/// @throws as run_motion()
std::vector<fem::EslSets> assess_by_motion(const RunContext& run,
                                           std::span<const mmc::BodyProblem> problems,
                                           std::vector<fem::EslSets> loads, MotionResults& motions);

}  // namespace flexmorph::cases
