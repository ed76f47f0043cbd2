#pragma once

#include <string>

#include "cases/scene/scene.h"

/// The temperature rise of a body: [body.heat].
namespace flexmorph::cases {

/// Reads the table [body.heat]; the other keys of the body must be read before.
/// @throws Error (input) located in the file.
BodyHeat read_heat(const io::Table& t, const Scene& scene, const Body& body);

/// Returns the name of a thermal volume in cases: "grown", "grown_plane" or "reference".
std::string volume_name(fem::ThermalVolume volume);

/// Returns a temperature rise as text, such as "step of the temperature by 50 K at 1 s".
std::string temperature_text(const BodyHeat& heat);

}  // namespace flexmorph::cases
