#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flexmorph::fem {

/// A long computation that is independent of all others: for example a motion with a model, a work
/// space and files of its own.
struct Job {
  /// Name with which the messages of its errors begin, e.g. "the motion of uniform material".
  std::string name;
  /// Approximate cost of the job, in the same arbitrary unit for all jobs of a list.
  double cost = 1;
  /// Function that does the computation. Its argument keep_running is a cancellation callback: it
  /// returns false if a job before this one in the list has failed, and the function should then
  /// end early.
  std::function<void(const std::function<bool()>& keep_running)> run;
};

/// Runs jobs. A single thread runs them in the order of the list; several threads run up to
/// `threads` jobs at a time, the most expensive first, each with one OpenMP thread.
///
/// If a job throws, the jobs before it in the list run to their end, and the jobs after it are
/// cancelled (by keep_running(), or they are never started). Therefore all jobs up to the first one
/// that fails have done exactly what they would have done one after the other.
/// @throws the exception of the first job in the list that failed; the message of an Error begins
///         with the name of the job.
void side_by_side(int threads, const std::vector<Job>& jobs);

}  // namespace flexmorph::fem
