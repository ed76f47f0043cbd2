#include "cases/assembly/reservoir.h"

namespace flexmorph::cases {
namespace {

fem::MaterialReservoir reservoirs_of(const Scene& scene, const Body& body, const Anchor& outlet) {
  const Flow& flow = *body.flow;
  const double total = body.reservoir_at_start(scene.time.end) + body.length;
  const auto stored = [length = body.length, speed = flow.speed, motion = flow.motion,
                       total](double t) {
    const fem::Motion x = motion ? motion(t) : fem::Motion{length + speed * t, speed, 0};
    return fem::Motion{total - x.value, -x.rate, -x.acceleration};
  };
  using Kind = fem::MaterialReservoir::Kind;
  return {.kind = flow.reservoir == Reservoir::rod ? Kind::rod : Kind::coil,
          .outlet = outlet.point,
          .angle = outlet.angle,
          .at = flow.reservoir_at.value_or(outlet.point),
          .width = body.width,
          .area_density = body.density * body.thickness,
          .length = stored};
}

/// Calls use(joint, body) for every plate with a material reservoir in a rigid body.
template <class Use>
void each_reservoir(const Scene& scene, const Use& use) {
  for (const Joint& joint : scene.joints) {
    if (!joint.on_rigid_body() || joint.edge != "root") continue;
    const Body& body = scene.body(joint.body);
    if (body.flow && body.flow->reservoir != Reservoir::none) use(joint, body);
  }
}

}  // namespace

std::vector<fem::MaterialReservoir> reservoirs_in(const Scene& scene,
                                                  const std::string& rigid_body) {
  std::vector<fem::MaterialReservoir> out;
  each_reservoir(scene, [&](const Joint& joint, const Body& body) {
    if (joint.b.body == rigid_body) out.push_back(reservoirs_of(scene, body, joint.b));
  });
  return out;
}

void add_outlets(const Scene& scene, fem::Model& model) {
  each_reservoir(scene, [&](const Joint& joint, const Body& body) {
    model.add_force_element(fem::make_outlet("outlet of " + body.name, joint.b.body, body.name,
                                             reservoirs_of(scene, body, joint.b)));
  });
}

}  // namespace flexmorph::cases
