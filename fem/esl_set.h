#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/grid.h"

namespace flexmorph::fem {

/// A force at a node of the design mesh, in the body frame [N].
struct NodalForce {
  int node = 0;
  Vec2 force{0, 0};
};

/// One equivalent static load: the snapshot of one body at one time on its design mesh.
///
/// All vectors are in the body frame (origin and axes of the hub at that time; of a link, of the
/// line through its pins), node by node, (x, y) interleaved: entry 2 node + c.
///
/// Source: fem/README.md, Equivalent static loads; the idea P (31), (32).
struct EslSet {
  double time = 0;      ///< [s]
  double weight = 1;    ///< w_i of P (35)
  int root_column = 0;  ///< column i of nodes on the root line; columns < i are inside
  /// Elastic displacement w_i (2 n_nodes) [m]: of a hot body from where it would be had it grown
  /// freely about its root, of a cold one the displacement itself. Zero inside the root line; on it
  /// -held_stretch (0, Y).
  VectorXd deformation;
  /// Material acceleration minus gravity (2 n_nodes) [m/s^2]. Inside the hub it is continued
  /// smoothly (the acceleration of the rigid, extending body), which costs nothing, because rows
  /// outside never see it, and keeps the rank of all loads together small.
  VectorXd acceleration;
  std::vector<NodalForce> forces;  ///< concentrated forces: -m a of point masses, applied loads
  double strain_energy = 0;    ///< of the body in the motion at that time [J]; beside it 1/2 w.K w
  double thermal_stretch = 0;  ///< a_i = α ΔT: free, the body is 1 + a_i times as large [-]
  /// What is missing of it across the root line: a_i where that cannot grow, 0 where it is free to.
  double held_stretch = 0;
  /// The same across the far edge, where a joint holds it; 0 where none does.
  double held_end_stretch = 0;
};

/// The loads of one body: what dynamics hands to the design problem.
struct EslSets {
  Grid grid;  ///< design mesh over the longest extent, root side at x0
  std::vector<EslSet> sets;
  std::optional<std::array<int, 2>> pins = {};  ///< nodes of a link between two pins
};

}  // namespace flexmorph::fem
