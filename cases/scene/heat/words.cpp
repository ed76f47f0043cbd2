#include "cases/scene/heat/heat.h"
#include "cases/scene/heat/keys.h"
#include "io/files.h"

namespace flexmorph::cases {

namespace heat_keys {

const io::Key& kExpansion = io::key("body.heat", "expansion")
                                .number(io::any_number("a coefficient of expansion", "1/K"))
                                .says("Strain of the free body per kelvin.");
const io::Key& kRise = io::key("body.heat", "rise")
                           .number(io::any_number("a rise of the temperature", "K"))
                           .name_of("a drive")
                           .says("How much warmer it gets, or the drive of that.");
const io::Choice<fem::ThermalVolume> kVolume(
    io::key("body.heat", "volume")
        .otherwise("grown")
        .says("What the elastic energy is integrated over: grown, in the plane only, or cold."),
    "a thermal volume",
    {{"grown", fem::ThermalVolume::grown},
     {"grown_plane", fem::ThermalVolume::grown_plane},
     {"reference", fem::ThermalVolume::reference}});
const io::Key& kProfile = io::key("body.heat", "profile")
                              .word("a profile", {"quartic", "cosine", "quintic", "linear", "step"})
                              .otherwise("quartic")
                              .when("`rise` is a number, in a motion")
                              .says("How the temperature goes with time.");
const io::Key& kStart = io::key("body.heat", "start")
                            .number(io::not_negative("the start of a rise", "s"))
                            .otherwise(0.0)
                            .when("`rise` is a number, in a motion")
                            .says("When it begins to rise.");
const io::Key& kSettle = io::key("body.heat", "settle")
                             .number(io::positive("how long a rise takes", "s"))
                             .otherwise_as("of a `step` it does not matter")
                             .when("`rise` is a number, in a motion")
                             .says("How long it takes.");
const io::Key& kForce = io::key("body.heat", "force")
                            .boolean()
                            .otherwise_as("true of beams that move in the plane, else false")
                            .says("The thermal inertia force Q_tk acts.");

}  // namespace heat_keys

std::string volume_name(fem::ThermalVolume volume) { return heat_keys::kVolume.word_of(volume); }

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
