#include <cmath>

#include "cases/scene/heat.h"
#include "cases/scene/read.h"
#include "fem/dynamics/step_control.h"
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

/// A number, or "adaptive" with what belongs to it; the integrator is read.
void read_step(const Table& t, TimeSpan& time) {
  time.step = std::min(1e-3, time.end);
  if (t.is_string("step")) {
    t.choice("step", "a time step in words", std::vector<std::string>{"adaptive"});
    if (time.integrator != "generalized_alpha")
      t.fail("step", "only \"generalized_alpha\" knows its local error, which \"adaptive\" needs");
    auto span = between("a tolerance", "", 0, 0.1);
    span.lower_open = true;
    time.tolerance = t.number("tolerance", span, fem::AdaptiveStep{}.tolerance);
    if (!t.has("largest_step")) return;
    time.largest_step = t.number("largest_step", positive("a time step", "s"));
    if (time.largest_step > time.end)
      t.fail("largest_step", "a time step is no longer than time.end [s]");
    return;
  }
  if (t.has("largest_step")) t.fail("largest_step", "only step = \"adaptive\" has one");
  if (time.integrator == "minimal_coordinates")
    time.explicit_tolerance =
        t.number("tolerance", between("a tolerance", "", 1e-13, 0.1), time.explicit_tolerance);
  else if (t.has("tolerance"))
    t.fail("tolerance", "only step = \"adaptive\" and \"minimal_coordinates\" have one");
  time.step = t.number("step", positive("a time step", "s"), time.step);
  if (time.step > time.end) t.fail("step", "a time step is no longer than time.end [s]");
}

