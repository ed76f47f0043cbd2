#include <algorithm>
#include <cmath>

#include "cases/output/plots/plots.h"

namespace flexmorph::cases {
namespace {

struct Line {
  const char* column;
  const char* name;
  bool analytic = false;  // true: closed-form solution of the free body
};

struct Group {
  const char* title;
  const char* label;
  std::vector<Line> lines;
};

const std::vector<Group>& groups() {
  static const std::vector<Group> kGroups = {
      {"temperature", "temperature rise [K]", {{"temperature", ""}}},
      {"displacement along x",
       "displacement [m]",
       {{"root_ux", "root"}, {"end_ux", "free end"}, {"free_ux", "free body, closed form", true}}},
      {"displacement along y",
       "displacement [m]",
       {{"root_uy", "root"}, {"end_uy", "free end"}, {"free_uy", "free body, closed form", true}}},
      {"position gradients at the free end",
       "length [-]",
       {{"end_rx", "|r_x|"}, {"end_ry", "|r_y|"}}},
      {"velocity of the free end", "velocity [m/s]", {{"end_vx", "x"}, {"end_vy", "y"}}},
      {"deflection of the midpoint", "deflection [m]", {{"midpoint_deflection", ""}}},
      {"largest elastic strain", "strain [-]", {{"max_elastic_strain", ""}}}};
  return kGroups;
}

/// Returns the names of the bodies of columns "<body>.<quantity>", each once.
std::vector<std::string> bodies_of(const Series& table) {
  std::vector<std::string> out;
  for (const size_t c : table.of_group(ColumnGroup::measured)) {
    const std::string& name = table.columns[c].name;
    const std::string body = name.substr(0, name.find('.'));
    if (out.empty() || out.back() != body) out.push_back(body);
  }
  return out;
}

/// Returns true if the values of a curve are more than rounding errors.
bool shows(const io::Curve& curve) {
  return std::any_of(curve.y.begin(), curve.y.end(), [](double y) { return std::abs(y) > 1e-12; });
}

}  // namespace

void add_measured(const std::vector<double>& x, const std::string& x_label, const Series& table,
                  io::Figure& figure) {
  for (const std::string& body : bodies_of(table))
    for (const Group& group : groups()) {
      io::Panel panel;
      panel.title = body + ": " + group.title;
      panel.x.label = x_label;
      panel.y.label = group.label;
      for (const Line& line : group.lines) {
        const std::vector<double>* values = table.find(body + "." + line.column);
        if (!values) continue;
        io::Curve curve{line.name, x, *values};
        curve.dashed = line.analytic;
        panel.curves.push_back(std::move(curve));
      }
      if (std::any_of(panel.curves.begin(), panel.curves.end(), shows))
        figure.panels.push_back(std::move(panel));
    }
}

io::Figure measured_plot(const MotionRecord& motion) {
  const std::vector<std::string> bodies = bodies_of(motion.table);
  if (bodies.empty()) return {};
  const std::vector<double>& time = motion.time();
  io::Figure figure;
  figure.title = "Measured quantities";
  figure.panel_height = 240;
  add_measured(time, "time [s]", motion.table, figure);
  io::Panel kinetic;
  kinetic.title = "kinetic energy";
  kinetic.x.label = "time [s]";
  kinetic.y.label = "kinetic energy [J]";
  kinetic.curves.push_back({"model", time, motion.table.at(kKineticColumn)});
  for (const std::string& body : bodies)
    if (const std::vector<double>* free = motion.table.find(body + ".free_kinetic")) {
      io::Curve curve{body + " (free body, closed form)", time, *free};
      curve.dashed = true;
      kinetic.curves.push_back(std::move(curve));
    }
  if (kinetic.curves.size() > 1) figure.panels.push_back(std::move(kinetic));
  return figure;
}

}  // namespace flexmorph::cases
