#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "cases/accuracy_knobs.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::to_text;
using Overrides = std::vector<std::string>;

std::string pair(int a, int b) {
  return std::string("[").append(to_text(a)).append(", ").append(to_text(b)).append("]");
}

std::optional<Theory> no_theory(const Scene&, Part) { return {}; }

std::string no_loads(const Scene& scene, Part part) {
  if (part == Part::motion) return "of designs only";
  return scene.esl && !scene.domain ? "" : "loads are given, not those of a motion";
}

/// Whole numbers of loads up to the very end: else the last load moves.
std::vector<Level> load_levels(const Scene& scene, const io::CaseFile&) {
  std::vector<Level> out;
  for (const double factor : {20.0, 10.0, 5.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1}) {
    const double every = scene.esl->every * factor, count = scene.time.end / every;
    if (factor != 1 && (count < 1.5 || std::abs(count - std::round(count)) > 1e-6)) continue;
    Level& level = out.emplace_back();
    level.h = factor;
    level.name = "every " + to_text(every) + " s";
    if (factor != 1) level.overrides = {"esl.every=" + to_text(every)};
  }
  return out;
}

std::optional<Theory> load_theory(const Scene&, Part) {
  return Theory{1, "a sum over load times is a one-sided rectangle rule"};
}

std::string no_design(const Scene&, Part part) {
  return part == Part::design ? "" : "of designs only";
}

std::string design_key(size_t design, const std::string& rest) {
  return "design." + std::to_string(design) + "." + rest + "=";
}

std::string scaled_list(const std::vector<double>& values, double factor) {
  std::string out = "[";
  for (size_t i = 0; i < values.size(); ++i)
    out += (i > 0 ? ", " : "") + to_text(values[i] * factor);
  return out + "]";
}

/// Overrides of one design on cells `size`/`own` times as many in each direction. What the case
/// gives in cells stays as large in metres: the mesh alone changes.
void refine_design(const BodyDesign& d, const io::Table& t, size_t index, int own, int size,
                   Overrides& out) {
  const double finer = static_cast<double>(size) / own;
  const int nx = d.grid.nx / own * size, ny = d.grid.ny / own * size;
  if (t.has("cells"))
    out.push_back(design_key(index, "cells") + pair(nx, ny));
  else
    out.push_back(design_key(index, "cell") + to_text(d.grid.width / nx));
  const double cell = d.grid.dx() / finer;
  if (d.tdf.kind != TdfSettings::Kind::paper) {
    out.push_back(design_key(index, "band") + scaled_list(d.band, finer));
    out.push_back(design_key(index, "erosion") + to_text(d.tdf.erosion / cell));
  }
  out.push_back(design_key(index, "sharpness") + to_text(d.tdf.sharpness * cell));
  out.push_back(design_key(index, "min_thickness") + to_text(d.min_thickness));
  const std::vector<io::Table> solid = t.tables("solid"), empty = t.tables("void");
  const auto strips = [&](const std::vector<io::Table>& regions, const std::string& name) {
    for (size_t k = 0; k < regions.size(); ++k) {
      if (!regions[k].has("strip")) continue;
      const int cells = regions[k].integer("cells", "the width of a strip", 1, d.grid.nx, 2);
      // Not a whole number: no level, for the strip would be another.
      out.push_back(design_key(index, name + "." + std::to_string(k) + ".cells") +
                    to_text(cells * finer));
    }
  };
  strips(solid, "solid");
  strips(empty, "void");
}

std::vector<Level> cell_levels(const Scene& scene, const io::CaseFile& file) {
  int own = 0;
  for (const BodyDesign& d : scene.designs) own = std::gcd(own, std::gcd(d.grid.nx, d.grid.ny));
  const std::vector<io::Table> tables = file.root().tables("design");
  std::vector<Level> out;
  for (const int quarters : {1, 2, 3, 4, 6, 8, 10, 12, 16}) {
    if (own * quarters % 4 != 0) continue;
    const int size = own * quarters / 4;
    Level& level = out.emplace_back();
    level.h = static_cast<double>(own) / size;
    for (size_t i = 0; i < scene.designs.size(); ++i) {
      const Grid& g = scene.designs[i].grid;
      level.name +=
          (i > 0 ? ", " : "") + to_text(g.nx / own * size) + " x " + to_text(g.ny / own * size);
      if (size != own) refine_design(scene.designs[i], tables[i], i, own, size, level.overrides);
    }
  }
  return out;
}

std::string no_band(const Scene& scene, Part part) {
  for (const BodyDesign& d : scene.designs)
    if (d.tdf.kind == TdfSettings::Kind::paper) return "the band of tdf = \"paper\" is no length";
  return no_design(scene, part);
}

