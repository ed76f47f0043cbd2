#include "optim/moving_box.h"

#include <algorithm>

namespace flexmorph::optim {
namespace {

constexpr int kMaxUnimprovedRuns = 14;  // in sequence; the box is then about 1e-4 of the first one

}  // namespace

void search_in_boxes(Search& search, double box, const BoxRun& run) {
  if (box == 0) {
    // A library may end too early because its curvature estimates have diverged; a new run helps.
    while (!search.stopped()) {
      const Point start = search.best();
      const std::string why = run(start, search.lower(), search.upper());
      if (search.best().x == start.x) search.stop(Stop::stalled, why);
    }
    return;
  }
  double size = box;
  int unimproved_runs = 0;
  while (!search.stopped()) {
    const Point centre = search.best();
    const VectorXd lower = (centre.x.array() - size).matrix().cwiseMax(search.lower());
    const VectorXd upper = (centre.x.array() + size).matrix().cwiseMin(search.upper());
    const std::string why = run(centre, lower, upper);
    const double moved = (search.best().x - centre.x).lpNorm<Eigen::Infinity>();
    if (moved == 0) {
      size *= 0.5;
      if (++unimproved_runs >= kMaxUnimprovedRuns) {
        search.stop(Stop::stalled,
                    std::to_string(unimproved_runs) +
                        " boxes in a row contained no better design; the last run: " + why);
      }
    } else {
      unimproved_runs = 0;
      if (moved > 0.99 * size) size = std::min(box, 2 * size);
    }
  }
}

}  // namespace flexmorph::optim
