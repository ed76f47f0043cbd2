#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cases/assembly/build.h"

/// Figures by which a wrong unit shows: 5 Pa, 50 m, degrees for radians.
namespace flexmorph::cases {

/// How a strip is held, as far as its bending asks.
enum class Support {
  none,        ///< free
  one_point,   ///< turns about one place
  cantilever,  ///< one edge is held, with its direction
  two_places   ///< between two or more, taken for pins
};
std::string to_string(Support support);

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

/// What turns: a hub, or the drive of an angle.
struct TurnFigures {
  std::string what, key;
  double angle = 0;     ///< largest size over the run, from the start [rad]
  double per_step = 0;  ///< on the average; 0 where steps adapt [rad]
};
std::vector<TurnFigures> turn_figures(const Scene& scene);

/// A sentence to everything out of the ordinary, with its place in the case.
std::vector<std::string> odd_remarks(const Scene& scene);

}  // namespace flexmorph::cases
