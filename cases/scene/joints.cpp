#include <cmath>

#include "cases/scene/read.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::positive;
using io::Table;
using io::to_text;

using Words = std::vector<std::string>;

/// "line 3" of a body of so many elements; -1 for other words.
int line_of(const std::string& edge, const Body& body) {
  for (int i = 0; i <= body.elements[0]; ++i)
    if (edge == "line " + std::to_string(i)) return i;
  return -1;
}

/// An edge by its name, or, where the mesh does not change, an m-line.
std::string read_edge(const Table& t, const std::string& key, const Body& body,
                      const Words& names) {
  const std::string edge = t.string(key, "an edge");
  if (std::find(names.begin(), names.end(), edge) != names.end()) return edge;
  if (!body.mesh_changes() && line_of(edge, body) >= 0) return edge;
  std::string known;
  for (const std::string& name : names) known += "'" + name + "', ";
  t.fail(key, body.mesh_changes()
                  ? "an edge is " + known.substr(0, known.size() - 2)
                  : "an edge is " + known + "'line 0' to 'line " + to_text(body.elements[0]) + "'");
}

const Words& edge_names() {
  static const Words kNames = {"root", "free_end", "side_low", "side_high"};
  return kNames;
}

/// A material point that is outside of the hub all the time.
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

/// How the end of a beam is welded: its section keeps its direction and is free to grow (partial);
/// it keeps direction and size (edge); the axis is not stretched, either (full).
fem::WeldMode read_beam_mode(const Table& t) {
  return t.choice<fem::WeldMode>("mode", "the weld of a beam",
                                 {{"partial", fem::WeldMode::partial},
                                  {"edge", fem::WeldMode::edge},
                                  {"full", fem::WeldMode::full}},
                                 fem::WeldMode::partial);
}

