#pragma once

#include "optim/mmc/under_repair.h"

namespace flexmorph::mmc {

/// Idle material has less than a fifth of the mean strain energy per area. It goes where compliance
/// times volume falls by it: given back elsewhere, its volume is worth more.

/// Takes out idle components, the idlest first.
/// @return how many
int drop_idle(UnderRepair& design);

/// Takes idle ends off components, where that narrows no place.
/// @return how many
int cut_stubs(UnderRepair& design);

}  // namespace flexmorph::mmc
