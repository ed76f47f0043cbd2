#pragma once

#include <string>

#include "cases/scene/elements/row.h"
#include "cases/scene/scene.h"

namespace flexmorph::cases {

/// Returns the reason why plates that are welded node to node cannot move on the cells of their
/// designs; empty if no two plates are welded in this way, or if both have the same number of cells
/// across.
/// @param parts  elements per cell in each direction
inline std::string unmatched_cells(const Scene& scene, int parts) {
  const auto across = [&](const Body& body) {  // number of elements across; 0: not on cells
    for (const BodyDesign& design : scene.designs)
      if (design.body == body.name) return parts * design.grid.ny;
    return body.on_cells() ? body.elements[1] : 0;
  };
  const auto designed = [&](const Body& body) {
    return std::any_of(scene.designs.begin(), scene.designs.end(),
                       [&](const BodyDesign& design) { return design.body == body.name; });
  };
  for (const Joint& joint : scene.joints) {
    if (!joint.joins_edges()) continue;
    const Body &a = scene.body(joint.a.body), &b = scene.body(joint.b.body);
    const bool plates = a.row->across && b.row->across;
    if (plates && (designed(a) || designed(b)) && across(a) != across(b))
      return "'" + b.name + "' is welded to '" + a.name +
             "' node to node, but their nodes do not coincide on the cells of the design";
  }
  return {};
}

}  // namespace flexmorph::cases
