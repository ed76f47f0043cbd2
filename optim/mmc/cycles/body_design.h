#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optim/evaluation_log.h"
#include "optim/mmc/cycles/combined_problem.h"
#include "optim/mmc/problem/body_problem.h"
#include "optim/optimizer.h"

namespace flexmorph::mmc {

/// One row of the history of a body. All references are valid only during the call of the observer.
struct IterationReport {
  const BodyProblem& problem;  ///< Design problem of the body.
  int cycle = 1;               ///< Number of the cycle, from 1.
  int iteration = 0;           ///< Number of the iteration over all stages of the cycle, from 1.
  int evaluations = 0;         ///< Number of evaluations in the cycle so far.
  /// Iterations of this body in the cycle so far that had constraints on widths, which cost more.
  int with_widths = 0;
  /// Largest numbers of iterations of this body that follow in the cycle: of all, and of those with
  /// constraints on widths.
  int most_left = 0, most_left_with_widths = 0;

  /// Row of the optimizer. Its x belongs to this body alone; all other values belong to the
  /// combined problem of all bodies. CPU seconds of the combined problem are in the row of the
  /// first body.
  const optim::Iterate& iterate;
  const MmcProblem& state;                  ///< Problem of the body with the values at x.
  const ComplianceEvaluator::Value& value;  ///< Compliance at x and its derivatives.
  ComplianceEvaluator& loads;               ///< Loads of the body.
  const CrispDesign* crisp = nullptr;       ///< Crisp design at x, null if it was not evaluated.
};

/// Smallest widths that are required of a design, and the removal of components that serves them.
struct LengthScale {
  MinimumWidths wanted;  ///< Required smallest widths [m].
  int removed = 0;       ///< Number of unloaded components that were removed.
  double seconds = 0;    ///< CPU time of the removal [s].
};

/// The result of the design of one body in one cycle.
struct BodyOutcome {
  std::string body;      ///< Name of the body.
  Symmetry symmetry;     ///< Symmetry that all stages preserve.
  bool of_part = false;  ///< True if BodyProblem::part is the design; all values are then crisp.
  double compliance = 0, volume = 0;  ///< Compliance [J] and volume [-], regularized, last band.
  Figures further;                    ///< Further responses, regularized, last band.
  CrispDesign crisp;                  ///< Crisp design.
  double worst_compliance = 0;        ///< Largest compliance of a load, crisp design [J].
  double uniform_compliance = 0;      ///< Compliance of uniform material of equal volume [J].
  Figures full;                       ///< Result of full_values() under the loads of the cycle.
  double kkt = 0, change = 0;         ///< KKT residual and largest change of a variable.

  /// Numbers of iterations and evaluations in the cycle, of loads and of right-hand sides.
  int iterations = 0, evaluations = 0, n_loads = 0, n_right_hand_sides = 0;
  int start = 1;                    ///< Number of the start design that led to the result, from 1.
  int factorizations = 0;           ///< Number of factorizations of the stiffness matrix.
  std::optional<double> condition;  ///< Condition of the crisp stiffness matrix, if requested.
  std::string stop;                 ///< Reason why the optimizer stopped.
  optim::Verdict verdict;           ///< Convergence state at the end of the last stage.
  std::optional<LengthScale> length_scale;  ///< Length scale, if widths are required.
  std::vector<double> load_compliances;     ///< Compliance F_i . u_i of the crisp design [J].

  /// Ratio of ½ F_i . u_i of the design before the cycle to the strain energy of the motion, for
  /// each load [-].
  std::vector<double> energy_ratios;
  double design_change = 0;  ///< Change of the design in the cycle, see BodyVerdict.

  /// Tells whether the design is one connected region and reaches all required widths within 1 %;
  /// it returns true if no widths are required.
  bool reaches_length_scale() const;
};

/// Identifies a row of the history that an earlier run may have written.
struct RowOfHistory {
  const std::string& body;  ///< Name of the body.
  int cycle, iteration;     ///< Numbers of the cycle and of the iteration, from 1.
};

/// Records of an earlier run of the same case, which a restarted run repeats without solving
/// states.
struct Past {
  optim::EvaluationLog& log;  ///< Evaluations of the earlier run.

  /// Returns true if the row and all its data have been written. Such a row is not reported again.
  std::function<bool(const RowOfHistory&)> has_row;
};

/// Settings of the design of bodies in one cycle.
struct DesignSettings {
  int crisp_every = 25;       ///< Iterations between crisp evaluations; 0: only at the end.
  optim::Settings optimizer;  ///< Optimizer; max_iterations 0: designs are only evaluated.
  bool condition = false;     ///< True if the condition is estimated (costs a factorization).
  Past* past = nullptr;       ///< Records that are read and continued; null: no records.

  /// Cancellation callback between stages (within a stage the observer is called); false stops.
  /// Empty: the run continues.
  std::function<bool()> keep_running = {};
};

/// A function that is called with every row of the history; it returns false to stop the run after
/// the current iteration.
using IterationObserver = std::function<bool(const IterationReport&)>;

/// Designs bodies under given loads, stage by stage (stages.h): one body, or several bodies that
/// have one budget of mass in common (see SharedProblem). The stages of the first cycle are:
///
///   1. Every band of the continuation except the last, with nominal stiffness, from every start.
///   2. The last band with the stiffness of the eroded design, from every start; the best result is
///      continued.
///   3. Unloaded components are removed.
///   4. The last band with nominal stiffness, the widths as constraints and limits on the crisp
///      design. After 60 % of the iterations of this stage, stage 3 is repeated. At the end it is
///      repeated again, for components whose removal does not reduce any width too far.
///
/// Later cycles begin with stage 2 and have the same number of iterations per stage as the first
/// cycle. If no widths are required, there are only the stages 1 and 2. Every stage has an equal
/// share of the iterations; it ends at a plateau (optim::Verdict) or when its share is used.
/// Without a criterion of stagnation (StoppingWindow::rows = 0) it ends only when its share is
/// used. On return the problems hold the resulting designs.
/// @param is_running  on return false if the observer stopped the run
/// @throws Error (numerical) from statics; rows reported before remain valid. Error (input) from
///         SharedProblem.
///
/// Source: optim/README.md, Stages.
std::vector<BodyOutcome> design_bodies(std::span<const LoadedBody> bodies, int cycle,
                                       const DesignSettings& settings,
                                       const IterationObserver& observe, bool& is_running);
/// Designs one body under given loads, see design_bodies().
BodyOutcome design_body(BodyProblem& problem, ComplianceEvaluator& loads, int cycle,
                        const DesignSettings& settings, const IterationObserver& observe,
                        bool& is_running);

/// Returns the outcome of a design under its loads, without the members that the optimizer
/// provides.
/// @param condition  true if the condition of the stiffness matrix is estimated
BodyOutcome outcome_of(const Subproblem& part, const Design& design, const Formulation& formulation,
                       bool condition);

}  // namespace flexmorph::mmc
