#include "cases/assembly/heat.h"

namespace flexmorph::cases {

void add_heat(const Scene&, Mechanism&) {}

}  // namespace flexmorph::cases
