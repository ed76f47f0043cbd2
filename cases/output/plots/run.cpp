#include "cases/output/plots/plots.h"

namespace flexmorph::cases {
namespace {

/// Adds panels of observed columns. The components of a point share a panel, and the curves are
/// named by the text after the last underscore.
void add_observed(const io::Axis& x, const std::vector<double>& at, const Series& table,
                  const std::string& what, io::Figure& figure) {
  for (const size_t c : table.of_group(ColumnGroup::observed)) {
    const std::string& name = table.columns[c].name;
    const size_t cut = name.rfind('_');
    const std::string point = name.substr(0, cut);
    const bool line = point.ends_with(".line");
    const std::string title = line ? name : point;
    if (figure.panels.empty() || figure.panels.back().title != title) {
      io::Panel panel;
      panel.title = title;
      panel.x = x;
      panel.y.label = line ? "material coordinate [m]" : what;
      figure.panels.push_back(panel);
    }
    figure.panels.back().curves.push_back(
        {line ? "" : name.substr(cut + 1), at, table.values[c], true, false, false});
  }
}

}  // namespace

io::Figure convergence_plot(const RunFolder::History& h) {
  io::Figure figure;
  figure.title = "Convergence of the design of " + h.body;
  io::Panel compliance;
  compliance.x.label = "iteration";
  compliance.y = {"compliance [J]", true, {}, {}};
  compliance.curves.push_back({"smoothed", h.row, h.compliance, true, false, false});
  if (!h.crisp_row.empty())
    compliance.curves.push_back({"crisp", h.crisp_row, h.crisp_compliance, false, true, false});
  io::Panel volume;
  volume.x.label = "iteration";
  volume.y.label = "volume fraction";
  volume.curves.push_back({"", h.row, h.volume, true, false, false});
  io::Panel kkt;
  kkt.x.label = "iteration";
  kkt.y = {"KKT residual", true, {}, {}};
  kkt.curves.push_back({"", h.row, h.kkt, true, false, false});
  figure.panels = {compliance, volume, kkt};
  return figure;
}

io::Figure deflection_plot(const MotionRecord& design, const std::optional<MotionRecord>& uniform) {
  io::Figure figure;
  figure.title = "Tip deflection";
  const std::vector<size_t> tips = design.table.of_group(ColumnGroup::deflection);
  for (const size_t c : tips) {
    const std::string& name = design.table.columns[c].name;
    io::Panel panel;
    panel.title = tips.size() > 1 ? name.substr(0, name.size() - kDeflectionEnding.size()) : "";
    panel.x.label = "time [s]";
    panel.y.label = "deflection [m]";
    panel.curves.push_back(
        {uniform ? "optimized" : "", design.time(), design.table.values[c], true, false, false});
    if (uniform)
      panel.curves.push_back(
          {"uniform material", uniform->time(), uniform->table.at(name), true, false, true});
    figure.panels.push_back(panel);
  }
  return figure;
}

io::Figure observed_plot(const MotionRecord& motion) {
  io::Figure figure;
  figure.title = "Motion of observed points";
  io::Axis time;
  time.label = "time [s]";
  add_observed(time, motion.time(), motion.table, "position [m]", figure);
  return figure;
}

io::Figure path_plot(const PathRecord& path) {
  const std::vector<double>& factor = path.table.at(kFactorColumn);
  io::Figure figure;
  figure.title = "Path of equilibria";
  io::Axis load;
  load.label = "load factor";
  add_observed(load, factor, path.table, "displacement [m]", figure);
  add_measured(factor, load.label, path.table, figure);
  for (io::Panel& panel : figure.panels)
    for (io::Curve& curve : panel.curves) curve.markers = true;
  io::Panel energy;
  energy.x = load;
  energy.y.label = "strain energy [J]";
  energy.curves.push_back({"", factor, path.table.at(kStrainColumn), true, true, false});
  figure.panels.push_back(energy);
  return figure;
}

io::Figure energy_plot(const Scene& scene, const MotionRecord& motion) {
  io::Figure figure;
  figure.title = "Energies";
  const Series& table = motion.table;
  const auto panel = [&](const std::string& label, const std::vector<double>& y) {
    io::Panel out;
    out.x.label = "time [s]";
    out.y.label = label;
    out.curves.push_back({"", motion.time(), y, true, false, false});
    figure.panels.push_back(out);
  };
  panel("kinetic energy [J]", table.at(kKineticColumn));
  panel("strain energy [J]", table.at(kStrainColumn));
  if (scene.in_space() || scene.gravity) panel("potential energy [J]", table.at(kPotentialColumn));
  for (const size_t c : table.of_group(ColumnGroup::term))
    panel(table.columns[c].name + " [J]", table.values[c]);
  panel("energy error [J]", table.at(kEnergyErrorColumn));
  return figure;
}

}  // namespace flexmorph::cases
