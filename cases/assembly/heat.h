#pragma once

#include "cases/assembly/build.h"

namespace flexmorph::cases {

/// Adds the temperatures of heated bodies to a mechanism, with thermal forces where they act, and
/// makes steps end at discontinuities of prescribed temperatures.
void add_heat(const Scene& scene, Mechanism& mechanism);

}  // namespace flexmorph::cases
