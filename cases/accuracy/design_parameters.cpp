#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "cases/accuracy/parameters.h"
#include "cases/scene/design/keys.h"
#include "cases/scene/tables.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Overrides = std::vector<std::string>;
using Levels = std::vector<Level>;

std::string no_loads(const Scene& scene, Part part) {
  if (part == Part::motion) return "this series is for designs only";
  return scene.esl && !scene.domain ? "" : "the loads are given and do not come from a motion";
}

/// Returns levels with a whole number of load times up to the end of the motion. With other numbers
/// the time of the last load would change between levels.
Levels load_levels(const Scene& scene, const io::CaseFile&) {
  Levels out;
  for (const double factor : {20.0, 10.0, 5.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1}) {
    const double every = scene.esl->every * factor, count = scene.time.end / every;
    if (factor != 1 && (count < 1.5 || std::abs(count - std::round(count)) > 1e-6)) continue;
    out.push_back(make_level(factor, "every " + to_text(every) + " s", factor == 1,
                             {"esl.every=" + to_text(every)}));
  }
  return out;
}

std::optional<Theory> load_theory(const Scene&, Part, const std::string&) {
  return Theory{1, "many loads, because their sum is a one-sided rectangle rule"};
}

std::string no_design(const Scene&, Part part) {
  return part == Part::design ? "" : "this series is for designs only";
}

std::string design_key(size_t design, const std::string& rest) {
  return "design." + std::to_string(design) + "." + rest + "=";
}

/// Returns the overrides of one design with `size`/`own` times the number of cells in each
/// direction. The band, the erosion and the smooth maximum keep their sizes measured in cells.
/// Therefore components have sharper edges on finer cells.
Overrides refine_design(const BodyDesign& d, const io::Table& t, size_t index, int own, int size) {
  Overrides out;
  const double finer = static_cast<double>(size) / own;
  const int nx = d.grid.nx / own * size, ny = d.grid.ny / own * size;
  if (t.has(design_keys::kCells))
    out.push_back(design_key(index, "cells") + list_of({1.0 * nx, 1.0 * ny}));
  else
    out.push_back(design_key(index, "cell") + to_text(d.grid.width / nx));
  out.push_back(design_key(index, "min_thickness") + to_text(d.min_thickness));
  const std::vector<io::Table> solid = t.tables(design_keys::kSolid),
                               empty = t.tables(design_keys::kVoid);
  const auto strips = [&](const std::vector<io::Table>& regions, const std::string& name) {
    for (size_t k = 0; k < regions.size(); ++k) {
      if (!regions[k].has(design_keys::kStrip)) continue;
      const int cells = regions[k].integer(design_keys::kStripCells);
      // If the number is not whole, the case is refused and so is the level, because the strip
      // would have another width.
      out.push_back(design_key(index, name + "." + std::to_string(k) + ".cells") +
                    to_text(cells * finer));
    }
  };
  strips(solid, "solid");
  strips(empty, "void");
  return out;
}

Levels cell_levels(const Scene& scene, const io::CaseFile& file) {
  int own = 0;
  for (const BodyDesign& d : scene.designs) own = std::gcd(own, std::gcd(d.grid.nx, d.grid.ny));
  assert(own > 0);
  const std::vector<io::Table> tables = file.root().tables(tables::kDesign);
  Levels out;
  for (const int quarters : {1, 2, 3, 4, 6, 8, 10, 12, 16, 24, 32}) {
    if (own * quarters % 4 != 0) continue;
    const int size = own * quarters / 4;
    Level& level = out.emplace_back();
    level.h = static_cast<double>(own) / size;
    for (size_t i = 0; i < scene.designs.size(); ++i) {
      const Grid& g = scene.designs[i].grid;
      level.name +=
          (i > 0 ? ", " : "") + to_text(g.nx / own * size) + " x " + to_text(g.ny / own * size);
      if (size == own) continue;
      const Overrides finer = refine_design(scene.designs[i], tables[i], i, own, size);
      level.overrides.insert(level.overrides.end(), finer.begin(), finer.end());
    }
  }
  return out;
}

std::string no_band(const Scene& scene, Part part) {
  for (const BodyDesign& d : scene.designs)
    if (d.tdf.kind == TdfSettings::Kind::paper)
      return "the band of tdf = \"paper\" is not a length";
  return no_design(scene, part);
}

