#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/components/outline.h"

/// Plots as SVG text, for files and for the report.
namespace flexmorph::io {

/// One line of a plot. It is interrupted at points that are not finite (or not positive on a
/// logarithmic axis).
struct Curve {
  std::string name = {};               ///< Name in the legend; empty: not in the legend.
  std::vector<double> x = {}, y = {};  ///< Coordinates of the points.

  /// True for a line, for markers at points, for a dashed line.
  bool line = true, markers = false, dashed = false;
  /// Index in the list of colours; absent: the index of the curve. Curves of equal colour that have
  /// names differ by their dashes, unless `dashed` is true.
  std::optional<size_t> color = {};
  bool thin = false;  ///< True for a thin line.
};

/// One axis of a plot.
struct Axis {
  std::string label = {};                        ///< Label with its unit, such as "time [s]".
  bool logarithmic = false;                      ///< True for a logarithmic axis.
  std::optional<double> lower = {}, upper = {};  ///< Limits; taken from the data if absent.
};

/// One diagram with its axes and curves.
struct Panel {
  std::string title = {};          ///< Title above the diagram.
  Axis x = {}, y = {};             ///< Horizontal and vertical axis.
  std::vector<Curve> curves = {};  ///< Curves of the diagram.
};

/// A page with one or more diagrams below each other.
struct Figure {
  std::string title = {};          ///< Title of the page.
  std::vector<Panel> panels = {};  ///< Diagrams from top to bottom.
  /// Width of the page and height of a diagram with a legend of at most three rows [px].
  int width = 760, panel_height = 300;
};

/// Returns a page of diagrams as SVG text.
std::string plot_svg(const Figure& figure);

/// Returns positions of about `wanted` ticks in [lower, upper], at multiples of 1, 2 or 5 times a
/// power of ten.
std::vector<double> nice_ticks(double lower, double upper, int wanted);

/// Returns an SVG page with regions as one filled path. The page shows `frame` in full size: one
/// unit of the view box is one metre, and y points upwards.
/// @param digits  significant digits of coordinates; 0: all. Five suffice for viewing and halve the
///         size of the text.
std::string outline_svg(std::span<const Region> regions, const Box& frame, int digits = 0);

}  // namespace flexmorph::io
