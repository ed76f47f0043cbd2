#pragma once

#include <span>
#include <vector>

#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/cycles/combined_problem.h"

/// The stages of a design: each stage is a function from a design state to a design state.
namespace flexmorph::mmc {

/// Number of unloaded components that were removed, and the cost of their removal.
struct Removal {
  int components = 0;  ///< Number of removed components.
  double seconds = 0;  ///< CPU time [s].
};

/// The designs of all bodies after a stage.
struct StageResult {
  std::vector<Design> designs;            ///< Designs, one per body.
  std::vector<Formulation> formulations;  ///< Formulations of the last optimization, one per body.
  optim::Result result;                   ///< Result of the last optimization.
  std::vector<double> changes;            ///< Largest change of a variable of each body in it.
  std::vector<Removal> removed;           ///< Removed components of each body so far.
};

/// The limits on the cost of a stage.
struct StageBudget {
  int iterations = 0;   ///< Largest number of iterations.
  int solves = 0;       ///< Number of state solves of the cycle at which it ends; 0: no limit.
  int later = 0;        ///< Largest number of iterations of the stages that follow.
  bool widths = false;  ///< True if the stage has constraints on widths, as all later ones have.
  int later_with_widths = 0;  ///< Number of later iterations with constraints on widths.
  bool gentle = false;        ///< True if the stage begins with small steps.
};

/// Runs the optimizer for the stages of one cycle, reports every iterate and counts iterations and
/// evaluations.
class StageRunner {
 public:
  /// Creates a runner for one cycle; all references must outlive it.
  StageRunner(std::span<const LoadedBody> bodies, int cycle, const DesignSettings& settings,
              const IterationObserver& observe);

  /// Returns the bodies with the data that all their designs use.
  const std::vector<Subproblem>& parts() const { return parts_; }
  /// Returns the settings of the design.
  const DesignSettings& settings() const { return settings_; }
  /// Returns false if the observer has stopped the run.
  bool is_running() const { return is_running_; }
  /// Returns the number of iterations of the cycle so far.
  int iterations() const { return iterations_; }
  /// Returns the number of evaluations in the finished optimizations of the cycle.
  int evaluations() const { return evaluations_; }
  /// Returns false if the observer or the cancellation callback has stopped the run.
  bool keeps_running() const {
    return is_running_ && (!settings_.keep_running || settings_.keep_running());
  }

  /// Optimizes the designs of `from` once.
  /// @return its best designs; `from` if the run has stopped or its share is used up
  StageResult optimize(const StageResult& from, std::vector<Formulation> formulations,
                       const StageBudget& share);

 private:
  bool see(CombinedProblem& whole, const optim::Iterate& iterate);
  bool see(const Subproblem& part, MmcProblem& state, const optim::Iterate& iterate, bool first);

  std::vector<Subproblem> parts_;
  int cycle_;
  const DesignSettings& settings_;
  const IterationObserver& observe_;
  int iterations_ = 0, evaluations_ = 0;
  int most_left_ = 0, most_left_with_widths_ = 0;  // iterations that the budgets permit
  int with_widths_ = 0;                            // iterations so far
  bool in_widths_ = false;
  bool is_running_ = true;
};

/// Returns the present designs of the problems as a stage result.
StageResult first_designs(std::span<const Subproblem> parts);

/// Optimizes with nominal stiffness at a band of the continuation.
/// @param band  index of the band for the body with most bands; bodies with fewer bands use each of
///              them for several indices
StageResult at_band(StageRunner& run, const StageResult& from, size_t band,
                    const StageBudget& share);
/// Optimizes at the last band with the stiffness of the eroded design, which closes slits.
StageResult with_erosion(StageRunner& run, const StageResult& from, const StageBudget& share);
/// Removes unloaded components from the bodies whose widths are limited. Void has no gradient,
/// therefore later stages would not remove these components.
/// @param keeps_width  true if no removal may reduce widths, because no later stage would restore
///                     them, see remove_unloaded_components()
StageResult without_unloaded_components(StageRunner& run, const StageResult& from,
                                        bool keeps_width);
/// Optimizes with last_formulation(): widths are constraints from the first iteration, and all
/// limits apply to the crisp design.
StageResult last_stage(StageRunner& run, const StageResult& from, const StageBudget& share);

/// Tells whether result a is at least as good as result b: a feasible result is better than an
/// infeasible one; then the objective decides, or the violation if both are infeasible.
bool is_better(const optim::Result& a, const optim::Result& b, double feasibility);

}  // namespace flexmorph::mmc
