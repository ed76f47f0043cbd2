#include "cases/stability/suites.h"

#include <algorithm>
#include <numbers>
#include <ranges>

#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "cases/study/study.h"
#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Rows = std::vector<Perturbation>;

constexpr int kShortSteps = 40;     // largest number of steps of a shortened motion
constexpr double kLongSteps = 1e5;  // number of steps in the suite "long"

/// Returns an override of a list of tables: "body.0.thickness=0.0001".
std::string entry(const std::string& list, size_t index, const std::string& key,
                  const std::string& value) {
  return list + "." + std::to_string(index) + "." + key + "=" + value;
}
std::string entry(const std::string& list, size_t index, const std::string& key, double value) {
  return entry(list, index, key, to_text(value));
}

std::string list_of(const VectorXd& v) {
  std::string out = "[";
  for (int i = 0; i < v.size(); ++i) out.append(i > 0 ? ", " : "").append(to_text(v[i]));
  return out + "]";
}

bool moves(const Scene& scene) { return !scene.domain && !scene.statics; }

std::string end_after(const Scene& scene, double step) {
  return "time.end=" + to_text(std::max(step, std::min(scene.time.end, kShortSteps * step)));
}

Rows stiffness(const Scene& scene) {
  if (scene.domain || scene.bodies.empty()) return {};
  Rows out;
  const auto add = [&](const std::string& name, double modulus, double thickness, double density) {
    Perturbation& row = out.emplace_back();
    row.parameter = name;
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
      if (modulus > 0) row.overrides.push_back(entry("body", i, "youngs_modulus", modulus));
      if (thickness > 0)
        row.overrides.push_back(entry("body", i, scene.bodies[i].row->thinnest, thickness));
      if (density > 0) row.overrides.push_back(entry("body", i, "density", density));
    }
  };
  add("E = 2e11 Pa", 2e11, 0, 0);
  add("E = 1e3 Pa", 1e3, 0, 0);
  add("thickness = 1e-4 m", 0, 1e-4, 0);
  add("E = 2e11 Pa, thickness = 1e-4 m", 2e11, 1e-4, 0);
  if (scene.statics) return out;
  add("density = 1e-6 kg/m^3", 0, 0, 1e-6);
  add("E = 2e11 Pa, density = 1e-3 kg/m^3", 2e11, 0, 1e-3);
  return out;
}

Rows step(const Scene& scene) {
  Rows out;
  if (scene.statics)
    for (const int steps : {1, 2, 100})
      out.push_back({to_text(steps) + " steps", {"static.steps=" + to_text(steps)}});
  if (!moves(scene)) return out;
  for (const double h : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1})
    if (h <= scene.time.end)
      out.push_back({"h = " + to_text(h) + " s", {"time.step=" + to_text(h), end_after(scene, h)}});
  return out;
}

Rows rho_inf(const Scene& scene) {
  Rows out;
  if (!moves(scene) || scene.time.integrator != "generalized_alpha") return out;
  for (const double rho : {0.0, 0.5, 1.0})
    out.push_back({"rho_inf = " + to_text(rho), {"time.rho_inf=" + to_text(rho)}});
  return out;
}

/// Returns overrides with which all hubs (rigid frames with prescribed motion) and driven cranks
/// turn at a constant rate; none if nothing turns.
/// @param omega  rate [rad/s]
std::vector<std::string> turning(const Scene& scene, double omega) {
  std::vector<std::string> out;
  for (size_t i = 0; i < scene.hubs.size(); ++i)
    if (scene.hubs[i].turn.drive.empty()) out.push_back(entry("hub", i, "angular_velocity", omega));
  for (const Joint& joint : scene.joints) {
    if (!joint.row->drives_angle || joint.laws.empty()) continue;
    for (size_t i = 0; i < scene.drives.size(); ++i) {
      const Drive& drive = scene.drives[i];
      if (drive.from_trajectory || drive.name != joint.laws[0].drive) continue;
      std::string formula = "\"" + to_text(drive.motion(0).value);
      formula.append(" + ").append(to_text(omega)).append("*t\"");
      out.push_back(entry("drive", i, "formula", formula));
    }
  }
  return out;
}

/// Returns runs with fast turns, with the time step of the case and with 200 steps per turn.
Rows spin(const Scene& scene) {
  Rows out;
  if (!moves(scene)) return out;
  for (const double turns : {1.0, 10.0, 100.0})
    for (const double h : {scene.time.step, 1 / (200 * turns)}) {
      Perturbation row{to_text(turns) + " rev/s, h = " + to_text(h, 3) + " s",
                       turning(scene, 2 * std::numbers::pi * turns)};
      if (row.overrides.empty()) return out;
      row.overrides.insert(row.overrides.end(), {"time.step=" + to_text(h), end_after(scene, h)});
      out.push_back(std::move(row));
    }
  return out;
}