/// Hub or sleeve: a frame for one edge of the body, which also says where the body begins.
void read_frame(const Table& t, const Scene& scene, const Body& body, Joint& joint) {
  const std::vector<std::string> rigid = names_of(scene.rigid_bodies);
  if (joint.type == "weld") {
    std::vector<std::string> carriers = names_of(scene.hubs);
    carriers.insert(carriers.end(), rigid.begin(), rigid.end());
    joint.to = t.choice("to", rigid.empty() ? "a hub" : "a hub or rigid body", carriers);
  }
  const bool on_rigid = std::find(rigid.begin(), rigid.end(), joint.to) != rigid.end();
  joint.edge = read_edge(t, "edge", body, on_rigid ? Words{"root", "free_end"} : Words{"root"});
  joint.line = std::max(0, line_of(joint.edge, body));
  if (body.is_beam() && joint.line != 0) t.fail("edge", "a beam is welded at one of its ends");
  if (on_rigid) read_carrier(t, joint);
  if (joint.type == "weld") {
    joint.mode = body.is_beam() ? read_beam_mode(t) : read_mode(t, fem::WeldMode::edge);
  } else {
    if (body.is_beam()) t.fail("body", "material slides through the sleeves of plates only");
    const double line = body.start_lines(0, body.elements[0])[static_cast<size_t>(joint.line)];
    const auto at =
        t.numbers("position", any_number("a position", "m"), 2, std::vector<double>{line, 0});
    joint.position = {at[0], at[1]};
    joint.angle = t.number("angle", any_number("an angle", "rad"), 0.0);
    joint.mode = read_mode(t, fem::WeldMode::direction);
    if (body.flow) t.fail("body", "material flows out of a hub, see \"weld\", not out of a sleeve");
  }
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

void read_components(const Table& t, const Body& body, Joint& joint) {
  static const Words kAxes = {"x", "y", "z"};
  const auto axes = std::span(kAxes).first(static_cast<size_t>(body.dim()));
  if (!t.has("components")) {
    for (int c = 0; c < body.dim(); ++c) joint.components.push_back(c);
    return;
  }
  for (const std::string& axis : t.choices("components", "a component", axes))
    joint.components.push_back(axis[0] - 'x');
}

void read_line_drive(const Table& t, const Body& body, const Scene& scene, Joint& joint) {
  joint.line = t.integer("line", "a free m-line", 0, body.elements[0]);
  const bool free = std::any_of(body.lines.begin(), body.lines.end(),
                                [&](const BodyLine& l) { return l.free && l.index == joint.line; });
  if (!free) t.fail("line", "only a free line is driven: see [[body.line]]");
  if (t.has("at")) {
    if (t.has("speed")) t.fail("speed", "a line moves at a `speed`, or as the drive `at` says");
    joint.at.drive = t.choice("at", "a drive", names_of(scene.drives));
    const double start = scene.motion_of(joint.at)(0).value;
    const double line = body.start_lines(0, body.elements[0])[static_cast<size_t>(joint.line)];
    if (std::abs(start - line) > 1e-9)
      t.fail("at",
             "this drive starts at " + to_text(start) + ", the line at " + to_text(line) + " [m]");
  } else {
    joint.speed = t.number("speed", any_number("the speed of a line", "m/s"), 0.0);
  }
  if (scene.statics && joint.speed != 0) t.fail("speed", "in a [static] analysis lines rest");
  for (const Joint& other : scene.joints)
    if (other.type == "line_drive" && other.body == joint.body && other.line == joint.line)
      t.fail("line", "this line of '" + joint.body + "' is driven already");
}

Joint read_joint(const Table& t, const Vocabulary& words, const Scene& scene) {
  Joint joint;
  joint.type = t.choice("type", "a joint", words.joints);
  const bool between_bodies = joint.type != "weld" || !t.has("body");
  if (between_bodies && read_body_joint(t, scene, joint)) return joint;
  joint.body = t.choice("body", "a body", names_of(scene.bodies));
  const Body& body = scene.body(joint.body);
  joint.name = joint.body + "." + joint.type;
  if (joint.holds_frame()) {
    read_frame(t, scene, body, joint);
    joint.name = joint.body + "." + joint.edge;
  }
  if (joint.type == "pin") {
    joint.point = read_point(t, body, scene.time.end);
    read_components(t, body, joint);
  }
  if (joint.holds_edges()) {
    if (!body.in_space()) t.fail("type", "edges are held in space; bodies in the plane have hubs");
    const std::string noun = "an edge";
    joint.edges = t.choices("edges", noun, edge_names());
    if (joint.type == "clamp") joint.mode = read_mode(t, fem::WeldMode::edge);
    if (body.flow) t.fail("body", "material flows out of a hub: its edges are not held");
    if (body.mesh_changes()) t.fail("body", "its lines of nodes come and go: edges are not held");
  }
  if (joint.type == "line_drive") {
    read_line_drive(t, body, scene, joint);
    joint.name = joint.body + ".line " + std::to_string(joint.line);
  }
  return joint;
}

/// Held edges are held where the undeformed body lies: not turned, not shifted.
void check_held(const Table& t, const Joint& joint, const Scene& scene) {
  for (const Joint& other : scene.joints)
    if (joint.holds_edges() && other.body == joint.body && other.holds_frame())
      t.fail("type", "'" + joint.body + "' sits in a hub or sleeve: hold it there");
}

/// A line that nothing moves through the material would be an unknown without an equation.
void check_lines(const Table& t, const Body& body, const Scene& scene) {
  for (const BodyLine& line : body.lines) {
    if (!line.free) continue;
    const bool used = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
      return j.body == body.name && j.line == line.index &&
             (j.holds_frame() || j.type == "line_drive");
    });
    if (!used)
      t.fail("nothing holds the free line " + to_text(line.index) +
             ": a [[joint]] \"sleeve\" or \"weld\" with edge = \"line " + to_text(line.index) +
             "\", or a \"line_drive\", is missing");
  }
}

