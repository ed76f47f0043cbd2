#pragma once

#include <functional>

#include "cases/assembly/prepared_case.h"
#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"

namespace flexmorph::cases {

/// Says which motion is computed and what it leaves behind.
struct MotionRequest {
  std::vector<fem::Factors>
      factors;  ///< scale factors of the cells, per design; empty: full material
  MeshChoice mesh;
  std::optional<double> step;        ///< time step other than the scene's [s]
  bool loads = false;                ///< whether equivalent static loads are collected
  double frames_every = 0;           ///< spacing of frames for ParaView [s]; 0: no frames
  int snapshots = 0;                 ///< number of pictures of a mechanism; 0, or at least 2
  bool condition = false;            ///< whether the condition of the last matrix is estimated
  bool balance = true;               ///< whether the energy balance is kept
  std::string table = "motion.csv";  ///< file of the run folder for the rows
  std::string phase = "motion";      ///< part of the run that messages name
  /// File of the run folder that keeps what the motion needs to be resumed; empty: no such file.
  std::string checkpoint;
  double checkpoint_every = 1;  ///< least wall time between two of them [s]
  bool resume = false;          ///< whether the motion is resumed from the checkpoint, if it fits

  /// Receives the rows of a motion that fails or is interrupted; null: they are lost.
  std::optional<MotionRecord>* unfinished = nullptr;

  std::function<bool()> go_on;                      ///< asked at every step; false interrupts
  std::function<void(double)> reached;              ///< told the time of every step [s]
  std::function<void(const std::string&)> say;      ///< told what is unusual when it happens
  std::function<void(const std::string&)> resumed;  ///< told where or why not the motion resumes
};

/// The result of run_motion().
struct MotionOutcome {
  MotionRecord record;
  std::vector<fem::EslSets> loads;  ///< one entry per design, where loads were asked for
};

/// Integrates the motion of a copy of the mechanism of a case.
/// @param folder  receives the table of steps, the frames and the checkpoint; null: nothing is
///                written, and the request asks for no frames
/// @throws FailedRun or Interrupted; the steps before are in the table, the checkpoint is written
MotionOutcome run_motion(const PreparedCase& prepared, const MotionRequest& request,
                         RunFolder* folder = nullptr);

}  // namespace flexmorph::cases
