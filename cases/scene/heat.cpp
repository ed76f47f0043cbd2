#include "cases/scene/heat.h"

#include "cases/scene/read.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::not_negative;
using io::positive;
using io::Table;

const std::vector<std::string>& profile_names() {
  static const std::vector<std::string> kNames = {"quartic", "cosine", "quintic", "linear", "step"};
  return kNames;
}

/// How the temperature goes with time.
void read_course(const Table& t, const Scene& scene, BodyHeat& heat) {
  const bool driven = !heat.rise.drive.empty();
  if (scene.statics || driven) {
    for (const char* key : {"profile", "start", "settle"})
      if (t.has(key))
        t.fail(key, driven ? "the drive of `rise` says how the temperature goes"
                           : "in a [static] analysis a temperature is constant, or grows with the "
                             "load factor: static.grows");
    return;
  }
  heat.profile = t.choice("profile", "a profile", profile_names(), "quartic");
  heat.start = t.number("start", not_negative("the start of a rise", "s"), 0.0);
  heat.settle = t.number("settle", positive("how long a rise takes", "s"),
                         heat.profile == "step" ? std::optional<double>(1) : std::nullopt);
}

void read_force(const Table& t, const Scene& scene, const Body& body, BodyHeat& heat) {
  const std::string why = scene.statics           ? "nothing is in motion in a [static] analysis"
                          : body.in_space()       ? "the thermal force is for bodies in the plane"
                          : body.flow             ? "no thermal force where material flows"
                          : body.has_free_lines() ? "no thermal force with free material lines"
                                                  : "";
  heat.force = t.boolean("force", why.empty() && body.is_beam());
  if (heat.force && !why.empty()) t.fail("force", why);
}

}  // namespace

BodyHeat read_heat(const Table& t, const Scene& scene, const Body& body) {
  BodyHeat heat;
  heat.expansion = t.number("expansion", any_number("a coefficient of expansion", "1/K"));
  heat.rise = read_law(t, "rise", any_number("a rise of the temperature", "K"), scene);
  if (scene.follows_trajectory(heat.rise))
    t.fail("rise", "a temperature cannot follow from a trajectory");
  heat.volume = t.choice<fem::ThermalVolume>("volume", "a thermal volume",
                                             {{"grown", fem::ThermalVolume::grown},
                                              {"grown_plane", fem::ThermalVolume::grown_plane},
                                              {"reference", fem::ThermalVolume::reference}},
                                             fem::ThermalVolume::grown);
  read_course(t, scene, heat);
  read_force(t, scene, body, heat);
  if (!body.has_term([](const fem::TermRow& row) { return row.elastic != nullptr; }))
    t.fail("a hot body has an elastic term");
  const std::array<double, 2> range =
      heat.rise.drive.empty()
          ? std::array{std::min(0.0, heat.rise.value), std::max(0.0, heat.rise.value)}
          : range_of(scene.motion_of(heat.rise), scene.time.end);
  for (const double rise : range)
    if (1 + heat.expansion * rise <= 0)
      t.fail("rise", "1 + expansion * rise, the stretch of the free body, is positive");
  return heat;
}

}  // namespace flexmorph::cases