/// Returns levels in which a value of all designs is multiplied by factors.
/// @param h      function that returns the parameter h of a factor
/// @param value  function that returns, for a design and a factor, the name of a level and the
///               value as text of a case file
Levels scaled_levels(const Scene& scene, const std::string& key, const std::vector<double>& factors,
                     double (*h)(double factor),
                     std::pair<std::string, std::string> (*value)(const BodyDesign& design,
                                                                  double factor)) {
  Levels out;
  for (const double factor : factors) {
    std::string names;
    Overrides changes;
    for (size_t i = 0; i < scene.designs.size(); ++i) {
      const auto [name, text] = value(scene.designs[i], factor);
      names += (i > 0 ? ", " : "") + name;
      changes.push_back(design_key(i, key) + text);
    }
    out.push_back(make_level(h(factor), names, factor == 1, changes));
  }
  return out;
}

double as_factor(double factor) { return factor; }

Levels band_levels(const Scene& scene, const io::CaseFile&) {
  const double root = std::sqrt(2.0), half = std::sqrt(0.5);
  return scaled_levels(scene, "band", {4, 2 * root, 2, root, 1, half, 0.5, 0.5 * half}, as_factor,
                       [](const BodyDesign& d, double factor) {
                         std::vector<double> bands = d.band;
                         for (double& band : bands) band *= factor;
                         return std::pair(to_text(bands.back(), 4) + " cells", list_of(bands));
                       });
}

Levels void_levels(const Scene& scene, const io::CaseFile&) {
  return scaled_levels(scene, "alpha", {16, 8, 4, 2, 1, 0.5, 0.25, 0.125}, as_factor,
                       [](const BodyDesign& d, double factor) {
                         const double alpha = d.tdf.alpha * factor;
                         return std::pair(to_text(alpha, 4), to_text(alpha));
                       });
}

/// Returns levels of the sharpness of the smooth maximum over components. The smooth maximum of n
/// equal components exceeds their maximum by ln(n) / sharpness.
Levels sharpness_levels(const Scene& scene, const io::CaseFile&) {
  return scaled_levels(
      scene, "sharpness", {0.25, 0.5, 1, 2, 4, 8, 16}, [](double factor) { return 1 / factor; },
      [](const BodyDesign& d, double factor) {
        const double sharpness = d.tdf.sharpness * d.grid.dx() * factor;  // [1/cell]
        return std::pair(to_text(sharpness, 4), to_text(sharpness));
      });
}

std::optional<Theory> void_theory(const Scene&, Part, const std::string&) {
  return Theory{1, "small alpha, because the Heaviside function is linear in alpha"};
}
std::optional<Theory> sharpness_theory(const Scene&, Part, const std::string&) {
  return no_order(
      "the smooth maximum of n coinciding components exceeds their maximum by ln n / sharpness "
      "(order 1); where components cross, only a strip of this width is changed (order 2)");
}

/// Returns the theory for the size of cells. A point force on a plane continuum causes an infinite
/// displacement and therefore an infinite compliance, so there is no limit then.
std::optional<Theory> cell_theory(const Scene& scene, Part, const std::string& quantity) {
  const auto is_point = [](const PlaneForce& f) {
    return f.location.kind == NodeRegion::Kind::point;
  };
  const bool points =
      scene.domain && std::ranges::any_of(scene.domain->loads, [&](const StaticLoadCase& load) {
        return std::ranges::any_of(load.forces, is_point);
      });
  if (points && quantity.ends_with("compliance"))
    return Theory{
        0, "under a point force the compliance grows with the logarithm of the number of cells"};
  return no_order("the edges of components cross the cells at arbitrary positions");
}

std::optional<Theory> band_theory(const Scene&, Part, const std::string&) {
  return no_order("a band narrower than one cell is not resolved by the cells");
}

}  // namespace

std::vector<Parameter> design_parameters() {
  const auto power = Approach::power;
  return {
      {"loads", "loads", power, 0.5, true, no_loads, load_levels, load_theory},
      {"design_mesh", "design_mesh", power, 2.5, true, no_design, cell_levels, cell_theory},
      {"void", "void", power, 0.1, true, no_design, void_levels, void_theory},
      {"sharpness", "design_mesh", power, 0.1, true, no_design, sharpness_levels, sharpness_theory},
      {"band", "design_mesh", power, 0.1, true, no_band, band_levels, band_theory}};
}

}  // namespace flexmorph::cases
