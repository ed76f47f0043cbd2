#pragma once

#include "cases/output/report.h"
#include "cases/run/motion_run.h"
#include "cases/run/progress.h"

/// The motions of a run: what they have in common, and those that load and judge its designs.
namespace flexmorph::cases {

/// Pictures of a mechanism in its motion.
int moments_of(const Scene& scene);

/// Tells how far a motion is.
std::function<void(double)> way_of(Progress& progress, const Scene& scene,
                                   const std::string& phase);

/// The motion can be gone on with: "NAME.checkpoint" of its table keeps it, until the run is done.
void keep_going(MotionWishes& wishes, const RunReport& report, Progress& progress,
                const std::string& table);

/// Paths of the files that a run made in its folder, by the ending of their names.
using FilesOf = std::function<std::vector<std::string>(const std::string& ending)>;

/// Removes what keep_going() kept, and the tables of cycles that did not pay, of a run whose
/// results are all written.
void forget_motions(const FilesOf& files_of);

/// The motions of the cycles of a run: those that make loads, on the elements of the case, and
/// those on the cells of the designs that judge them, where the case verifies on cells.
class CycleMotions {
 public:
  /// @param condition  of a run that designs nothing its one motion estimates it
  CycleMotions(const Scene& scene, bool condition, std::function<bool()> go_on, RunFolder& folder,
               Progress& progress, RunReport& report);

  /// The loads of all designs. @throws as run_motion()
  std::vector<fem::EslSets> loads(std::span<const fem::Factors> factors);
  /// Empty where the motions that make loads judge.
  mmc::VerificationMotion judge();
  /// What was judged last is the best so far: report.verified, with its table.
  void keep_judged();

 private:
  double on_cells(std::span<const fem::Factors> factors);
  MotionOutcome run(MotionWishes& wishes, const std::string& table);

  const Scene& scene_;
  bool condition_;
  std::function<bool()> go_on_;
  RunFolder& folder_;
  Progress& progress_;
  RunReport& report_;
  int n_loads_ = 0, n_judged_ = 0;
  std::optional<MotionRecord> judged_;  ///< the last one
};

/// Static energies of the sharp designs of problems beside those of the motion their loads are of.
/// @throws Error (numerical) from statics
std::vector<EnergyComparison> compared_energies(std::span<const mmc::BodyProblem> problems,
                                                std::span<const fem::EslSets> loads);

/// The judge of a design is the motion with it; beside it the same volume spread evenly, and both
/// on a finer mesh or on cells where the scene asks for it (the design's own is there already where
/// a cycle was judged by it). All are in the report then, and where no motion on cells judges also
/// how far the design's static energies are from those of its motion.
/// @throws as run_motion()
void judge_by_motion(const Scene& scene, bool condition, std::function<bool()> go_on,
                     RunFolder& folder, Progress& progress, RunReport& report);

}  // namespace flexmorph::cases
