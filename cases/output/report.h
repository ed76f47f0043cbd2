#pragma once

#include <cmath>
#include <optional>

#include "cases/output/run_folder.h"
#include "cases/results/failure.h"
#include "cases/results/judged.h"

namespace flexmorph::cases {

/// Static energy of a sharp design under its own loads beside the strain energy of the motion with
/// it, load by load: coarse elements bridge what the cells of a design show (fem/README.md, Cells).
struct EnergyComparison {
  static constexpr double kApart = 0.2;  ///< of what a load's energies may be apart
  /// Loads with less than this part of the largest energy say nothing: a swing passes through rest.
  static constexpr double kLeast = 0.01;

  std::string body;
  int compared = 0, apart = 0;  ///< loads, and those that are further apart than kApart
  double ratio = 1, time = 0;  ///< static energy over that of the motion, furthest from 1; when [s]

  void add(double at, double found) {
    ++compared;
    if (std::abs(found - 1) > kApart) ++apart;
    if (std::abs(found - 1) > std::abs(ratio - 1)) ratio = found, time = at;
  }
};

/// What came of cycles that correct: J of the outlines on the cells of the case.
struct CorrectedMotion {
  double before = 0, after = 0;
  bool pays() const { return after < before; }
};

/// Everything a run knows at its end (or at its failure).
struct RunReport {
  std::string status, message;
  std::string lost_frames;         ///< what became of them, in words; mostly nothing
  std::string missing_exports;     ///< likewise
  std::optional<Failure> failure;  ///< of a run that failed
  int threads = 1, cycles = 0;
  bool resumed = false;  ///< does it go on with what is in its folder?
  double seconds_wall = 0, seconds_cpu = 0, peak_memory_bytes = 0;
  std::vector<std::pair<std::string, double>> phases;  ///< CPU seconds of designs (phases_of())
  /// CPU seconds of this process: repairs of designs; motions whose loads they are for; motions
  /// with the final designs and with uniform material.
  double seconds_mending = 0, seconds_motion = 0, seconds_verification = 0;
  std::vector<mmc::BodyProblem> problems;
  std::vector<mmc::BodyOutcome> outcomes;
  std::vector<JudgedBody> judged;  ///< final designs, in the order of the outcomes; or none yet
  std::vector<mmc::CycleVerdict> verdicts;       ///< of a run of several cycles
  std::vector<mmc::CorrectedCycle> corrections;  ///< the design they begin with, then every cycle
  std::optional<CorrectedMotion> corrected;
  std::optional<mmc::MotionCertificate> certificate;
  std::optional<PathRecord> path;                          ///< of a [static] analysis
  std::optional<MotionRecord> motion, uniform_motion;      ///< of the design; of uniform material
  std::optional<MotionRecord> verified, verified_uniform;  ///< the same on the finer mesh or cells
  std::vector<EnergyComparison> energies;  ///< of final designs that no motion on cells judges

  /// The motion that designs are judged by: the verification where there is one.
  const std::optional<MotionRecord>& judging() const { return verified ? verified : motion; }
  const std::optional<MotionRecord>& judging_uniform() const {
    return verified ? verified_uniform : uniform_motion;
  }
};

/// CPU seconds of iterations, outlines of final designs, their repairs and judge, and of motions,
/// by phase; empty without designs.
std::vector<std::pair<std::string, double>> phases_of(const RunReport& report,
                                                      const RunFolder& folder);

/// Writes run.json, the plots and report.html.
void write_report(const Scene& scene, const RunReport& report, RunFolder& folder);

}  // namespace flexmorph::cases
