#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "cases/scene/elements/row.h"
#include "cases/scene/joints/reading.h"
#include "cases/scene/joints/row.h"
#include "fem/body_weld.h"

namespace flexmorph::cases {
namespace {

const io::Key& kTo =
    io::key("joint", "to")
        .name_of("a hub or a body")
        .when("`type = \"weld\"`, of a plate or beam")
        .description("Hub, rigid body, plate or beam to which the edge is welded.");
const io::Key& kPoint =
    io::key("joint", "point")
        .numbers(io::any_number("a location", "m"), 2, 2)
        .otherwise(std::vector<double>{0, 0})
        .when("`type = \"weld\"`, of a plate or beam to a rigid body")
        .description("Location of the middle of the edge in the axes of the rigid body.");
const io::Key& kAngle =
    io::key("joint", "angle")
        .number(io::any_number("an angle", "rad"))
        .otherwise(0.0)
        .when("`type = \"weld\"`, of a plate or beam")
        .description("Angle of the normal of the edge in the axes of the hub or rigid body.");

const io::Key& kOwnEdge = io::key("joint", "edge")
                              .word("an edge", {"root", "free_end"})
                              .when("`type = \"weld\"`, of two plates or beams")
                              .description("Welded edge of `body`.");
const io::Key& kToEdge = io::key("joint", "to_edge")
                             .word("an edge", {"root", "free_end"})
                             .when("`type = \"weld\"`, of two plates or beams")
                             .description("Welded edge of the plate or beam `to`.");
const io::Key& kTurn =
    io::key("joint", "angle")
        .number(io::any_number("an angle", "rad"))
        .otherwise_as("0; pi where two roots or two free ends meet")
        .when("`type = \"weld\"`, of two plates or beams")
        .description("Angle from the axis of `to` to the axis of `body` at the weld, undeformed.");
const io::Choice<fem::WeldMode> kJoining(
    io::key("joint", "mode")
        .otherwise_as("`partial` for two beams, else `edge`")
        .when("`type = \"weld\"`, of two plates or beams")
        .description("Sections of beams rotate together, edges coincide, or also all slopes are "
                     "continuous."),
    "a mode of the weld of two bodies",
    {{"partial", fem::WeldMode::partial},
     {"edge", fem::WeldMode::edge},
     {"full", fem::WeldMode::full}});

/// Reads the frame on a rigid body to which the edge is welded.
void read_driven_frame(const io::Table& t, Joint& joint) {
  joint.b.body = joint.to;
  joint.b.point = read_pair(t, kPoint);
  joint.b.angle = t.number(kAngle);
}

/// One side of a weld: an edge of a plate or beam, a rigid body, or the ground, which stands for
/// all hubs and sleeves.
using Part = std::pair<std::string, std::string>;  // body, edge

Part edge_part(const Scene& scene, const Joint& joint) {
  const bool last = joint.edge == "free_end" || joint.line == scene.body(joint.body).elements[0];
  return {joint.body, last ? "free_end" : joint.line == 0 ? "root" : joint.edge};
}

/// Returns both sides of a weld; for all other joints two empty sides.
std::array<Part, 2> parts_of(const Scene& scene, const Joint& joint) {
  if (joint.joins_edges()) return {{{joint.a.body, joint.edge_a}, {joint.b.body, joint.edge_b}}};
  if (joint.holds_frame()) return {edge_part(scene, joint), Part{joint.b.body, ""}};
  return {};
}

/// Throws if other welds already connect both sides of a joint. The second connection would add
/// constraint rows that depend on the others, so that the constraint Jacobian would be rank
/// deficient.
void refuse_second_weld(const io::Table& t, const io::Key& key, const Scene& scene,
                        const Joint& joint) {
  const auto [from, to] = parts_of(scene, joint);
  std::set<Part> reached = {from};
  for (bool grew = true; grew;) {
    grew = false;
    for (const Joint& other : scene.joints) {
      const auto [a, b] = parts_of(scene, other);
      if (reached.contains(a) != reached.contains(b)) grew = true, reached.insert({a, b});
    }
  }
  if (reached.contains(to))
    t.fail(
        key,
        "other welds connect these two already: a closed chain of welds must leave out one weld");
}

/// Reads the weld of an edge to a hub or a rigid body, which also determines the location of the
/// body at the start.
void read_welded_edge(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& body = read_jointed_body(t, scene, joint);
  const std::vector<std::string> rigid = names_of(scene.rigid_bodies);
  std::vector<std::string> driven_frames = names_of(scene.hubs);
  driven_frames.insert(driven_frames.end(), rigid.begin(), rigid.end());
  joint.to = t.choice(rigid.empty() ? kTo.called("a hub") : kTo, driven_frames);
  const bool on_rigid = std::find(rigid.begin(), rigid.end(), joint.to) != rigid.end();
  using Names = std::vector<std::string>;
  read_framed_edge(t, body, Names{"root", "free_end"}, joint);
  if (on_rigid)
    read_driven_frame(t, joint);
  else
    joint.angle = t.number(kAngle);
  joint.mode = body.row->read_weld(t);
  check_frame(t, scene, body, joint);
  refuse_second_weld(t, joint_keys::kEdge, scene, joint);
}

/// The keys of one edge of a weld: of its body and of the edge.
struct EdgeKeys {
  const io::Key &body, &edge;
};

/// Returns the end of a plate or beam as an anchor of a weld. The body must be in the plane, and
/// the edge must not move through the material.
Anchor anchor_at(const io::Table& t, const EdgeKeys& keys, const Body& body, double run_end,
                 const std::string& edge) {
  if (body.in_space()) t.fail(keys.body, "plates in space are not welded to other bodies");
  const bool root = edge == "root";
  const bool moves =
      (root && body.flow) || std::any_of(body.lines.begin(), body.lines.end(), [&](const auto& l) {
        return l.index == (root ? 0 : body.elements[0]);
      });
  if (moves)
    t.fail(keys.edge,
           "this edge of '" + body.name +
               "' moves through the material: only a hub, a sleeve or a rigid body can hold it");
  return {body.name, {root ? 0 : body.longest(run_end), 0}, root ? 0 : body.arc};
}

/// Checks that the edges of two plates coincide node by node.
void check_plates(const io::Table& t, const Body& a, const Body& b, const Joint& joint,
                  double angle) {
  if (std::abs(std::sin(angle)) > 1e-9)
    t.fail(kTurn,
           "the angle of a weld of two plates is 0 or pi; for another angle weld both plates to a "
           "rigid body between them");
  if (std::abs(a.width - b.width) > 1e-9 * a.width || a.elements[1] != b.elements[1] ||
      a.shape != b.shape)
    t.fail(kTo, "plates are welded node to node: '" + a.name + "' and '" + b.name +
                    "' need equal widths, equal numbers of elements across and equal shape sets");
  if (joint.mode == fem::WeldMode::partial)
    t.fail(kJoining, "\"partial\" is for beams only; plates are welded by \"edge\" or \"full\"");
}

/// Reads the weld of two plates or beams at their edges: a is the body that `to` names, b the body
/// that `body` names.
void read_joined_edges(const io::Table& t, const Scene& scene, Joint& joint) {
  const Body& b = scene.body(read_flexible(t, joint_keys::kBody, scene));
  const Body& a = scene.body(t.choice(kTo, names_of(scene.bodies)));
  if (&a == &b) t.fail(kTo, "a weld connects two different bodies");
  joint.edge_a = t.choice(kToEdge);
  joint.edge_b = t.choice(kOwnEdge);
  joint.a = anchor_at(t, {kTo, kToEdge}, a, scene.time.end, joint.edge_a);
  joint.b = anchor_at(t, {joint_keys::kBody, kOwnEdge}, b, scene.time.end, joint.edge_b);
  const bool beams = !a.row->across && !b.row->across, plates = a.row->across && b.row->across;
  const double angle =
      t.number(kTurn, std::optional(joint.edge_a == joint.edge_b ? std::numbers::pi : 0.0));
  joint.a.angle += angle;
  joint.angle = angle;
  joint.mode =
      t.choice(kJoining, std::optional(beams ? fem::WeldMode::partial : fem::WeldMode::edge));
  if (plates) check_plates(t, a, b, joint, angle);
  if (!beams && !plates && joint.mode != fem::WeldMode::edge)
    t.fail(kJoining, "a plate and a beam are welded by \"edge\"");
  refuse_second_weld(t, kToEdge, scene, joint);
  name_between(t, scene, joint);
}

void read(const io::Table& t, const Scene& scene, Joint& joint) {
  if (t.has(kToEdge) || t.says_one_of(kTo, names_of(scene.bodies))) {
    read_joined_edges(t, scene, joint);
    return;
  }
  if (t.has(joint_keys::kBody)) {
    read_welded_edge(t, scene, joint);
    return;
  }
  const auto [a, b] = read_anchors(t, scene, true, true);
  joint.a = a, joint.b = b;
  name_between(t, scene, joint);
}

std::unique_ptr<fem::Joint> make(const Joint& joint, const JointParts& parts) {
  if (!joint.joins_edges() || parts.rigid)
    return fem::make_rigid_weld(joint.name, parts.a, parts.b);
  return fem::make_body_weld(joint.name, {joint.a.body, joint.edge_a}, {joint.b.body, joint.edge_b},
                             joint.angle, joint.mode);
}

}  // namespace

extern const JointRow kWeld;
const JointRow kWeld = {
    .name = "weld",
    .sentence =
        "Welds an edge to a hub, a rigid body or another edge, or two rigid bodies to each other.",
    .read = read,
    .make = make,
    .has_moment = true};

}  // namespace flexmorph::cases
