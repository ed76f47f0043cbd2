#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"

/// Joints that hold edges of plates in space at their locations in the undeformed plate.
namespace flexmorph::cases {
namespace {

const io::Key& kEdges = io::key("joint", "edges")
                            .words("an edge", edge_names)
                            .when("clamp, support, symmetry")
                            .says("Edges of a plate in space.");

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& body = read_jointed_body(t, scene, joint);
  if (!body.in_space())
    t.fail(joint_keys::kType, "edges are held in space; bodies in the plane have hubs");
  joint.edges = t.choices(kEdges);
}

void check(const io::Table& t, const Scene& scene, const Joint& joint) {
  const Body& body = scene.body(joint.body);
  if (body.flow) t.fail(joint_keys::kBody, "material flows out of a hub: its edges are not held");
  if (body.mesh_changes())
    t.fail(joint_keys::kBody, "its lines of nodes come and go: edges are not held");
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
    .sentence = "Edges of a plate in space keep place and slope.",
    .read = read_clamp,
    .held = [](const Joint& j, const std::string& e) { return fem::clamped_edge(e, j.mode); }};

const JointRow kSupport = {
    .name = "support",
    .sentence = "Edges of a plate in space stay in its plane, free to turn and to slide.",
    .read = read_held,
    .held = [](const Joint&, const std::string& e) { return fem::supported_edge(e); }};

const JointRow kSymmetry = {
    .name = "symmetry",
    .sentence = "The plane through an edge, across the plate, is one of symmetry.",
    .read = read_held,
    .held = [](const Joint&, const std::string& e) { return fem::symmetry_edge(e); }};

}  // namespace flexmorph::cases
