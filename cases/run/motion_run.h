#pragma once

#include <functional>

#include "cases/assembly/prepared_case.h"
#include "cases/output/run_folder.h"
#include "cases/results/run_result.h"

namespace flexmorph::cases {

/// Specification of a motion: its model, its time step, its output and its callbacks.
struct MotionRequest {
  /// Scale factors of stiffness and mass of the cells, per design; empty means full material.
  std::vector<fem::ScaleFactors> factors;

  MeshChoice mesh;             ///< Mesh of the motion; by default the mesh of the scene.
  std::optional<double> step;  ///< Time step [s]; absent means the time step of the scene.
  bool loads = false;          ///< True if equivalent static loads are collected.
  double frames_every = 0;     ///< Time between two frames for ParaView [s]; 0 means no frames.
  int snapshots = 0;           ///< Number of pictures of a mechanism: 0, or at least 2.
  int animated = 0;            ///< Number of frames for the animation: 0, or at least 2.
  bool condition = false;      ///< True if the condition of the last matrix is estimated.
  bool balance = true;         ///< True if the energy balance is computed.

  std::string table = "motion.csv";  ///< Name of the file in the run folder for the rows.
  std::string phase = "motion";      ///< Name of the phase of the run in messages.
  std::string checkpoint;            ///< Name of the checkpoint file; empty means no checkpoint.
  double checkpoint_every = 1;       ///< Minimum wall time between two checkpoints [s].
  bool resume = false;  ///< True if the motion resumes from the checkpoint, if that fits.

  /// Receives the rows of a motion that fails or is interrupted; null means they are discarded.
  std::optional<MotionRecord>* unfinished = nullptr;

  std::function<bool()> keep_running;   ///< Cancellation callback of every step; false stops.
  std::function<void(double)> reached;  ///< Callback that receives the time of every step [s].

  /// Callback that receives a message when something unusual happens during the motion.
  std::function<void(const std::string&)> say;

  /// Callback that receives the message at which time the motion resumes, or why it restarts.
  std::function<void(const std::string&)> resumed;
};

/// The result of run_motion().
struct MotionOutcome {
  MotionRecord record;              ///< Table, pictures and counts of the motion.
  std::vector<fem::EslSets> loads;  ///< One entry per design; empty unless loads were requested.
};

/// Integrates the motion of a copy of the mechanism of a case.
/// @param folder  receives the table of steps, the frames and the checkpoint; null means that
///                nothing is written, and then the request must not contain frames
/// @throws FailedRun or Interrupted; the steps before are in the table, the checkpoint is written
MotionOutcome run_motion(const PreparedCase& prepared, const MotionRequest& request,
                         RunFolder* folder = nullptr);

}  // namespace flexmorph::cases
