#pragma once

#include <string>
#include <vector>

#include "fem/dofs.h"
#include "fem/dynamics/mesh_changes/mesh_map.h"

namespace flexmorph::fem {

/// Choice of the states of a motion that are stored in memory.
enum class Keep {
  nothing,  ///< No states.
  stops,    ///< The start, the stops of the settings, and the end.
  steps     ///< The start, every accepted step, and the state after every change of the mesh.
};

/// A stored motion: states in the order of time, with their multipliers, and the changes of the
/// mesh between them, which map the vectors of the states.
struct Trajectory {
  /// A state as the observer of the motion received it (MotionStep).
  struct Point {
    State x;            ///< State of the model.
    bool stop = false;  ///< True if x.t is one of the stops, or the end.
  };
  /// A change of the mesh of one body. With Keep::steps, `map` was applied to points[after].x. The
  /// result, after balance_forces() and after the projection of its velocity onto the constraints,
  /// is points[after + 1].x.
  struct Change {
    double time = 0;                            ///< Time of the change [s].
    std::string body;                           ///< Name of the body.
    MeshChange change = MeshChange::insertion;  ///< Kind of the change.
    size_t after = 0;  ///< Index of the last point that was stored before the change.
    double line = 0;   ///< Material coordinate m of the inserted or removed line [m].
    MeshMap map;       ///< Linear map of the vectors of the model across the change.
  };

  std::vector<Point> points;    ///< Stored states in the order of time.
  std::vector<Change> changes;  ///< Changes of the mesh; empty with Keep::nothing.
};

}  // namespace flexmorph::fem
