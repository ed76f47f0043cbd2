#pragma once

#include "cases/run/motion_run.h"
#include "cases/run/progress.h"
#include "cases/run/report.h"

/// The motions of a run: what they have in common, and those that judge its designs.
namespace flexmorph::cases {

/// Pictures of a mechanism in its motion.
int moments_of(const Scene& scene);

/// Tells how far a motion is.
std::function<void(double)> way_of(Progress& progress, const Scene& scene,
                                   const std::string& phase);

/// The motion can be gone on with: "NAME.checkpoint" of its table keeps it, until the run is done.
void keep_going(MotionWishes& wishes, const RunReport& report, Progress& progress,
                const std::string& table);

/// Removes what keep_going() kept, when the run is done.
void forget_motions(RunFolder& folder);

/// The judge of a design is the motion with it; beside it the same volume spread evenly, and both
/// on a finer mesh where the scene asks for it. All are in the report then.
/// @throws as run_motion()
void judge_by_motion(const Scene& scene, bool condition, std::function<bool()> go_on,
                     RunFolder& folder, Progress& progress, RunReport& report);

}  // namespace flexmorph::cases