BodyLoad read_load(const Table& t, const Scene& scene) {
  BodyLoad load;
  load.type =
      t.choice("type", "a load", Words{"point", "edge", "surface", "pressure", "edge_moment"});
  load.body = t.choice("body", "a body", names_of(scene.bodies));
  const Body& body = scene.body(load.body);
  if (load.type == "point") load.point = read_point(t, body, scene.time.end);
  if (load.type == "edge" || load.type == "edge_moment")
    load.edge = read_edge(t, "edge", body, edge_names());
  if (body.is_beam() && load.type != "point") t.fail("type", "loads on a beam act at points");
  const bool follows = load.type == "pressure" || load.type == "edge_moment";
  if (follows && !body.in_space()) t.fail("type", "this load acts on a plate in space");
  if (follows && scene.time.integrator == "energy_momentum")
    t.fail("type", "a load that follows the plate needs integrator = \"generalized_alpha\"");
  if (load.type == "pressure") {
    load.size = t.number("pressure", any_number("a pressure", "N/m^2"));
  } else if (load.type == "edge_moment") {
    load.size = t.number("moment", any_number("a moment per length", "N"));
  } else {
    const char* unit = load.type == "point" ? "N" : load.type == "edge" ? "N/m" : "N/m^2";
    const auto force = t.numbers("force", any_number("a force", unit), body.dim());
    load.force = Eigen::Map<const VectorXd>(force.data(), body.dim());
  }
  return load;
}

Observe read_observe(const Table& t, const Scene& scene) {
  Observe out;
  out.name = read_word(t, "the name of an observed point");
  out.body = t.choice("body", "a body", names_of(scene.bodies));
  const Body& body = scene.body(out.body);
  if (t.has("point") == t.has("at"))
    t.fail("an observed point has either a `point` or `at` = \"free_end\"");
  if (t.has("point")) {
    out.point = read_point(t, body, scene.time.end);
  } else {
    t.choice("at", "a place", Words{"free_end"});
    out.point = {body.longest(scene.time.end), body.low() + 0.5 * body.width};
  }
  for (const Observe& other : scene.observed)
    if (other.name == out.name && other.body == out.body)
      t.fail("name", "there is another '" + out.name + "' of '" + out.body + "'");
  return out;
}

}  // namespace

std::string read_word(const Table& t, const std::string& noun) {
  std::string name = t.string("name", noun);
  const auto is_word_letter = [](char c) { return std::isalnum(c) || c == '_'; };
  if (name.empty() || static_cast<unsigned char>(name[0]) > 127 || !std::isalpha(name[0]) ||
      !std::all_of(name.begin(), name.end(), is_word_letter))
    t.fail("name", noun + " begins with a letter; letters, digits and _ follow");
  return name;
}

StaticAnalysis read_analysis(const Table& t) {
  using Path = fem::StaticSettings::Path;
  constexpr int kMost = 1'000'000;
  StaticAnalysis out;
  out.path = t.choice<Path>("path", "a path",
                            {{"load", Path::load}, {"arc_length", Path::arc_length}}, Path::load);
  out.to = t.number("to", any_number("a load factor"), 1.0);
  if (out.to == 0) t.fail("to", "the load factor grows from 0 to another value");
  out.steps = t.integer("steps", "a number of steps", 1, kMost, out.steps);
  out.max_steps = t.integer("max_steps", "a number of steps", 1, kMost, std::max(1000, out.steps));
  if (out.max_steps < out.steps) t.fail("max_steps", "at least static.steps");
  out.max_iterations = t.integer("max_iterations", "a number of iterations", 1, 1000, 15);
  return out;
}

void read_growing(const Table& root, Scene& scene) {
  enum class Grows { loads, temperatures, both };
  const Table t = root.table("static");
  const bool loaded = !scene.loads.empty() || scene.gravity, hot = scene.has_heat();
  if (!loaded && !hot)
    root.fail("static", "nothing loads the bodies: gravity, a [[load]] or [body.heat] is missing");
  const Grows grows = t.choice<Grows>(
      "grows", "what the load factor multiplies",
      {{"loads", Grows::loads}, {"temperatures", Grows::temperatures}, {"both", Grows::both}},
      loaded ? Grows::loads : Grows::temperatures);
  StaticAnalysis& out = *scene.statics;
  out.loads_grow = grows != Grows::temperatures;
  out.temperatures_grow = grows != Grows::loads;
  if (out.loads_grow && !loaded) t.fail("grows", "there is no load and no gravity to grow");
  if (out.temperatures_grow && !hot) t.fail("grows", "no body has a temperature: [body.heat]");
}

