#pragma once

#include "cases/build.h"
#include "cases/run_folder.h"

namespace flexmorph::cases {

/// What a motion is asked to leave behind.
struct MotionWishes {
  std::vector<fem::Factors> factors;   ///< one per design; empty: full material
  MeshChoice mesh;
  bool loads = false;                  ///< collect equivalent static loads
  double frames_every = 0;             ///< VTK frames [s]; 0: none
  bool balance = true;                 ///< keep the energy balance
};

struct MotionOutcome {
  MotionRecord record;
  std::vector<fem::EslSets> loads;     ///< one per design
};

/// Builds the mechanism of a scene and moves it through its time.
/// @param folder  receives VTK frames and, when the motion fails, motion.csv up to the failure
MotionOutcome run_motion(const Scene& scene, const MotionWishes& wishes, RunFolder& folder);

}  // namespace flexmorph::cases
