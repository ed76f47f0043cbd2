#include "cases/output/plots/run.h"

#include "cases/output/plots/measured.h"

namespace flexmorph::cases {
namespace {

/// Panels of observed columns: components of a point share one, and curves are named by what
/// follows the last underscore.
void add_observed(const std::vector<double>& x, const std::string& x_label,
                  const std::vector<Column>& columns, const std::string& what, io::Figure& figure) {
  for (const Column& column : columns) {
    const size_t cut = column.name.rfind('_');
    const std::string point = column.name.substr(0, cut);
    const bool line = point.ends_with(".line");
    const std::string title = line ? column.name : point;
    if (figure.panels.empty() || figure.panels.back().title != title) {
      io::Panel panel;
      panel.title = title;
      panel.x.label = x_label;
      panel.y.label = line ? "material coordinate [m]" : what;
      figure.panels.push_back(panel);
    }
    figure.panels.back().curves.push_back(
        {line ? "" : column.name.substr(cut + 1), x, column.values, true, false, false});
  }
}

}  // namespace

std::string convergence_plot(const RunFolder::History& h) {
  io::Figure figure;
  figure.title = "Design of " + h.body;
  io::Panel compliance;
  compliance.x.label = "iteration";
  compliance.y = {"compliance [J]", true, {}, {}};
  compliance.curves.push_back({"blurred", h.row, h.compliance, true, false, false});
  if (!h.sharp_row.empty())
    compliance.curves.push_back({"sharp", h.sharp_row, h.sharp_compliance, false, true, false});
  io::Panel volume;
  volume.x.label = "iteration";
  volume.y.label = "volume fraction";
  volume.curves.push_back({"", h.row, h.volume, true, false, false});
  io::Panel kkt;
  kkt.x.label = "iteration";
  kkt.y = {"KKT residual", true, {}, {}};
  kkt.curves.push_back({"", h.row, h.kkt, true, false, false});
  figure.panels = {compliance, volume, kkt};
  return io::plot_svg(figure);
}

std::string deflection_plot(const MotionRecord& design,
                            const std::optional<MotionRecord>& uniform) {
  io::Figure figure;
  figure.title = "Tip deflection";
  for (size_t i = 0; i < design.deflection.size(); ++i) {
    io::Panel panel;
    panel.title = design.bodies.size() > 1 ? design.bodies[i] : "";
    panel.x.label = "time [s]";
    panel.y.label = "deflection [m]";
    const bool designed = uniform.has_value();
    panel.curves.push_back(
        {designed ? "optimized" : "", design.time, design.deflection[i], true, false, false});
    if (designed)
      panel.curves.push_back(
          {"uniform, same volume", uniform->time, uniform->deflection[i], true, false, true});
    figure.panels.push_back(panel);
  }
  return io::plot_svg(figure);
}

std::string observed_plot(const MotionRecord& motion) {
  io::Figure figure;
  figure.title = "Observed motion";
  add_observed(motion.time, "time [s]", motion.observed, "position [m]", figure);
  return io::plot_svg(figure);
}

std::string path_plot(const PathRecord& path) {
  io::Figure figure;
  figure.title = "Path of equilibria";
  add_observed(path.factor, "load factor", path.observed, "displacement [m]", figure);
  add_measured(path.factor, "load factor", path.measured, figure);
  for (io::Panel& panel : figure.panels)
    for (io::Curve& curve : panel.curves) curve.markers = true;
  io::Panel energy;
  energy.x.label = "load factor";
  energy.y.label = "strain energy [J]";
  energy.curves.push_back({"", path.factor, path.strain, true, true, false});
  figure.panels.push_back(energy);
  return io::plot_svg(figure);
}

std::string energy_plot(const Scene& scene, const MotionRecord& motion) {
  io::Figure figure;
  figure.title = "Energies";
  const auto panel = [&](const std::string& label, const std::vector<double>& y) {
    io::Panel out;
    out.x.label = "time [s]";
    out.y.label = label;
    out.curves.push_back({"", motion.time, y, true, false, false});
    figure.panels.push_back(out);
  };
  panel("kinetic [J]", motion.kinetic);
  panel("strain [J]", motion.strain);
  if (scene.in_space() || scene.gravity) panel("potential [J]", motion.potential);
  for (const Column& column : motion.written) panel(column.name + " [J]", column.values);
  panel("defect of the balance [J]", motion.defect);
  return io::plot_svg(figure);
}

}  // namespace flexmorph::cases
