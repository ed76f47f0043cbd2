#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optim/evaluation_log.h"
#include "optim/mmc/cycles/designed_parts.h"
#include "optim/mmc/problem/body_problem.h"
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
};

/// Smallest widths that were wanted of a design, and how far it has come.
struct LengthScale {
  Widths wanted;       ///< [m]
  int removed = 0;     ///< components that carried nothing, and were removed
  double seconds = 0;  ///< CPU, of the removal
};

/// What a body's design came to in one cycle.
struct BodyOutcome {
  std::string body;
  Symmetry symmetry;     ///< that all stages kept
  bool of_part = false;  ///< whether it is that of BodyProblem::part: components have no numbers
  double compliance = 0, volume = 0;  ///< regularized, at the last band
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
  std::optional<LengthScale> length_scale;  ///< where widths were wanted
  std::vector<double> load_compliances;     ///< F_i . u_i of the sharp design
  std::vector<double> energy_ratios;        ///< ½ F_i . u_i of the starting design / strain energy
  double design_change = 0;  ///< see esl_loop(): between the designs before and after the cycle

  /// Tells whether the design is one piece with all widths that were wanted, within a hundredth.
  bool reaches_length_scale() const;
};

/// A row of the history that an earlier run may have written.
struct RowOfHistory {
  const std::string& body;
  int cycle, iteration;
};

/// What an earlier run of the same case left, which is gone through again without solving states.
struct Past {
  optim::EvaluationLog& log;
  /// Is the row on record, with all that belongs to it? It is not reported again then.
  std::function<bool(const RowOfHistory&)> has_row;
};

struct DesignSettings {
  int sharp_every = 25;       ///< iterations between sharp evaluations; 0: only at the end
  optim::Settings optimizer;  ///< max_iterations 0: designs are evaluated as they are
  bool condition = false;     ///< estimate it at the end (costs a factorization)
  Past* past = nullptr;       ///< where evaluations are kept, and may be known from
  /// Asked between stages, as the observer is within them. Empty: go on.
  std::function<bool()> go_on = {};
};

/// Looks on; false stops the run after the current iteration.
using IterationObserver = std::function<bool(const IterationReport&)>;

/// The designs of bodies under given loads, stage by stage (stages.h): of one body, or of several
/// that share one budget of mass (see SharedProblem). In the first cycle
///
///   1. every band of the continuation but the last: nominal stiffness, from every start;
///   2. the last band: stiffness of the eroded design, from every start; the best one goes on;
///   3. components that carry nothing are removed;
///   4. the last band: nominal stiffness, widths as limits, limits of the crisp design; after 60 %
///      of its share 3 comes once more, and at the end where widths do not suffer.
///
/// Later cycles begin with stage 2 and have as many iterations for each stage as the first one.
/// Without wanted widths there are stages 1 and 2 only. Every stage has an equal share of the
/// iterations and ends at a plateau (optim::Verdict), at the latest when its share is used. The
/// designs of the problems are left at the result.
/// @param going  comes back false when the observer stopped the run
/// @throws Error (numerical) from statics; rows reported before it stand. Error (input) from
///         SharedProblem.
///
/// Source: optim/README.md, Stages.
std::vector<BodyOutcome> design_bodies(std::span<const LoadedBody> bodies, int cycle,
                                       const DesignSettings& settings,
                                       const IterationObserver& observe, bool& going);
/// The same of one body.
BodyOutcome design_body(BodyProblem& problem, ComplianceEvaluator& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& going);

/// The figures of a delivered design under its loads: all of an outcome but what the optimizer
/// says.
BodyOutcome outcome_of(const Part& part, const Design& design, const Formulation& formulation,
                       bool condition);

}  // namespace flexmorph::mmc
