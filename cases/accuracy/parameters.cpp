#include "cases/accuracy/parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "cases/assembly/build.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/joints/row.h"
#include "fem/dynamics/integrators/energy_momentum.h"
#include "geometry/text.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Levels = std::vector<Level>;

const std::string kPoints = "bending_points";

bool any_lines(const Scene& scene) {
  return std::ranges::any_of(scene.bodies, [](const Body& b) { return !b.lines.empty(); });
}
bool bends(const Scene& scene) {
  const auto bends = [](const Body& b) { return b.number(kPoints) > 0; };
  return !scene.bodies.empty() && std::ranges::all_of(scene.bodies, bends);
}
bool mesh_changes(const Scene& scene) {
  return std::ranges::any_of(scene.bodies, &Body::mesh_changes);
}
bool is_beam(const Body& b) { return b.term_domain() == fem::TermDomain::beam; }
bool any_beams(const Scene& scene) { return std::ranges::any_of(scene.bodies, is_beam); }
bool all_beams(const Scene& scene) {
  return !scene.bodies.empty() && std::ranges::all_of(scene.bodies, is_beam);
}
bool is_explicit(const Scene& scene) { return scene.time.integrator == "minimal_coordinates"; }

/// Tells whether the scene has a motion.
bool moves(const Scene& scene) { return !scene.domain && !scene.statics; }

std::string key(const std::string& body, const std::string& rest) {
  return "body." + body + "." + rest + "=";
}

/// Returns the number of elements times `factor`; nothing if the result is not a whole number.
std::optional<int> times(int count, double factor) {
  const double exact = count * factor;
  if (exact < 0.5 || std::abs(exact - std::round(exact)) > 1e-9) return {};
  return static_cast<int>(std::lround(exact));
}

/// Returns the number of elements across the axis, times `factor`; nothing if it is not a whole
/// number. A beam always has one element across. A strip with one element across keeps it on
/// coarser meshes.
std::optional<int> across(const Body& b, double factor) {
  if (!b.row->across || (b.elements[1] == 1 && factor < 1)) return 1;
  return times(b.elements[1], factor);
}

std::string no_elements(const Scene& scene, Part) {
  if (scene.bodies.empty()) return "the case has no bodies with elements";
  if (any_lines(scene)) return "[[body.line]] contains line numbers of the mesh of the case";
  return "";
}

constexpr int kMaxAlong = 64;  // largest number of elements along the axis for factors above 4

/// Returns levels in which all bodies are refined by the same factor. The length limits of boundary
/// elements scale with the elements.
Levels mesh_levels(const Scene& scene, const io::CaseFile&) {
  Levels out;
  for (const double factor : {0.25, 0.375, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0}) {
    Level level;
    level.h = 1 / factor;
    bool whole = factor <= 4 || scene.bodies.front().elements[0] * factor <= kMaxAlong;
    for (const Body& b : scene.bodies) {
      const std::optional<int> m = times(b.elements[0], factor), n = across(b, factor);
      whole = whole && m && n;
      if (!whole) break;
      level.name += (level.name.empty() ? "" : ", ") + to_text(*m) +
                    (b.row->across ? " x " + to_text(*n) : " elements");
      if (factor == 1) continue;
      level.overrides.push_back(key(b.name, "elements") +
                                (b.row->across ? list_of({1.0 * *m, 1.0 * *n}) : to_text(*m)));
      if (!b.flow) continue;
      if (b.flow->max_length > 0)
        level.overrides.push_back(key(b.name, "flow.max_length") +
                                  to_text(b.flow->max_length * level.h));
      if (b.flow->min_length > 0)
        level.overrides.push_back(key(b.name, "flow.min_length") +
                                  to_text(b.flow->min_length * level.h));
    }
    if (whole) out.push_back(std::move(level));
  }
  return out;
}

std::optional<Theory> mesh_theory(const Scene& scene, Part part, const std::string&) {
  if (part == Part::design) return no_order("the motion only supplies the loads");
  if (all_beams(scene))
    return Theory{2,
                  "smooth motions; gradients across the axis are linear along it: "
                  "2 (1 + 1 - 1), Strang & Fix 1973"};
  if (any_beams(scene)) return {};
  if (std::ranges::any_of(scene.joints, [](const Joint& j) { return j.row->holds_point; }) ||
      std::ranges::any_of(scene.loads, [](const BodyLoad& l) { return l.row->at_point; }))
    return no_order("stresses are singular at pins and point loads");
  if (mesh_changes(scene))
    return no_order(
        "the mesh changes at times that depend on it, and the corners of held edges are singular");
  if (!bends(scene)) return no_order("stresses are singular at the corners of held edges");
  if (scene.bodies.front().shape != "h16")
    return no_order("the incomplete shape functions are not conforming in bending");
  return Theory{4, "smooth deflections, cubic Hermite: 2 (3 + 1 - 2), Strang & Fix 1973"};
}

std::string other_shape(const Scene& scene) {
  return scene.bodies.front().shape == "h16" ? "h12" : "h16";
}

