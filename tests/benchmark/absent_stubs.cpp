// Stands in place of fem/terms/free_work.cpp where absent_cost.sh leaves free material lines out:
// every body asks once whether it has some.
#include "fem/terms/free_work.h"

namespace flexmorph::fem {

void FreeTables::prepare(const Element& element, int, Tabulate, const Factors&) {
  if (element.n_scalars() > 0) throw Error::input("built without free material lines");
}

}  // namespace flexmorph::fem
