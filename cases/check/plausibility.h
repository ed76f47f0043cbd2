#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/assembly/resource_estimate.h"

/// Plausibility checks: numbers that reveal a wrong unit, such as 5 Pa, 50 m, or degrees in place
/// of radians.
namespace flexmorph::cases {

/// Support of a strip, as far as its bending depends on it.
enum class Support {
  none,          ///< The strip is free.
  one_point,     ///< The strip turns about one point.
  cantilever,    ///< One edge is clamped: its direction is held.
  two_locations  ///< The strip is held at two or more points, which are taken as pins.
};

/// Plausibility numbers of the bending of a plate or beam, which is taken as a slender strip with
/// its longest length L and the depth d in the direction of bending (thickness in space, width in
/// the plane): f = c / (2 π L²) √(E/ρ) d/√12 with the factor c of its support (1.8751² of a
/// cantilever, π² between pins, 3.9266² about one pin, 4.7300² free).
struct BendingFigures {
  std::string body;                 ///< Name of the plate or beam.
  Support support = Support::none;  ///< Support of the strip.
  double length = 0;                ///< Length L; of the longer arm if it is held in between [m].
  double depth = 0;                 ///< Depth d in the direction of bending [m].

  /// Two lowest natural frequencies of the strip [Hz]; 0 in a static analysis without gravity.
  std::array<double, 2> frequencies{};

  double step_frequency = 0;  ///< Time step times lowest frequency [-]; 0: no motion.

  /// Deflections under gravity (under the loads) divided by the length, by linear theory [-].
  std::optional<double> sag, bend;

  /// Returns the ratio of length and depth [-].
  double slenderness() const { return length / depth; }
};
/// Returns the plausibility numbers of the bending of all plates and beams.
std::vector<BendingFigures> bending_figures(const Scene& scene);

/// Plausibility numbers of the rotation of a hub, or of a joint whose angle a drive prescribes.
struct TurnFigures {
  std::string what, key;  ///< Text that names the hub or joint, and its key in the case.
  double angle = 0;       ///< Largest absolute angle over the run, relative to the start [rad].
  double per_step = 0;    ///< Mean angle per time step [rad]; 0 with adaptive steps.
};
/// Returns the plausibility numbers of all rotations; none for static scenes and analyses.
std::vector<TurnFigures> turn_figures(const Scene& scene);

/// Returns one sentence about every implausible number, with its location in the case.
std::vector<std::string> plausibility_remarks(const Scene& scene);

/// Number of columns before the text of a line of a summary.
inline constexpr size_t kSummaryIndent = 24;
/// Returns one line of a summary: a name, and the text about it in the second column.
std::string summary_row(const std::string& what, const std::string& words);

/// Returns the section of a summary that makes mistakes visible: slenderness, deflections,
/// rotations, the resource estimate, and implausible numbers.
/// @param mechanism  mechanism of a scene that moves, else null
std::string numbers_text(const Scene& scene, const Mechanism* mechanism, const Machine& machine);

}  // namespace flexmorph::cases
