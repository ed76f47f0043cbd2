#pragma once

#include <chrono>
#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optim/problem.h"

namespace flexmorph::optim {

/// Counters of the work of a run, and whatever else its next count depends on. Only the WorkCounter
/// that returned them knows their meaning.
using Work = std::vector<std::uint64_t>;

/// Interface of a counter of work that a continued run does not repeat, for example factorizations.
class WorkCounter {
 public:
  virtual ~WorkCounter() = default;
  /// Returns the counters so far.
  virtual Work work() const = 0;
  /// Continues from the counters of an earlier run. Empty counters change nothing.
  virtual void continue_from(const Work& work) = 0;
};

/// The result of one evaluation of a problem at one design.
struct Evaluation {
  VectorXd x;              ///< Design (n).
  std::string failure;     ///< Reason why the state could not be solved; empty if it was solved.
  ProblemValues response;  ///< Values and gradients at x; valid only if `failure` is empty.
  bool acceptable = true;  ///< True if Problem::acceptable() accepts the design.
  Work work;               ///< Work until the end of the evaluation.
};

/// A file of evaluations in the order in which an optimizer requests them; it is kept after the
/// process ends. Optimizers are deterministic: an optimizer that starts again from the same design
/// requests the same evaluations, and no state is solved for an evaluation that is in the file.
/// Therefore a killed run continues exactly (bit for bit) where it was killed, whatever internal
/// state the optimizer has.
///
/// A stored evaluation is used only if its x agrees bit for bit with the requested x. If another x
/// is requested, the remaining records belong to a different run and are deleted.
///
/// File format: a header line with the name and the version of the format, then records
/// [bytes, CRC-32, data] in the byte order of the machine. The first incomplete or damaged record
/// ends the file. A record without a design contains only work.
class EvaluationLog {
 public:
  /// Opens the file, or creates it; a file with another header line is cleared.
  /// @throws Error (numerical) if the file cannot be written.
  explicit EvaluationLog(std::string path);
  ~EvaluationLog();
  EvaluationLog(const EvaluationLog&) = delete;
  EvaluationLog& operator=(const EvaluationLog&) = delete;

  /// Returns the next stored evaluation if its design is x. Otherwise it deletes the remaining
  /// records and returns nothing; from then on every call returns nothing.
  /// @throws Error (numerical) if the file cannot be written.
  std::optional<Evaluation> next(const VectorXd& x);

  /// Writes an evaluation to the end of the file.
  /// @throws Error (numerical) if the file cannot be written.
  void append(const Evaluation& evaluation);

  /// Writes the work until now, which includes work after the last evaluation. Nothing is written
  /// while the file has further evaluations, because these contain the work before them.
  /// @throws Error (numerical) if the file cannot be written.
  void append_work(const Work& work);
  /// Returns the work that append_work() has written after the evaluation that next() found; empty
  /// if there is none.
  const Work& work_after() const { return work_after_; }

  /// Returns true if the last call of next() found a stored evaluation.
  bool knew_last() const { return knew_last_; }
  /// Returns the number of stored evaluations that next() has found so far.
  int n_known() const { return n_known_; }

 private:
  std::optional<Evaluation> read(std::int64_t& end) const;
  void drop_rest();

  std::string path_;
  int file_ = -1;
  std::int64_t end_ = 0;  // end of the records that were read or written [bytes]
  bool reading_ = true, knew_last_ = false;
  int n_known_ = 0;
  Work work_after_;
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
};

/// A problem that takes evaluations from a log as long as the log has them; it evaluates the other
/// designs itself and appends them to the log.
class RecordedProblem final : public Problem {
 public:
  /// Wraps a problem; `problem`, `log` and `counter` must outlive the new object.
  /// @param counter  work that the log keeps; null: none
  RecordedProblem(Problem& problem, EvaluationLog& log, WorkCounter* counter = nullptr)
      : problem_(problem), log_(log), counter_(counter) {}

  int n_variables() const override { return problem_.n_variables(); }
  int n_constraints() const override { return problem_.n_constraints(); }
  VectorXd lower() const override { return problem_.lower(); }
  VectorXd upper() const override { return problem_.upper(); }
  VectorXd start() const override { return problem_.start(); }
  ProblemValues evaluate(const VectorXd& x) override;
  bool acceptable(const VectorXd& x) override;
  bool has_curvature() const override { return problem_.has_curvature(); }
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) override {
    return problem_.curvature(x, sigma, lambda);
  }

 private:
  Problem& problem_;
  EvaluationLog& log_;
  WorkCounter* counter_;
  bool acceptable_ = true;  // result for the design that was evaluated last
};

}  // namespace flexmorph::optim
