#include "cases/scene/elements/row.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kPosition =
    io::key("joint", "position")
        .numbers(io::any_number("a position", "m"), 2, 2)
        .otherwise_as("[X, 0], with the material coordinate X of the line at the start")
        .when("`type = \"sleeve\"`")
        .description("Position of the sleeve.");
const io::Key& kAngle = io::key("joint", "angle")
                            .number(io::any_number("an angle", "rad"))
                            .otherwise(0.0)
                            .when("`type = \"sleeve\"`")
                            .description("Angle of the sleeve.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& body = read_jointed_body(t, scene, joint);
  read_framed_edge(t, body, {"root"}, joint);
  if (!body.row->lines) t.fail(joint_keys::kBody, "a sleeve holds plates only, not beams");
  const double line = body.start_lines(0, body.elements[0])[static_cast<size_t>(joint.line)];
  joint.position = read_pair(t, kPosition, Vec2(line, 0));
  joint.angle = t.number(kAngle);
  joint.mode = read_mode(t, fem::WeldMode::direction);
  if (body.flow)
    t.fail(joint_keys::kBody,
           "a body with material flow is held by a \"weld\" to a hub or a rigid body, not by a "
           "sleeve");
  check_frame(t, scene, body, joint);
}

}  // namespace

extern const JointRow kSleeve;
const JointRow kSleeve = {
    .name = "sleeve",
    .sentence =
        "Holds an edge or a free line in a fixed frame; material slides through a free line.",
    .read = read};

}  // namespace flexmorph::cases
