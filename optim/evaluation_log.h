#pragma once

#include <chrono>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "optim/problem.h"

namespace flexmorph::optim {

/// What a problem answered at a design.
struct Evaluation {
  VectorXd x;           ///< (n)
  std::string failure;  ///< why the state could not be solved; empty: it was, and
  Response response;    ///< is what it came to
  bool acceptable = true;
};

/// Evaluations in the order in which an optimizer asked for them, in a file that outlives the
/// process. Optimizers are deterministic: started again from the same design they ask the same
/// questions, and where the answers are known no state is solved. So a run goes on bit for bit
/// where it was killed, whatever the optimizer keeps in mind.
///
/// It is a memory, no authority: an answer counts for the very x it was given at. Where another x
/// is asked for, what follows in the file belongs to another run and is dropped.
///
/// File: a line that says what it is, then records [bytes, CRC-32, data] in the byte order of the
/// machine. A record that is torn or damaged ends it.
class EvaluationLog {
 public:
  /// Opens the file, or makes it.
  /// @throws Error (numerical) when it cannot be written; append() likewise.
  explicit EvaluationLog(std::string path);
  ~EvaluationLog();
  EvaluationLog(const EvaluationLog&) = delete;
  EvaluationLog& operator=(const EvaluationLog&) = delete;

  /// The next answer where it was given at this x; else none, and no more to come.
  std::optional<Evaluation> next(const VectorXd& x);
  void append(const Evaluation& evaluation);

  bool knew_last() const { return knew_last_; }  ///< did the last next() find an answer?
  int n_known() const { return n_known_; }       ///< answers that were found so far

 private:
  void drop_rest();

  std::string path_;
  int file_ = -1;
  std::int64_t end_ = 0;  // of what was read or written
  bool reading_ = true, knew_last_ = false;
  int n_known_ = 0;
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
};

/// A problem whose answers are taken from a log as far as it knows them, and written there.
class RecordedProblem final : public Problem {
 public:
  RecordedProblem(Problem& problem, EvaluationLog& log) : problem_(problem), log_(log) {}

  int n_variables() const override { return problem_.n_variables(); }
  int n_constraints() const override { return problem_.n_constraints(); }
  VectorXd lower() const override { return problem_.lower(); }
  VectorXd upper() const override { return problem_.upper(); }
  VectorXd start() const override { return problem_.start(); }
  Response evaluate(const VectorXd& x) override;
  bool acceptable(const VectorXd& x) override;
  bool has_curvature() const override { return problem_.has_curvature(); }
  MatrixXd curvature(const VectorXd& x, double sigma, const VectorXd& lambda) override {
    return problem_.curvature(x, sigma, lambda);
  }

 private:
  Problem& problem_;
  EvaluationLog& log_;
  bool acceptable_ = true;  // the last design
};

}  // namespace flexmorph::optim