std::string no_shape(const Scene& scene, Part part) {
  if (part == Part::design) return "designs are analysed on the design mesh";
  if (any_beams(scene)) return "beams have only one set of shape functions";
  for (const Body& b : scene.bodies)
    if (b.shape != scene.bodies.front().shape)
      return "the bodies have different sets of shape functions";
  return no_elements(scene, part);
}

Levels shape_levels(const Scene& scene, const io::CaseFile& file) {
  Levels out = mesh_levels(scene, file);
  for (Level& level : out) {
    level.name = other_shape(scene) + " " + level.name;
    for (const Body& b : scene.bodies)
      level.overrides.push_back(key(b.name, "shape") + other_shape(scene));
  }
  return out;
}

std::optional<Theory> no_theory(const Scene&, Part, const std::string&) { return {}; }

std::string no_model(const Scene& scene, Part) {
  return all_beams(scene) ? "" : "\"gcm\" and \"ecm\" are models of beams only";
}

/// Returns levels of the alternative beam model on all meshes. This model does not approximate the
/// model of the case, so its errors contain the difference of the models.
Levels model_levels(const Scene& scene, const io::CaseFile& file) {
  Levels out = mesh_levels(scene, file);
  for (Level& level : out) {
    std::string models;
    for (const Body& b : scene.bodies) {
      std::string terms;
      for (const std::string& term : b.terms) {
        const auto others = fem::alternatives(fem::term_row(term), b.term_domain());
        if (!others.empty()) models += (models.empty() ? "" : ", ") + others.front();
        terms += (terms.empty() ? "'" : ", '") + (others.empty() ? term : others.front()) + "'";
      }
      level.overrides.push_back(key(b.name, "terms") + "[" + terms + "]");
    }
    level.name = models + " " + level.name;
  }
  return out;
}

std::string no_time(const Scene& scene, Part) {
  return moves(scene) ? "" : "the case has no motion in time";
}
std::string no_time_or_design(const Scene& scene, Part part) {
  return part == Part::design ? "this series is for motions only" : no_time(scene, part);
}

Levels step_levels(const Scene& scene, const io::CaseFile&) {
  Levels out;
  for (const double factor : {4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625}) {
    const double step = scene.time.step * factor;
    if (step > scene.time.end / 4) continue;
    std::vector<std::string> changes = {"time.step=" + to_text(step)};
    if (scene.time.tolerance)
      changes.insert(changes.end(), {"time.tolerance=", "time.largest_step="});
    if (is_explicit(scene))
      changes.insert(changes.end(), {"time.integrator='generalized_alpha'", "time.tolerance="});
    const bool is_case = factor == 1 && !scene.time.tolerance && !is_explicit(scene);
    out.push_back(make_level(factor, to_text(step) + " s", is_case, changes));
  }
  return out;
}

std::optional<Theory> step_theory(const Scene& scene, Part part, const std::string&) {
  if (part == Part::design) return no_order("the loads are samples of the motion in time");
  if (mesh_changes(scene))
    return no_order("every mesh change excites axial vibrations that the steps do not resolve");
  if (scene.time.start == Start::rigid && !scene.bodies.empty())
    return no_order("the start excites axial vibrations that the steps do not resolve");
  return Theory{2, "steps that resolve the motion, Arnold & Bruls 2007"};
}

std::string no_adaptive(const Scene& scene, Part part) {
  if (scene.time.integrator != "generalized_alpha")
    return "only \"generalized_alpha\" estimates its local error";
  return no_time_or_design(scene, part);
}

std::string no_explicit(const Scene& scene, Part part) {
  if (mesh_changes(scene)) return "\"minimal_coordinates\" cannot change the mesh";
  if (!all_beams(scene) && !scene.bodies.empty())
    return "the high stiffness of plates requires implicit steps";
  return no_time_or_design(scene, part);
}

/// Returns levels of adaptive time steps.
/// @param own     tolerance of the case; 0: the case does not use this kind of adaptive steps
/// @param change  override that selects this kind of adaptive steps
Levels tolerance_levels(const std::vector<double>& tolerances, double own,
                        const std::string& change) {
  Levels out;
  for (const double tolerance : tolerances)
    out.push_back(make_level(tolerance / tolerances[tolerances.size() / 2],
                             "tolerance " + to_text(tolerance), tolerance == own,
                             {change, "time.tolerance=" + to_text(tolerance)}));
  return out;
}

Levels adaptive_levels(const Scene& scene, const io::CaseFile&) {
  return tolerance_levels({1e-2, 1e-3, 1e-4, 1e-5, 1e-6}, scene.time.tolerance.value_or(0),
                          "time.step='adaptive'");
}

Levels explicit_levels(const Scene& scene, const io::CaseFile&) {
  return tolerance_levels({1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8},
                          is_explicit(scene) ? scene.time.explicit_tolerance : 0,
                          "time.integrator='minimal_coordinates'");
}

