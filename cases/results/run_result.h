#pragma once

#include <cmath>
#include <exception>
#include <optional>

#include "cases/results/failure.h"
#include "cases/results/motion_record.h"
#include "cases/results/parts/part_comparison.h"
#include "cases/results/parts/verified_outline.h"
#include "cases/results/static_loads.h"
#include "optim/mmc/cycles/corrected_cycles.h"
#include "optim/mmc/cycles/esl_loop.h"

/// The results of a run. The stages of a run return components of it, and the complete result is
/// passed as const.
namespace flexmorph::cases {

/// Objective of the crisp outlines on the cells of the case before and after corrected cycles.
struct CorrectedMotion {
  double before = 0, after = 0;  ///< Objective before and after, in the unit of the objective.

  /// Tells whether the objective is smaller after the corrected cycles.
  bool improves() const { return after < before; }
};

/// A warning of a run about its own results.
struct Warning {
  std::string words;      ///< Text of the warning.
  bool unusable = false;  ///< True if the result is not usable; the status says so then.
};

/// An expectation of the case, compared with the result.
struct Expected {
  std::string name;             ///< Name of the number.
  std::optional<double> found;  ///< Value in the result; absent if it was not computed.
  bool holds = false;           ///< True if the value satisfies the expectation.
  std::string words;            ///< Message: "volume = 0.52: expected at most 0.5001".
};

/// CPU times of the phases of a run, by name [s].
using Seconds = std::vector<std::pair<std::string, double>>;

/// The general information on a run: status, messages, times and memory.
struct RunInfo {
  std::string status = "running", message;  ///< Status, and message of an error.
  std::string lost_frames;      ///< Message on frames that could not be written; often empty.
  std::string missing_exports;  ///< Message on exports that could not be made; often empty.
  int threads = 1;              ///< Number of motions computed at the same time.

  /// Wall time [s] and CPU time [s] of all calls of the run, and its peak memory [bytes].
  double seconds_wall = 0, seconds_cpu = 0, peak_memory_bytes = 0;

  Seconds phases;  ///< CPU times of the phases of a run with designs [s].
};

/// The designs of a run and the results about them.
struct DesignResult {
  std::vector<mmc::BodyProblem> problems;   ///< Design problems of the bodies, with their designs.
  std::vector<mmc::BodyOutcome> outcomes;   ///< Outcomes of the designs, one per body.
  std::vector<VerifiedOutline> outlines;    ///< Verified outlines, in the order of the outcomes.
  std::vector<StaticLoad> static_loads;     ///< Load cases of the final design of a static plate.
  std::vector<mmc::CycleVerdict> verdicts;  ///< Assessments of cycles of a run with several.
  std::string cycles_end;                   ///< Sentence on the reason for which the cycles ended.

  /// Corrected cycles; the first entry is the design before the corrections.
  std::vector<mmc::CorrectedCycle> corrections;

  std::optional<CorrectedMotion> corrected;  ///< Objective before and after correction.
  std::optional<mmc::OptimalityCertificate>
      certificate;  ///< Optimality certificate of the designs.

  /// Differences between the loads of the designs and the loads of the motion with the designs.
  std::vector<mmc::LoadDifference> load_differences;

  int cycles = 0;  ///< Number of design cycles.

  /// CPU times [s] of the post-processing of designs; of the motions that supply loads; of the
  /// motions with final designs and with uniform material.
  double seconds_unloaded = 0, seconds_motion = 0, seconds_verification = 0;
};

/// The motions of a run: the motion with the design (or with full material), the motion with
/// uniform material of the same volume, and both motions on the mesh of [verify].
struct MotionResults {
  /// The motion with the design and with uniform material, on the mesh of the scene and of
  /// [verify].
  std::optional<MotionRecord> motion, uniform, verified, verified_uniform;

  /// Returns the motion by which a design is assessed: the verification if there is one.
  const std::optional<MotionRecord>& assessed() const { return verified ? verified : motion; }
  /// Returns the motion with uniform material that is compared with assessed().
  const std::optional<MotionRecord>& assessed_uniform() const {
    return verified ? verified_uniform : uniform;
  }
};

/// Statistics of the deflection of a point of a designed body, with the design and with uniform
/// material.
struct PointVariation {
  std::string name;             ///< Name of the observed point; empty means the tip.
  Variation designed, uniform;  ///< Statistics with the design, and with uniform material [m].

  /// Ratio to the deflection with uniform material above which a design causes a warning [-].
  static constexpr double kLargestRatio = 1.05;

  /// Returns the ratio of the root mean squares of design and uniform material.
  double rms_ratio() const { return designed.rms / uniform.rms; }
  /// Returns the ratio of the peak-to-peak values of design and uniform material.
  double peak_to_peak_ratio() const { return designed.peak_to_peak / uniform.peak_to_peak; }
  /// Tells whether the point of the design moves by more than rounding errors do.
  bool moves() const { return designed.peak_to_peak > 1e-9 * designed.largest; }
};
/// Returns the statistics of the tip deflection of a body in the motions by which designs are
/// assessed; nothing if the body has no tip, or if one of the motions is missing.
std::optional<PointVariation> tip_variation(const MotionResults& motions, const std::string& body);
/// Returns the statistics of the deflections of the observed points of a designed body in the
/// motions by which designs are assessed; none if one of the motions is missing.
std::vector<PointVariation> point_variations(const MotionResults& motions, const std::string& body);

/// All results of a run at its end, or at its failure.
struct RunResult {
  RunInfo info;                              ///< Status, times and memory.
  DesignResult design;                       ///< Designs; empty if the case has none.
  MotionResults motions;                     ///< Motions; absent if the case has none.
  std::optional<PathRecord> path;            ///< Path of equilibria of a [static] analysis.
  std::optional<PartComparison> comparison;  ///< Comparison of parts, of the command `verify`.
  std::optional<Failure> failure;            ///< State of the run when it failed.
  std::vector<Warning> warnings;             ///< Warnings about the results.
  std::vector<Expected> expectations;        ///< Expectations of the case, compared.
};

/// The result of a run that may have ended early: the computed results, and the reason of the end.
struct EndedRun {
  RunResult result;          ///< Results that were computed before the end.
  std::exception_ptr error;  ///< Error or Interrupted; null if the run is complete.
};

/// The exception that is thrown when the user interrupts a run.
struct Interrupted {};

}  // namespace flexmorph::cases
