#pragma once

#include <algorithm>
#include <vector>

#include "geometry/cpu_time.h"
#include "optim/mmc/problem/mmc_problem.h"
#include "optim/optimizer.h"

/// Measurement of the parts of a design iteration.
namespace flexmorph::benchmark {

/// Median CPU times of an iteration and of its parts [ms].
struct Iteration {
  double tdf = 0, factor = 0, solve = 0, sensitivity = 0, optimizer = 0, total = 0;
  int right_hand_sides = 0;
};

/// Measures iterations of MMA with one evaluation each, without the first two.
inline Iteration measure_iterations(mmc::MmcProblem& problem, const optim::Settings& settings,
                                    int right_hand_sides) {
  std::vector<double> parts[6];
  double mark = cpu_seconds();
  int evaluations = 0;
  optim::make_optimizer(settings)->minimize(problem, [&](const optim::Iterate& iterate) {
    const double now = cpu_seconds();
    if (iterate.evaluations == evaluations + 1 && iterate.iteration > 2) {
      const mmc::ComplianceEvaluator::Seconds s = problem.seconds();
      const double seconds[] = {problem.seconds_tdf(), s.factor,        s.solve,
                                s.sensitivity,         iterate.seconds, now - mark};
      for (int k = 0; k < 6; ++k) parts[k].push_back(seconds[k]);
    }
    problem.clear_seconds();
    evaluations = iterate.evaluations;
    mark = cpu_seconds();
    return true;
  });
  const auto median = [&](int k) {
    std::vector<double>& values = parts[k];
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return 1e3 * *middle;
  };
  return {median(0), median(1), median(2), median(3), median(4), median(5), right_hand_sides};
}

}  // namespace flexmorph::benchmark
