#include "cases/results/quantities.h"

#include "cases/assembly/build.h"
#include "cases/results/motion_columns.h"

namespace flexmorph::cases {
namespace {

const std::vector<std::string> kFigures = {"compliance", "volume", "crisp_compliance",
                                           "crisp_volume", "uniform_compliance"};

/// Returns the names of the columns that can be quantities of interest. Abscissas, numbers of the
/// solver, lengths and powers are left out.
std::vector<std::string> names_of(const std::vector<ColumnInfo>& columns) {
  std::vector<std::string> out;
  for (const ColumnInfo& c : columns)
    if (c.group != ColumnGroup::abscissa && c.group != ColumnGroup::solver &&
        c.group != ColumnGroup::length && c.group != ColumnGroup::power)
      out.push_back(c.name);
  return out;
}

}  // namespace

std::string to_string(Part part) { return part == Part::motion ? "motion" : "design"; }

std::vector<Part> parts_of(const Scene& scene) {
  std::vector<Part> out;
  if (!scene.domain) out.push_back(Part::motion);
  if (!scene.designs.empty()) out.push_back(Part::design);
  return out;
}

std::vector<std::string> candidates(const PreparedCase& prepared, Part part) {
  const Scene& scene = prepared.scene();
  std::vector<std::string> out;
  if (part == Part::motion)
    return names_of(scene.statics
                        ? path_columns(scene)
                        : MotionColumns(scene, prepared.mechanism().moving_roots, true).columns());
  for (const BodyDesign& design : scene.designs)
    for (const std::string& figure : kFigures)
      out.push_back(scene.designs.size() > 1 ? design.body + "." + figure : figure);
  return out;
}

std::string all_candidates(const PreparedCase& prepared) {
  std::string out;
  for (const Part part : parts_of(prepared.scene()))
    for (const std::string& name : candidates(prepared, part))
      out += (out.empty() ? "" : ", ") + name;
  return out;
}

}  // namespace flexmorph::cases
