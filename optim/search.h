#pragma once

#include <deque>
#include <string>

#include "optim/optimizer.h"

namespace flexmorph::optim {

/// A design with the values and gradients of the problem there.
struct Point {
  VectorXd x;              ///< Design (n).
  ProblemValues response;  ///< Values and gradients at x.
};

/// Outcome of the evaluation of a trial design.
enum class Trial {
  taken,         ///< The design may become an iterate.
  unacceptable,  ///< Problem::acceptable() rejects the design; it must not become an iterate.
  failed         ///< The evaluation failed or is not finite; it must not become an iterate.
};

/// Returns the largest constraint value g, at least 0.
double violation(const ProblemValues& response);
/// Returns a number in scientific notation for messages, such as 1.2e-05.
std::string scientific(double value);

/// The functions that all optimizers have in common: guarded and counted evaluations, the best
/// design so far, the rows of the history, and the criteria to stop.
///
/// Designs are ranked: acceptable designs first, then usable ones by the objective that they
/// attain, then the remaining ones by their violation (constraints that bound an auxiliary variable
/// do not count). As soon as one acceptable design is known, unacceptable designs are refused;
/// before that they are taken, because the start itself may be disconnected.
class Search {
 public:
  /// Creates a search; all three arguments must outlive it.
  /// @throws Error (input) if there are no variables, if bounds are not finite or lower > upper, or
  ///         if the bounds have the wrong length.
  Search(Problem& problem, const Settings& settings, const Observer& observe);

  /// Returns the number of variables.
  int n() const { return static_cast<int>(lower_.size()); }
  /// Returns the number of constraints.
  int m() const { return m_; }
  /// Returns the lower bounds of the variables (n).
  const VectorXd& lower() const { return lower_; }
  /// Returns the upper bounds of the variables (n).
  const VectorXd& upper() const { return upper_; }

  /// Evaluates the start design of the problem and returns it.
  /// @throws Error (input) if the start has the wrong length or lies outside the bounds; Error
  ///         (numerical) if its evaluation fails or is not finite.
  Point start();

  /// Evaluates the problem once. Exceptions other than a numerical Error are passed on.
  /// @param out  the response, valid if the trial is `taken`
  Trial evaluate(const VectorXd& x, ProblemValues& out);
  /// Returns the number of evaluations so far.
  int evaluations() const { return evaluations_; }
  /// Returns true if the problem has second derivatives.
  bool has_curvature() const { return problem_.has_curvature(); }
  /// Returns σ ∇²f + Σ λ_i ∇²g_i of the problem at x (n x n).
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) {
    return problem_.curvature(x, sigma, lambda);
  }
  /// Returns true if the largest number of state solves has been reached.
  bool spent() const;
  /// Returns the number of trials in sequence that were not taken, up to the last one.
  int refused_in_a_row() const { return refused_in_a_row_; }
  /// Returns the reason why the most recent refused trial was not taken.
  const std::string& refusal() const { return refusal_; }

  /// Records a row of the history: passes the iterate to the observer and tests all criteria to
  /// stop. It returns false if the search has stopped, for example because the iterate satisfies
  /// the KKT conditions or stagnates, is the last one allowed, or because the observer returned
  /// false.
  /// @param iteration  number of the row, from 1
  bool row(int iteration, const Point& point);
  /// Stops the search if spent(); optimizers call it between two rows.
  void stop_when_spent();
  /// Returns the number of rows recorded so far.
  int rows() const { return rows_; }

  /// Stops the search for a reason; only the first call has an effect.
  void stop(Stop stop, const std::string& message);
  /// Returns true if the search has stopped.
  bool stopped() const { return stopped_; }

  /// Returns the best design found so far.
  const Point& best() const { return best_.point; }
  /// Returns true if all constraints hold, including those that bound an auxiliary variable.
  bool feasible(const ProblemValues& response) const;

  /// Returns the result with the best design, at which the problem was evaluated last.
  Result result();

 private:
  struct Ranked {
    Point point;
    bool acceptable = false;
  };
  bool usable(const ProblemValues& response) const;  // design_violation() is within the tolerance
  bool better(const ProblemValues& response, bool acceptable) const;
  void check(const ProblemValues& response) const;
  bool stagnates(double change, double violation);
  double recent_change() const;
  void end_or_continue(const Iterate& it, const Point& point, double price);
  void keep_last(const Point& point, double slack);
  double improvement_over(int rows) const;
  bool at_plateau() const;
  Verdict verdict_on(const Result& result) const;

  Problem& problem_;
  const Settings& settings_;
  const Observer& observe_;
  int m_ = 0;
  VectorXd lower_, upper_;

  Ranked best_;
  bool best_is_new_ = false;
  VectorXd last_x_, previous_row_;
  int evaluations_ = 0, rows_ = 0, last_usable_row_ = 0, resting_ = 0, refused_in_a_row_ = 0;
  std::deque<double> objectives_;         // of the last settings_.rest.rows + 1 rows at most
  std::deque<double> best_objectives_;    // of the best usable design at the last rows
  double mark_ = 0, inside_problem_ = 0;  // CPU seconds
  std::string refusal_;

  bool stopped_ = false;
  Stop stop_ = Stop::failed;
  std::string message_;
};

}  // namespace flexmorph::optim
