#include <algorithm>
#include <cmath>

#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "cases/stability/judge.h"
#include "cases/stability/overrides.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Rows = std::vector<Perturbation>;

/// Energy of a uniform strain of one, in all bodies: what energies are small against [J].
double stiff_energy(const Scene& scene) {
  double out = 0;
  for (const Body& body : scene.bodies)
    out += body.youngs_modulus * body.longest(scene.time.end) * body.width * body.thickness;
  return out;
}

/// A load across the middle of the first body, as more TOML.
std::string load_text(const Scene& scene, double size) {
  const Body& body = scene.bodies.front();
  VectorXd force = VectorXd::Zero(body.dim());
  force[body.dim() - 1] = -size;
  const VectorXd middle = Vec2(0.5 * body.length_at(0), body.low() + 0.5 * body.width);
  return "\n[[load]]\ntype = \"point\"\nbody = \"" + body.name +
         "\"\npoint = " + vector_of(middle) + "\nforce = " + vector_of(force) + "\n";
}

Rows domain_loads(const Scene& scene) {
  Rows out;
  for (const double factor : {1e-12, 1e6}) {
    Perturbation& row = out.emplace_back();
    row.parameter = "all loads times " + to_text(factor);
    row.part = Part::design;
    row.demand = Demand::runs;
    for (size_t l = 0; l < scene.domain->loads.size(); ++l)
      for (size_t f = 0; f < scene.domain->loads[l].forces.size(); ++f)
        row.overrides.push_back(
            entry_text("load", l, "force." + std::to_string(f) + ".force",
                       vector_of(factor * scene.domain->loads[l].forces[f].force)));
    for (const char* name : {"compliance", "sharp_compliance"})
      row.invariances.push_back(
          {name, {}, factor * factor, 1e-9, 0, true, "compliance goes with the load squared"});
    row.invariances.push_back({"volume", {}, 1, 1e-12, 0, true, "loads have no volume"});
  }
  const PlaneForce& first = scene.domain->loads.front().forces.front();
  for (const double size : {1e-12, 1e6}) {
    Perturbation& row = out.emplace_back();
    row.parameter = to_text(size) + " N beside the other loads";
    row.part = Part::design;
    row.demand = Demand::runs;
    const Box& box = first.place.box;
    row.appended =
        "\n[[load]]\nname = \"beside\"\n[[load.force]]\nbox = " +
        vector_of(Eigen::Vector4d(box.lower.x(), box.lower.y(), box.upper.x(), box.upper.y())) +
        "\nforce = " + vector_of(Vec2(0, -size)) + "\n";
    if (size < 1)
      row.invariances.push_back({"compliance", {}, 1, 1e-12, 0, true, "the load is nothing"});
  }
  return out;
}

Rows loads(const Scene& scene) {
  if (scene.domain) return domain_loads(scene);
  Rows out;
  if (scene.bodies.empty()) return out;
  const double nothing = 1e-20 * stiff_energy(scene);
  Perturbation& tiny = out.emplace_back();
  tiny.parameter = "1e-12 N beside the other loads";
  tiny.appended = load_text(scene, 1e-12);
  for (const char* name : {"energy.kinetic", "energy.strain"})
    if (!scene.statics || name == std::string("energy.strain"))
      tiny.invariances.push_back({name, {}, 1, 1e-6, nothing, true, "the load is nothing"});
  for (const double size : {1e3, 1e6}) {
    Perturbation& row = out.emplace_back();
    row.parameter = to_text(size) + " N beside the other loads";
    row.appended = load_text(scene, size);
  }
  return out;
}

/// Nothing happens, and that is a valid scene.
Rows rest(const Scene& scene) {
  Rows out;
  if (scene.domain || !scene.springs.empty()) return out;
  Perturbation& row = out.emplace_back();
  row.parameter = "no weight, no load, no speed, no heat";
  if (!scene.statics) row.demand = Demand::runs;  // a path without a load is refused
  row.overrides = {"gravity=", "load="};
  for (size_t i = 0; i < scene.hubs.size(); ++i)
    if (scene.hubs[i].turn.drive.empty() && !scene.statics)
      row.overrides.push_back(entry("hub", i, "angular_velocity", 0));
  for (size_t i = 0; i < scene.drives.size(); ++i) {
    if (scene.drives[i].from_trajectory) continue;
    for (const char* key : {"csv", "column", "time", "table"})
      row.overrides.push_back(entry_text("drive", i, key, ""));
    row.overrides.push_back(
        entry_text("drive", i, "formula", "\"" + to_text(scene.drives[i].motion(0).value) + "\""));
  }
  for (size_t i = 0; i < scene.rigid_bodies.size(); ++i)
    for (const char* key : {"velocity", "angular_velocity"})
      row.overrides.push_back(entry_text("rigid_body", i, key, ""));
  for (size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].flow && scene.bodies[i].flow->length.drive.empty())
      row.overrides.push_back(entry("body", i, "flow.speed", 0));
    if (scene.bodies[i].heat && scene.bodies[i].heat->rise.drive.empty())
      row.overrides.push_back(entry("body", i, "heat.rise", 0));
  }
  for (size_t i = 0; i < scene.joints.size(); ++i)
    if (scene.joints[i].drives_line && scene.joints[i].at.drive.empty())
      row.overrides.push_back(entry("joint", i, "speed", 0));
  const double nothing = 1e-18 * stiff_energy(scene);
  row.invariances.push_back(
      {"energy.strain.largest", 0, 1, 0, nothing, true, "nothing happens at rest"});
  if (!scene.statics)
    row.invariances.push_back(
        {"energy.kinetic.largest", 0, 1, 0, nothing, true, "nothing happens at rest"});
  return out;
}

