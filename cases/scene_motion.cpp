#include <cmath>

#include "cases/scene_parts.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::between;
using io::not_negative;
using io::positive;
using io::Table;
using io::to_text;

constexpr int kMostElements = 100'000;

/// Part of column names and file names, so: a letter, then letters, digits, underscores.
std::string read_name(const Table& t, const std::string& noun, const Scene& scene) {
  std::string name = t.string("name", noun);
  const auto is_word_letter = [](char c) { return std::isalnum(c) || c == '_'; };
  if (name.empty() || static_cast<unsigned char>(name[0]) > 127 || !std::isalpha(name[0]) ||
      !std::all_of(name.begin(), name.end(), is_word_letter))
    t.fail("name", noun + " begins with a letter; letters, digits and _ follow");
  if (name == "energy") t.fail("name", "'energy' names columns of motion.csv already");
  for (const std::vector<std::string>& taken : {names_of(scene.hubs), names_of(scene.bodies)})
    for (const std::string& other : taken)
      if (name == other) t.fail("name", "there is another '" + name + "'");
  return name;
}

TimeSpan read_time(const Table& t) {
  TimeSpan time;
  time.end = t.number("end", positive("an end time", "s"));
  time.step = t.number("step", positive("a time step", "s"), std::min(1e-3, time.end));
  if (time.step > time.end) t.fail("step", "a time step is no longer than time.end [s]");
  time.rho_inf = t.number("rho_inf", between("a spectral radius", "", 0, 1), 0.8);
  time.start = t.choice<Start>("start", "a start",
                               {{"prestretched", Start::prestretched},
                                {"rigid", Start::rigid},
                                {"hub_at_rest", Start::hub_at_rest}},
                               Start::prestretched);
  if (time.start == Start::hub_at_rest) {
    auto span = between("a spin-up", "s", 0, time.end);
    span.lower_open = true;
    time.spin_up = t.number("spin_up", span, 0.2 * time.end);
  } else if (t.has("spin_up")) {
    t.fail("spin_up", "only start = \"hub_at_rest\" spins up");
  }
  return time;
}

Hub read_hub(const Table& t, const Scene& scene) {
  Hub hub;
  hub.name = read_name(t, "the name of a hub", scene);
  const std::vector<double> position =
      t.numbers("position", any_number("a position", "m"), 2, std::vector<double>{0, 0});
  hub.position = {position[0], position[1]};
  hub.angle = t.number("angle", any_number("an angle", "rad"), 0.0);
  hub.angular_velocity = t.number("angular_velocity", any_number("an angular velocity", "rad/s"));
  return hub;
}

/// Limits of the boundary element. They must not chatter: two halves that were just split must
/// not be short enough to be merged again, nor a merged element long enough to be split.
Flow read_flow(const Table& t, const Body& body, double end) {
  Flow flow;
  flow.speed = t.number("speed", any_number("the speed of the material", "m/s"));
  flow.max_length = t.number("max_length", positive("a length", "m"));
  flow.min_length = t.number("min_length", positive("a length", "m"), 0.3 * flow.max_length);

  const double element = body.length / body.elements[0];
  const double shortest = std::min(body.length, body.length + flow.speed * end);
  if (element > flow.max_length * (1 + 1e-9))
    t.fail("max_length", "the elements are " + to_text(element, 4) +
                             " m long at the start: more elements, or a larger max_length [m]");
  const std::string min_key = t.has("min_length") ? "min_length" : "max_length";
  if (element < flow.min_length * (1 - 1e-9))
    t.fail(min_key, "the elements are " + to_text(element, 4) +
                        " m long at the start, shorter than min_length = " +
                        to_text(flow.min_length, 4) + " m, and would be merged at once");
  const double neighbour =
      flow.speed < 0 ? std::max(element, 0.5 * flow.max_length) : 0.5 * flow.max_length;
  if (flow.min_length + neighbour > 0.9 * flow.max_length * (1 + 1e-9))
    t.fail(min_key, "min_length + the neighbour's " + to_text(neighbour, 4) +
                        " m stays below 0.9 max_length, or elements are split and merged in turn");
  if (shortest < flow.min_length)
    t.fail("speed", "the body keeps at least min_length, but " + to_text(shortest, 4) +
                        " m are left at time.end");
  return flow;
}

