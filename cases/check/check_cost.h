#pragma once

#include "cases/assembly/build.h"

namespace flexmorph::cases {

/// Estimated operations of a time step, or of a step of a [static] path.
struct StepOperations {
  double forces = 0, tangents = 0, solver = 0, flow = 0;
  double total() const { return forces + tangents + solver + flow; }
};

/// From counts of elements, shape functions, Gauss points and unknowns, and from how often Newton's
/// method asks on the average of the shipped cases: within a factor of 2 of instructions counted by
/// valgrind in a build for all processors (README, "Measured"). Not of `minimal_coordinates`.
StepOperations step_operations(const Scene& scene, const Mechanism& mechanism);

/// CPU time of a run [s]: all its motions, and as many iterations as its designs may take. Within a
/// factor of three of the shipped cases on one core of 2020; of adaptive steps at the least.
/// @param mechanism  of a scene that moves, else null
double expected_seconds(const Scene& scene, const Mechanism* mechanism);

}  // namespace flexmorph::cases
