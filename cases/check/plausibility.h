#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/build.h"
#include "cases/assembly/resource_estimate.h"

/// Numbers by which a wrong unit shows: 5 Pa, 50 m, degrees for radians.
namespace flexmorph::cases {

/// How a strip is held, as far as its bending depends on it.
enum class Support {
  none,        ///< free
  one_point,   ///< turns about one point
  cantilever,  ///< one edge is held, with its direction
  two_places   ///< between two or more points, taken for pins
};

/// Bending of a plate or beam as of a slender strip of its longest length L and the depth d that it
/// bends by (thickness in space, width in the plane): f = c / (2 π L²) √(E/ρ) d/√12, with c of its
/// support (1.8751² of a cantilever, π² between pins, 3.9266² about one, 4.7300² free).
struct BendingFigures {
  std::string body;
  Support support = Support::none;
  double length = 0;                    ///< of the longer arm where it is held in between [m]
  double depth = 0;                     ///< [m]
  std::array<double, 2> frequencies{};  ///< the lowest [Hz]; 0: statics without weight
  double step_frequency = 0;            ///< h times the lowest [-]; 0: nothing moves
  std::optional<double> sag, bend;      ///< under gravity, under its loads, by length; linear
  double slenderness() const { return length / depth; }
};
std::vector<BendingFigures> bending_figures(const Scene& scene);

/// Rotation of a hub, or of the drive of an angle.
struct TurnFigures {
  std::string what, key;
  double angle = 0;     ///< largest size over the run, from the start [rad]
  double per_step = 0;  ///< on the average; 0 where steps adapt [rad]
};
std::vector<TurnFigures> turn_figures(const Scene& scene);

/// Returns a sentence on every number that is out of the ordinary, with its place in the case.
std::vector<std::string> odd_remarks(const Scene& scene);

/// Returns a line of a summary.
std::string summary_row(const std::string& what, const std::string& words);

/// Returns the part of a summary that makes mistakes visible: lowest frequencies, deflections,
/// turns, what the run will take, and what is out of the ordinary.
/// @param mechanism  of a scene that moves, else null
std::string figures_text(const Scene& scene, const Mechanism* mechanism, const Machine& machine);

}  // namespace flexmorph::cases
