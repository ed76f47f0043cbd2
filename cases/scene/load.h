#pragma once

#include <string>

#include "geometry/base.h"

/// [[load]] on bodies that move.
namespace flexmorph::cases {

/// A load on a body: a row of this table,
///
/// point        `force` [N] at a material point      edge         `force` [N/m] along an edge
/// surface      `force` [N/m^2]                      pressure     `size` [N/m^2], follows
/// edge_moment  `size` [N] per length of an edge, follows
struct BodyLoad {
  std::string type, body;
  std::string edge;
  Vec2 point{0, 0};  ///< material [m]
  VectorXd force;    ///< (dim)
  double size = 0;
};

}  // namespace flexmorph::cases
