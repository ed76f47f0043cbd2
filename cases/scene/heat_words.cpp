#include "cases/scene/heat.h"
#include "io/files.h"

namespace flexmorph::cases {

std::string volume_name(fem::ThermalVolume volume) {
  switch (volume) {
    case fem::ThermalVolume::reference:
      return "reference";
    case fem::ThermalVolume::grown_plane:
      return "grown_plane";
    case fem::ThermalVolume::grown:
      return "grown";
  }
  return "";
}

std::string temperature_words(const BodyHeat& heat) {
  if (!heat.rise.drive.empty()) return "temperature by drive '" + heat.rise.drive + "'";
  const std::string rise = io::to_text(heat.rise.value, 6) + " K";
  if (heat.profile.empty()) return "uniform temperature rise of " + rise;
  const std::string at = " at " + io::to_text(heat.start, 6) + " s";
  if (heat.profile == "step") return "step of the temperature by " + rise + at;
  return heat.profile + " rise of the temperature by " + rise + " in " +
         io::to_text(heat.settle, 6) + " s, from " + io::to_text(heat.start, 6) + " s on";
}

}  // namespace flexmorph::cases
