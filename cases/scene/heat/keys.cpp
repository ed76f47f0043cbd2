#include "cases/scene/heat/keys.h"

#include "cases/scene/heat/heat.h"
#include "io/files.h"

namespace flexmorph::cases {

namespace heat_keys {

const io::Key& kExpansion = io::key("body.heat", "expansion")
                                .number(io::any_number("a coefficient of expansion", "1/K"))
                                .otherwise_as("that of `material`; required without it")
                                .description("Coefficient of thermal expansion.");
const io::Key& kRise = io::key("body.heat", "rise")
                           .number(io::any_number("a temperature rise", "K"))
                           .name_of("a drive")
                           .description(
                               "Final temperature rise above the unstressed state, or the drive of "
                               "the temperature rise.");
const io::Choice<fem::ThermalVolume> kVolume(
    io::key("body.heat", "volume")
        .otherwise("grown")
        .description(
            "Volume of the elastic energy: expanded, expanded in the plane only, or unexpanded."),
    "a thermal volume",
    {{"grown", fem::ThermalVolume::grown},
     {"grown_plane", fem::ThermalVolume::grown_plane},
     {"reference", fem::ThermalVolume::reference}});
const io::Key& kProfile = io::key("body.heat", "profile")
                              .word("a profile", {"quartic", "cosine", "quintic", "linear", "step"})
                              .otherwise("quartic")
                              .when("`rise` is a number, and the case is a motion")
                              .description("Time profile of the temperature rise.");
const io::Key& kStart = io::key("body.heat", "start")
                            .number(io::not_negative("the start of a rise", "s"))
                            .otherwise(0.0)
                            .when("`rise` is a number, and the case is a motion")
                            .description("Time at which the temperature rise begins.");
const io::Key& kDuration = io::key("body.heat", "duration")
                               .formerly("settle")
                               .number(io::positive("the duration of a rise", "s"))
                               .otherwise_as("required, except for `profile = \"step\"`")
                               .when("`rise` is a number, and the case is a motion")
                               .description("Duration of the temperature rise.");
const io::Key& kForce =
    io::key("body.heat", "force")
        .boolean()
        .otherwise_as("true for beams that move in the plane, else false")
        .description("True if the thermal inertia force Q_tk acts on the body.");

}  // namespace heat_keys

std::string volume_name(fem::ThermalVolume volume) { return heat_keys::kVolume.word_of(volume); }

std::string temperature_text(const BodyHeat& heat) {
  if (!heat.rise.drive.empty()) return "temperature rise by drive '" + heat.rise.drive + "'";
  const std::string rise = io::to_text(heat.rise.value, 6) + " K";
  if (heat.profile.empty()) return "uniform temperature rise of " + rise;
  const std::string at = " at " + io::to_text(heat.start, 6) + " s";
  if (heat.profile == "step") return "step of the temperature by " + rise + at;
  return heat.profile + " rise of the temperature by " + rise + " in " +
         io::to_text(heat.duration, 6) + " s, from " + io::to_text(heat.start, 6) + " s on";
}

}  // namespace flexmorph::cases
