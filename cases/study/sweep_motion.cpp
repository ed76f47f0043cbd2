#include "cases/study/sweep_motion.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cases/assembly/prepared_case.h"
#include "cases/results/motion_columns.h"
#include "cases/results/quantities.h"
#include "io/case_files/case_file.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

Motions columns_of(const std::string& path, const std::string& label) {
  const io::CsvTable table = io::read_csv(path);
  Motions out;
  out.label = label;
  out.names = table.columns;
  for (const std::string& name : out.names) out.columns.push_back(table.numbers(name));
  return out;
}

Motions first_of(std::initializer_list<const char*> names, const std::string& directory,
                 const std::string& label) {
  for (const char* name : names)
    if (std::filesystem::exists(directory + name)) return columns_of(directory + name, label);
  return {label, {}, {}};
}

/// Returns the descriptions of the columns of a run from the case in its folder; none if the case
/// cannot be read or built.
std::vector<ColumnInfo> described_columns(const std::string& directory) {
  const std::string file = directory + "/case.toml";
  if (!std::filesystem::exists(file)) return {};
  try {
    const PreparedCase of(read_scene(io::CaseFile(file)));
    if (of.scene().statics) return path_columns(of.scene());
    return MotionColumns(of.scene(), of.mechanism().moving_roots, true).columns();
  } catch (const Error&) {
    return {};
  }
}

/// Returns a name with its unit, if it has one: "plate.corner_z [m]".
std::string with_unit(const Motions& motions, size_t column) {
  const std::string unit = column < motions.units.size() ? motions.units[column] : "";
  return motions.names[column] + (unit.empty() || unit == "-" ? "" : " [" + unit + "]");
}

/// Tells whether values vary by more than rounding. A quantity that is zero except for rounding is
/// far below 1e-18 in its unit.
bool varies(const std::vector<double>& y) {
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  if (low == y.end()) return false;
  const double rounding = std::max(1e-18, 1e-12 * std::max(std::abs(*low), std::abs(*high)));
  return *high - *low > rounding;
}

}  // namespace

const std::vector<double>* Motions::column(const std::string& name) const {
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? nullptr : &columns[static_cast<size_t>(at - names.begin())];
}

Motions read_motions(const std::string& directory, const std::string& label) {
  return first_of({"/motion.csv", "/path.csv"}, directory, label);
}

void set_units(std::span<Motions> variants, std::span<const VariantResult> runs) {
  const auto first =
      std::ranges::find_if(variants, [](const Motions& m) { return m.names.size() > 1; });
  if (first == variants.end()) return;
  const std::vector<ColumnInfo> all =
      described_columns(runs[static_cast<size_t>(first - variants.begin())].directory);
  for (Motions& each : variants)
    for (const std::string& name : each.names) {
      const auto at = std::ranges::find(all, name, &ColumnInfo::name);
      each.units.push_back(at == all.end() ? "" : at->unit);
    }
}

double Deflection::largest() const {
  double out = 0;
  for (const double y : value) out = std::max(out, std::abs(y));
  return out;
}

std::optional<Deflection> deflection_of(const VariantResult& run, const std::string& body) {
  const Motions motion = first_of({"/motion_verified.csv", "/motion.csv"}, run.directory, "");
  const std::vector<double>* value = motion.column(body + ".tip_deflection");
  return value ? std::optional(Deflection{motion.columns[0], *value}) : std::nullopt;
}

Motions read_reference(const std::string& path) {
  if (path.empty()) return {};
  return columns_of(path, std::filesystem::path(path).stem().string());
}

namespace {

io::Figure figure_of(const std::string& title) {
  io::Figure out;
  out.title = title;
  out.panel_height = 240;
  return out;
}

/// Returns the first variant that has columns, else one without columns.
const Motions& first_with_columns(std::span<const Motions> variants) {
  static const Motions none;
  const auto first = std::find_if(variants.begin(), variants.end(),
                                  [](const Motions& m) { return m.names.size() > 1; });
  return first == variants.end() ? none : *first;
}

}  // namespace

