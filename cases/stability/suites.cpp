#include "cases/stability/suites.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "cases/stability/overrides.h"
#include "cases/study/study.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Rows = std::vector<Perturbation>;

constexpr int kShortSteps = 40;  // of a row that is about nothing else

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
      if (density > 0 && !scene.statics)
        row.overrides.push_back(entry("body", i, "density", density));
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

/// Elements next to the root of a fraction of their neighbours: by a line of their own, or, where
/// material flows, by how much of them has gone into the hub at the end.
Rows boundary(const Scene& scene) {
  Rows out;
  if (scene.domain) return out;
  for (const double fraction : {1e-6, 1e-4, 1e-2, 0.5}) {
    Perturbation row;
    row.parameter = "boundary element = " + to_text(fraction) + " of its neighbour";
    const double end = std::min(scene.time.end, kShortSteps * scene.time.step);
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
      const Body& body = scene.bodies[i];
      const double element = body.length / body.elements[0];
      if (!body.row->lines || body.elements[0] < 2 || body.is_even()) continue;
      if (body.flow && body.flow->length.drive.empty()) {
        row.overrides.push_back(entry("body", i, "flow.speed", -element * (1 - fraction) / end));
        row.overrides.push_back(entry("body", i, "flow.min_length", 0.5 * fraction * element));
      } else if (!body.flow && body.lines.empty()) {
        // From line 1 to line 2 it is the rest of two elements.
        row.overrides.push_back(entry_text(
            "body", i, "line",
            "[{ index = 1, at = " + to_text(2 * element * fraction / (1 + fraction)) + " }]"));
      } else if (!body.flow && body.lines.size() == 1 && body.lines[0].free && body.lines[0].at) {
        const int line = body.lines[0].index;
        const double before = element * (line - 1), after = element * (line + 1);
        row.overrides.push_back("body." + to_text(static_cast<int>(i)) + ".line.0.at=" +
                                to_text(before + (after - before) * fraction / (1 + fraction)));
      }
    }
    if (!row.overrides.empty()) out.push_back(std::move(row));
  }
  return out;
}

Rows step(const Scene& scene) {
  Rows out;
  if (scene.statics)
    for (const int steps : {1, 2, 100})
      out.push_back({to_text(steps) + " steps", {"static.steps=" + to_text(steps)}});
  if (scene.domain || scene.statics) return out;
  for (const double h : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
    if (h > scene.time.end) continue;
    out.push_back({"h = " + to_text(h) + " s",
                   {"time.step=" + to_text(h), end_after(scene, h, kShortSteps)}});
  }
  return out;
}

Rows rho_inf(const Scene& scene) {
  Rows out;
  if (scene.domain || scene.statics || scene.time.integrator != "generalized_alpha") return out;
  for (const double rho : {0.0, 0.5, 1.0}) {
    out.push_back({"rho_inf = " + to_text(rho), {"time.rho_inf=" + to_text(rho)}});
    out.back().demand = Demand::runs;
  }
  return out;
}

/// Hubs and cranks at so many turns per second, at the step of the case and at 200 to a turn.
Rows spin(const Scene& scene) {
  Rows out;
  if (scene.domain || scene.statics) return out;
  for (const double turns : {1.0, 10.0, 100.0})
    for (const bool fine : {false, true}) {
      Perturbation row;
      const double omega = 2 * std::numbers::pi * turns;
      for (size_t i = 0; i < scene.hubs.size(); ++i)
        if (scene.hubs[i].turn.drive.empty())
          row.overrides.push_back(entry("hub", i, "angular_velocity", omega));
      for (const Joint& joint : scene.joints)
        for (size_t i = 0; joint.row->drives_angle && i < scene.drives.size(); ++i) {
          const Drive& drive = scene.drives[i];
          if (drive.from_trajectory || joint.laws.empty() || drive.name != joint.laws[0].drive)
            continue;
          row.overrides.push_back(entry_text("drive", i, "formula",
                                             std::string("\"")
                                                 .append(to_text(drive.motion(0).value))
                                                 .append(" + ")
                                                 .append(to_text(omega))
                                                 .append("*t\"")));
        }
      if (row.overrides.empty()) return out;
      const double h = fine ? 1 / (200 * turns) : scene.time.step;
      row.parameter = to_text(turns) + " rev/s, h = " + to_text(h, 3) + " s";
      row.overrides.push_back("time.step=" + to_text(h));
      row.overrides.push_back(end_after(scene, h, kShortSteps));
      out.push_back(std::move(row));
    }
  return out;
}

