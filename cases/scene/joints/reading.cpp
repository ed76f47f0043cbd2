#include "cases/scene/joints/reading.h"

#include <algorithm>

#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {

using io::any_number;
using io::Key;
using io::Table;
using io::to_text;

namespace {

const Key& body_key(const char* name, const char* sentence) {
  return io::shared_key({"joint", "spring"}, name)
      .name_of("a body")
      .otherwise("ground")
      .when("joints between bodies, and springs")
      .description(sentence);
}

const Key& point_key(const char* name, const char* sentence) {
  return io::shared_key({"joint", "spring"}, name)
      .numbers(any_number("a location", "m"), 2, 2)
      .otherwise_as(
          "[0, 0] on a rigid body; on the ground the position of the other point at the start; "
          "required on a plate or beam")
      .when("joints and springs that use points")
      .description(sentence);
}

const Key& angle_key(const char* name, const char* sentence) {
  return io::shared_key({"joint", "spring"}, name)
      .number(any_number("an angle", "rad"))
      .otherwise(0.0)
      .when("joints and springs that use axes")
      .description(sentence);
}

}  // namespace

const AnchorKeys kAnchorA{
    body_key("a", "First body of the joint or spring, or the ground."),
    point_key(
        "point_a",
        "Point on `a`: in the axes of a rigid body or the ground, or a material point of a plate."),
    angle_key("angle_a",
              "Angle of the first axis of the joint or spring on `a`, in the axes of `a`.")};
const AnchorKeys kAnchorB{
    body_key("b", "Second body of the joint or spring, or the ground."),
    point_key(
        "point_b",
        "Point on `b`: in the axes of a rigid body or the ground, or a material point of a plate."),
    angle_key("angle_b",
              "Angle of the first axis of the joint or spring on `b`, in the axes of `b`.")};

namespace {

const Key& kName =
    io::key("joint", "name")
        .text("the name of a joint")
        .otherwise_as("a name made of type and bodies; no columns of forces")
        .when("joints between bodies")
        .description("Name of the joint. The forces of a named joint are columns of motion.csv.");

const io::Choice<fem::WeldMode> kMode(
    io::key("joint", "mode")
        .otherwise_as("`edge`; for a sleeve `direction`")
        .when("`type` is \"weld\", \"sleeve\" or \"clamp\", of a plate")
        .description("Quantities held at the edge: its points, also the direction of its slope, or "
                     "all slopes."),
    "a mode of a joint",
    {{"edge", fem::WeldMode::edge},
     {"direction", fem::WeldMode::direction},
     {"full", fem::WeldMode::full}});

}  // namespace

namespace joint_keys {

const Key& kBody = io::key("joint", "body")
                       .name_of("a body")
                       .when("joints of one plate or beam")
                       .description("Plate or beam that the joint holds.");
const Key& kEdge =
    io::key("joint", "edge")
        .text("an edge")
        .when("`type` is \"weld\" (of a body to a hub or a rigid body) or \"sleeve\"")
        .description(
            "Edge that the joint holds: `root`, `free_end`, or a line across the axis such as "
            "`line 3`.");

}  // namespace joint_keys

Vec2 read_pair(const Table& t, const Key& key, const std::optional<Vec2>& computed) {
  std::optional<std::vector<double>> both;
  if (computed) both = {computed->x(), computed->y()};
  const std::vector<double> v = t.numbers(key, both);
  return {v[0], v[1]};
}

Anchor read_anchor(const Table& t, const AnchorKeys& keys, const Scene& scene, bool with_point,
                   bool with_axis) {
  static const std::string kGround = "ground";
  std::vector<std::string> known = names_of(scene.rigid_bodies);
  if (!with_axis)
    for (const Body& b : scene.bodies) known.push_back(b.name);
  known.push_back(kGround);
  Anchor anchor;
  anchor.body = t.choice(keys.body, known);
  if (anchor.body == kGround) anchor.body.clear();
  if (with_point) {
    const bool on_plate = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                      [&](const Body& b) { return b.name == anchor.body; });
    anchor.given = t.has(keys.point) || !anchor.on_ground();
    if (on_plate)
      anchor.point = read_pair(t, keys.point.called("a material point"));
    else if (anchor.given)
      anchor.point = read_pair(t, keys.point, Vec2(0, 0));
  } else if (t.has(keys.point)) {
    t.fail(keys.point, "this kind of joint or spring uses no points");
  }
  if (with_axis)
    anchor.angle = t.number(keys.angle);
  else if (t.has(keys.angle))
    t.fail(keys.angle, "this kind of joint or spring uses no axes");
  return anchor;
}

