#pragma once

#include <string>
#include <vector>

#include "fem/dofs.h"
#include "fem/dynamics/mesh_changes/mesh_map.h"

namespace flexmorph::fem {

/// How much of a motion is kept in memory.
enum class Keep {
  nothing,
  stops,  ///< the start, the stops that were asked for, the end
  steps   ///< the start, every accepted step, and the state after every change of the mesh
};

/// A motion as a value: states in the order of time, with their multipliers, and what happened to
/// their vectors between them.
struct Trajectory {
  /// A state, as an observer of the motion saw it (MotionStep).
  struct Point {
    State x;
    bool stop = false;  ///< at one of the stops, or the end
  };
  /// A change of a mesh. With Keep::steps `map` was applied to points[after].x, and
  /// points[after + 1].x is what balance_forces() made of it, its velocity moved onto the
  /// constraints.
  struct Change {
    double time = 0;  ///< [s]
    std::string body;
    MeshChange change = MeshChange::insertion;
    size_t after = 0;  ///< last point kept before it
    double line = 0;   ///< place of the line that came or went [m]
    MeshMap map;
  };

  std::vector<Point> points;
  std::vector<Change> changes;  ///< none with Keep::nothing
};

}  // namespace flexmorph::fem