std::optional<Theory> tolerance_theory(const Scene&, Part, const std::string&) {
  return no_order(
      "steps end at other times if the tolerance changes, so errors scatter about order 1");
}

std::string no_rho(const Scene& scene, Part part) {
  if (scene.time.integrator != "generalized_alpha")
    return "only \"generalized_alpha\" has this parameter";
  return no_time_or_design(scene, part);
}

Levels rho_levels(const Scene& scene, const io::CaseFile&) {
  std::vector<double> values = {0, 0.2, 0.4, 0.6, 0.8, 0.9, 1, scene.time.rho_inf};
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  Levels out;
  for (const double rho : values)
    out.push_back(
        make_level(1, to_text(rho), rho == scene.time.rho_inf, {"time.rho_inf=" + to_text(rho)}));
  return out;
}

std::string no_integrator(const Scene& scene, Part part) {
  if (scene.has_eulerian_lines()) return "free mesh lines need \"generalized_alpha\"";
  if (scene.time.tolerance || is_explicit(scene)) return "the case uses adaptive steps";
  std::string no_series = no_time_or_design(scene, part);
  if (no_series.empty() && !fem::has_mean_forces(build_mechanism(scene).model))
    return "a term or a force element does not support \"energy_momentum\"";
  return no_series;
}

Levels integrator_levels(const Scene& scene, const io::CaseFile& file) {
  const std::string other =
      scene.time.integrator == "generalized_alpha" ? "energy_momentum" : "generalized_alpha";
  Levels out = step_levels(scene, file);
  for (Level& level : out) {
    level.name = other + " " + level.name;
    level.overrides.push_back("time.integrator=" + other);
  }
  return out;
}

std::string no_bending(const Scene& scene, Part part) {
  return part == Part::motion && bends(scene)
             ? ""
             : "this series is for motions in which all bodies have bending at Gauss points";
}

Levels quadrature_levels(const Scene& scene, const io::CaseFile&) {
  const int own = static_cast<int>(scene.bodies.front().number(kPoints));
  Levels out;
  for (int points = std::min(3, own); points <= std::max(11, own); ++points) {
    std::vector<std::string> changes;
    for (const Body& b : scene.bodies) changes.push_back(key(b.name, kPoints) + to_text(points));
    out.push_back(make_level(static_cast<double>(own) / points,
                             to_text(points) + " x " + to_text(points), points == own, changes));
  }
  return out;
}

std::string no_path(const Scene& scene, Part part) {
  return scene.statics && part == Part::motion ? "" : "the case has no path of equilibria";
}

Levels path_levels(const Scene& scene, const io::CaseFile&) {
  Levels out;
  const int own = scene.statics->steps;
  for (const double factor : {0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0}) {
    const auto steps = static_cast<int>(std::lround(own * factor));
    if (steps < 1 || (!out.empty() && out.back().h == static_cast<double>(own) / steps)) continue;
    out.push_back(make_level(static_cast<double>(own) / steps, to_text(steps) + " steps",
                             steps == own, {"static.steps=" + to_text(steps)}));
  }
  return out;
}

}  // namespace

const std::vector<Parameter>& parameters() {
  static const std::vector<Parameter> table = [] {
    const auto power = Approach::power, fast = Approach::fast;
    std::vector<Parameter> rows = {
        {"elements", "elements", power, 2.5, true, no_elements, mesh_levels, mesh_theory},
        {"shape", "elements", power, 2.5, true, no_shape, shape_levels, no_theory},
        {"model", "elements", power, 2.5, true, no_model, model_levels, mesh_theory, false},
        {"step", "step", power, 1, true, no_time, step_levels, step_theory},
        {"adaptive", "step", power, 0.4, true, no_adaptive, adaptive_levels, tolerance_theory},
        {"minimal_coordinates", "step", power, 0.2, true, no_explicit, explicit_levels,
         tolerance_theory},
        {"rho_inf", "step", power, 0, false, no_rho, rho_levels, no_theory},
        {"integrator", "step", power, 1, true, no_integrator, integrator_levels, step_theory},
        {"quadrature", "quadrature", fast, 1, true, no_bending, quadrature_levels, no_theory},
        {"load_steps", "load_steps", fast, 1, true, no_path, path_levels, no_theory}};
    for (Parameter& row : design_parameters()) rows.push_back(std::move(row));
    return rows;
  }();
  return table;
}

const Parameter& parameter(const std::string& name) {
  for (const Parameter& each : parameters())
    if (each.name == name) return each;
  throw Error::input("refinement series '" + name + "' is unknown; the names are: " +
                     joined(std::views::transform(parameters(), &Parameter::name)));
}

Level make_level(double h, const std::string& name, bool is_case,
                 const std::vector<std::string>& overrides) {
  return {h, name, is_case ? std::vector<std::string>() : overrides};
}

Theory no_order(const std::string& why) { return {std::numeric_limits<double>::quiet_NaN(), why}; }

std::string list_of(const std::vector<double>& values) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "[" : ", ") + to_text(value);
  return out + "]";
}

}  // namespace flexmorph::cases
