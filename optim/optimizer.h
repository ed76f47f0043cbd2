#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "optim/problem.h"
#include "optim/verdict.h"

namespace flexmorph::optim {

/// One row of the history: an iteration (mma, ipopt) or an evaluation (NLopt has no iteration
/// callback: its rows are evaluations, `improved` marks better feasible points).
struct Iterate {
  int iteration = 0;    ///< from 1
  int evaluations = 0;  ///< evaluations of the problem so far
  const VectorXd* x = nullptr;
  const Response* response = nullptr;
  double kkt = 0;         ///< KKT residual at x, see kkt_residual()
  double violation = 0;   ///< max(0, largest g)
  double change = 0;      ///< largest |x - previous x|
  bool improved = false;  ///< best feasible design so far
  double seconds = 0;     ///< CPU seconds inside the optimizer itself since the last row
};

/// Looks on; returns false to stop the run.
using Observer = std::function<bool(const Iterate&)>;

enum class Stop {
  converged,
  plateau,
  iteration_limit,
  evaluation_limit,
  observer,
  stalled,
  failed
};
std::string to_string(Stop stop);

/// When a search has come to rest: over the last rows the objective has kept within a band, and the
/// last of them is feasible and nearly meets the KKT conditions.
struct Rest {
  int rows = 15;            ///< 0: it never rests
  double objective = 1e-3;  ///< width of that band; of a logarithm, a part
  double kkt = 1e-3;        ///< infinite: whatever the residual
};

struct Settings {
  std::string name = "mma";
  int max_iterations = 300;  ///< iterations, or evaluations for NLopt
  /// State solves allowed, 0: no limit. The best design is evaluated once more when it was not the
  /// last.
  int max_evaluations = 0;
  double kkt_tolerance = 1e-4;  ///< stop when the KKT residual and ...
  double feasibility = 1e-5;    ///< ... the violation are below these
  double change_tolerance = 0;  ///< stop after 3 iterations with less change (0: off)
  Rest rest = {};               ///< stop there, too
  /// Stop when the best usable design has improved by less than Verdict::kPlateau over
  /// Verdict::kPlateauRows rows.
  bool plateau = false;
  double move_limit = 0.05;  ///< largest change of a variable per iteration (mma), box (NLopt)
  /// Settings of one optimizer, by name (see its file for the names); unknown names are errors.
  std::map<std::string, double> options;
};

struct Result {
  VectorXd x;         ///< best feasible design met, or the least infeasible one
  Response response;  ///< there
  double kkt = 0, violation = 0;
  int iterations = 0, evaluations = 0;
  Stop stop = Stop::failed;
  std::string message;  ///< one sentence: why it stopped
  Verdict verdict;      ///< on the best design
};

class Optimizer {
 public:
  virtual ~Optimizer() = default;
  /// @throws Error (input) for a start outside the bounds or n = 0; Error (numerical) when the
  ///         very first evaluation fails or is not finite.
  virtual Result minimize(Problem& problem, const Observer& observe) = 0;
};

/// @throws Error (input) naming the known optimizers and options.
std::unique_ptr<Optimizer> make_optimizer(const Settings& settings);
std::vector<std::string> optimizer_names();  ///< of the table, in alphabetical order

/// A row of the table of optimizers.
struct OptimizerRow {
  const char* name;  ///< as cases say it: name = "mma"
  /// Makes one. @throws Error (input) for options that it does not know (with_defaults())
  std::unique_ptr<Optimizer> (*make)(const Settings& settings);
};
/// Adds a row, see Registry::add().
void register_optimizer(const OptimizerRow& row);

/// KKT residual computed the same way for all optimizers.
///
///   min over λ >= 0 with λ_i = 0 where g_i is inactive of  |P(df + dgᵀ λ)|_∞
///
/// P drops entries that push against an active bound. Multipliers by non-negative least squares.
double kkt_residual(const Response& r, const VectorXd& x, const VectorXd& lower,
                    const VectorXd& upper, double active_tolerance = 1e-4);

}  // namespace flexmorph::optim