namespace {

/// Limits of the element next to a free root line; two halves that were just split must not be
/// merged again.
void read_limits(const Table& t, const Body& body, BodyLine& line) {
  const std::string key = t.has("max_length") ? "max_length" : "min_length";
  if (!line.free || line.index != 0)
    t.fail(key, "lines of nodes come and go next to a free root line: index = 0, free = true");
  line.max_length = t.number("max_length", positive("a length", "m"));
  line.min_length = t.number("min_length", positive("a length", "m"), 0.3 * line.max_length);
  const double element = body.length / body.elements[0];
  if (element > line.max_length * (1 + 1e-9) || element < line.min_length * (1 - 1e-9))
    t.fail(key, "the elements are " + to_text(element, 4) +
                    " m long at the start: between min_length and max_length [m]");
  if (line.min_length + 0.5 * line.max_length > 0.9 * line.max_length * (1 + 1e-9))
    t.fail(key,
           "min_length + 0.5 max_length stays below 0.9 max_length, or elements are split and "
           "merged in turn");
}

}  // namespace

std::vector<BodyLine> read_lines(const Table& body_table, const Body& body) {
  std::vector<BodyLine> out;
  std::vector<Table> tables = body_table.tables("line");
  for (const Table& t : tables) {
    BodyLine line;
    line.index =
        t.integer("index", "the number of an m-line before the free end", 0, body.elements[0] - 1);
    line.free = t.boolean("free", false);
    if (t.has("at")) line.at = t.number("at", any_number("a material coordinate", "m"));
    if (!line.free && !line.at) t.fail("a line is `free`, or `at` a place of its own, or both");
    if (line.at && line.index == 0) t.fail("at", "the first line is an end of the body");
    for (const BodyLine& other : out)
      if (other.index == line.index) t.fail("index", "there is another line of this number");
    if (body.flow) t.fail("material flows through '" + body.name + "': its lines come and go");
    if (t.has("max_length") || t.has("min_length")) read_limits(t, body, line);
    out.push_back(line);
  }
  std::sort(out.begin(), out.end(),
            [](const BodyLine& a, const BodyLine& b) { return a.index < b.index; });
  if (out.empty()) return out;
  if (out.front().has_limits() && out.size() > 1)
    tables.front().fail(
        "lines come and go next to the root: no other line has a number to name it");
  Body with_lines = body;
  with_lines.lines = out;
  const std::vector<double> at = with_lines.start_lines(0, body.elements[0]);
  for (size_t i = 0; i + 1 < at.size(); ++i)
    if (at[i + 1] <= at[i])
      tables.front().fail("lines " + std::to_string(i) + " and " + std::to_string(i + 1) +
                          " begin at " + to_text(at[i], 4) + " m and " + to_text(at[i + 1], 4) +
                          " m: they must increase");
  return out;
}

std::vector<Joint> read_joint_list(const Table& root, const Vocabulary& words, const Scene& scene) {
  Scene growing = scene;  // a joint must fit together with those before it
  for (const Table& t : root.tables("joint"))
    growing.joints.push_back(read_joint(t, words, growing));
  return growing.joints;
}

void read_joints(const Table& root, const Vocabulary& words, Scene& scene) {
  const std::vector<Table> joints = root.tables("joint"), bodies = root.tables("body");
  scene.joints = read_joint_list(root, words, scene);
  for (size_t i = 0; i < joints.size(); ++i) check_held(joints[i], scene.joints[i], scene);
  for (size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
      return j.type == "weld" && j.body == body.name && j.edge == "root";
    });
    if (body.flow && !welded)
      bodies[i].fail("material flows out of a hub: a [[joint]] with edge = \"root\" is missing");
    check_lines(bodies[i], body, scene);
  }
}

void read_loads(const Table& root, Scene& scene) {
  for (const Table& t : root.tables("load")) scene.loads.push_back(read_load(t, scene));
  for (const Table& t : root.tables("observe")) scene.observed.push_back(read_observe(t, scene));
}

}  // namespace flexmorph::cases
