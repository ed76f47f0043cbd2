#include "cases/scene/measure.h"

#include <map>

namespace flexmorph::cases {
namespace {

const std::map<std::string, std::vector<MeasuredColumn>>& all_quantities() {
  static const std::map<std::string, std::vector<MeasuredColumn>> kColumns = {
      {"temperature", {{"temperature", "K", "temperature rise of the body"}}},
      {"max_elastic_strain",
       {{"max_elastic_strain", "-",
         "largest entry of the elastic Green strain over the Gauss points"}}},
      {"midpoint_deflection",
       {{"midpoint_deflection", "m",
         "deflection of the middle of the axis across the line between its ends"}}},
      {"end_displacements",
       {{"root_ux", "m", "displacement of the root along x"},
        {"root_uy", "m", "displacement of the root along y"},
        {"end_ux", "m", "displacement of the free end along x"},
        {"end_uy", "m", "displacement of the free end along y"}}},
      {"end_velocity",
       {{"end_vx", "m/s", "velocity of the free end along x"},
        {"end_vy", "m/s", "velocity of the free end along y"}}},
      {"end_slopes",
       {{"end_rx", "-", "length of the position gradient along the axis at the free end"},
        {"end_ry", "-", "length of the position gradient across the axis at the free end"}}},
      {"free_expansion",
       {{"free_ux", "m", "displacement along x of the end of an unconstrained body (closed form)"},
        {"free_uy", "m", "displacement along y of the end of an unconstrained body (closed form)"},
        {"free_kinetic", "J", "kinetic energy of an unconstrained body (closed form)"}}}};
  return kColumns;
}

}  // namespace

const std::vector<std::string>& measured_quantities() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& [name, columns] : all_quantities()) names.push_back(name);
    return names;
  }();
  return kNames;
}

const std::vector<MeasuredColumn>& columns_of_quantity(const std::string& quantity) {
  return all_quantities().at(quantity);
}

std::string refusal_of_measure(const Scene& scene, const Body& body, const std::string& quantity) {
  if (body.flow || body.has_eulerian_lines() || body.mesh_changes())
    return "a measured body has no material flow and no free lines";
  if (body.in_space() && quantity != "temperature" && quantity != "max_elastic_strain")
    return "this quantity is defined for bodies in the plane only";
  const bool hot = quantity == "temperature" || quantity == "free_expansion";
  if (hot && !body.heat) return "'" + body.name + "' has no [body.heat]";
  if (scene.statics && quantity == "end_velocity") return "a [static] analysis has no velocities";
  return "";
}

}  // namespace flexmorph::cases
