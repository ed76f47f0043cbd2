#pragma once

#include "cases/results/run_result.h"
#include "cases/run/motion_run.h"
#include "cases/run/run_context.h"

/// The motions of a run: the motions that supply equivalent static loads, and the motions by which
/// designs are assessed.
namespace flexmorph::cases {

/// Returns the request of a motion with the callbacks of a run: it shows progress on the terminal,
/// can be interrupted, and writes a checkpoint. The checkpoint of the table "NAME.csv" is
/// "NAME.checkpoint"; it is kept until the run is complete.
MotionRequest resumable_request(const RunContext& run, const std::string& phase,
                                const std::string& table);

/// Returns the request of the motion that is the result of a run. Frames, snapshots and the
/// estimate of the condition are set by the case and the options.
MotionRequest result_request(const RunContext& run, const std::string& phase);

/// Returns a message on the mesh changes of a motion: "16 mesh changes", or "uniform mesh"
/// if a body has a uniform moving mesh and no mesh changed.
std::string mesh_text(const Scene& scene, const fem::MotionResult& result);

/// A function that returns the paths of the files of a run whose names have the given ending.
using FilesOf = std::function<std::vector<std::string>(const std::string& ending)>;

/// Removes checkpoints, and tables of cycles that did not improve the design. It is called when all
/// results of the run are written.
void remove_checkpoints(const FilesOf& files_of);

/// The motions of the design cycles of a run: motions on the elements of the case that supply the
/// loads, and motions on the cells of the designs if the case verifies on cells.
class CycleMotions {
 public:
  /// Creates the motions of a run; the context has to outlive them.
  explicit CycleMotions(const RunContext& run) : run_(run) {}

  /// Computes the loads of all designs, and the number by which cycles are compared.
  /// @param factors  scale factors of stiffness and mass of the cells, one entry per design
  /// @throws as run_motion()
  mmc::CycleMotion loads(std::span<const fem::ScaleFactors> factors);
  /// Returns the motion on cells by which cycles are compared. The result is empty if the motions
  /// that supply the loads compare the cycles.
  mmc::VerificationMotion verify();
  /// Stores the last motion on cells, with its table, as the motion of the best design so far.
  void keep_assessed();

  /// Returns the stored motions: the motion with the design if the run optimizes nothing, and the
  /// motion on cells of the best design. It can be called once.
  MotionResults take_results() { return std::move(results_); }
  /// Returns the CPU time of all motions so far [s].
  double seconds() const { return seconds_; }

 private:
  double measure_on_cells(std::span<const fem::ScaleFactors> factors);
  MotionOutcome run_one(const MotionRequest& request);

  const RunContext& run_;
  int n_loads_ = 0, n_assessed_ = 0;
  double seconds_ = 0;
  MotionResults results_;
  std::optional<MotionRecord> last_on_cells_;
};

/// Computes the motions that assess designs: the motion with the design and the motion with uniform
/// material of the same volume, and both motions again on the mesh of [verify] if the case has one.
/// Motions with the design that `motions` already contains are not computed again.
/// @param loads    loads of the last motion of the cycles
/// @param motions  receives the motions as far as they were computed
/// @return loads of the motion with the design
/// @throws as run_motion()
std::vector<fem::EslSets> assess_by_motion(const RunContext& run,
                                           std::span<const mmc::BodyProblem> problems,
                                           std::vector<fem::EslSets> loads, MotionResults& motions);

}  // namespace flexmorph::cases
