#include "cases/scene/measure.h"

#include <map>

namespace flexmorph::cases {
namespace {

const std::map<std::string, std::vector<const char*>>& columns_of() {
  static const std::map<std::string, std::vector<const char*>> kColumns = {
      {"temperature", {"temperature"}},
      {"max_elastic_strain", {"max_elastic_strain"}},
      {"midpoint_deflection", {"midpoint_deflection"}},
      {"end_displacements", {"root_ux", "root_uy", "end_ux", "end_uy"}},
      {"end_velocity", {"end_vx", "end_vy"}},
      {"end_slopes", {"end_rx", "end_ry"}},
      {"free_expansion", {"free_ux", "free_uy", "free_kinetic"}}};
  return kColumns;
}

}  // namespace

const std::vector<std::string>& measured_quantities() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& [name, columns] : columns_of()) names.push_back(name);
    return names;
  }();
  return kNames;
}

std::vector<std::string> measured_columns(const Measure& measure) {
  std::vector<std::string> out;
  for (const std::string& quantity : measure.quantities)
    for (const char* column : columns_of().at(quantity)) out.push_back(measure.body + "." + column);
  return out;
}

std::string refusal_of_measure(const Scene& scene, const Body& body, const std::string& quantity) {
  if (body.flow || body.has_free_lines() || body.mesh_changes())
    return "bodies are measured whose material does not flow and whose lines are not free";
  if (body.in_space() && quantity != "temperature" && quantity != "max_elastic_strain")
    return "this is measured of bodies in the plane";
  const bool hot = quantity == "temperature" || quantity == "free_expansion";
  if (hot && !body.heat) return "'" + body.name + "' has no [body.heat]";
  if (scene.statics && quantity == "end_velocity") return "nothing moves in a [static] analysis";
  return "";
}

}  // namespace flexmorph::cases
