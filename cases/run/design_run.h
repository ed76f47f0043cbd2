#pragma once

#include "cases/results/run_result.h"
#include "cases/run/run_context.h"

namespace flexmorph::cases {

/// Ending of the names of the files that store the evaluations of designs until a run is complete.
inline constexpr const char* kEvaluations = "evaluations.log";

class CycleMotions;
class KeptEvaluations;

/// A run with designs. It optimizes moving bodies in cycles of motions and designs, or a static
/// plate in one design. Afterwards it verifies the outlines, computes the motions with the final
/// designs, and computes the certificate.
class DesignRun {
 public:
  /// Creates the run; the context has to outlive it.
  explicit DesignRun(const RunContext& run) : run_(run) {}

  /// Computes all stages of the run. After an exception, take_design() and take_motions() return
  /// the results that were computed before it.
  /// @throws Error, Interrupted
  void run();

  /// Returns the designs of the run; can be called once.
  DesignResult take_design() { return std::move(design_); }
  /// Returns the motions of the run; can be called once.
  MotionResults take_motions() { return std::move(motions_); }

 private:
  void design_moving();
  void design_at_rest();
  struct CycleLoads;
  void run_cycles(std::vector<fem::EslSets>& loads);
  mmc::LoopObserver cycle_observer(CycleMotions& motions, const KeptEvaluations& kept,
                                   CycleLoads& loads);
  void add_unloaded_seconds(const mmc::BodyOutcome& outcome);
  void compare_loads(std::span<const fem::EslSets> own);
  void verify_outlines(std::span<const fem::EslSets> loads);

  const RunContext& run_;
  DesignResult design_;
  MotionResults motions_;
};

}  // namespace flexmorph::cases
