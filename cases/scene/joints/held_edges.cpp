#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

/// Joints that hold edges of plates in space at their locations in the undeformed plate.
namespace flexmorph::cases {
namespace {

const io::Key& kEdges = io::key("joint", "edges")
                            .words("an edge", edge_names)
                            .when("`type` is \"clamp\", \"support\" or \"symmetry\"")
                            .description("Edges of the plate in space that the joint holds.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& body = read_jointed_body(t, scene, joint);
  if (!body.in_space())
    t.fail(joint_keys::kType,
           "this joint holds edges of plates in space; bodies in the plane are welded to hubs");
  joint.edges = t.choices(kEdges);
}

void check(const io::Table& t, const Scene& scene, const Joint& joint) {
  const Body& body = scene.body(joint.body);
  if (body.flow) t.fail(joint_keys::kBody, "the edges of a body with material flow cannot be held");
  if (body.mesh_changes())
    t.fail(joint_keys::kBody,
           "the edges of a body whose lines of nodes are inserted and removed cannot be held");
}

void read_held(const io::Table& t, const Scene& scene, Joint& joint) {
  read(t, scene, joint);
  check(t, scene, joint);
}

void read_clamp(const io::Table& t, const Scene& scene, Joint& joint) {
  read(t, scene, joint);
  joint.mode = read_mode(t, fem::WeldMode::edge);
  check(t, scene, joint);
}

}  // namespace

extern const JointRow kClamp, kSupport, kSymmetry;

const JointRow kClamp = {
    .name = "clamp",
    .sentence = "Holds the position and the slope of edges of a plate in space.",
    .read = read_clamp,
    .held = [](const Joint& j, const std::string& e) { return fem::clamped_edge(e, j.mode); }};

const JointRow kSupport = {
    .name = "support",
    .sentence =
        "Holds edges of a plate in space in its undeformed plane; they can rotate and slide.",
    .read = read_held,
    .held = [](const Joint&, const std::string& e) { return fem::supported_edge(e); }};

const JointRow kSymmetry = {
    .name = "symmetry",
    .sentence = "Makes the plane through an edge, normal to the plate, a plane of symmetry.",
    .read = read_held,
    .held = [](const Joint&, const std::string& e) { return fem::symmetry_edge(e); }};

}  // namespace flexmorph::cases
