#pragma once

#include <functional>

#include "cases/assembly/build.h"
#include "cases/output/run_folder.h"

namespace flexmorph::cases {

/// What a motion is asked to leave behind.
struct MotionWishes {
  std::vector<fem::Factors> factors;  ///< one per design; empty: full material
  MeshChoice mesh;
  bool loads = false;                ///< collect equivalent static loads
  double frames_every = 0;           ///< VTK frames [s]; 0: none
  int moments = 0;                   ///< pictures of a mechanism, evenly over the run
  bool condition = false;            ///< estimate it at the end
  bool balance = true;               ///< keep the energy balance
  std::string table = "motion.csv";  ///< file of the folder: the steps, up to a failure too
  std::function<void(const std::string&)> say;  ///< told what is odd when it happens, if there
  std::function<bool()> go_on;      ///< asked at every step; false ends it with Interrupted
  std::string phase = "motion";     ///< of the run, for messages
  std::function<void(double)> way;  ///< told the time of every step [s]
  /// File of the folder that keeps what the motion needs to go on; empty: it is not kept.
  std::string checkpoint;
  double checkpoint_every = 1;  ///< [s] of wall time, at least
  bool resume = false;          ///< go on from that file, where there is one of this motion
  /// Told where the motion goes on, or why it begins anew.
  std::function<void(const std::string&)> resumed;
};

/// The user wants no more. What was computed is in the folder.
struct Interrupted {};

struct MotionOutcome {
  MotionRecord record;
  std::vector<fem::EslSets> loads;  ///< one per design
};

/// Builds the mechanism of a scene and moves it through its time.
/// @param folder  receives the table of steps and VTK frames
/// @throws FailedRun or Interrupted, with the steps before it in the table, and the checkpoint
/// written
MotionOutcome run_motion(const Scene& scene, const MotionWishes& wishes, RunFolder& folder);

}  // namespace flexmorph::cases
