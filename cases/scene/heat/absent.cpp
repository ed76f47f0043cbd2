#include "cases/scene/heat/heat.h"

namespace flexmorph::cases {

BodyHeat read_heat(const io::Table& t, const Scene&, const Body&) {
  t.fail("this flexmorph was built without heat: FLEXMORPH_HEAT=ON builds it");
}

}  // namespace flexmorph::cases
