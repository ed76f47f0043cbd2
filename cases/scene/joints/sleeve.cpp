#include "cases/scene/elements/row.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kPosition = io::key("joint", "position")
                               .numbers(io::any_number("a position", "m"), 2, 2)
                               .otherwise_as("the line's own place")
                               .when("sleeve")
                               .says("Where the sleeve is.");
const io::Key& kAngle = io::key("joint", "angle")
                            .number(io::any_number("an angle", "rad"))
                            .otherwise(0.0)
                            .when("sleeve")
                            .says("How the sleeve is turned.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& body = read_jointed_body(t, scene, joint);
  read_framed_edge(t, body, {"root"}, joint);
  if (!body.row->lines)
    t.fail(joint_keys::kBody, "material slides through the sleeves of plates only");
  const double line = body.start_lines(0, body.elements[0])[static_cast<size_t>(joint.line)];
  joint.position = read_pair(t, kPosition, Vec2(line, 0));
  joint.angle = t.number(kAngle);
  joint.mode = read_mode(t, fem::WeldMode::direction);
  if (body.flow)
    t.fail(joint_keys::kBody, "material flows out of a hub, see \"weld\", not out of a sleeve");
  check_frame(t, scene, body, joint);
}

}  // namespace

extern const JointRow kSleeve;
const JointRow kSleeve = {.name = "sleeve",
                          .sentence =
                              "An edge or a free line in a frame at rest: material slides "
                              "through the line.",
                          .read = read};

}  // namespace flexmorph::cases
