#include "cases/assembly/stored.h"

namespace flexmorph::cases {
namespace {

fem::StoredMaterial stored_of(const Scene& scene, const Body& body, const Anchor& outlet) {
  const Flow& flow = *body.flow;
  const double total = body.stored_at_start(scene.time.end) + body.length;
  const auto stored = [length = body.length, speed = flow.speed, motion = flow.motion,
                       total](double t) {
    const fem::Motion x = motion ? motion(t) : fem::Motion{length + speed * t, speed, 0};
    return fem::Motion{total - x.value, -x.rate, -x.acceleration};
  };
  using Kind = fem::StoredMaterial::Kind;
  return {.kind = flow.stored == Stored::rod ? Kind::rod : Kind::coil,
          .outlet = outlet.point,
          .angle = outlet.angle,
          .at = flow.stored_at.value_or(outlet.point),
          .width = body.width,
          .area_density = body.density * body.thickness,
          .length = stored};
}

/// Calls use(joint, body) for every plate with a material reservoir in a rigid body.
template <class Use>
void each_stored(const Scene& scene, const Use& use) {
  for (const Joint& joint : scene.joints) {
    if (!joint.on_rigid_body() || joint.edge != "root") continue;
    const Body& body = scene.body(joint.body);
    if (body.flow && body.flow->stored != Stored::none) use(joint, body);
  }
}

}  // namespace

std::vector<fem::StoredMaterial> stored_in(const Scene& scene, const std::string& rigid_body) {
  std::vector<fem::StoredMaterial> out;
  each_stored(scene, [&](const Joint& joint, const Body& body) {
    if (joint.b.body == rigid_body) out.push_back(stored_of(scene, body, joint.b));
  });
  return out;
}

void add_outlets(const Scene& scene, fem::Model& model) {
  each_stored(scene, [&](const Joint& joint, const Body& body) {
    model.add_link(fem::make_outlet("outlet of " + body.name, joint.b.body, body.name,
                                    stored_of(scene, body, joint.b)));
  });
}

}  // namespace flexmorph::cases
