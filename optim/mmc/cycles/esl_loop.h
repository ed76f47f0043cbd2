#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fem/esl_set.h"
#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/cycles/load_difference.h"

namespace flexmorph::mmc {

/// The result of a motion of the mechanism that a cycle uses.
struct CycleMotion {
  std::vector<fem::EslSets> loads;  ///< Equivalent static loads, one entry per problem.
  double measure = 0;               ///< Number that cycles are compared by; smaller is better.
};

/// A function that computes a motion of the mechanism with given scale factors (one entry per
/// problem).
using Simulate = std::function<CycleMotion(std::span<const fem::ScaleFactors>)>;

/// A function that returns the measure of a motion with given scale factors on a finer model than
/// the one that gives the loads (fem/README.md, Cells).
using VerificationMotion = std::function<double(std::span<const fem::ScaleFactors>)>;

/// The result of a cycle for one body.
struct BodyVerdict {
  std::string body;                             ///< Name of the body.
  double compliance = 0, crisp_compliance = 0;  ///< Regularized and crisp compliance [J].

  /// Fraction of the domain whose material changed: mean |Δ| of the crisp area fractions between
  /// the designs before and after the cycle. (The largest change of a cell would be 1 as soon as an
  /// outline moves by one cell, and the number of variables changes with the components.)
  double design_change = 0;
};

/// The result of a cycle for the mechanism. The measure comes from a motion with the designs of the
/// cycle: from LoopSettings::verification_motion if it is set, otherwise from the motion that gives
/// the loads.
struct CycleVerdict {
  int cycle = 1;                    ///< Number of the cycle, from 1.
  double objective = 0;             ///< Sum of the regularized compliances of the bodies [J].
  std::vector<BodyVerdict> bodies;  ///< Results of the bodies, one entry per problem.
  double measure = 0;               ///< Measure of the motion; smaller is better.
  double violation = 0;  ///< Largest crisp_violation() of the bodies; 0: the designs are usable.
  bool best = false;     ///< True if this cycle is the best one so far; then it is the result.
};

/// The event that ends the cycles.
enum class CyclesEnd {
  loads_agree,         ///< The loads agree with those of the motion with the new designs.
  little_improvement,  ///< A cycle improves the measure by less than the tolerance.
  most_cycles          ///< The largest number of cycles is reached.
};

/// Settings of the cycles of motion, loads and design.
struct LoopSettings {
  int max_cycles = 1;       ///< Largest number of cycles.
  double tolerance = 0.01;  ///< Relative improvement of the measure below which the cycles end [-].

  /// Load difference below which the cycles end, if all bodies are below it, see LoadDifference
  /// [-].
  double load_difference = LoadDifference::kLargest;
  DesignSettings design;  ///< Settings of the design of each cycle.

  /// Motion that compares the cycles if there are several; empty: the motion that gives the loads.
  VerificationMotion verification_motion = {};
};

/// Callbacks of the cycles. If `iteration` returns false, the run stops after the current
/// iteration; the outcomes of that cycle are then those of the bodies up to the stopped one.
struct LoopObserver {
  IterationObserver iteration;  ///< Called with every row of the history.

  /// Called after the motion of a cycle with its loads, one entry per problem.
  std::function<void(int cycle, std::span<const fem::EslSets>)> loads;
  /// Called after the design of a cycle with its outcomes.
  std::function<void(int cycle, std::span<const BodyOutcome>)> cycle;
  /// Called in a run of several cycles after each motion that measures the designs of a cycle, with
  /// the results of all cycles so far.
  std::function<void(std::span<const CycleVerdict>)> verdict;
  /// Called after the loads of a cycle have been compared with the loads of the motion with its
  /// designs, one entry per problem.
  std::function<void(int cycle, std::span<const LoadDifference>)> difference;
  /// Called at the end of the cycles of a run of several cycles with the reason of the end.
  std::function<void(CyclesEnd)> end = {};
};

/// Repeats motion, equivalent static loads and design (optim/README.md, Cycles) and returns the
/// outcomes of the best usable cycle. If no cycle is usable, it returns the cycle with the smallest
/// violation. The cycles end at the first of these events:
///
/// - The loads agree with those of the motion with the new designs (LoopSettings::load_difference),
///   and no design is worse_than_uniform().
/// - A cycle improves the measure by less than the tolerance.
/// - The largest number of cycles is reached.
///
/// Bodies with a common budget of mass form one design problem, the remaining bodies one each. On
/// return `problems` hold the designs that belong to the outcomes.
/// @throws Error (numerical) from dynamics or statics; rows reported before remain valid.
std::vector<BodyOutcome> esl_loop(std::vector<BodyProblem>& problems, const Simulate& simulate,
                                  const LoopSettings& settings, const LoopObserver& observer);

}  // namespace flexmorph::mmc