Rows temperature(const Scene& scene) {
  Rows out;
  if (scene.domain) return out;
  const auto add = [&](const std::string& name, const std::string& key, const std::string& value) {
    Perturbation row{name, {}};
    for (size_t i = 0; i < scene.bodies.size(); ++i)
      if (const auto& heat = scene.bodies[i].heat; heat && heat->rise.drive.empty())
        row.overrides.push_back(entry("body", i, "heat." + key, value));
    if (!row.overrides.empty()) out.push_back(std::move(row));
  };
  for (const double rise : {1000.0, -1000.0, 1e4})
    add("rise = " + to_text(rise) + " K", "rise", to_text(rise));
  if (scene.statics) return out;
  for (const char* profile : {"step", "linear", "cosine"})
    add(std::string("profile ") + profile, "profile", profile);
  add("settling time of one step", "settle", to_text(scene.time.step));
  return out;
}

/// Returns runs in which gravity and all constant loads are multiplied by a factor.
Rows loads(const Scene& scene) {
  Rows out;
  for (const double factor : {0.01, 100.0}) {
    Perturbation row{"loads times " + to_text(factor), {}};
    if (scene.gravity && !scene.gravity_law().varies())
      row.overrides.push_back("gravity=" + list_of(factor * *scene.gravity));
    for (size_t i = 0; i < scene.loads.size(); ++i) {
      const BodyLoad& load = scene.loads[i];
      if (load.law.varies()) continue;
      row.overrides.push_back(
          load.force.size() > 0 ? entry("load", i, load.row->key.name, list_of(factor * load.force))
                                : entry("load", i, load.row->key.name, factor * load.size));
    }
    if (!row.overrides.empty()) out.push_back(std::move(row));
  }
  return out;
}

/// Returns runs in which the void of all designs has the same small scale factor.
Rows voids(const Scene& scene) {
  Rows out;
  for (const double factor : {1e-3, 1e-5, 1e-7, 1e-9}) {
    Perturbation row{"void scale factor " + to_text(factor), {}, Part::design};
    for (size_t i = 0; i < scene.designs.size(); ++i) {
      row.overrides.push_back(entry("design", i, "alpha", factor));
      if (!scene.domain) row.overrides.push_back(entry("design", i, "stiffness_void", factor));
    }
    if (!row.overrides.empty()) out.push_back(std::move(row));
  }
  return out;
}

/// Returns runs of 1e5 steps with one element per body, for motions without drives, hubs, loads,
/// heat and free lines of the mesh.
Rows long_runs(const Scene& scene) {
  Rows out;
  if (!moves(scene) || scene.has_eulerian_lines() || scene.has_heat() || !scene.hubs.empty() ||
      !scene.drives.empty() || !scene.loads.empty())
    return out;
  const auto add = [&](const std::string& name, double step, const std::string& scheme) {
    Perturbation& row = out.emplace_back();
    row.parameter = "1e5 steps, " + name;
    for (size_t i = 0; i < scene.bodies.size(); ++i)
      row.overrides.push_back(
          entry("body", i, "elements", scene.bodies[i].row->across ? "[1, 1]" : "1"));
    row.overrides.insert(row.overrides.end(), {scheme, "time.step=" + to_text(step),
                                               "time.end=" + to_text(kLongSteps * step)});
  };
  for (const std::string scheme : {"time.rho_inf=1", "time.rho_inf=0.9"}) {
    add(scheme, scene.time.step, scheme);
    add(scheme + ", a tenth of the time step", 0.1 * scene.time.step, scheme);
  }
  add("energy_momentum", scene.time.step, "time.integrator=energy_momentum");
  return out;
}

}  // namespace

const std::vector<Suite>& suites() {
  static const std::vector<Suite> kSuites = {{"stiffness", false, stiffness},
                                             {"step", false, step},
                                             {"rho_inf", false, rho_inf},
                                             {"spin", false, spin},
                                             {"temperature", false, temperature},
                                             {"loads", false, loads},
                                             {"void", false, voids},
                                             {"long", true, long_runs}};
  return kSuites;
}

const Suite& suite(const std::string& name) {
  for (const Suite& each : suites())
    if (each.name == name) return each;
  throw Error::input("--suites " + name + ": this suite is unknown; the suites are: " +
                     joined(std::views::transform(suites(), &Suite::name)));
}

std::vector<std::string> short_overrides(const Scene& scene, Part part) {
  std::vector<std::string> out = lean_overrides(scene, part);
  out.emplace_back("accuracy=");
  if (!moves(scene)) return out;
  if (part == Part::motion) {
    out.push_back(end_after(scene, scene.time.step));
    return out;
  }
  out.push_back("time.end=" + to_text(scene.esl->every));  // only one load time
  // The size of cells has to divide the largest length of the body, which depends on the end time.
  // Numbers of cells, as 120 x 20, fit every length.
  for (size_t i = 0; i < scene.designs.size(); ++i)
    if (const auto& flow = scene.body(scene.designs[i].body).flow;
        flow && !flow->length.drive.empty()) {
      out.push_back(entry("design", i, "cell", ""));
      out.push_back(entry("design", i, "cells", "[120, 20]"));
    }
  return out;
}

}  // namespace flexmorph::cases