io::Figure motion_figure(const std::string& title, std::span<const Motions> variants,
                         const Motions& reference) {
  io::Figure figure = figure_of(title);
  const Motions& shown = first_with_columns(variants);
  for (size_t c = 1; c < shown.names.size(); ++c) {
    const std::string& name = shown.names[c];
    io::Panel panel;
    panel.title = with_unit(shown, c);
    panel.x.label = with_unit(shown, 0);
    bool any = false;
    for (size_t v = 0; v < variants.size(); ++v) {
      const std::vector<double>* y = variants[v].column(name);
      if (!y) continue;
      any |= varies(*y);
      io::Curve curve{variants[v].label, variants[v].columns[0], *y};
      curve.color = v;
      panel.curves.push_back(std::move(curve));
    }
    if (const std::vector<double>* y = reference.column(name)) {
      io::Curve points{reference.label, reference.columns[0], *y};
      points.line = false;
      points.markers = true;
      points.color = variants.size();
      panel.curves.push_back(std::move(points));
    }
    if (any) figure.panels.push_back(std::move(panel));
  }
  return figure;
}

io::Figure final_figure(const std::string& title, const std::string& label,
                        std::span<const Motions> variants, std::span<const double> number,
                        std::span<const std::string> curve) {
  io::Figure figure = figure_of(title);
  const Motions& shown = first_with_columns(variants);
  for (size_t c = 1; c < shown.names.size(); ++c) {
    io::Panel panel;
    panel.title = with_unit(shown, c);
    panel.x.label = label;
    for (size_t v = 0; v < variants.size(); ++v) {
      const std::vector<double>* y = variants[v].column(shown.names[c]);
      if (!y || y->empty()) continue;
      auto at = std::find_if(panel.curves.begin(), panel.curves.end(),
                             [&](const io::Curve& each) { return each.name == curve[v]; });
      if (at == panel.curves.end()) at = panel.curves.insert(at, io::Curve{curve[v]});
      at->x.push_back(number[v]);
      at->y.push_back(y->back());
    }
    if (std::none_of(panel.curves.begin(), panel.curves.end(),
                     [](const io::Curve& each) { return varies(each.y); }))
      continue;
    const bool relative = std::all_of(panel.curves.begin(), panel.curves.end(),
                                      [](const io::Curve& each) { return each.y[0] != 0; });
    panel.y.label = relative ? "change of the final value [%]" : "final value";
    for (io::Curve& each : panel.curves) {
      each.markers = true;
      const double base = each.y[0];
      for (double& y : each.y) y = relative ? 100 * (y / base - 1) : y;
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::vector<std::vector<std::string>> motion_table(std::span<const Motions> variants,
                                                   std::span<const VariantResult> runs) {
  std::vector<std::vector<std::string>> rows = {
      {"variant", "status", "quantity", "unit", "smallest", "largest", "last", "CPU s"}};
  for (size_t v = 0; v < variants.size(); ++v) {
    const std::string status = runs[v].words();
    if (variants[v].names.size() < 2)
      rows.push_back({variants[v].label,
                      status + (runs[v].message.empty() ? "" : ": " + runs[v].message), "", "", "",
                      "", "", ""});
    for (size_t c = 1; c < variants[v].names.size(); ++c) {
      const std::vector<double>& y = variants[v].columns[c];
      if (!varies(y)) continue;
      const auto [low, high] = std::minmax_element(y.begin(), y.end());
      rows.push_back({variants[v].label, status, variants[v].names[c],
                      c < variants[v].units.size() ? variants[v].units[c] : "",
                      io::to_text(*low, 6), io::to_text(*high, 6), io::to_text(y.back(), 6),
                      io::to_text(runs[v].seconds_cpu, 3)});
    }
  }
  return rows;
}

}  // namespace flexmorph::cases