Body read_body(const Table& t, const Vocabulary& words, const Scene& scene) {
  Body body;
  body.name = read_name(t, "the name of a body", scene);
  body.element = t.choice("element", "an element", words.elements);
  body.shape = t.choice("shape", "a shape set", words.shapes, "h16");
  body.space = t.choice("space", "a space", std::vector<std::string>{"plane"}, "plane");
  body.terms = t.choices("terms", "a term", words.terms);
  if (std::find(body.terms.begin(), body.terms.end(), "inertia") == body.terms.end())
    t.fail("terms", "a body that moves has \"inertia\"");
  body.length = t.number("length", positive("a length", "m"));
  body.width = t.number("width", positive("a width", "m"));
  body.thickness = t.number("thickness", positive("a thickness", "m"));
  body.density = t.number("density", positive("a density", "kg/m^3"));
  body.youngs_modulus = t.number("youngs_modulus", positive("Young's modulus", "Pa"));
  body.poisson_ratio = t.number("poisson_ratio", between("Poisson's ratio", "", 0, 0.5));
  const std::vector<int> elements =
      t.integers("elements", "a number of elements", 1, kMostElements, 2);
  body.elements = {elements[0], elements[1]};
  if (1.0 * elements[0] * elements[1] > kMostElements)
    t.fail("elements", "at most " + to_text(kMostElements) + " elements");

  const bool flows = body.element == "ale_ancf_plate";
  if (flows) {
    body.flow = read_flow(t.table("flow"), body, scene.time.end);
  } else if (t.has("flow")) {
    t.fail("flow", "material flows through \"ale_ancf_plate\" only");
  }
  return body;
}

Joint read_joint(const Table& t, const Vocabulary& words, const Scene& scene) {
  Joint joint;
  joint.type = t.choice("type", "a joint", words.joints);
  joint.body = t.choice("body", "a body", names_of(scene.bodies));
  joint.edge = t.choice("edge", "an edge", std::vector<std::string>{"root"});
  joint.to = t.choice("to", "a hub", names_of(scene.hubs));
  joint.mode = t.choice<fem::WeldMode>("mode", "a weld",
                                       {{"edge", fem::WeldMode::edge},
                                        {"direction", fem::WeldMode::direction},
                                        {"full", fem::WeldMode::full}},
                                       fem::WeldMode::edge);
  for (const Joint& other : scene.joints)
    if (other.body == joint.body && other.edge == joint.edge)
      t.fail("edge", "this edge of '" + joint.body + "' is welded already");
  return joint;
}

PointMass read_point_mass(const Table& t, const Scene& scene) {
  PointMass mass;
  mass.body = t.choice("body", "a body", names_of(scene.bodies));
  mass.at = t.choice("at", "the place of a point mass", std::vector<std::string>{"free_end"});
  mass.mass = t.number("mass", positive("a mass", "kg"));
  return mass;
}

}  // namespace

void read_motion(const Table& root, const Vocabulary& words, Scene& scene) {
  scene.time = read_time(root.table("time"));
  if (root.has("gravity")) {
    const auto gravity = root.numbers("gravity", any_number("gravity", "m/s^2"), 2);
    scene.gravity = Vec2(gravity[0], gravity[1]);
  }
  for (const Table& t : root.tables("hub")) scene.hubs.push_back(read_hub(t, scene));
  const std::vector<Table> bodies = root.tables("body");
  if (bodies.empty()) root.fail("body", "a scene has one or more [[body]]");
  for (const Table& t : bodies) scene.bodies.push_back(read_body(t, words, scene));
  for (const Table& t : root.tables("joint")) scene.joints.push_back(read_joint(t, words, scene));
  for (const Table& t : root.tables("point_mass"))
    scene.point_masses.push_back(read_point_mass(t, scene));

  for (size_t i = 0; i < bodies.size(); ++i) {
    const bool welded = std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& j) {
      return j.body == scene.bodies[i].name && j.edge == "root";
    });
    if (scene.bodies[i].flow && !welded)
      bodies[i].fail("material flows out of a hub: a [[joint]] with edge = \"root\" is missing");
  }
}

}  // namespace flexmorph::cases
