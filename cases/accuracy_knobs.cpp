#include "cases/accuracy_knobs.h"

#include <algorithm>
#include <cmath>

#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Overrides = std::vector<std::string>;

bool any_lines(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const Body& b) { return !b.lines.empty(); });
}

bool bends(const Scene& scene) {
  return !scene.bodies.empty() && std::all_of(scene.bodies.begin(), scene.bodies.end(),
                                              [](const Body& b) { return b.has("bending"); });
}

/// Is there a motion behind this part?
bool moves(const Scene& scene) { return !scene.domain && !scene.statics; }

std::string key(const std::string& body, const std::string& rest) {
  return "body." + body + "." + rest + "=";
}

std::string pair(int a, int b) {
  return std::string("[").append(to_text(a)).append(", ").append(to_text(b)).append("]");
}

/// A number of elements `factor` times as large; nothing where that is no whole number. A strip of
/// one element across stays one on coarser meshes.
std::optional<int> times(int count, double factor) {
  const double exact = count * factor;
  if (count == 1 && factor < 1) return 1;
  if (exact < 0.5 || std::abs(exact - std::round(exact)) > 1e-9) return {};
  return static_cast<int>(std::lround(exact));
}

std::string no_elements(const Scene& scene, Part) {
  if (scene.bodies.empty()) return "the case has no plates with elements";
  if (any_lines(scene)) return "[[body.line]] numbers lines of the case's own mesh";
  return "";
}

constexpr int kMostAlong =
    64;  // elements along a plate, where that is more than four times its own

/// All bodies refined together, limits of boundary elements with them.
std::vector<Level> mesh_levels(const Scene& scene, const io::CaseFile&) {
  std::vector<Level> out;
  for (const double factor : {0.25, 0.375, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0}) {
    Level level;
    level.h = 1 / factor;
    bool whole = factor <= 4 || scene.bodies.front().elements[0] * factor <= kMostAlong;
    for (const Body& b : scene.bodies) {
      const std::optional<int> m = times(b.elements[0], factor), n = times(b.elements[1], factor);
      whole = whole && m && n;
      if (!whole) break;
      level.name += (level.name.empty() ? "" : ", ") + to_text(*m) + " x " + to_text(*n);
      if (factor == 1) continue;
      level.overrides.push_back(key(b.name, "elements") + pair(*m, *n));
      if (!b.flow) continue;
      level.overrides.push_back(key(b.name, "flow.max_length") +
                                to_text(b.flow->max_length * level.h));
      level.overrides.push_back(key(b.name, "flow.min_length") +
                                to_text(b.flow->min_length * level.h));
    }
    if (whole) out.push_back(std::move(level));
  }
  return out;
}

std::optional<Theory> mesh_theory(const Scene& scene, Part part) {
  // Plates in the plane are held at edges whose corners are singular, pins and point loads are
  // singular, too; material that flows changes its mesh at times that depend on it.
  if (std::any_of(scene.joints.begin(), scene.joints.end(),
                  [](const Joint& j) { return j.type == "pin"; }) ||
      std::any_of(scene.loads.begin(), scene.loads.end(),
                  [](const BodyLoad& l) { return l.type == "point"; }))
    return {};
  if (part == Part::design || !bends(scene) || scene.bodies.front().shape != "h16") return {};
  if (std::any_of(scene.bodies.begin(), scene.bodies.end(),
                  [](const Body& b) { return b.mesh_changes(); }))
    return {};
  return Theory{4, "energy of cubic Hermite plates, 2 (3 + 1 - 2), Strang & Fix 1973"};
}

std::string other_shape(const Scene& scene) {
  return scene.bodies.front().shape == "h16" ? "h12" : "h16";
}

std::string no_shape(const Scene& scene, Part part) {
  if (part == Part::design) return "designs are analysed with cells";
  for (const Body& b : scene.bodies)
    if (b.shape != scene.bodies.front().shape) return "bodies have different shape sets";
  return no_elements(scene, part);
}

std::vector<Level> shape_levels(const Scene& scene, const io::CaseFile& file) {
  std::vector<Level> out = mesh_levels(scene, file);
  for (Level& level : out) {
    level.name = other_shape(scene) + " " + level.name;
    for (const Body& b : scene.bodies)
      level.overrides.push_back(key(b.name, "shape") + other_shape(scene));
  }
  return out;
}

std::optional<Theory> no_theory(const Scene&, Part) { return {}; }

std::string no_time(const Scene& scene, Part) {
  return moves(scene) ? "" : "nothing moves: there is no time";
}
std::string no_time_or_design(const Scene& scene, Part part) {
  return part == Part::design ? "of the motion only" : no_time(scene, part);
}

Level step_level(const Scene& scene, double factor) {
  Level level;
  level.h = factor;
  const double step = scene.time.step * factor;
  level.name = to_text(step) + " s";
  if (factor != 1) level.overrides = {"time.step=" + to_text(step)};
  return level;
}

