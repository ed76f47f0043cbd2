#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/assembly/build.h"
#include "cases/stability/overrides.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Rows = std::vector<Perturbation>;
using Components = std::vector<Component>;

std::string text_of(const Components& components) {
  std::string out = "X0,Y0,half_length,angle,c1,c2,c3\n";
  for (const Component& c : components) {
    std::string row;
    for (const double p : c.parameters()) row.append(row.empty() ? "" : ",").append(to_text(p));
    out.append(row).append("\n");
  }
  return out;
}

/// The same factor of the void for all designs.
Rows voids(const Scene& scene) {
  Rows out;
  for (const double factor : {1e-3, 1e-5, 1e-7, 1e-9}) {
    if (scene.designs.empty()) return out;
    Perturbation& row = out.emplace_back();
    row.part = Part::design;
    row.parameter = "void of " + to_text(factor);
    for (size_t i = 0; i < scene.designs.size(); ++i) {
      row.overrides.push_back(entry("design", i, "alpha", factor));
      if (!scene.domain) row.overrides.push_back(entry("design", i, "stiffness_void", factor));
    }
    for (const char* name : {"compliance", "sharp_compliance"})
      row.invariances.push_back(
          {name,
           {},
           1,
           0.3,
           0,
           false,
           "a thinner void changes little, unless masses or loads hang on it: its stiffness is "
           "alpha^2"});
  }
  return out;
}

/// Elastic constants of a plate at rest: compliance goes with 1/E and with 1/thickness.
Rows scales(const Scene& scene) {
  Rows out;
  if (!scene.domain) return out;
  const auto add = [&](const char* key, double own, double value) {
    Perturbation& row = out.emplace_back();
    row.part = Part::design;
    row.demand = Demand::runs;
    row.parameter = std::string(key) + " = " + to_text(value);
    row.overrides = {std::string("domain.") + key + "=" + to_text(value)};
    for (const char* name : {"compliance", "sharp_compliance"})
      row.invariances.push_back({name,
                                 {},
                                 own / value,
                                 1e-8,
                                 0,
                                 true,
                                 std::string("compliance is proportional to 1/") + key});
  };
  add("youngs_modulus", scene.domain->youngs_modulus, 2e11);
  add("youngs_modulus", scene.domain->youngs_modulus, 1e-6);
  add("thickness", scene.domain->thickness, 1e-4);
  for (const char* ratio : {"0.0", "0.499"})
    out.push_back({std::string("poisson_ratio = ") + ratio,
                   {std::string("domain.poisson_ratio=") + ratio},
                   Part::design});
  return out;
}

/// What is added lies elsewhere, or upon what is there: the union stays what it was.
void same_union(Perturbation& row) {
  row.demand = Demand::runs;
  for (const char* name : {"sharp_volume", "sharp_compliance", "connected"})
    row.invariances.push_back({name, {}, 1, 1e-9, 0, true, "the union is the same"});
}

Rows components(const Scene& scene) {
  Rows out;
  if (scene.designs.empty()) return out;
  const Components own = build_problems(scene).front().design.components();
  const Grid& g = scene.designs.front().grid;
  const auto add = [&](const std::string& name, const Components& list) -> Perturbation& {
    Perturbation& row = out.emplace_back();
    row.parameter = name;
    row.part = Part::design;
    row.components = text_of(list);
    return row;
  };
  const auto changed = [&](const auto& change) {
    Components list = own;
    for (Component& c : list) change(c);
    return list;
  };
  same_union(add("as they are", own));
  for (const double thickness : {1e-3, 1e-6})
    add("thickness " + to_text(thickness) + " m",
        changed([&](Component& c) { c.c1 = c.c2 = c.c3 = thickness; }));
  add("half length 1e-6 m", changed([](Component& c) { c.half_length = 1e-6; }));
  same_union(add("turned by 1000 half turns",
                 changed([](Component& c) { c.angle += 1000 * std::numbers::pi; })));
  Components twice = own, far = own;
  twice.insert(twice.end(), own.begin(), own.end());
  same_union(add("each twice", twice));
  far.push_back(own.front());
  far.back().center += Vec2(10 * g.width, -10 * g.height);
  add("one more, far outside", far);
  add("all in one place", changed([&](Component& c) {
        c = own.front();
        c.center = {g.x0 + 0.5 * g.width, g.y0 + 0.5 * g.height};
      }));
  add("all far outside", changed([&](Component& c) { c.center += Vec2(10 * g.width, 0); }));
  add("all undercut", changed([](Component& c) { c.c3 *= 1e-3; }));
  const Components half(own.begin(), own.begin() + static_cast<long>((own.size() + 1) / 2));
  add("disconnected: the first half", half);
  add("disconnected: one alone", {own.front()});
  out.emplace_back().parameter = "a thickness that is no number";
  out.back().part = Part::design;
  out.back().components = "X0,Y0,half_length,angle,c1,c2,c3\n0.1,0,0.05,0,nan,0.01,0.01\n";
  out.back().demand = Demand::refused;
  out.push_back(out.back());
  out.back().parameter = "a file without components";
  out.back().components = text_of({});
  return out;
}

/// The same layouts, designed for a few iterations.
Rows steps_of(const Scene& scene) {
  Rows out;
  if (!scene.domain) return out;
  for (Perturbation& row : components(scene)) {
    if (row.demand == Demand::refused) continue;
    row.invariances.clear();
    row.overrides.insert(row.overrides.end(), {"optimizer.max_iterations=4"});
    row.demand = Demand::none;
    out.push_back(std::move(row));
  }
  return out;
}

Rows volume(const Scene& scene) {
  Rows out;
  if (!scene.domain || !scene.designs.front().goal.objective->needs_state()) return out;
  for (const double most : {1e-6, 0.01, 0.999999, 1.0}) {
    Perturbation& row = out.emplace_back();
    row.part = Part::design;
    row.parameter = "volume at most " + to_text(most);
    row.overrides = {entry("design", 0, "max_volume", most), "optimizer.max_iterations=20"};
  }
  return out;
}

}  // namespace

std::vector<Suite> design_suites() {
  return {{"void", "stiffness of the void from 1e-3 to 1e-9", false, Part::design, voids},
          {"scales", "elastic constants of plates at rest", false, Part::design, scales},
          {"components", "thin, coincident, distant and disconnected components", false,
           Part::design, components},
          {"iterations", "the same layouts, a few iterations on", false, Part::design, steps_of},
          {"volume", "volumes that cannot be reached, or that fill everything", false, Part::design,
           volume}};
}

}  // namespace flexmorph::cases
