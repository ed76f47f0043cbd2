#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/base.h"

/// Closed outlines from the drawings of other programs.
namespace flexmorph::io {

/// How a drawing is read.
struct DrawingSettings {
  std::optional<double> unit = {};              ///< metres in one unit; absent: as the file says
  std::vector<std::string> layers = {};         ///< of a DXF file; empty: all
  std::string needs_unit = "`unit` is needed";  ///< what helps where the file says no unit
};

/// Sides of curves stay within this part of the drawing's size of them; ends that are as near to
/// each other meet.
constexpr double kDrawingTolerance = 1e-5;

/// Closed curves of a drawing as polygons: vertices lie on the curves [m]. By the end of its name
/// the file is DXF or SVG.
///
/// DXF: LWPOLYLINE and POLYLINE with their arcs, CIRCLE, ELLIPSE, SPLINE with control points, and
/// chains of LINE, ARC, open splines and open polylines; texts, dimensions, hatches and points are
/// passed over. The unit is that of $INSUNITS. SVG: path, polygon, polyline, rect, circle, ellipse
/// with the transformations above them. The unit is that of width and height; lengths in px have
/// none. The origin is the lower left corner of the page, y goes up.
///
/// @throws Error (input) "<path>: ..." for a file that cannot be read, that says no unit where none
/// is given, that is empty, has open curves or what is not known here.
std::vector<std::vector<Vec2>> read_drawing(const std::string& path,
                                            const DrawingSettings& settings);

/// Names of the layers of a DXF file that something is drawn on, in alphabetical order.
/// @throws Error (input) "<path>: ..." for a file that cannot be read.
std::vector<std::string> layers_of_dxf(const std::string& path);

/// What the readers of all formats share.
namespace drawing {

/// A curve from at(0) to at(1) [of the drawing].
struct Curve {
  std::function<Vec2(double)> at;
  bool straight = false;
};

/// A closed ring, or a part of a chain that others close.
struct Path {
  std::vector<Curve> curves;
  bool closed = false;

  Vec2 begin() const { return curves.front().at(0); }
  Vec2 end() const { return curves.back().at(1); }
};

struct Drawing {
  std::vector<Path> paths;
  std::optional<double> unit = {};  ///< metres in one unit, where the file says it
};

Curve line(const Vec2& from, const Vec2& to);
/// From one angle to another on an ellipse with the half-axes `major` and `minor` [rad].
Curve arc(const Vec2& center, const Vec2& major, const Vec2& minor, double from, double to);

/// A rational B-spline as drawings have it.
struct Spline {
  unsigned degree = 3;
  std::vector<double> knots;    ///< ascending (n_points + degree + 1)
  std::vector<Vec2> points;     ///< control points
  std::vector<double> weights;  ///< positive (n_points)
};
/// The pieces of a spline between its knots, one after the other.
/// @throws Error (input) for numbers of knots and points that do not fit, knots that fall, or
///         weights that are not positive.
std::vector<Curve> spline(Spline s);

/// The closed curves of a drawing as polygons, open ones joined end to end [m].
/// @param unit  metres in one unit of the drawing
/// @throws Error (input) as read_drawing(), without the path.
std::vector<std::vector<Vec2>> closed_rings(Drawing drawing, double unit);

constexpr std::size_t kMostCurves = 100'000;
Drawing read_dxf(const std::string& text, const std::vector<std::string>& layers);
std::vector<std::string> dxf_layers(const std::string& text);
Drawing read_svg(const std::string& text);

}  // namespace drawing
}  // namespace flexmorph::io
