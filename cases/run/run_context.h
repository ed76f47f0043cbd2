#pragma once

#include "cases/output/run_folder.h"
#include "cases/run/progress.h"
#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// What all parts of a run share.
struct RunContext {
  const Scene& scene;
  RunFolder& folder;
  Progress& progress;
  std::function<bool()> go_on;  ///< asked at every step and iteration; false interrupts the run
  int threads = 1;
  bool condition = false;  ///< whether conditions of matrices are estimated at the end
  bool resume = false;     ///< whether the run resumes what is in its folder
};

}  // namespace flexmorph::cases
