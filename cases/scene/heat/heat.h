#pragma once

#include <string>

#include "cases/scene/scene.h"

/// [body.heat] as data.
namespace flexmorph::cases {

/// [body.heat]; the body's other keys are read.
/// @throws Error (input) located in the file.
BodyHeat read_heat(const io::Table& t, const Scene& scene, const Body& body);

/// "grown", "grown_plane" or "reference", as in a case.
std::string volume_name(fem::ThermalVolume volume);

/// "quartic rise of 50 K in 1 s".
std::string temperature_words(const BodyHeat& heat);

}  // namespace flexmorph::cases
