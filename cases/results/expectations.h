#pragma once

#include <string>
#include <vector>

#include "cases/output/report.h"

/// `[expect]` of a case against what its run came to.
namespace flexmorph::cases {

/// One expectation and what was found.
struct Expected {
  std::string name;
  std::optional<double> found;  ///< absent where the run did not get that far
  bool holds = false;
  std::string words;  ///< "volume = 0.52: expected at most 0.5001"
};

/// In the order of the names.
std::vector<Expected> judge_expectations(const Scene& scene, const RunReport& report);

/// @throws Error (input), with place and the names there are, for an expectation of a name that no
///         run of the scene can have.
void check_expectations(const Scene& scene);

}  // namespace flexmorph::cases
