#pragma once

#include <string>
#include <vector>

#include "fem/joint.h"

namespace flexmorph::fem {

/// The constraint rows of the nodes of a welded edge, in the axes e₁, e₂ of the frame. make_weld()
/// and make_edge_weld() share them, independent of what moves the frame.
struct WeldRows {
  /// Prescribes a vector as  moves · origin + local.x e₁ + local.y e₂.
  struct Fixed {
    int vector;    ///< Number of the vector unknown.
    double moves;  ///< Factor of the origin of the frame: 1 for positions, 0 for gradients.
    Vec2 local;    ///< Coordinates in the axes of the frame.
  };
  /// Prescribes that a vector has no component along  normal.x e₁ + normal.y e₂.
  struct Along {
    int vector;   ///< Number of the vector unknown.
    Vec2 normal;  ///< Direction in the axes of the frame.
  };
  std::vector<Fixed> fixed;  ///< Prescribed vectors.
  std::vector<Along> along;  ///< Vectors without a component along a direction.
  std::vector<int> flat;     ///< Numbers of the vectors in space whose z entry is zero.
};

/// The vectors of an edge in the undeformed body, in its axes e₁ along m and e₂.
struct EdgeVectors {
  Vec2 r_m{1, 0}, r_n{0, 1};  ///< Position gradients r_m and r_n in the axes e₁, e₂.
};

/// Returns the reference vectors of an edge: the unit axes for a plate, and the nodal reference
/// vectors for the end of a beam, which may be tapered or sheared.
inline EdgeVectors edge_vectors(const Element& element, const std::vector<NodeVectors>& nodes) {
  if (nodes.size() > 1) return {};
  const MatrixXd reference = element.reference();
  const Vec2 axis = reference.row(nodes[0].r_m), section = reference.row(nodes[0].r_n);
  const Vec2 e1 = axis.normalized();
  return {{axis.norm(), 0}, {e1.dot(section), e1.x() * section.y() - e1.y() * section.x()}};
}

/// Returns the constraint rows of a welded edge.
/// @throws Error (input) for `partial` at the edge of a plate.
inline WeldRows weld_rows(const Element& element, const std::vector<NodeVectors>& nodes,
                          WeldMode mode, const std::string& joint) {
  const bool beam = nodes.size() == 1;
  if (mode == WeldMode::partial && !beam)
    throw Error::input("joint '" + joint +
                       "': a partial weld is only available for the end of a beam");
  const auto across = [](const Vec2& x) { return Vec2(-x.y(), x.x()); };
  const auto [r_m, r_n] = edge_vectors(element, nodes);
  WeldRows out;
  for (const NodeVectors& node : nodes) {
    out.fixed.push_back({node.r, 1, {0, beam ? 0 : node.material.y()}});
    // A plate of cells has no gradients; its nodes keep the edge straight.
    if (node.r_n < 0) continue;
    if (mode == WeldMode::partial)
      out.along.push_back({node.r_n, across(r_n)});
    else
      out.fixed.push_back({node.r_n, 0, r_n});
    for (const int vector : {node.r_m, node.r_mn}) {
      if (vector < 0) continue;
      if (mode == WeldMode::direction) out.along.push_back({vector, {0, 1}});
      if (mode == WeldMode::full)
        out.fixed.push_back({vector, 0, vector == node.r_m ? r_m : Vec2(0, 0)});
    }
    if (element.dim() == 3)
      for (const int vector : {node.r, node.r_n, node.r_m, node.r_mn})
        if (vector >= 0) out.flat.push_back(vector);
  }
  return out;
}

}  // namespace flexmorph::fem
