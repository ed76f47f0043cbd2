#include "cases/assembly/heat.h"

#include "fem/thermal/heated.h"
#include "fem/thermal/temperature.h"
#include "fem/thermal/thermal_force.h"

namespace flexmorph::cases {
namespace {

fem::TemperatureRise rise_of(const BodyHeat& heat) {
  return {fem::profile_of(heat.profile), heat.rise.value, heat.start, heat.duration};
}

std::function<fem::Motion(double)> temperature_of(const Scene& scene, const BodyHeat& heat) {
  return heat.profile.empty() ? scene.motion_of(heat.rise) : fem::make_temperature(rise_of(heat));
}

}  // namespace

void add_heat(const Scene& scene, Mechanism& mechanism) {
  for (const Body& body : scene.bodies) {
    if (!body.heat) continue;
    const BodyHeat& heat = *body.heat;
    const fem::Heat hot{heat.expansion, temperature_of(scene, heat), heat.volume};
    for (fem::Body& built : mechanism.model.bodies())
      if (built.name == body.name) fem::heat(built, hot);
    const bool acts = heat.profile.empty() || fem::accelerates(rise_of(heat));
    if (heat.force && acts)
      mechanism.model.add_force_element(std::make_unique<fem::ThermalForce>(
          "thermal force of " + body.name, body.name, hot, body.density * body.thickness));
    if (!heat.profile.empty())
      for (const double t : fem::discontinuities(rise_of(heat)))
        if (t < scene.time.end) mechanism.motion.discontinuities.push_back(t);
  }
}

}  // namespace flexmorph::cases
