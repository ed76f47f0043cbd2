#pragma once

#include "fem/heat.h"
#include "io/case_files/key.h"

/// Keys of [body.heat].
namespace flexmorph::cases::heat_keys {

extern const io::Key &kExpansion, &kRise, &kProfile, &kStart, &kDuration, &kForce;
extern const io::Choice<fem::ThermalVolume> kVolume;

}  // namespace flexmorph::cases::heat_keys
