#pragma once

#include <optional>
#include <string>

#include "geometry/base.h"

namespace flexmorph::cases {

/// The state of a run when it failed: phase, body, time, iteration, and the cause.
struct Failure {
  std::string phase;  ///< Phase: "motion", "design", "verification ..."; empty means unknown.
  std::string body;   ///< Name of the body that was being designed.
  std::optional<double> time;           ///< Last time that the motion reached [s].
  std::optional<double> load_factor;    ///< Last load factor that the path reached [-].
  std::optional<int> step;              ///< Number of steps or equilibria before the failure.
  std::optional<int> cycle, iteration;  ///< Cycle and iteration of the design.
  std::string kind;                     ///< Kind of the error: "input", "numerical", "defect"; or
                                        ///< "limit" if the run reached its limit of CPU time.
  std::optional<double> seconds_limit;  ///< The limit of CPU time that was reached [s].
  std::string cause;                    ///< Message of the error.
};

/// An error that contains the state of the run when it failed.
class FailedRun : public Error {
 public:
  /// Creates the error with the kind and the message of another one.
  FailedRun(const Error& error, Failure where)
      : Error(error.kind(), error.what()), where_(std::move(where)) {}
  /// Returns the state of the run when it failed.
  const Failure& where() const { return where_; }

 private:
  Failure where_;
};

/// Describes an exception and the state of the run in which it occurred.
/// @param here  state of the run, for exceptions that do not contain it
Failure failure_of(const std::exception& error, const Failure& here);

}  // namespace flexmorph::cases
