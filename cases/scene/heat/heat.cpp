#include "cases/scene/heat/heat.h"

#include "cases/scene/elements/row.h"
#include "cases/scene/heat/keys.h"
#include "cases/scene/materials/material.h"
#include "cases/scene/read.h"

namespace flexmorph::cases {
namespace {

using namespace heat_keys;
using io::Key;
using io::Table;

/// Reads the time profile of the temperature rise.
void read_course(const Table& t, const Scene& scene, BodyHeat& heat) {
  const bool driven = !heat.rise.drive.empty();
  if (scene.statics || driven) {
    for (const Key* key : {&kProfile, &kStart, &kDuration})
      if (t.has(*key))
        t.fail(*key, driven ? "the drive of `rise` determines the temperature over time"
                            : "in a [static] analysis a temperature rise is constant or "
                              "proportional to the load factor, see static.grows");
    return;
  }
  heat.profile = t.choice(kProfile);
  heat.start = t.number(kStart);
  heat.duration =
      t.number(kDuration, heat.profile == "step" ? std::optional<double>(1) : std::nullopt);
}

void read_force(const Table& t, const Scene& scene, const Body& body, BodyHeat& heat) {
  const std::string why = scene.statics     ? "a [static] analysis has no thermal inertia force"
                          : body.in_space() ? "the thermal force needs a body in the plane"
                          : body.flow       ? "the thermal force cannot be used with material flow"
                          : body.has_eulerian_lines()
                              ? "the thermal force cannot be used with free material lines"
                              : "";
  heat.force = t.boolean(kForce, why.empty() && body.row->thermal_force);
  if (heat.force && !why.empty()) t.fail(kForce, why);
}

}  // namespace

BodyHeat read_heat(const Table& t, const Scene& scene, const Body& body) {
  BodyHeat heat;
  heat.expansion = t.number(kExpansion, body.material ? body.material->expansion : std::nullopt);
  heat.rise = read_law(t, kRise, scene);
  if (scene.follows_trajectory(heat.rise))
    t.fail(kRise, "the drive of a temperature cannot have from = \"trajectory\"");
  heat.volume = t.choice(kVolume);
  read_course(t, scene, heat);
  read_force(t, scene, body, heat);
  if (!body.has_term([](const fem::TermRow& row) { return row.elastic != nullptr; }))
    t.fail("a heated body needs an elastic term in `terms`");
  const std::array<double, 2> range =
      heat.rise.drive.empty()
          ? std::array{std::min(0.0, heat.rise.value), std::max(0.0, heat.rise.value)}
          : range_of(scene.motion_of(heat.rise), scene.time.end);
  for (const double rise : range)
    if (1 + heat.expansion * rise <= 0)
      t.fail(kRise, "1 + expansion * rise, the stretch of the free body, is positive");
  return heat;
}

}  // namespace flexmorph::cases