/// Steps that do not fall on the times at which lines of nodes come in. The first is due when the
/// boundary element reaches max_length; its half then grows for as long as (max_length / 2) /
/// speed.
Rows insertion(const Scene& scene) {
  Rows out;
  if (scene.domain) return out;
  for (const Body& body : scene.bodies) {
    if (!body.flow || body.is_even()) continue;
    if (!body.flow->length.drive.empty()) {
      for (const double steps : {25.0, 60.0}) {
        const double h = scene.time.end / steps;
        out.push_back({"h = " + to_text(h, 3) + " s over all changes",
                       {"time.step=" + to_text(h), "time.end=" + to_text(scene.time.end)}});
      }
      return out;
    }
    if (!(body.flow->speed > 0)) return out;
    const double element = body.length / body.elements[0];
    const double first = (body.flow->max_length - element) / body.flow->speed;
    const double again = 0.5 * body.flow->max_length / body.flow->speed;
    if (!(first > 0)) return out;
    const auto add = [&](const std::string& name, double h, double end, double events) {
      out.push_back({name, {"time.step=" + to_text(h), "time.end=" + to_text(end)}});
      out.back().invariances.push_back(
          {"events", events, 1, 0, 0.5, true, "lines come in when max_length is reached"});
    };
    const double late = first + 0.4 * again;
    add("h = 0.37 of the time to the insertion", 0.37 * first, late, 1);
    add("h = 0.07 of the time to the insertion", 0.07 * first, late, 1);
    add("h = 1/30 of the time to the insertion", first / 30, late, 1);
    add("h reaches over two insertions", 0.05 * late, first + 1.4 * again, 2);
    add("the end is the insertion", first / 25, first, 0);
    return out;
  }
  return out;
}

/// 1e5 steps of one element per body.
Rows long_runs(const Scene& scene) {
  Rows out;
  if (scene.domain || scene.statics || scene.has_free_lines() || !bounds_of(scene).undriven)
    return out;
  const auto add = [&](const std::string& name, double step, const std::string& scheme) {
    Perturbation& row = out.emplace_back();
    row.parameter = "1e5 steps, " + name;
    row.demand = Demand::runs;
    for (size_t i = 0; i < scene.bodies.size(); ++i)
      row.overrides.push_back(
          entry_text("body", i, "elements", scene.bodies[i].row->across ? "[1, 1]" : "1"));
    row.overrides.insert(row.overrides.end(),
                         {scheme, "time.step=" + to_text(step), "time.end=" + to_text(1e5 * step)});
  };
  // Soft bodies buckle and collapse in so long a time: a step that cannot follow that is refused.
  for (const char* scheme : {"time.rho_inf=1", "time.rho_inf=0.9"}) {
    add(scheme, scene.time.step, scheme);
    out.back().demand = Demand::none;
    add(std::string(scheme) + ", a tenth of the step", 0.1 * scene.time.step, scheme);
  }
  add("energy_momentum", scene.time.step, "time.integrator=energy_momentum");
  return out;
}

/// Joints that hold nothing, and joints that hold twice.
Rows joints(const Scene& scene) {
  Rows out;
  if (scene.domain) {
    out.push_back({"a support without a direction", {"support.0.fix=[]"}, Part::design});
    out.back().demand = Demand::refused;
    return out;
  }
  for (size_t i = 0; i < scene.joints.size(); ++i) {
    const Joint& joint = scene.joints[i];
    const bool pin = joint.row->holds_point;
    if (!pin && !joint.holds_edges()) continue;
    out.push_back({"joint " + std::to_string(i + 1) + " holds nothing",
                   {entry_text("joint", i, pin ? "components" : "edges", "[]")}});
    out.back().demand = Demand::refused;
    if (!pin || joint.body.empty()) continue;
    Perturbation twice{"joint " + std::to_string(i + 1) + " twice", {}};
    twice.appended = "\n[[joint]]\ntype = \"pin\"\nbody = \"" + joint.body +
                     "\"\npoint = " + vector_of(joint.point) + "\n";
    twice.demand = Demand::refused;
    out.push_back(std::move(twice));
  }
  return out;
}

/// All files a case can write.
Rows outputs(const Scene& scene) {
  Perturbation row{"all files", {"output.vtk=true", "output.plots=true"}};
  row.demand = Demand::runs;
  if (scene.domain) {
    row.part = Part::design;
    row.overrides.insert(row.overrides.end(), {"optimizer.max_iterations=2", "output.sharp_every=1",
                                               "output.design_every=1"});
  } else if (!scene.statics) {
    row.overrides.push_back("output.motion_every=" + to_text(4 * scene.time.step));
  }
  return {row};
}

}  // namespace

std::vector<Suite> event_suites() {
  return {{"loads", "1e-12 N beside other loads, and 1e6 N", false, Part::motion, loads},
          {"rest", "scenes in which nothing happens", false, Part::motion, rest},
          {"insertion", "steps that straddle changes of the mesh", false, Part::motion, insertion},
          {"joints", "joints that hold nothing or hold twice", false, Part::motion, joints},
          {"outputs", "every file a case can write", false, Part::motion, outputs},
          {"long", "1e5 steps of undriven scenes", true, Part::motion, long_runs}};
}

}  // namespace flexmorph::cases