std::vector<Level> band_levels(const Scene& scene, const io::CaseFile&) {
  std::vector<Level> out;
  for (const double factor : {4.0, 2.0 * std::sqrt(2.0), 2.0, std::sqrt(2.0), 1.0, std::sqrt(0.5),
                              0.5, 0.5 * std::sqrt(0.5)}) {
    Level& level = out.emplace_back();
    level.h = factor;
    for (size_t i = 0; i < scene.designs.size(); ++i) {
      const double band = scene.designs[i].band.back() * factor;
      level.name += (i > 0 ? ", " : "") + to_text(band, 4) + " cells";
      if (factor != 1)
        level.overrides.push_back(design_key(i, "band") +
                                  scaled_list(scene.designs[i].band, factor));
    }
  }
  return out;
}

/// Levels of a number that every design has.
std::vector<Level> number_levels(const Scene& scene, const std::string& name,
                                 const std::vector<double>& factors,
                                 double (*own)(const BodyDesign& design)) {
  std::vector<Level> out;
  for (const double factor : factors) {
    Level& level = out.emplace_back();
    for (size_t i = 0; i < scene.designs.size(); ++i) {
      const double value = own(scene.designs[i]) * factor;
      level.name += (i > 0 ? ", " : "") + to_text(value, 4);
      if (factor != 1) level.overrides.push_back(design_key(i, name) + to_text(value));
    }
  }
  return out;
}

std::vector<Level> void_levels(const Scene& scene, const io::CaseFile&) {
  const std::vector<double> factors = {16, 8, 4, 2, 1, 0.5, 0.25, 0.125};
  std::vector<Level> out =
      number_levels(scene, "alpha", factors, [](const BodyDesign& d) { return d.tdf.alpha; });
  for (size_t i = 0; i < out.size(); ++i) out[i].h = factors[i];
  return out;
}

/// The smooth maximum over components: ln(n) / sharpness above the maximum of n equal ones.
std::vector<Level> sharpness_levels(const Scene& scene, const io::CaseFile&) {
  const std::vector<double> factors = {0.25, 0.5, 1, 2, 4, 8, 16};
  std::vector<Level> out = number_levels(scene, "sharpness", factors, [](const BodyDesign& d) {
    return d.tdf.sharpness * d.grid.dx();  // as the case gives it, per cell
  });
  for (size_t i = 0; i < out.size(); ++i) out[i].h = 1 / factors[i];
  return out;
}

std::optional<Theory> void_theory(const Scene&, Part) {
  return Theory{1, "the Heaviside function is linear in alpha"};
}
std::optional<Theory> sharpness_theory(const Scene&, Part) {
  return Theory{1, "the smooth maximum of n lies up to ln n / sharpness above the maximum"};
}

/// Keys in cells: a finer mesh and another value of their own multiply.
const char* const kPerCell[] = {"band", "sharpness"};

}  // namespace

std::vector<Knob> design_knobs() {
  const auto power = Approach::power;
  return {
      {"loads", "loads", power, 0.5, true, no_loads, load_levels, load_theory},
      {"design_mesh", "design_mesh", power, 2.5, true, no_design, cell_levels, no_theory},
      {"void", "void", power, 0.1, true, no_design, void_levels, void_theory},
      {"sharpness", "sharpness", power, 0.1, true, no_design, sharpness_levels, sharpness_theory},
      {"band", "band", power, 0.1, true, no_band, band_levels, no_theory}};
}

std::vector<std::string> together(const Scene& scene, const std::vector<std::string>& overrides) {
  Overrides out = overrides;
  for (size_t i = 0; i < scene.designs.size(); ++i)
    for (const std::string key : kPerCell) {
      const BodyDesign& d = scene.designs[i];
      const std::string start = design_key(i, key);
      const auto is_it = [&](const std::string& each) { return each.starts_with(start); };
      if (std::count_if(out.begin(), out.end(), is_it) < 2) continue;
      const double own = key == "band" ? d.band.front() : d.tdf.sharpness * d.grid.dx();
      double factor = 1;
      for (const std::string& each : out) {
        if (!is_it(each)) continue;
        const std::string value = each.substr(start.size() + (each[start.size()] == '['));
        double first = 0;
        std::from_chars(value.data(), value.data() + value.size(), first);
        factor *= first / own;
      }
      std::erase_if(out, is_it);
      out.push_back(start + (key == "band" ? scaled_list(d.band, factor) : to_text(own * factor)));
    }
  return out;
}

}  // namespace flexmorph::cases
