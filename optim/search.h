#pragma once

#include <deque>
#include <string>

#include "optim/optimizer.h"

namespace flexmorph::optim {

/// A design and what the problem says about it.
struct Point {
  VectorXd x;
  Response response;
};

/// What became of a trial design: `unacceptable` and `failed` ones must not become iterates.
enum class Trial { taken, unacceptable, failed };

double violation(const Response& response);  ///< max(0, largest g)
std::string scientific(double value);        ///< for messages: 1.2e-05

/// What all optimizers share: guarded and counted evaluations, the best design met, the rows of
/// the history, and the reasons to stop.
///
/// Designs are ordered: acceptable ones first, then usable ones by the objective that they attain,
/// then the others by their violation (bounds of an auxiliary variable do not count). Once an
/// acceptable design was met, unacceptable ones are refused; before that (the start itself has come
/// apart) they pass.
class Search {
 public:
  /// @throws Error (input) for no variables, bounds that cross or are not finite, a start
  ///         outside of them.
  Search(Problem& problem, const Settings& settings, const Observer& observe);

  int n() const { return static_cast<int>(lower_.size()); }
  int m() const { return m_; }
  const VectorXd& lower() const { return lower_; }
  const VectorXd& upper() const { return upper_; }

  /// The start, evaluated.
  /// @throws Error (numerical) when that fails or is not finite.
  Point start();

  /// One evaluation of the problem. Anything but a numerical Error passes through.
  /// @param out  valid when `taken`
  Trial evaluate(const VectorXd& x, Response& out);
  int evaluations() const { return evaluations_; }
  bool has_curvature() const { return problem_.has_curvature(); }
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) {
    return problem_.curvature(x, sigma, lambda);
  }
  bool spent() const;  ///< all state solves that are allowed are used
  int refused_in_a_row() const { return refused_in_a_row_; }
  const std::string& refusal() const { return refusal_; }  ///< why a trial was not taken, last

  /// Shows an iterate to the observer and asks whether to go on: false when it satisfies the
  /// KKT conditions, rests, is the last one allowed, or the observer says so.
  /// @param iteration  from 1
  bool row(int iteration, const Point& point);
  void stop_when_spent();  ///< for those that are between two rows
  int rows() const { return rows_; }

  void stop(Stop stop, const std::string& message);
  bool stopped() const { return stopped_; }

  const Point& best() const { return best_.point; }
  /// Tells whether all constraints hold, those of an auxiliary variable among them.
  bool feasible(const Response& response) const;

  /// The best design; the problem's last evaluation is there, too.
  Result result();

 private:
  struct Ranked {
    Point point;
    bool acceptable = false;
  };
  bool usable(const Response& response) const;  ///< the design meets its own constraints
  bool better(const Response& response, bool acceptable) const;
  void check(const Response& response) const;
  bool rests(double change, double violation);
  double recent_change() const;
  void end_or_go_on(const Iterate& it, const Point& point, double price);
  void keep_last(const Point& point, double slack);
  double improvement_over(int rows) const;
  bool at_plateau() const;  ///< of the best usable design
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
  std::deque<double> objectives_;         // of the last rows, at most settings_.rest.rows + 1
  std::deque<double> best_objectives_;    // of the best usable design at the last rows
  double mark_ = 0, inside_problem_ = 0;  // CPU seconds
  std::string refusal_;

  bool stopped_ = false;
  Stop stop_ = Stop::failed;
  std::string message_;
};

}  // namespace flexmorph::optim
