#pragma once

#include <functional>
#include <span>
#include <vector>

#include "fem/esl_set.h"
#include "optim/mmc/body_design.h"

namespace flexmorph::mmc {

/// Motion of the whole scene with these factors (one per problem) -> loads of every body.
using Simulate = std::function<std::vector<fem::EslSets>(std::span<const fem::Factors>)>;

/// A cycle as a whole, judged by the motion with its designs.
struct CycleVerdict {
  int cycle = 1;
  double strain_energy_integral = 0;  ///< ∫ U dt of that motion [J s]; smaller is better
  bool best = false;                  ///< of all cycles: its designs are the result
};

struct LoopSettings {
  int max_cycles = 1;
  double tolerance = 0.01;  ///< stop when every compliance changes by less between cycles
  DesignSettings design;
};

/// Looks on; false stops the run after the current iteration: the outcomes of that cycle are then
/// those of the bodies up to the one that was stopped.
struct LoopObserver {
  IterationObserver iteration;
  /// After the motion of a cycle: its loads, one entry per problem.
  std::function<void(int cycle, std::span<const fem::EslSets>)> loads;
  std::function<void(int cycle, std::span<const BodyOutcome>)> cycle;
  /// At the end of a run of several cycles.
  std::function<void(std::span<const CycleVerdict>)> verdict;
};

/// dynamics -> ESL -> design problem -> dynamics ..., until the designs rest (design.md section
/// 10). The designs of `problems` are left at the result; the outcome is that of the last cycle.
/// @throws Error (numerical) from dynamics or statics; rows reported before it stand.
std::vector<BodyOutcome> esl_loop(std::vector<BodyProblem>& problems, const Simulate& simulate,
                                  const LoopSettings& settings, const LoopObserver& observer);

}  // namespace flexmorph::mmc
