#pragma once

#include "cases/results/run_result.h"
#include "cases/run/run_context.h"

namespace flexmorph::cases {

/// The end of the names of files that keep the evaluations of designs until a run is done.
inline constexpr const char* kEvaluations = "evaluations.log";

class CycleMotions;
class KeptEvaluations;

/// A run with designs: cycles of motions and designs, or the design of a plate at rest; then the
/// verification of the outlines, the motions with the final designs, and the certificate.
class DesignRun {
 public:
  explicit DesignRun(const RunContext& run) : run_(run) {}

  /// Runs all of it. @throws Error, Interrupted; take_design() and take_motions() then have what
  /// was computed before
  void run();

  DesignResult take_design() { return std::move(design_); }
  MotionResults take_motions() { return std::move(motions_); }

 private:
  void design_moving();
  void design_at_rest();
  struct CycleLoads;
  void run_cycles(std::vector<fem::EslSets>& loads);
  mmc::LoopObserver cycle_observer(CycleMotions& motions, const KeptEvaluations& kept,
                                   CycleLoads& loads);
  void add_idle_seconds(const mmc::BodyOutcome& outcome);
  void compare_loads(std::span<const fem::EslSets> own);
  void verify_outlines(std::span<const fem::EslSets> loads);

  const RunContext& run_;
  DesignResult design_;
  MotionResults motions_;
};

}  // namespace flexmorph::cases
