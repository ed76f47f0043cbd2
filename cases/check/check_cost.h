#pragma once

#include "cases/assembly/build.h"

namespace flexmorph::cases {

/// Estimated floating point operations of a time step, or of a step of a [static] path.
struct StepOperations {
  double forces = 0, tangents = 0, solver = 0, flow = 0;  ///< Operations by their purpose.

  /// Returns the sum of all operations.
  double total() const { return forces + tangents + solver + flow; }
};

/// Estimates the operations of a step from the numbers of elements, shape functions, Gauss points
/// and unknowns, and from the mean numbers of evaluations by Newton's method in the shipped cases.
/// The estimate is within a factor of 2 of the instructions counted by valgrind in a build for all
/// processors (README, "Measured"). It is not valid for `minimal_coordinates`.
StepOperations step_operations(const Scene& scene, const Mechanism& mechanism);

/// Returns the expected CPU time of a run [s]: all its motions, and the largest number of
/// iterations that its designs may take. The value is within a factor of three for the shipped
/// cases on one core of 2020; with adaptive steps it is a lower bound.
/// @param mechanism  mechanism of a scene that moves, else null
double expected_seconds(const Scene& scene, const Mechanism* mechanism);

}  // namespace flexmorph::cases
