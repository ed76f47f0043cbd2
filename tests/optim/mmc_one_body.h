#pragma once

#include "tests/optim/mmc_small.h"

namespace flexmorph::mmc::test {

/// Returns settings without erosion, because ten cells across are too few to remove half a cell all
/// around.
inline TdfSettings whole(double band) {
  TdfSettings settings = tdf_settings(band);
  settings.erosion = 0;
  return settings;
}

inline std::vector<BodyProblem> one_body(std::vector<double> bands = {2, 1}) {
  std::vector<TdfSettings> settings;
  for (const double band : bands) settings.push_back(whole(band));
  return {body_of(Design(kGrid, layout(), kScale), settings)};
}

inline LoopSettings quick(int iterations) {
  LoopSettings settings;
  settings.design.crisp_every = 7;
  settings.design.optimizer.max_iterations = iterations;
  return settings;
}

}  // namespace flexmorph::mmc::test
