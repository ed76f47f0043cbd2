#include <algorithm>
#include <cmath>
#include <optional>

#include "cases/study/rows.h"
#include "cases/study/study_page.h"
#include "cases/study/sweep_plan.h"
#include "io/files.h"
#include "io/plots.h"
#include "io/sheet.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

std::string history_picture(const BodyResult& b, double lowest, double highest) {
  io::Figure figure;
  figure.width = 560;
  figure.panel_height = 300;
  io::Panel panel;
  panel.x.label = "iteration";
  panel.y = {"compliance [J]", true, lowest, highest};
  std::vector<double> iteration(b.history_compliance.size());
  for (size_t i = 0; i < iteration.size(); ++i) iteration[i] = static_cast<double>(i + 1);
  panel.curves.push_back({"smoothed", iteration, b.history_compliance});
  // The compliance of a disconnected design is far above the range of the axis, so the legend gives
  // the number of such designs.
  const auto above = std::count_if(b.crisp_history.begin(), b.crisp_history.end(),
                                   [&](double c) { return c > highest; });
  const std::string name =
      above > 0 ? "crisp (" + std::to_string(above) + " above the axis)" : "crisp";
  panel.curves.push_back({name, b.crisp_iteration, b.crisp_history, false, true});
  figure.panels = {panel};
  return io::plot_svg(figure);
}

/// Returns the smallest and the largest compliance, of regularized and crisp designs, in the
/// histories of one body in the runs of one case [J].
std::pair<double, double> range_of(const Sweep& sweep, std::span<const VariantResult> runs,
                                   const std::string& case_name, size_t body) {
  double lowest = INFINITY, highest = 0;
  for (size_t k = 0; k < runs.size(); ++k) {
    if (sweep.variants[k].case_name != case_name || body >= runs[k].bodies.size()) continue;
    const BodyResult& b = runs[k].bodies[body];
    for (const std::vector<double>* history : {&b.history_compliance, &b.crisp_history})
      for (const double c : *history) {
        if (!(c > 0)) continue;
        lowest = std::min(lowest, c);
        highest = std::max(highest, c);
      }
  }
  return {lowest, highest};
}

/// Returns a picture of the deflections of a body in the run `first` and in the following runs that
/// differ from it in the last key.
std::string deflection_picture(const Sweep& sweep, std::span<const VariantResult> runs,
                               size_t first, size_t body) {
  io::Panel panel;
  panel.x.label = "time [s]";
  panel.y.label = "tip deflection [m]";
  const size_t last = sweep.varied.size() - 1;
  for (size_t k = first; k < std::min(first + sweep.n_last(), runs.size()); ++k) {
    if (body >= runs[k].bodies.size()) continue;
    const auto deflection = deflection_of(runs[k], runs[k].bodies[body].body);
    if (!deflection) continue;
    panel.curves.push_back({last_part(sweep.varied[last].key) + " = " + sweep.value(k, last),
                            deflection->time, deflection->value});
    panel.curves.back().color = k - first;
  }
  if (panel.curves.empty()) return "";
  io::Figure figure;
  figure.width = 560;
  figure.panel_height = 300;
  figure.panels = {std::move(panel)};
  return io::plot_svg(figure);
}

