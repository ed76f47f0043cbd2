#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/base.h"
#include "io/drawings/length_unit.h"

/// What a run shows, and what it must reproduce.
namespace flexmorph::cases {

/// Quantities of a body that are results, see BodyMeasures.
struct Measure {
  std::string body;
  std::vector<std::string> quantities;
};

/// A material point whose position is a result.
struct Observe {
  std::string name, body;
  Vec2 point{0, 0};  ///< material [m]
};

struct Output {
  std::string directory;    ///< empty: chosen by the command line
  int design_every = 1;     ///< design iterations between VTK files, 0: none
  double motion_every = 0;  ///< time between VTK files of the motion [s], 0: none
  int sharp_every = 25;     ///< iterations between sharp evaluations, 0: the final design only
  bool vtk = true, plots = true;
  io::LengthUnit unit = io::kMillimetre;  ///< of exported drawings and solids
  double tolerance = 0;  ///< of exported curves [m]; 0: not given, see export_tolerance()
};

/// A number the run must reproduce: value with a tolerance, or bounds.
struct Expectation {
  std::optional<double> value, at_least, at_most;
  double tolerance = 0;  ///< absolute, around `value`
  std::string place;     ///< file and line, for messages

  bool holds(double found) const;
};

}  // namespace flexmorph::cases
