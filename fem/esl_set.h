#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/grid.h"

namespace flexmorph::fem {

/// A force at a node of the design mesh, in the frame of the body.
struct NodalForce {
  int node = 0;      ///< Number of the node in the design mesh.
  Vec2 force{0, 0};  ///< Force in the axes of the body frame [N].
};

/// One equivalent static load: the displacements, accelerations and forces of one body at one time,
/// on its design mesh.
///
/// All vectors are in the body frame, ordered node by node with (x, y) interleaved: entry 2 node +
/// c. The body frame has the origin and the axes of the hub (the rigid frame with prescribed motion
/// that carries the body) at that time; for a body between two pins it is the frame of the line
/// through the pins.
///
/// Source: fem/README.md, Equivalent static loads; the idea P (31), (32).
struct EslSet {
  double time = 0;    ///< Time of the load [s].
  double weight = 1;  ///< Weight w_i of P (35) [-].

  /// Column i of nodes on the root line; nodes of lower columns are inside the hub.
  int root_column = 0;
  /// Elastic displacement w_i (2 n_nodes) [m]. For a body with a temperature change it is measured
  /// from the position after free thermal growth about the root, for other bodies from the
  /// undeformed position. It is zero inside the root line; on the root line it is -held_stretch (0,
  /// Y).
  VectorXd deformation;
  /// Material acceleration minus gravity (2 n_nodes) [m/s²]. Inside the hub it is continued
  /// smoothly by the acceleration of the rigid, extending body. This has no effect on the loads,
  /// because the rows outside never use these entries, and it keeps the rank of the set of all
  /// loads small.
  VectorXd acceleration;
  /// Concentrated forces: -m a of point masses, and applied loads.
  std::vector<NodalForce> forces;
  /// Strain energy of the body in the motion at that time [J]; it is compared with 1/2 w · K w.
  double strain_energy = 0;
  /// Thermal strain a_i = α ΔT [-]: a free body is 1 + a_i times as large.
  double thermal_stretch = 0;
  /// Fraction of the thermal strain that is prevented across the root line [-]: a_i where the root
  /// cannot grow, 0 where it grows freely.
  double held_stretch = 0;
  /// Thermal strain that a joint prevents across the far edge [-]; 0 where no joint holds that
  /// edge.
  double held_end_stretch = 0;
};

/// The equivalent static loads of one body: the data that dynamics passes to the design problem.
struct EslSets {
  Grid grid;  ///< Design mesh over the largest length of the body; the root side is at x0 [m].
  std::vector<EslSet> sets;  ///< Loads at the chosen times.

  /// Nodes of the pins of a body between two pins; absent otherwise.
  std::optional<std::array<int, 2>> pins = {};
};

}  // namespace flexmorph::fem
