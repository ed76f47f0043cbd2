#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kPoint = io::key("joint", "point")
                            .numbers(io::any_number("a material coordinate", "m"), 2, 2)
                            .when("`type = \"pin\"`")
                            .description("Material point that the pin holds.");
const io::Key& kComponents = io::key("joint", "components")
                                 .words("a component", {"x", "y", "z"})
                                 .otherwise_as("all components")
                                 .when("`type = \"pin\"`")
                                 .description("Components of the position that the pin holds.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const std::vector<std::string> all = {"x", "y", "z"};
  const Body& body = read_jointed_body(t, scene, joint);
  joint.point = read_point(t, kPoint, body, scene.time.end);
  const auto axes = std::span(all).first(static_cast<size_t>(body.dim()));
  if (t.has(kComponents))
    for (const std::string& axis : t.choices(kComponents, axes))
      joint.components.push_back(axis[0] - 'x');
  else
    for (int c = 0; c < body.dim(); ++c) joint.components.push_back(c);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  const Vec3 at = parts.start(joint.point);
  std::vector<fem::Motion> rest;
  for (const int c : joint.components) rest.push_back({at[c], 0, 0});
  const auto stay = [rest](double) { return rest; };
  return parts.rigid ? fem::make_point_drive(joint.name, parts.location(joint.point), stay,
                                             joint.components)
                     : fem::make_pin(joint.name, joint.body, joint.point, stay, joint.components);
}

}  // namespace

extern const JointRow kPin;
const JointRow kPin = {.name = "pin",
                       .sentence = "Holds components of the position of a material point.",
                       .read = read,
                       .make = make,
                       .holds_point = true};

}  // namespace flexmorph::cases