std::vector<Level> step_levels(const Scene& scene, const io::CaseFile&) {
  std::vector<Level> out;
  for (const double factor : {4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625})
    if (scene.time.step * factor <= scene.time.end / 4) out.push_back(step_level(scene, factor));
  return out;
}

std::optional<Theory> step_theory(const Scene&, Part) {
  return Theory{2, "generalized-alpha, Arnold & Bruls 2007; energy_momentum: midpoint rule"};
}

std::string no_rho(const Scene& scene, Part part) {
  if (scene.time.integrator != "generalized_alpha") return "\"generalized_alpha\" has it";
  return no_time_or_design(scene, part);
}

std::vector<Level> rho_levels(const Scene& scene, const io::CaseFile&) {
  std::vector<double> values = {0, 0.2, 0.4, 0.6, 0.8, 0.9, 1, scene.time.rho_inf};
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  std::vector<Level> out;
  for (const double rho : values) {
    Level& level = out.emplace_back();
    level.name = to_text(rho);
    if (rho != scene.time.rho_inf) level.overrides = {"time.rho_inf=" + to_text(rho)};
  }
  return out;
}

std::string no_integrator(const Scene& scene, Part part) {
  if (scene.has_free_lines()) return "free lines need \"generalized_alpha\"";
  return no_time_or_design(scene, part);
}

std::vector<Level> integrator_levels(const Scene& scene, const io::CaseFile& file) {
  const std::string other =
      scene.time.integrator == "generalized_alpha" ? "energy_momentum" : "generalized_alpha";
  std::vector<Level> out = step_levels(scene, file);
  for (Level& level : out) {
    level.name = other + " " + level.name;
    level.overrides.push_back("time.integrator=" + other);
  }
  return out;
}

std::string no_bending(const Scene& scene, Part part) {
  return part == Part::motion && bends(scene) ? "" : "there is no bending at Gauss points";
}

std::vector<Level> quadrature_levels(const Scene& scene, const io::CaseFile&) {
  const int own = scene.bodies.front().bending_points;
  std::vector<Level> out;
  for (int points = std::min(3, own); points <= std::max(9, own); ++points) {
    Level& level = out.emplace_back();
    level.h = static_cast<double>(own) / points;
    level.name = to_text(points) + " x " + to_text(points);
    if (points == own) continue;
    for (const Body& b : scene.bodies)
      level.overrides.push_back(key(b.name, "bending_points") + to_text(points));
  }
  return out;
}

std::string no_path(const Scene& scene, Part part) {
  return scene.statics && part == Part::motion ? "" : "there is no path of equilibria";
}

std::vector<Level> path_levels(const Scene& scene, const io::CaseFile&) {
  std::vector<Level> out;
  const int own = scene.statics->steps;
  for (const double factor : {0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0}) {
    const auto steps = static_cast<int>(std::lround(own * factor));
    if (steps < 1 || (!out.empty() && out.back().h == static_cast<double>(own) / steps)) continue;
    Level& level = out.emplace_back();
    level.h = static_cast<double>(own) / steps;
    level.name = to_text(steps) + " steps";
    if (steps != own) level.overrides = {"static.steps=" + to_text(steps)};
  }
  return out;
}

}  // namespace

const std::vector<Knob>& knobs() {
  static const std::vector<Knob> table = [] {
    std::vector<Knob> rows = {
        {"elements", "elements", Approach::power, 2.5, true, no_elements, mesh_levels, mesh_theory},
        {"shape", "elements", Approach::power, 2.5, true, no_shape, shape_levels, no_theory},
        {"step", "step", Approach::power, 1, true, no_time, step_levels, step_theory},
        {"rho_inf", "step", Approach::power, 0, false, no_rho, rho_levels, no_theory},
        {"integrator", "step", Approach::power, 1, true, no_integrator, integrator_levels,
         step_theory},
        {"quadrature", "quadrature", Approach::fast, 1, true, no_bending, quadrature_levels,
         no_theory},
        {"load_steps", "load_steps", Approach::fast, 1, true, no_path, path_levels, no_theory},
    };
    for (Knob& row : design_knobs()) rows.push_back(std::move(row));
    return rows;
  }();
  return table;
}

std::vector<std::string> knob_names() {
  std::vector<std::string> out;
  for (const Knob& each : knobs()) out.push_back(each.name);
  return out;
}

const Knob& knob(const std::string& name) {
  std::string known;
  for (const Knob& each : knobs()) {
    if (each.name == name) return each;
    known += (known.empty() ? "" : ", ") + each.name;
  }
  throw Error::input("ladder '" + name + "' is not known; there are: " + known);
}

std::vector<std::string> lean_overrides(const Scene& scene, Part part) {
  Overrides out = {"output.vtk=false", "output.plots=false"};
  if (part == Part::motion) {
    if (scene.designs.empty()) return out;
    for (const char* name : {"design=", "optimizer=", "cycle=", "verify=", "esl="})
      out.emplace_back(name);
    return out;
  }
  for (const char* name : {"optimizer.max_iterations=0", "verify=", "output.sharp_every=0"})
    out.emplace_back(name);
  return out;
}

}  // namespace flexmorph::cases
