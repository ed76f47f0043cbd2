#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "cases/output/run_folder.h"
#include "cases/results/animation.h"
#include "io/plots.h"

/// Data of the scripts of a page as JSON. Positions are integers, as multiples of a length `unit`,
/// because integers are short and are the same on every machine.
namespace flexmorph::cases {

/// Returns the frames of a motion. The unit is 1e-8 of the size of the picture; angles are
/// multiples of 1e-8 rad.
nlohmann::ordered_json animation_data(const Animation& animation);

/// Returns the points of a ring without those that are closer than a tolerance [m] to the line
/// between their neighbours that remain.
std::vector<Vec2> thinned(const std::vector<Vec2>& ring, double tolerance);

/// Returns the displacements of the static loads of a plate on every few nodes of its cells: a grid
/// with at most 24 intervals along its longer side, as multiples of 1e-4 of the largest
/// displacement of each load. The object is empty if no displacements are known.
nlohmann::ordered_json static_loads_data(const Grid& grid, std::span<const StaticLoad> loads);

/// Returns the outline of a design in material coordinates, with tolerance 1e-3 of its size.
/// @param frame  box that contains the design domain
nlohmann::ordered_json outline_data(std::span<const Region> outline, const Box& frame);

/// Returns the components of every iteration. An entry of `components` begins with 1 if its
/// parameters follow, with 0 if their differences from those of the entry before follow; it is
/// empty if the components are unknown.
/// @param frame  box that contains the design domain
nlohmann::ordered_json history_data(const RunFolder::History& history, const Box& frame);

/// Returns the panels of a figure with their curves. Values have six significant digits; of long
/// curves the extreme values of short intervals are kept.
nlohmann::ordered_json figure_data(const io::Figure& figure);

}  // namespace flexmorph::cases