std::array<Anchor, 2> read_anchors(const Table& t, const Scene& scene, bool with_points,
                                   bool with_axes) {
  const Anchor a = read_anchor(t, kAnchorA, scene, with_points, with_axes),
               b = read_anchor(t, kAnchorB, scene, with_points, with_axes);
  if (a.on_ground() && b.on_ground())
    t.fail("`a` and `b` are both the ground: `a`, `b` or both must name a body");
  if (a.body == b.body && !a.on_ground())
    t.fail(kAnchorB.body, "`a` and `b` are two different bodies");
  return {a, b};
}

void name_between(const Table& t, const Scene& scene, Joint& joint) {
  const auto body = [](const Anchor& a) { return a.on_ground() ? "ground" : a.body; };
  std::string name =
      std::string(joint.row->name) + " of " + body(joint.a) + " and " + body(joint.b);
  joint.named = t.has(kName);
  if (joint.named) name = read_word(t, kName);
  for (const Hub& hub : scene.hubs)
    if (hub.name == name) t.fail(kName, "there is a hub '" + name + "'");
  for (const Joint& other : scene.joints)
    if (!other.name.empty() && other.name == name) {
      if (joint.named) t.fail(kName, "there is another joint '" + name + "'");
      name += ", " + std::to_string(scene.joints.size() + 1);
      break;
    }
  joint.name = name;
}

const Body& read_jointed_body(const Table& t, const Scene& scene, Joint& joint) {
  joint.body = read_flexible(t, joint_keys::kBody, scene);
  joint.name = joint.body + "." + joint.row->name;
  return scene.body(joint.body);
}

const std::vector<std::string>& edge_names() {
  static const std::vector<std::string> kNames = {"root", "free_end", "side_low", "side_high"};
  return kNames;
}

int line_of(const std::string& edge, const Body& body) {
  for (int i = 0; i <= body.elements[0]; ++i)
    if (edge == "line " + std::to_string(i)) return i;
  return -1;
}

std::string read_edge(const Table& t, const Key& key, const Body& body,
                      const std::vector<std::string>& names) {
  std::string edge = t.string(key);
  if (std::find(names.begin(), names.end(), edge) != names.end()) return edge;
  const bool moves = body.flow || body.mesh_changes();
  if (!moves && line_of(edge, body) >= 0) return edge;
  const std::string lines = ", 'line 0' to 'line " + to_text(body.elements[0]) + "'";
  t.fail(key, "an edge is " + joined(names, ", ", "'") + (moves ? "" : lines));
}

Vec2 read_point(const Table& t, const Key& key, const Body& body, double end) {
  const auto v = t.numbers(key);
  const double longest = body.longest(end), first = longest - body.shortest(end);
  const double slack = 1e-9 * longest;
  if (v[0] < first - slack || v[0] > longest + slack || v[1] < body.low() - slack ||
      v[1] > body.low() + body.width + slack)
    t.fail(key, "a material point of '" + body.name + "' lies in [" + to_text(first, 6) + ", " +
                    to_text(longest, 6) + "] x [" + to_text(body.low(), 6) + ", " +
                    to_text(body.low() + body.width, 6) + "] [m]");
  return {v[0], v[1]};
}

fem::WeldMode read_mode(const Table& t, fem::WeldMode fallback) {
  return t.choice(kMode, std::optional(fallback));
}

void read_framed_edge(const Table& t, const Body& body, const std::vector<std::string>& names,
                      Joint& joint) {
  joint.edge = read_edge(t, joint_keys::kEdge, body, names);
  joint.line = std::max(0, line_of(joint.edge, body));
  joint.name = joint.body + "." + joint.edge;
  if (!body.row->lines && joint.line != 0)
    t.fail(joint_keys::kEdge, "a beam is welded at `root` or at `free_end`");
}

void check_frame(const Table& t, const Scene& scene, const Body& body, const Joint& joint) {
  const bool free = std::any_of(body.lines.begin(), body.lines.end(), [&](const BodyLine& l) {
    return l.free && joint.edge != "free_end" && l.index == joint.line;
  });
  if (free && scene.is_mechanism() && !joint.on_rigid_body())
    t.fail(joint_keys::kEdge,
           "in a scene with rigid bodies or welds between bodies, a free line is held in a rigid "
           "body, not in a hub or a sleeve");
  for (const Joint& other : scene.joints) {
    if (other.body != joint.body || !other.holds_frame()) continue;
    if (other.edge == joint.edge)
      t.fail(joint_keys::kEdge,
             "this edge of '" + joint.body + "' is held by another joint already");
    if (joint.edge != "free_end" && other.edge != "free_end")
      t.fail(joint_keys::kEdge,
             "'" + joint.body + "' is held in another hub, sleeve or rigid body already");
  }
}

}  // namespace flexmorph::cases
