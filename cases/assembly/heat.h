#pragma once

#include "cases/assembly/build.h"

namespace flexmorph::cases {

/// Makes the hot bodies of a model hot, with their thermal forces where they act, and lets steps
/// land on the kinks of temperatures.
void add_heat(const Scene& scene, Mechanism& mechanism);

}  // namespace flexmorph::cases