TimeSpan read_time(const Table& t) {
  TimeSpan time;
  time.end = t.number("end", positive("an end time", "s"));
  time.integrator = t.choice(
      "integrator", "an integrator",
      std::vector<std::string>{"generalized_alpha", "energy_momentum", "minimal_coordinates"},
      time.integrator);
  read_step(t, time);
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

/// A drive says itself how it starts.
void refuse_spin_up(const Table& t, const std::string& key, const Scene& scene) {
  if (scene.time.start == Start::hub_at_rest)
    t.fail(key,
           "time.start = \"hub_at_rest\" spins up hubs that turn at a constant rate, not "
           "driven ones");
}

/// Two numbers, or the names of two drives.
void read_position(const Table& t, const Scene& scene, Hub& hub) {
  if (t.is_list_of_strings("position")) {
    refuse_spin_up(t, "position", scene);
    const std::vector<std::string> names = t.choices("position", "a drive", names_of(scene.drives));
    if (names.size() != 2) t.fail("position", "two drives, of x and of y");
    for (size_t c = 0; c < 2; ++c) {
      hub.path[c].drive = names[c];
      hub.position[static_cast<int>(c)] = scene.motion_of(hub.path[c])(0).value;
    }
    return;
  }
  const std::vector<double> position =
      t.numbers("position", any_number("a position", "m"), 2, std::vector<double>{0, 0});
  hub.position = {position[0], position[1]};
}

Hub read_hub(const Table& t, const Scene& scene) {
  Hub hub;
  hub.name = read_name(t, "the name of a hub", scene);
  read_position(t, scene, hub);
  if (t.is_string("angle")) {
    refuse_spin_up(t, "angle", scene);
    hub.turn = read_law(t, "angle", any_number("an angle", "rad"), scene);
    hub.angle = scene.motion_of(hub.turn)(0).value;
    if (t.has("angular_velocity"))
      t.fail("angular_velocity", "the drive of `angle` says how the hub turns");
    return hub;
  }
  hub.angle = t.number("angle", any_number("an angle", "rad"), 0.0);
  const std::optional<double> rest = scene.statics ? std::optional<double>(0) : std::nullopt;
  hub.angular_velocity =
      t.number("angular_velocity", any_number("an angular velocity", "rad/s"), rest);
  if (scene.statics && hub.angular_velocity != 0)
    t.fail("angular_velocity", "in a [static] analysis hubs rest");
  return hub;
}

Flow read_flow(const Table& t, const Scene& scene) {
  Flow flow;
  if (t.has("length")) {
    if (t.has("speed"))
      t.fail("speed", "material flows at a `speed`, or as the drive `length` says");
    flow.length.drive = t.choice("length", "a drive", names_of(scene.drives));
  } else {
    flow.speed = t.number("speed", any_number("the speed of the material", "m/s"));
  }
  flow.max_length = t.number("max_length", positive("a length", "m"));
  flow.min_length = t.number("min_length", positive("a length", "m"), 0.3 * flow.max_length);
  return flow;
}

void read_plate(const Table& t, const Scene& scene, bool has_density, Body& body) {
  body.shape = t.choice("shape", "a shape set", plate_shapes(), "h16");
  body.space = t.choice("space", "a space", std::vector<std::string>{"plane", "space"}, "plane");
  if (!scene.bodies.empty() && scene.bodies.front().space != body.space)
    t.fail("space", "all bodies of a scene live in the plane, or all in space");
  if (scene.is_mechanism() && body.in_space())
    t.fail("space", "rigid bodies live in the plane: in their scenes plates do, too");
  read_terms(t, scene, body);
  // A drive of the length says how it starts, too.
  const bool driven = t.has("flow") && t.table("flow").has("length");
  body.length = t.number("length", positive("a length", "m"),
                         driven ? std::optional<double>(0) : std::nullopt);
  body.width = t.number("width", positive("a width", "m"));
  body.thickness = t.number("thickness", positive("a thickness", "m"));
  body.density = t.number("density", positive("a density", "kg/m^3"),
                          has_density ? std::nullopt : std::optional<double>(1));
  body.youngs_modulus = t.number("youngs_modulus", positive("Young's modulus", "Pa"));
  body.poisson_ratio = t.number("poisson_ratio", between("Poisson's ratio", "", 0, 0.5));
  const std::vector<int> elements =
      t.integers("elements", "a number of elements", 1, kMostElements, 2);
  body.elements = {elements[0], elements[1]};
  if (1.0 * elements[0] * elements[1] > kMostElements)
    t.fail("elements", "at most " + to_text(kMostElements) + " elements");

  const bool flows = body.element == "ale_ancf_plate";
  if (flows) {
    body.flow = read_flow(t.table("flow"), scene);
  } else if (t.has("flow")) {
    t.fail("flow", "material flows through \"ale_ancf_plate\" only");
  }
  if (flows && scene.statics) t.fail("element", "in a [static] analysis no material flows");
  body.lines = read_lines(t, body);
  for (const std::string& term : body.terms)
    if (body.has_free_lines() && !fem::term_row(term).free_lines)
      t.fail("terms", "\"" + term + "\" does not know free material lines ([[body.line]])");
}

Body read_body(const Table& t, const Scene& scene, bool has_gravity) {
  Body body;
  body.name = read_name(t, "the name of a body", scene);
  body.element = t.choice("element", "an element", element_names());
  // Nothing at rest asks for the density but weight.
  const bool has_density = !scene.statics || has_gravity;
  if (body.is_beam())
    read_beam(t, scene, has_density, body);
  else
    read_plate(t, scene, has_density, body);
  if (t.has("position")) {
    const auto at = t.numbers("position", any_number("a position", "m"), 2);
    body.position = Vec2(at[0], at[1]);
    body.angle = t.number("angle", any_number("an angle", "rad"), 0.0);
  }
  if (t.has("heat")) body.heat = read_heat(t.table("heat"), scene, body);
  return body;
}

PointMass read_point_mass(const Table& t, const Scene& scene) {
  PointMass mass;
  mass.body = t.choice("body", "a body", names_of(scene.bodies));
  mass.at = t.choice("at", "the place of a point mass", std::vector<std::string>{"free_end"});
  mass.mass = t.number("mass", positive("a mass", "kg"));
  return mass;
}

}  // namespace

