#include "cases/results/limit_points.h"

namespace flexmorph::cases {

std::vector<double> limit_loads(std::span<const double> arc, std::span<const double> factor) {
  std::vector<double> out;
  for (size_t i = 1; i + 1 < factor.size(); ++i) {
    const double h0 = arc[i] - arc[i - 1], h1 = arc[i + 1] - arc[i];
    const double slope0 = (factor[i] - factor[i - 1]) / h0,
                 slope1 = (factor[i + 1] - factor[i]) / h1;
    if (!(slope0 * slope1 < 0)) continue;
    // Parabola f + s x + c x^2 about the middle equilibrium; its extremum is at x = -s / (2 c).
    const double c = (slope1 - slope0) / (h0 + h1), s = (slope0 * h1 + slope1 * h0) / (h0 + h1);
    out.push_back(factor[i] - s * s / (4 * c));
  }
  return out;
}

}  // namespace flexmorph::cases
