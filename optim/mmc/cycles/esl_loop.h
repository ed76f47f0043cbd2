#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/cycles/load_difference.h"

namespace flexmorph::mmc {

/// What a motion of the whole scene leaves to a cycle.
struct CycleMotion {
  std::vector<fem::EslSets> loads;  ///< one per problem
  double measure = 0;               ///< what cycles are compared by; smaller is better
};

/// Computes a motion of the whole scene with these factors (one per problem).
using Simulate = std::function<CycleMotion(std::span<const fem::Factors>)>;

/// Returns the measure of a motion with these factors on a finer model than the one that makes the
/// loads (fem/README.md, Cells).
using VerificationMotion = std::function<double(std::span<const fem::Factors>)>;

/// What a cycle made of one body.
struct BodyVerdict {
  std::string body;
  double compliance = 0, sharp_compliance = 0;  ///< under the loads of the cycle [J]
  /// Part of the domain whose material changed: mean |Δ| of the sharp area fractions between the
  /// designs before and after the cycle. (The largest change of a cell would be 1 as soon as an
  /// outline moves by one; variables come and go with components.)
  double design_change = 0;
};

/// A cycle as a whole, measured by a motion with its designs: LoopSettings::verification_motion, or
/// else the one that makes loads.
struct CycleVerdict {
  int cycle = 1;
  double objective = 0;             ///< Σ compliance of the bodies [J]
  std::vector<BodyVerdict> bodies;  ///< one per problem
  double measure = 0;               ///< of that motion; smaller is better
  /// Largest crisp_violation() of the bodies; 0: the designs are usable.
  double violation = 0;
  bool best = false;  ///< of all cycles so far: its designs are the result
};

struct LoopSettings {
  int max_cycles = 1;
  double tolerance = 0.01;  ///< cycles end when one improves the measure by less than this part
  /// They end when the loads of all bodies differ by less than this part from their motion's.
  double load_difference = LoadDifference::kLargest;
  DesignSettings design;
  /// Compares cycles where there are several; empty: the motion that makes loads does.
  VerificationMotion verification_motion = {};
};

/// Looks on; false stops the run after the current iteration: the outcomes of that cycle are then
/// those of the bodies up to the one that was stopped.
struct LoopObserver {
  IterationObserver iteration;
  /// After the motion of a cycle: its loads, one entry per problem.
  std::function<void(int cycle, std::span<const fem::EslSets>)> loads;
  std::function<void(int cycle, std::span<const BodyOutcome>)> cycle;
  /// In a run of several cycles whenever one more is measured, which is after the motion with its
  /// designs: all cycles so far.
  std::function<void(std::span<const CycleVerdict>)> verdict;
  /// After the motion with the designs of a cycle, where another cycle may follow: one entry per
  /// problem.
  std::function<void(int cycle, std::span<const LoadDifference>)> difference;
};

/// Repeats motion, equivalent static loads and design until the loads are those of the motion with
/// the designs (LoopSettings::load_difference) and the designs are of use (worse_than_uniform()), a
/// cycle improves the measure by less than the tolerance, or the number of cycles is reached
/// (optim/README.md, Cycles). Bodies that share mass are one design problem, the others have one
/// each. The designs of `problems` are left at the result, that of the best usable cycle (of the
/// least violation, where none is usable), and the outcomes belong to it.
/// @throws Error (numerical) from dynamics or statics; rows reported before it stand.
std::vector<BodyOutcome> esl_loop(std::vector<BodyProblem>& problems, const Simulate& simulate,
                                  const LoopSettings& settings, const LoopObserver& observer);

}  // namespace flexmorph::mmc
