#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optim/evaluation_log.h"
#include "optim/mmc/body_problem.h"
#include "optim/mmc/clean_up.h"
#include "optim/mmc/turnover.h"
#include "optim/optimizer.h"

namespace flexmorph::mmc {

/// One row of the history. Everything it refers to lives during the call only.
struct IterationReport {
  const BodyProblem& problem;
  int cycle = 1;
  int iteration = 0;  ///< over all stages of the cycle, from 1
  int evaluations = 0;
  /// x is the body's own; all else is of the problem it is a part of. Seconds that bodies share are
  /// in the row of the first.
  const optim::Iterate& iterate;
  const MmcProblem& state;                  ///< values at the iterate's x
  const ComplianceEvaluator::Value& value;  ///< compliance and its derivatives there
  ComplianceEvaluator& loads;
  const SharpDesign* sharp = nullptr;  ///< when evaluated
  /// What becomes of its components after this iteration.
  std::span<const ComponentEvent> events = {};
};

/// What a body's design came to in one cycle.
struct BodyOutcome {
  std::string body;
  double compliance = 0, volume = 0;  ///< blurred, at the last stage's band
  Figures further;                    ///< likewise
  SharpDesign sharp;
  double worst_compliance = 0;    ///< largest of the loads, of the sharp design
  double uniform_compliance = 0;  ///< same loads, uniform material of the same volume
  Figures full;                   ///< full_values() under the loads of the cycle
  double kkt = 0, change = 0;
  int iterations = 0, evaluations = 0, n_loads = 0, n_right_hand_sides = 0;
  int start = 1;  ///< whose design it is, of the problem's starts
  int factorizations = 0;
  std::optional<double> condition;  ///< of the stiffness of the sharp design, when asked for
  std::string stop;                 ///< why the optimizer stopped
  optim::Verdict verdict;           ///< on the last stage
  std::vector<ComponentEvent> events;
  std::optional<CleanUp> clean_up;       ///< when a smallest feature was wanted
  std::vector<double> load_compliances;  ///< F_i . u_i of the sharp design
  std::vector<double> energy_ratios;     ///< ½ F_i . u_i of the starting design / strain energy
  double seconds_mending = 0;  ///< CPU seconds of repairs; those of bodies together are the first's
  double design_change = 0;    ///< see esl_loop(): between the designs before and after the cycle
};

/// A row of the history that an earlier run may have written.
struct RowOfHistory {
  const std::string& body;
  int cycle, iteration;
  std::span<const ComponentEvent> events;  ///< after it
};

/// What an earlier run of the same case left, which is gone through again without solving states.
struct Past {
  optim::EvaluationLog& log;
  /// Is the row on record, with all that belongs to it? It is not reported again then.
  std::function<bool(const RowOfHistory&)> has_row;
};

/// What fewer iterations come to is no design yet: as a lattice on its way it is repaired at a high
/// price, if at all, and only where that is asked for.
constexpr int kFewestMendedIterations = 40;

/// A last solve of a mended design is done so many times at most.
constexpr int kFinishTries = 4;

struct DesignSettings {
  int sharp_every = 25;       ///< iterations between sharp evaluations; 0: only at the end
  optim::Settings optimizer;  ///< max_iterations 0: designs are analysed, at their last band
  bool condition = false;     ///< estimate it at the end (costs a factorization)
  Past* past = nullptr;       ///< where evaluations are kept, and may be known from
  /// A last solve from what the stages reached, at their last band and without drops.
  std::optional<optim::Settings> finish = {};
  /// Asked while designs are repaired, as the observer is while they are optimized. Empty: go on.
  std::function<bool()> go_on = {};
};

/// Looks on; false stops the run after the current iteration.
using IterationObserver = std::function<bool(const IterationReport&)>;

/// A body and the loads it is designed under.
struct LoadedBody {
  BodyProblem& problem;
  ComplianceEvaluator& loads;
};

/// The designs of bodies under given loads, over all stages of their bands: of one body, or of
/// several that share one budget of mass (see SharedProblem). A stage ends at a plateau (see
/// optim::Verdict), at the latest when its share of the iterations is used. These have one
/// optimizer; every body keeps its own bands (of fewer stages each lasts longer), solid regions,
/// drops and clean-up, and rows of its own in every iteration. The designs of the problems are left
/// at the result.
/// @param going  comes back false when the observer stopped the run
/// @throws Error (numerical) from statics; rows reported before it stand. Error (input) from
///         SharedProblem.
std::vector<BodyOutcome> design_bodies(std::span<const LoadedBody> bodies, int cycle,
                                       const DesignSettings& settings,
                                       const IterationObserver& observe, bool& going);
/// The same of one body.
BodyOutcome design_body(BodyProblem& problem, ComplianceEvaluator& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& going);

}  // namespace flexmorph::mmc
