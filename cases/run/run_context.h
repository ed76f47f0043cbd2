#pragma once

#include "cases/assembly/prepared_case.h"
#include "cases/output/run_folder.h"
#include "cases/run/progress.h"

namespace flexmorph::cases {

/// What all parts of a run share.
struct RunContext {
  const PreparedCase& prepared;
  RunFolder* folder;  ///< receives all files; null: no file is written
  Progress& progress;
  std::function<bool()> go_on;  ///< asked at every step and iteration; false interrupts the run
  int threads = 1;
  bool condition = false;  ///< whether conditions of matrices are estimated at the end
  bool resume = false;     ///< whether the run resumes what is in its folder
  bool uniform = true;     ///< whether motions with uniform material are computed
  /// Told every design iteration, after it is written.
  std::function<void(const mmc::IterationReport&)> iteration{};

  const Scene& scene() const { return prepared.scene(); }
};

}  // namespace flexmorph::cases