/// Returns one page as P Figs. 13 to 23 (see fem/README.md): designs above their histories, and
/// deflections below them. Histories of one body and case have the same axis.
std::string sheet_of(const Sweep& sweep, std::span<const VariantResult> runs) {
  std::vector<io::SheetEntry> entries;
  for (size_t k = 0; k < runs.size(); ++k) {
    const VariantResult& run = runs[k];
    io::SheetEntry entry;
    entry.title = sweep.title_of(k);
    if (!run.done())
      entry.title += " (" + run.status + ")";
    else if (!run.bodies.empty())
      entry.title += " (" + run.verdicts() + ")";
    for (size_t i = 0; i < run.bodies.size(); ++i) {
      const std::string stem = run.bodies.size() > 1 ? "/design_" + run.bodies[i].body : "/design";
      const std::string design = text_of(run.directory + stem + ".svg");
      if (!design.empty()) entry.pictures.push_back(design);
      const auto [lowest, highest] = range_of(sweep, runs, sweep.variants[k].case_name, i);
      entry.pictures.push_back(
          history_picture(run.bodies[i], 0.9 * lowest, std::min(highest, 30 * lowest)));
    }
    entries.push_back(std::move(entry));
  }
  for (size_t first = 0; first < runs.size(); first += sweep.n_last()) {
    io::SheetEntry entry;
    entry.title = sweep.title_of(first, sweep.varied.size() - 1);
    for (size_t i = 0; i < sweep.table.n_bodies(); ++i)
      if (const std::string picture = deflection_picture(sweep, runs, first, i); !picture.empty())
        entry.pictures.push_back(picture);
    if (!entry.pictures.empty()) entries.push_back(std::move(entry));
  }
  // Variants that differ in the last key are placed side by side if they fit on a page.
  return io::contact_sheet(
      sweep.case_name, entries,
      sweep.varied.size() > 1 && sweep.n_last() <= 6 ? static_cast<int>(sweep.n_last()) : 4);
}

/// Returns the smoothed compliances of all runs over their iterations, a panel per body.
io::Figure histories_of(const Sweep& sweep, std::span<const VariantResult> runs) {
  io::Figure out;
  for (size_t b = 0; b < sweep.table.n_bodies(); ++b) {
    io::Panel panel;
    panel.x.label = "iteration";
    panel.y = {"compliance [J]", true, {}, {}};
    for (size_t k = 0; k < runs.size(); ++k) {
      if (b >= runs[k].bodies.size()) continue;
      panel.title = runs[k].bodies[b].body;
      io::Curve curve{sweep.title_of(k), {}, runs[k].bodies[b].history_compliance};
      for (size_t i = 0; i < curve.y.size(); ++i) curve.x.push_back(static_cast<double>(i + 1));
      panel.curves.push_back(std::move(curve));
    }
    if (!panel.curves.empty()) out.panels.push_back(std::move(panel));
  }
  return out;
}

}  // namespace

const std::string& Sweep::value(size_t variant, size_t key) const {
  for (size_t k = varied.size() - 1; k > key; --k) variant /= varied[k].values.size();
  const std::vector<std::string>& values = varied[key].values;
  return values[variant % values.size()];
}

std::string Sweep::title_of(size_t variant, size_t n_keys) const {
  std::string out;
  for (size_t v = 0; v < n_keys; ++v)
    out += (v > 0 ? ", " : "") + last_part(varied[v].key) + " = " + value(variant, v);
  return out;
}

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

void write_designs(const Sweep& sweep, std::span<const VariantResult> runs,
                   const std::string& stem) {
  write_results(sweep.table, runs, stem + ".csv");
  const std::string note =
      "The figure ranks the designs: it is body-fitted compliance x volume / allowed volume. "
      "If the outline was not verified, the compliance and the volume of the crisp design "
      "are used. If the objective is not a compliance, the figure is the objective of the "
      "crisp design.";
  const std::vector<std::vector<std::string>> rows = result_rows(sweep.table, runs);
  io::write_file(stem + ".md", "# " + sweep.case_name + "\n\n" + io::markdown_table(rows) + "\n" +
                                   note + "\n" + convergence_note(runs) + rows_note(runs));
  io::write_file(stem + ".svg", sheet_of(sweep, runs));
  StudyPage page;
  page.title = sweep.case_name + ": sweep";
  page.notes = {note, rows_note(runs)};
  page.rows = rows;
  page.plots = {{"convergence", histories_of(sweep, runs)}};
  write_study_page(page, runs, stem + ".html");
}

}  // namespace flexmorph::cases