Rows temperature(const Scene& scene) {
  Rows out;
  if (scene.domain) return out;
  const auto add = [&](const std::string& name, const auto& change) {
    Perturbation row;
    row.parameter = name;
    for (size_t i = 0; i < scene.bodies.size(); ++i)
      if (const auto& heat = scene.bodies[i].heat; heat && heat->rise.drive.empty())
        change(row, i, *heat);
    if (!row.overrides.empty()) out.push_back(std::move(row));
  };
  for (const double rise : {0.0, 1e-9, 1000.0, -1000.0, 1e4})
    add("rise = " + to_text(rise) + " K", [&](Perturbation& row, size_t i, const BodyHeat&) {
      row.overrides.push_back(entry("body", i, "heat.rise", rise));
      if (rise == 0 && !scene.statics) row.demand = Demand::runs;  // an arc of nothing is refused
    });
  add("1 + expansion rise = -0.01", [](Perturbation& row, size_t i, const BodyHeat& heat) {
    row.overrides.push_back(entry("body", i, "heat.rise", -1.01 / heat.expansion));
    row.demand = Demand::refused;
  });
  if (scene.statics) return out;
  for (const char* profile : {"step", "linear", "cosine"})
    add(std::string("profile ") + profile, [&](Perturbation& row, size_t i, const BodyHeat&) {
      row.overrides.push_back(entry_text("body", i, "heat.profile", profile));
    });
  add("settles within a step", [&](Perturbation& row, size_t i, const BodyHeat&) {
    row.overrides.push_back(entry("body", i, "heat.settle", scene.time.step));
  });
  return out;
}

/// Starts far from consistent: rigid bodies off their places, with velocities no joint allows; or
/// another way to start.
Rows start(const Scene& scene) {
  Rows out;
  if (scene.domain || scene.statics) return out;
  for (const char* name : {"rigid", "prestretched", "hub_at_rest"})
    out.push_back({std::string("start ") + name, {std::string("time.start=") + name}});
  for (const double off : {1e-6, 1e-2, 0.3, 10.0}) {
    Perturbation row;
    row.parameter = "rigid bodies off by " + to_text(off) + " m";
    for (size_t i = 0; i < scene.rigid_bodies.size(); ++i) {
      const Vec2 at = scene.rigid_bodies[i].position;
      row.overrides.push_back(entry_text("rigid_body", i, "position",
                                         vector_of(Vec2(at.x() + off, at.y() - 0.7 * off))));
    }
    if (!row.overrides.empty()) out.push_back(std::move(row));
  }
  Perturbation turned{"rigid bodies turned by 1 rad", {}}, fast{"rigid bodies at 100 m/s", {}};
  for (size_t i = 0; i < scene.rigid_bodies.size(); ++i) {
    turned.overrides.push_back(entry("rigid_body", i, "angle", scene.rigid_bodies[i].angle + 1));
    fast.overrides.push_back(entry_text("rigid_body", i, "velocity", "[100, -70]"));
  }
  if (!turned.overrides.empty()) out.insert(out.end(), {turned, fast});
  return out;
}

}  // namespace

const std::vector<Suite>& suites() {
  static const std::vector<Suite> kSuites = [] {
    std::vector<Suite> out = {
        {"stiffness", "stiff, soft, thin and massless bodies", false, Part::motion, stiffness},
        {"boundary", "elements at the root that are tiny beside their neighbours", false,
         Part::motion, boundary},
        {"step", "steps from 1e-6 to 0.1 s; few and many steps of load", false, Part::motion, step},
        {"rho_inf", "spectral radii 0, 0.5, 1", false, Part::motion, rho_inf},
        {"spin", "hubs and cranks at 1 to 100 turns per second", false, Part::motion, spin},
        {"temperature", "steps, large and negative rises", false, Part::motion, temperature},
        {"start", "starts far from consistent", false, Part::motion, start}};
    for (const auto& more : {event_suites(), design_suites()})
      out.insert(out.end(), more.begin(), more.end());
    return out;
  }();
  return kSuites;
}

std::vector<std::string> suite_names() {
  std::vector<std::string> out;
  for (const Suite& each : suites()) out.push_back(each.name);
  return out;
}

const Suite& suite(const std::string& name) {
  std::string known;
  for (const Suite& each : suites()) {
    if (each.name == name) return each;
    known += (known.empty() ? "" : ", ") + each.name;
  }
  throw Error::input("--suites " + name + ": no such suite; there are: " + known);
}

std::vector<std::string> short_overrides(const Scene& scene, Part part) {
  std::vector<std::string> out = lean_overrides(scene, part);
  out.insert(out.end(), {"accuracy="});
  if (scene.domain || scene.statics) return out;
  if (part == Part::motion) {
    out.push_back(end_after(scene, scene.time.step, kShortSteps));
  } else {  // one load
    out.push_back("time.end=" + to_text(scene.esl->every));
    // Cells have to divide the longest length, which the end decides: so many of them always do.
    for (size_t i = 0; i < scene.designs.size(); ++i)
      if (const auto& flow = scene.body(scene.designs[i].body).flow;
          flow && !flow->length.drive.empty()) {
        out.push_back(entry_text("design", i, "cell", ""));
        out.push_back(entry_text("design", i, "cells", "[120, 20]"));
      }
  }
  return out;
}

std::string end_after(const Scene& scene, double step, int steps) {
  return "time.end=" + to_text(std::max(step, std::min(scene.time.end, steps * step)));
}

std::string entry(const std::string& list, size_t index, const std::string& key, double value) {
  return entry_text(list, index, key, to_text(value));
}

std::string vector_of(const VectorXd& v) {
  std::string out = "[";
  for (int i = 0; i < v.size(); ++i) out.append(i > 0 ? ", " : "").append(to_text(v[i]));
  return out + "]";
}

std::string entry_text(const std::string& list, size_t index, const std::string& key,
                       const std::string& value) {
  return list + "." + std::to_string(index) + "." + key + "=" + value;
}

}  // namespace flexmorph::cases
