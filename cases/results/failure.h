#pragma once

#include <optional>
#include <string>

#include "geometry/base.h"

namespace flexmorph::cases {

/// Says where a run was when it failed.
struct Failure {
  std::string phase;                    ///< "motion", "design", "verification ..."; empty: unknown
  std::string body;                     ///< that was designed
  std::optional<double> time;           ///< last one that was reached [s]
  std::optional<double> load_factor;    ///< of a path of equilibria, likewise
  std::optional<int> step;              ///< number of steps or equilibria until there
  std::optional<int> cycle, iteration;  ///< of the design
  std::string kind;                     ///< "input", "numerical", "defect"
  std::string cause;                    ///< the message
};

/// An error that says where the run was.
class FailedRun : public Error {
 public:
  FailedRun(const Error& error, Failure where)
      : Error(error.kind(), error.what()), where_(std::move(where)) {}
  const Failure& where() const { return where_; }

 private:
  Failure where_;
};

/// Describes an exception.
/// @param here  where the run is, for exceptions that do not know
Failure failure_of(const std::exception& error, const Failure& here);

}  // namespace flexmorph::cases
