#include "cases/scene/elements/row.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

const io::Key& kTo = io::key("joint", "to")
                         .name_of("a hub or rigid body")
                         .when("weld of a body")
                         .says("What the edge is welded to.");
const io::Key& kPoint = io::key("joint", "point")
                            .numbers(io::any_number("a place", "m"), 2, 2)
                            .otherwise(std::vector<double>{0, 0})
                            .when("weld of a body to a rigid one")
                            .says("Where the middle of the edge is, in the axes of that body.");
const io::Key& kAngle = io::key("joint", "angle")
                            .number(io::any_number("an angle", "rad"))
                            .otherwise(0.0)
                            .when("weld of a body")
                            .says("Of the edge's normal, in the axes of the hub or rigid body.");

/// The frame on a rigid body that the edge is welded to.
void read_carrier(const io::Table& t, Joint& joint) {
  joint.b.body = joint.to;
  joint.b.point = read_pair(t, kPoint);
  joint.b.angle = t.number(kAngle);
}

/// An edge in a hub or on a rigid body; which also says where the body begins.
void read_welded_edge(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& body = read_jointed_body(t, scene, joint);
  const std::vector<std::string> rigid = names_of(scene.rigid_bodies);
  std::vector<std::string> carriers = names_of(scene.hubs);
  carriers.insert(carriers.end(), rigid.begin(), rigid.end());
  joint.to = t.choice(rigid.empty() ? kTo.called("a hub") : kTo, carriers);
  const bool on_rigid = std::find(rigid.begin(), rigid.end(), joint.to) != rigid.end();
  using Names = std::vector<std::string>;
  read_framed_edge(t, body, Names{"root", "free_end"}, joint);
  if (on_rigid)
    read_carrier(t, joint);
  else
    joint.angle = t.number(kAngle);
  joint.mode = body.row->read_weld(t);
  check_frame(t, scene, body, joint);
}

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  if (t.has(joint_keys::kBody)) {
    read_welded_edge(t, scene, joint);
    return;
  }
  read_anchors(t, scene, true, true, joint.a, joint.b);
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  return fem::make_rigid_weld(joint.name, parts.a, parts.b);
}

}  // namespace

extern const JointRow kWeld;
const JointRow kWeld = {
    .name = "weld",
    .sentence =
        "An edge sits in a hub or on a rigid body; or the axes of two rigid bodies are one.",
    .read = read,
    .make = make,
    .has_moment = true};

}  // namespace flexmorph::cases
