#include <cmath>

#include "cases/scene/body_keys.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"
#include "cases/scene/tables.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::Table;
using io::to_text;

Joint read_joint(const Table& t, const Scene& scene) {
  Joint joint;
  joint.row = find_joint(t.choice(joint_keys::kType));
  joint.row->read(t, scene, joint);
  return joint;
}

/// Throws if a body with held edges is also in a hub or a sleeve, because held edges keep the
/// locations of the undeformed body, which a hub or sleeve may turn or shift.
void check_held(const Table& t, const Joint& joint, const Scene& scene) {
  for (const Joint& other : scene.joints)
    if (joint.holds_edges() && other.body == joint.body && other.holds_frame())
      t.fail(joint_keys::kType, "'" + joint.body +
                                    "' is held in a hub, a sleeve or a rigid body, therefore its "
                                    "edges cannot be held by this joint");
}

/// Throws if no joint holds or drives a free line, because its material coordinate would be an
/// unknown without an equation.
void check_lines(const Table& t, const Body& body, const Scene& scene) {
  for (const BodyLine& line : body.lines) {
    if (!line.free) continue;
    const bool used = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
      return j.body == body.name && j.line == line.index && (j.holds_frame() || j.drives_line);
    });
    if (!used)
      t.fail("no joint holds the free line " + to_text(line.index) +
             ": the case needs a [[joint]] \"sleeve\" or \"weld\" with edge = \"line " +
             to_text(line.index) + "\", or a \"line_drive\"");
  }
}

/// Throws if a body with a material reservoir leaves a hub. Stored material acts on rigid bodies
/// only, because the motion of a hub is prescribed.
void check_reservoir(const Table& t, const Body& body, const Scene& scene) {
  if (!body.flow || body.flow->reservoir == Reservoir::none) return;
  for (const Joint& joint : scene.joints)
    if (joint.carries(body.name) && !joint.on_rigid_body())
      t.table(body_keys::kFlow)
          .fail(flow_keys::kReservoir, "material is stored in a rigid body, but '" + body.name +
                                           "' leaves the hub '" + joint.to +
                                           "', whose motion is prescribed");
}

}  // namespace

const io::Key& joint_keys::kType = io::key("joint", "type")
                                       .word("a joint",
                                             [] {
                                               io::Glossary rows;
                                               for (const JointRow* row : joint_rows())
                                                 rows.emplace_back(row->name, row->sentence);
                                               return rows;
                                             })
                                       .description("Kind of the joint.");

std::vector<Joint> read_joint_list(const Table& root, const Scene& scene) {
  Scene growing = scene;  // each joint is checked against the joints before it
  for (const Table& t : root.tables(tables::kJoint))
    growing.joints.push_back(read_joint(t, growing));
  return growing.joints;
}

void read_joints(const Table& root, Scene& scene) {
  const std::vector<Table> joints = root.tables(tables::kJoint),
                           bodies = root.tables(tables::kBody);
  scene.joints = read_joint_list(root, scene);
  for (size_t i = 0; i < joints.size(); ++i) check_held(joints[i], scene.joints[i], scene);
  for (size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(),
                                    [&](const Joint& j) { return j.carries(body.name); });
    if (body.flow && !welded)
      bodies[i].fail("a body with material flow needs a [[joint]] with edge = \"root\"");
    check_reservoir(bodies[i], body, scene);
    check_lines(bodies[i], body, scene);
    const bool framed = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
      return j.body == body.name && j.holds_frame() && j.edge != "free_end";
    });
    const bool at_end = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
      return j.body == body.name && j.edge == "free_end" && !j.on_rigid_body();
    });
    if (at_end && !framed)
      bodies[i].fail(
          "its free end is held in a hub, but no joint determines the location of its root: the "
          "case needs a [[joint]] with edge = \"root\"");
  }
}

}  // namespace flexmorph::cases
