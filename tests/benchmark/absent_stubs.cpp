// Replaces fem/terms/eulerian_work.cpp in the build of absent_cost.sh without free material lines:
// every body is checked once for such lines.
#include "fem/terms/eulerian_work.h"

namespace flexmorph::fem {

void EulerianTables::prepare(const Element& element, int, Tabulate, const ScaleFactors&) {
  if (element.n_scalars() > 0) throw Error::input("built without free material lines");
}

}  // namespace flexmorph::fem
