#pragma once

#include <string>
#include <vector>

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
/// processors. It is not valid for `minimal_coordinates`.
StepOperations step_operations(const Scene& scene, const Mechanism& mechanism);

/// The expected cost of one phase of a run.
struct PhaseCost {
  std::string name;    ///< Name that the run shows: "design", "motion on cells", ...
  std::string kind;    ///< Kind of computation: one kind has one ratio of true to expected time.
  int cycle = 0;       ///< Number of the cycle it belongs to, from 1; 0: no cycle.
  double seconds = 0;  ///< Expected CPU time [s].
  bool may_end_early = false;  ///< True for iterations, whose number is an upper bound.
  int group = 0;               ///< Phases with the same group (not 0) may run at the same time.
};

/// The expected CPU time of an iteration of one design [s].
struct IterationCost {
  std::string body;        ///< Name of the designed body.
  double plain = 0;        ///< Without constraints on widths.
  double with_widths = 0;  ///< With constraints on widths, which need the exact outline.
};

/// Returns the expected costs of the iterations of all designs.
std::vector<IterationCost> iteration_costs(const Scene& scene);

/// Returns the phases of a run in the order in which they run, with all permitted cycles and
/// iterations. The sum of the first cycle is within a factor of three for the shipped cases on one
/// core of 2020; with adaptive steps it is a lower bound.
/// @param mechanism  mechanism of a scene that moves, else null
std::vector<PhaseCost> phase_costs(const Scene& scene, const Mechanism* mechanism);

/// The expected CPU time of a run [s].
struct ExpectedSeconds {
  double one_cycle = 0;  ///< Time if the first cycle of motion and design is the last one.
  double most = 0;       ///< Time with all permitted cycles and iterations.
};
/// Returns the expected CPU time of a run: the sums of phase_costs() and the start.
ExpectedSeconds expected_seconds(const Scene& scene, const Mechanism* mechanism);

}  // namespace flexmorph::cases