void read_terms(const Table& t, const Scene& scene, Body& body) {
  body.terms = t.choices("terms", body.is_beam() ? "a term of a beam" : "a term",
                         fem::term_names(body.place()));
  if (const std::string why = fem::refusal_of_terms(body.place(), body.terms, !scene.statics);
      !why.empty())
    t.fail("terms", why);
  for (const std::string& term : body.terms)
    for (const fem::TermKey& key : fem::term_row(term).keys) {
      if (key.whole) {
        std::optional<int> fallback;
        if (key.fallback) fallback = static_cast<int>(*key.fallback);
        body.numbers[key.name] = t.integer(key.name, key.noun, static_cast<int>(key.low),
                                           static_cast<int>(key.high), fallback);
        continue;
      }
      const io::Quantity quantity{key.noun, key.unit, key.low, key.high, key.low_open};
      body.numbers[key.name] = t.number(key.name, quantity, key.fallback);
    }
}

void read_motion(const Table& root, const Follow& follow, Scene& scene) {
  if (root.has("static")) {
    for (const char* key :
         {"time", "drive", "constants", "esl", "design", "optimizer", "cycle", "verify"})
      if (root.has(key))
        root.fail(key, "a scene with a [static] analysis has no '" + std::string(key) + "'");
    scene.statics = read_analysis(root.table("static"));
  } else {
    scene.time = read_time(root.table("time"));
  }
  read_drives(root, scene);
  for (const Table& t : root.tables("hub")) scene.hubs.push_back(read_hub(t, scene));
  read_rigid_bodies(root, scene);
  const std::vector<Table> bodies = root.tables("body");
  if (bodies.empty() && !scene.is_mechanism())
    root.fail("body", "a scene has one or more [[body]]");
  for (const Table& t : bodies) scene.bodies.push_back(read_body(t, scene, root.has("gravity")));
  if (root.has("gravity")) {
    const auto gravity =
        root.numbers("gravity", any_number("gravity", "m/s^2"), scene.in_space() ? 3 : 2);
    scene.gravity = Eigen::Map<const VectorXd>(gravity.data(), scene.in_space() ? 3 : 2);
  }
  const auto follow_lengths = [&](bool trajectory) {
    for (size_t i = 0; i < bodies.size(); ++i)
      if (Body& b = scene.bodies[i];
          b.flow && scene.follows_trajectory(b.flow->length) == trajectory)
        follow_length(bodies[i].table("flow"), scene, b);
  };
  follow_lengths(false);
  if (root.has("trajectory")) read_trajectory(root, follow, scene);
  follow_lengths(true);
  read_joints(root, scene);
  read_springs(root, scene);
  check_mechanism_parts(root, scene);
  for (const Table& t : root.tables("point_mass"))
    scene.point_masses.push_back(read_point_mass(t, scene));
  read_loads(root, scene);
  read_observed(root, scene);
  read_measures(root, scene);
  if (scene.statics) {
    read_growing(root, scene);
    return;
  }

  const Table time = root.table("time");
  if (scene.time.integrator != "generalized_alpha" && scene.has_free_lines())
    time.fail("integrator", "free material lines ([[body.line]]) need \"generalized_alpha\": \"" +
                                scene.time.integrator + "\" does not know them");
  // Without a hub there is nothing to be stretched by, and a free line starts where it is put.
  if (!scene.is_mechanism() && (scene.hubs.empty() || scene.has_free_lines())) {
    if (time.has("start") && scene.time.start == Start::prestretched)
      time.fail("start", "\"prestretched\" is for bodies in hubs whose lines are not free");
    if (scene.time.start == Start::prestretched) scene.time.start = Start::rigid;
  }
}

}  // namespace flexmorph::cases
