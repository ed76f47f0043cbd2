#pragma once

#include <span>
#include <vector>

#include "optim/mmc/cycles/body_design.h"
#include "optim/mmc/cycles/designed_parts.h"

/// The stages of a design: each is a function from a design state to a design state.
namespace flexmorph::mmc {

/// Components that carried nothing.
struct Removal {
  int components = 0;
  double seconds = 0;  ///< CPU
};

/// The designs of bodies after a stage.
struct StageResult {
  std::vector<Design> designs;            ///< one per body
  std::vector<Formulation> formulations;  ///< under which they were optimized last
  optim::Result result;                   ///< of that optimization
  std::vector<double> changes;            ///< largest change of a variable of each body in it
  std::vector<Removal> removed;           ///< of each body, so far
};

/// What a stage may spend.
struct Share {
  int iterations = 0;
  int solves = 0;       ///< state solves of the cycle after which it ends; 0: no limit
  bool gentle = false;  ///< with small steps first
};

/// Runs the optimizer for the stages of one cycle, shows every iterate and counts.
class StageRunner {
 public:
  /// @param bodies, settings, observe  live longer
  StageRunner(std::span<const LoadedBody> bodies, int cycle, const DesignSettings& settings,
              const IterationObserver& observe);

  const std::vector<Part>& parts() const { return parts_; }
  const DesignSettings& settings() const { return settings_; }
  bool going() const { return going_; }  ///< false: the observer stopped the run
  int iterations() const { return iterations_; }
  int evaluations() const { return evaluations_; }
  bool goes_on() const { return going_ && (!settings_.go_on || settings_.go_on()); }

  /// One run of the optimizer from the designs of `from`.
  /// @return its best designs; `from` where there is nothing to spend
  StageResult optimize(const StageResult& from, std::vector<Formulation> formulations,
                       const Share& share);

 private:
  bool see(Whole& whole, const optim::Iterate& iterate);
  void see(const Part& part, MmcProblem& state, const optim::Iterate& iterate, bool first);

  std::vector<Part> parts_;
  int cycle_;
  const DesignSettings& settings_;
  const IterationObserver& observe_;
  int iterations_ = 0, evaluations_ = 0;
  bool going_ = true;
};

/// The designs of the problems as they are.
StageResult first_designs(std::span<const Part> parts);

/// Nominal stiffness at a band of the continuation.
/// @param band  of the body with most bands; the others keep theirs longer
StageResult at_band(StageRunner& run, const StageResult& from, size_t band, const Share& share);
/// The last band with the stiffness of the eroded design, which closes slits.
StageResult with_erosion(StageRunner& run, const StageResult& from, const Share& share);
/// Components that carry nothing are removed where widths are wanted: void has no gradient, so
/// that no later stage would see them.
/// @param keeps_width  no stage comes that would widen what they leave narrow
StageResult without_idle(StageRunner& run, const StageResult& from, bool keeps_width);
/// last_formulation(): widths are limits from the first iteration, and all limits hold of the crisp
/// design.
StageResult last_stage(StageRunner& run, const StageResult& from, const Share& share);

/// Which of two results is better: a feasible one, or the one with the lower objective.
bool is_better(const optim::Result& a, const optim::Result& b, double feasibility);

}  // namespace flexmorph::mmc
