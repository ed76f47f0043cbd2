#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/base.h"
#include "io/drawings/length_unit.h"

/// The output of a run, and the results that it is expected to have.
namespace flexmorph::cases {

/// Quantities of a body that are written as results ([[measure]]), see BodyMeasures.
struct MeasureRequest {
  std::string body;                     ///< Name of the measured body.
  std::vector<std::string> quantities;  ///< Names out of measured_quantities().
};

/// A material point whose position is written as a result ([[observe]]).
struct Observe {
  std::string name, body;  ///< Name of the point, and name of its body.
  Vec2 point{0, 0};        ///< Material coordinates of the point [m].
};

/// The output of a run: [output].
struct Output {
  std::string directory;    ///< Run folder; empty: the command line chooses it.
  int design_every = 1;     ///< Design iterations between VTK files; 0: none are written.
  int fields_every = 25;    ///< Design iterations between VTK files of all fields; 0: last only.
  double motion_every = 0;  ///< Time between VTK files of the motion [s]; 0: none are written.
  int crisp_every = 25;     ///< Iterations between crisp evaluations; 0: final design only.
  bool vtk = true, plots = true;          ///< True if VTK files (plots) are written.
  io::LengthUnit unit = io::kMillimetre;  ///< Unit of length of exported drawings and solids.
  double tolerance = 0;  ///< Tolerance of exported curves [m]; 0: see export_tolerance().
};

/// A number that a run must reproduce: a value with a tolerance, bounds, or both.
struct Expectation {
  std::optional<double> value, at_least, at_most;  ///< Value, lower bound and upper bound.
  double tolerance = 0;                            ///< Absolute tolerance of `value`.
  std::string location;                            ///< File and line, for messages.

  /// Returns true if a number satisfies the value and the bounds; NaN never does.
  bool holds(double found) const;
};

}  // namespace flexmorph::cases
