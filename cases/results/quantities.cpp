#include "cases/results/quantities.h"

#include "cases/assembly/build.h"
#include "cases/results/mechanism_columns.h"
#include "cases/scene/measure.h"

namespace flexmorph::cases {
namespace {

const std::vector<std::string> kFigures = {"compliance", "volume", "sharp_compliance",
                                           "sharp_volume", "uniform_compliance"};

/// Columns of points, of what moves (suffix "") or is displaced ("u").
void add_points(const Scene& scene, const std::string& letter, std::vector<std::string>& out) {
  static const char* const kAxes[] = {"x", "y", "z"};
  for (const Observe& o : scene.observed)
    for (int c = 0; c < scene.body(o.body).dim(); ++c)
      out.push_back(o.body + "." + o.name + "_" + letter + kAxes[c]);
}

void add_measures(const Scene& scene, std::vector<std::string>& out) {
  for (const Measure& measure : scene.measures)
    for (const std::string& column : measured_columns(measure)) out.push_back(column);
}

std::vector<std::string> motion_columns(const Scene& scene) {
  std::vector<std::string> out;
  for (const fem::Growth& growth : build_mechanism(scene).growths)
    if (!scene.body(growth.body).in_space() && growth.line == 0)
      out.push_back(growth.body + ".tip_deflection");
  add_points(scene, "", out);
  add_measures(scene, out);
  for (const Body& body : scene.bodies)
    for (const BodyLine& line : body.lines)
      if (line.free) out.push_back(body.name + ".line_" + std::to_string(line.index));
  for (const Column& column : MechanismColumns(scene).take()) out.push_back(column.name);
  for (const char* name : {"kinetic", "strain", "potential", "defect"})
    out.push_back(std::string("energy.") + name);
  for (const std::string& name : columns_of_terms(scene)) out.push_back(name);
  return out;
}

}  // namespace

std::vector<std::string> columns_of_terms(const Scene& scene) {
  std::vector<std::string> out;
  for (const Body& body : scene.bodies)
    for (const std::string& term : body.terms)
      for (const std::string& column : fem::term_row(term).columns)
        if (std::find(out.begin(), out.end(), column) == out.end()) out.push_back(column);
  return out;
}

std::string to_string(Part part) { return part == Part::motion ? "motion" : "design"; }

std::vector<Part> parts_of(const Scene& scene) {
  std::vector<Part> out;
  if (!scene.domain) out.push_back(Part::motion);
  if (!scene.designs.empty()) out.push_back(Part::design);
  return out;
}

std::vector<std::string> candidates(const Scene& scene, Part part) {
  std::vector<std::string> out;
  if (part == Part::motion) {
    if (!scene.statics) return motion_columns(scene);
    add_points(scene, "u", out);
    add_measures(scene, out);
    out.emplace_back("energy.strain");
    return out;
  }
  for (const BodyDesign& design : scene.designs)
    for (const std::string& figure : kFigures)
      out.push_back(scene.designs.size() > 1 ? design.body + "." + figure : figure);
  return out;
}

std::string all_candidates(const Scene& scene) {
  std::string out;
  for (const Part part : parts_of(scene))
    for (const std::string& name : candidates(scene, part)) out += (out.empty() ? "" : ", ") + name;
  return out;
}

}  // namespace flexmorph::cases
