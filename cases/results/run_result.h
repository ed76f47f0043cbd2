#pragma once

#include <cmath>
#include <exception>
#include <optional>

#include "cases/results/failure.h"
#include "cases/results/motion_record.h"
#include "cases/results/part_comparison.h"
#include "cases/results/static_loads.h"
#include "cases/results/verified_outline.h"
#include "optim/mmc/cycles/corrected_cycles.h"
#include "optim/mmc/cycles/esl_loop.h"

/// What a run found. Drivers return its parts; once it is complete it is const.
namespace flexmorph::cases {

/// Objective of the crisp outlines on the cells of the case before and after corrected cycles.
struct CorrectedMotion {
  double before = 0, after = 0;
  bool improves() const { return after < before; }
};

/// What a sentence of a run says against its own results.
struct Warning {
  std::string words;
  bool unusable = false;  ///< nobody can use the result: the run ends "done, not usable"
};

/// An expectation of the case and what was found.
struct Expected {
  std::string name;
  std::optional<double> found;  ///< nothing where the run did not get that far
  bool holds = false;
  std::string words;  ///< "volume = 0.52: expected at most 0.5001"
};

/// CPU seconds of parts of a run, by name.
using Seconds = std::vector<std::pair<std::string, double>>;

/// How a run went.
struct RunInfo {
  std::string status = "running", message;
  std::string lost_frames;      ///< sentence on frames that could not be written; mostly empty
  std::string missing_exports;  ///< sentence on files that could not be made; mostly empty
  int threads = 1;
  double seconds_wall = 0, seconds_cpu = 0, peak_memory_bytes = 0;
  Seconds phases;  ///< CPU seconds of a run with designs
};

/// The designs of a run and what is known of them.
struct DesignResult {
  std::vector<mmc::BodyProblem> problems;
  std::vector<mmc::BodyOutcome> outcomes;
  std::vector<VerifiedOutline> outlines;         ///< of final designs, in the order of the outcomes
  std::vector<StaticLoad> static_loads;          ///< of the final design of a plate at rest
  std::vector<mmc::CycleVerdict> verdicts;       ///< of a run of several cycles
  std::vector<mmc::CorrectedCycle> corrections;  ///< the design they begin with, then every cycle
  std::optional<CorrectedMotion> corrected;
  std::optional<mmc::MotionCertificate> certificate;
  /// How far the loads of the designs are from those of the motion with them.
  std::vector<mmc::LoadDifference> load_differences;
  int cycles = 0;
  /// CPU seconds: post-processing of designs; motions that make loads; motions with final designs
  /// and with uniform material.
  double seconds_idle = 0, seconds_motion = 0, seconds_verification = 0;
};

/// The motions of a run: with the design (or full material), with uniform material of the same
/// volume, and both on the mesh of [verify].
struct MotionResults {
  std::optional<MotionRecord> motion, uniform, verified, verified_uniform;

  /// The motion that a design is assessed by: the verification where there is one.
  const std::optional<MotionRecord>& assessed() const { return verified ? verified : motion; }
  const std::optional<MotionRecord>& assessed_uniform() const {
    return verified ? verified_uniform : uniform;
  }
};

/// How a point of a designed body deflects in its motion, and with uniform material.
struct PointVariation {
  std::string name;  ///< of the observed point; empty: the tip
  Variation designed, uniform;

  /// Parts of uniform material's that a design is warned of from.
  static constexpr double kLargestRatio = 1.05;
  double rms_ratio() const { return designed.rms / uniform.rms; }
  double peak_to_peak_ratio() const { return designed.peak_to_peak / uniform.peak_to_peak; }
  /// Tells whether the point of the design moves by more than rounding errors do.
  bool moves() const { return designed.peak_to_peak > 1e-9 * designed.largest; }
};
/// Returns the variation of the tip deflection of a body in the motions that designs are assessed
/// by; nothing where the body has no tip, or one of the motions is missing.
std::optional<PointVariation> tip_variation(const MotionResults& motions, const std::string& body);
/// Variations of the deflections of the observed points of a designed body in the motions that
/// designs are assessed by; none where one of the motions is missing.
std::vector<PointVariation> point_variations(const MotionResults& motions, const std::string& body);

/// Everything a run knows at its end, or when it fails.
struct RunResult {
  RunInfo info;
  DesignResult design;
  MotionResults motions;
  std::optional<PathRecord> path;            ///< of a [static] analysis
  std::optional<PartComparison> comparison;  ///< of the command `verify`
  std::optional<Failure> failure;
  std::vector<Warning> warnings;
  std::vector<Expected> expectations;
};

/// The result of a run that may have ended early: what was computed, and why it ended.
struct EndedRun {
  RunResult result;
  std::exception_ptr error;  ///< null where the run came to its end; else Error or Interrupted
};

/// Thrown when the user interrupts a run.
struct Interrupted {};

}  // namespace flexmorph::cases
