#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "optim/problem.h"
#include "optim/verdict.h"

namespace flexmorph::optim {

/// One row of the history: an iteration (mma, ipopt) or an evaluation (NLopt, which has no callback
/// for iterations).
struct Iterate {
  int iteration = 0;                        ///< Number of the row, from 1.
  int evaluations = 0;                      ///< Number of evaluations of the problem so far.
  const VectorXd* x = nullptr;              ///< Design (n).
  const ProblemValues* response = nullptr;  ///< Values and gradients at x.
  double kkt = 0;                           ///< KKT residual at x, see kkt_residual().
  double violation = 0;                     ///< Largest constraint value g, at least 0.
  double change = 0;      ///< Largest |x - x of the previous row|, 0 in the first row.
  bool improved = false;  ///< True if x is a new best usable design.
  double seconds = 0;     ///< CPU seconds in the optimizer itself since the last row.
};

/// A function that is called with every row of the history; it returns false to stop the run.
using Observer = std::function<bool(const Iterate&)>;

/// Reason why an optimization ended.
enum class Stop {
  converged,         ///< The KKT conditions hold, or the search stagnates (rest, change_tolerance).
  plateau,           ///< The best design improves too little, see Settings::plateau.
  iteration_limit,   ///< The largest number of iterations was reached.
  evaluation_limit,  ///< The largest number of state solves was reached.
  observer,          ///< The observer returned false.
  stalled,           ///< Too many designs were refused, or no better design was found.
  failed             ///< No reason was recorded.
};
/// Returns the name of a reason to stop, for example "iteration limit".
std::string to_string(Stop stop);

/// Criterion for a stagnating search. It is met if the objective has stayed within a narrow band
/// over the last rows, and the last of these rows is feasible and nearly meets the KKT conditions.
struct StoppingWindow {
  int rows = 15;  ///< Number of rows over which the objective is compared; 0: no criterion.
  double objective = 1e-3;  ///< Width of the band of the objective; for a logarithm, relative.
  double kkt = 1e-3;        ///< Largest KKT residual of the last row; infinite: any residual.
};

/// Settings of an optimizer.
struct Settings {
  std::string name = "mma";  ///< Name of the optimizer in the table.
  int max_iterations = 300;  ///< Largest number of iterations; for NLopt, of evaluations.

  /// Largest number of state solves; 0: no limit. At the end the best design is evaluated one more
  /// time if it was not the last one evaluated.
  int max_evaluations = 0;
  /// Largest KKT residual of a converged design. The run stops when it is reached and the design is
  /// feasible.
  double kkt_tolerance = 1e-4;
  double feasibility = 1e-5;    ///< Largest constraint value g of a feasible design.
  double change_tolerance = 0;  ///< Stops after 3 rows in sequence with less change; 0: off.
  StoppingWindow rest = {};     ///< Criterion of stagnation that stops the run as well.

  /// True if the run stops when the best usable design has improved by less than Verdict::kPlateau
  /// over Verdict::kPlateauRows rows.
  bool plateau = false;
  /// Largest change of a variable per iteration (mma); the half width of the box of NLopt follows
  /// from it.
  double move_limit = 0.05;
  /// Options of one optimizer by their names (see the file of the optimizer); unknown names are
  /// errors.
  std::map<std::string, double> options;
};

/// The result of an optimization.
struct Result {
  VectorXd x;                           ///< Best feasible design, or the least infeasible one (n).
  ProblemValues response;               ///< Values and gradients at x.
  double kkt = 0, violation = 0;        ///< KKT residual and design_violation() at x.
  int iterations = 0, evaluations = 0;  ///< Number of rows of the history and of evaluations.
  Stop stop = Stop::failed;             ///< Reason why the run ended.
  std::string message;                  ///< One sentence that says why the run ended.
  Verdict verdict;                      ///< Convergence state of the design x.
};

/// Interface of all optimizers.
class Optimizer {
 public:
  virtual ~Optimizer() = default;
  /// Minimizes a problem from its start and calls the observer with every row of the history.
  /// @throws Error (input) for a start outside the bounds or n = 0; Error (numerical) if the first
  ///         evaluation fails or is not finite.
  virtual Result minimize(Problem& problem, const Observer& observe) = 0;
};

/// Returns the optimizer that the settings name.
/// @throws Error (input) for an unknown optimizer or option (the message lists the known ones), and
///         for settings out of range.
std::unique_ptr<Optimizer> make_optimizer(const Settings& settings);
/// Returns the names of all optimizers of the table in alphabetical order.
std::vector<std::string> optimizer_names();

/// A row of the table of optimizers.
struct OptimizerRow {
  const char* name;  ///< Name of the optimizer in case files, as in name = "mma".

  /// Makes an optimizer with these settings.
  /// @throws Error (input) for options that the optimizer does not have, see with_defaults().
  std::function<std::unique_ptr<Optimizer>(const Settings& settings)> make;
};
/// Adds a row to the table of optimizers, see Registry::add().
void register_optimizer(const OptimizerRow& row);

/// Returns the KKT residual, which is computed by one formula for all optimizers:
///
///   min over λ >= 0 with λ_i = 0 where g_i is inactive of  |P(df + dgᵀ λ)|_∞
///
/// P sets those entries to zero that push against an active bound. The multipliers λ come from
/// non-negative least squares.
/// @param active_tolerance  distance below which constraints and bounds count as active
double kkt_residual(const ProblemValues& r, const VectorXd& x, const VectorXd& lower,
                    const VectorXd& upper, double active_tolerance = 1e-4);

}  // namespace flexmorph::optim
