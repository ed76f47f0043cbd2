#include "cases/scene/joints/reading.h"

#include <algorithm>

#include "cases/scene/joints/row.h"
#include "io/files.h"

namespace flexmorph::cases {

using io::any_number;
using io::Table;
using io::to_text;

Vec2 read_pair(const Table& t, const std::string& key, const std::string& noun,
               const std::string& unit, const std::optional<Vec2>& fallback) {
  std::optional<std::vector<double>> both;
  if (fallback) both = {fallback->x(), fallback->y()};
  const std::vector<double> v = t.numbers(key, any_number(noun, unit), 2, both);
  return {v[0], v[1]};
}

Anchor read_anchor(const Table& t, const std::string& which, const Scene& scene, bool with_point,
                   bool with_axis) {
  static const std::string kGround = "ground";
  std::vector<std::string> known = names_of(scene.rigid_bodies);
  if (!with_axis)
    for (const Body& b : scene.bodies) known.push_back(b.name);
  known.push_back(kGround);
  Anchor anchor;
  anchor.body = t.choice(which, "a body", known, kGround);
  if (anchor.body == kGround) anchor.body.clear();
  const std::string point = "point_" + which, angle = "angle_" + which;
  if (with_point) {
    const bool on_plate = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                      [&](const Body& b) { return b.name == anchor.body; });
    anchor.given = t.has(point) || !anchor.on_ground();
    if (on_plate)
      anchor.point = read_pair(t, point, "a material point", "m");
    else
      anchor.point = read_pair(t, point, "a place", "m", Vec2(0, 0));
  } else if (t.has(point)) {
    t.fail(point, "this joint does not look at points");
  }
  if (with_axis)
    anchor.angle = t.number(angle, any_number("an angle", "rad"), 0.0);
  else if (t.has(angle))
    t.fail(angle, "this joint does not look at axes");
  return anchor;
}

void read_anchors(const Table& t, const Scene& scene, bool points, bool axes, Anchor& a,
                  Anchor& b) {
  a = read_anchor(t, "a", scene, points, axes);
  b = read_anchor(t, "b", scene, points, axes);
  if (a.on_ground() && b.on_ground())
    t.fail("a body is missing: `a`, `b` or both name one; what is left out is the ground");
  if (a.body == b.body && !a.on_ground()) t.fail("b", "a joint is between two bodies");
}

void name_between(const Table& t, const Scene& scene, Joint& joint) {
  const auto body = [](const Anchor& a) { return a.on_ground() ? "ground" : a.body; };
  std::string name =
      std::string(joint.row->name) + " of " + body(joint.a) + " and " + body(joint.b);
  joint.named = t.has("name");
  if (joint.named) name = read_word(t, "the name of a joint");
  for (const Joint& other : scene.joints)
    if (!other.name.empty() && other.name == name) {
      if (joint.named) t.fail("name", "there is another joint '" + name + "'");
      name += ", " + std::to_string(scene.joints.size() + 1);
      break;
    }
  joint.name = name;
}

const Body& read_jointed_body(const Table& t, const Scene& scene, Joint& joint) {
  joint.body = t.choice("body", "a body", names_of(scene.bodies));
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

std::string read_edge(const Table& t, const std::string& key, const Body& body,
                      const std::vector<std::string>& names) {
  const std::string edge = t.string(key, "an edge");
  if (std::find(names.begin(), names.end(), edge) != names.end()) return edge;
  if (!body.mesh_changes() && line_of(edge, body) >= 0) return edge;
  std::string known;
  for (const std::string& name : names) known += "'" + name + "', ";
  t.fail(key, body.mesh_changes()
                  ? "an edge is " + known.substr(0, known.size() - 2)
                  : "an edge is " + known + "'line 0' to 'line " + to_text(body.elements[0]) + "'");
}

Vec2 read_point(const Table& t, const Body& body, double end) {
  const auto v = t.numbers("point", any_number("a material coordinate", "m"), 2);
  const double longest = body.longest(end), first = longest - body.shortest(end);
  const double slack = 1e-9 * longest;
  if (v[0] < first - slack || v[0] > longest + slack || v[1] < body.low() - slack ||
      v[1] > body.low() + body.width + slack)
    t.fail("point", "a material point of '" + body.name + "' lies in [" + to_text(first, 6) + ", " +
                        to_text(longest, 6) + "] x [" + to_text(body.low(), 6) + ", " +
                        to_text(body.low() + body.width, 6) + "] [m]");
  return {v[0], v[1]};
}

fem::WeldMode read_mode(const Table& t, fem::WeldMode fallback) {
  return t.choice<fem::WeldMode>("mode", "a weld",
                                 {{"edge", fem::WeldMode::edge},
                                  {"direction", fem::WeldMode::direction},
                                  {"full", fem::WeldMode::full}},
                                 fallback);
}

void read_framed_edge(const Table& t, const Body& body, const std::vector<std::string>& names,
                      Joint& joint) {
  joint.edge = read_edge(t, "edge", body, names);
  joint.line = std::max(0, line_of(joint.edge, body));
  joint.name = joint.body + "." + joint.edge;
  if (body.is_beam() && joint.line != 0) t.fail("edge", "a beam is welded at one of its ends");
}

void check_frame(const Table& t, const Scene& scene, const Body& body, const Joint& joint) {
  const bool free = std::any_of(body.lines.begin(), body.lines.end(), [&](const BodyLine& l) {
    return l.free && joint.edge != "free_end" && l.index == joint.line;
  });
  if (free && scene.is_mechanism() && !joint.on_rigid_body())
    t.fail("edge", "in a scene with rigid bodies a free line slides in one of them, not in a hub");
  for (const Joint& other : scene.joints) {
    if (other.body != joint.body || !other.holds_frame()) continue;
    if (other.edge == joint.edge)
      t.fail("edge", "this edge of '" + joint.body + "' is welded already");
    if (joint.edge != "free_end" && other.edge != "free_end")
      t.fail("edge", "'" + joint.body + "' sits in a hub or sleeve already");
  }
}

}  // namespace flexmorph::cases
