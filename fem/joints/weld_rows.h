#pragma once

#include <string>
#include <vector>

#include "fem/joint.h"

namespace flexmorph::fem {

/// What the weld of an edge asks of its nodes, in the axes e₁, e₂ of the frame: the rows of
/// make_weld() and make_edge_weld(), whatever moves the frame.
struct WeldRows {
  struct Fixed {  ///< the vector is  moves · origin + local.x e₁ + local.y e₂
    int vector;
    double moves;
    Vec2 local;
  };
  struct Along {  ///< the vector has no part along  normal.x e₁ + normal.y e₂
    int vector;
    Vec2 normal;
  };
  std::vector<Fixed> fixed;
  std::vector<Along> along;
  std::vector<int> flat;  ///< vectors in space whose z entry is zero
};

/// The vectors of an edge in the undeformed body, in its axes e₁ along m and e₂.
struct EdgeVectors {
  Vec2 r_m{1, 0}, r_n{0, 1};
};

/// A tapered or sheared end of a beam keeps its own.
inline EdgeVectors edge_vectors(const Element& element, const std::vector<NodeVectors>& nodes) {
  if (nodes.size() > 1) return {};
  const MatrixXd reference = element.reference();
  const Vec2 axis = reference.row(nodes[0].r_m), section = reference.row(nodes[0].r_n);
  const Vec2 e1 = axis.normalized();
  return {{axis.norm(), 0}, {e1.dot(section), e1.x() * section.y() - e1.y() * section.x()}};
}

/// @throws Error (input) for `partial` at the edge of a plate.
inline WeldRows weld_rows(const Element& element, const std::vector<NodeVectors>& nodes,
                          WeldMode mode, const std::string& joint) {
  const bool beam = nodes.size() == 1;
  if (mode == WeldMode::partial && !beam)
    throw Error::input("joint '" + joint + "': only the end of a beam is welded partially");
  const auto across = [](const Vec2& x) { return Vec2(-x.y(), x.x()); };
  const auto [r_m, r_n] = edge_vectors(element, nodes);
  WeldRows out;
  for (const NodeVectors& node : nodes) {
    out.fixed.push_back({node.r, 1, {0, beam ? 0 : node.material.y()}});
    if (node.r_n < 0) continue;  // a plate of cells: straight as its nodes are
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
