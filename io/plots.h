#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/components/outline.h"

/// Pictures as SVG text, for files and for the report.
namespace flexmorph::io {

/// One line of a plot. A point that is not finite (or not positive on a logarithmic axis) leaves
/// a gap.
struct Curve {
  std::string name = {};  ///< in the legend; empty: not there
  std::vector<double> x = {}, y = {};
  bool line = true, markers = false, dashed = false;
  std::optional<size_t> color = {};  ///< place in the list of colours; absent: that of the curve
  bool thin = false;
};

struct Axis {
  std::string label = {};  ///< with its unit: "time [s]"
  bool logarithmic = false;
  std::optional<double> lower = {}, upper = {};  ///< from the data where absent
};

struct Panel {
  std::string title = {};
  Axis x = {}, y = {};
  std::vector<Curve> curves = {};
};

/// Panels below each other.
struct Figure {
  std::string title = {};
  std::vector<Panel> panels = {};
  int width = 760, panel_height = 300;  ///< [px]
};

/// The figure as SVG.
std::string plot_svg(const Figure& figure);

/// Positions of ticks at 1, 2 or 5 times a power of ten, about `wanted` of them in [lower, upper].
std::vector<double> nice_ticks(double lower, double upper, int wanted);

/// Regions with holes as one filled path, in metres, y up, inside `frame`, true to scale: one unit
/// of the view box is one metre, the page is as large as the design. Coordinates with so many
/// digits, all where 0: five are enough to look at, and half as long.
std::string outline_svg(std::span<const Region> regions, const Box& frame, int digits = 0);

}  // namespace flexmorph::io
