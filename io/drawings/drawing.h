#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/base.h"

/// Closed outlines from drawings of other programs.
namespace flexmorph::io {

/// Settings for reading a drawing.
struct DrawingSettings {
  /// Length of one unit [m]; absent: the unit that the file gives.
  std::optional<double> unit = {};
  std::vector<std::string> layers = {};  ///< Layers of a DXF file that are read; empty: all.

  /// Advice in the message for a file without a unit.
  std::string needs_unit = "`unit` is needed";
};

/// Relative tolerance of drawings. Sides of polygons are within this fraction of the size of the
/// drawing of their curves, and ends of curves that are closer to each other meet.
constexpr double kDrawingTolerance = 1e-5;

/// The closed curves of a drawing.
struct DrawnOutlines {
  std::vector<std::vector<Vec2>> rings;  ///< Polygons whose vertices lie on the curves [m].

  /// Sentences about the contents of the drawing that were ignored.
  std::vector<std::string> notes;
};

/// Returns the closed curves of a drawing. The file name extension decides between DXF and SVG.
/// Lines of no length and curves that are drawn twice are ignored.
///
/// DXF: read are LWPOLYLINE and POLYLINE with their arcs, CIRCLE, ELLIPSE, SPLINE with control
/// points, and chains of LINE, ARC, open splines and open polylines. Texts, dimensions, hatches and
/// points are ignored, and layers for which is_annotation_layer() is true unless `settings` names
/// them. The unit is that of $INSUNITS.
///
/// SVG: read are path, polygon, polyline, line, rect, circle and ellipse with the transformations
/// of the elements that contain them. The unit is that of the attribute width; a width in px gives
/// no unit. The origin is the lower left corner of the page, and y points upwards.
///
/// @throws Error (input) "<path>: ..." for a file that cannot be read, that gives no unit while
///         `settings` has none, that is empty, or that has open curves or elements that are not
///         supported.
DrawnOutlines read_drawing(const std::string& path, const DrawingSettings& settings);

/// Returns the names of the layers of a DXF file on which something is drawn, in alphabetical
/// order.
/// @throws Error (input) "<path>: ..." for a file that cannot be read.
std::vector<std::string> layers_of_dxf(const std::string& path);

/// Returns true if the name of a layer says that the layer has dimensions or texts, such as
/// "DIM", "Text 1" or "defpoints".
bool is_annotation_layer(const std::string& layer);

/// Types and functions that the readers of all formats share.
namespace drawing {

/// A curve from at(0) to at(1), in units of the drawing.
struct Curve {
  std::function<Vec2(double)> at;  ///< Returns the point at a parameter between 0 and 1.
  bool straight = false;           ///< True if the curve is a straight line.
};

/// A closed ring, or an open chain of curves that other paths continue.
struct Path {
  std::vector<Curve> curves;  ///< Curves, each of which begins where the previous one ends.
  bool closed = false;        ///< True if the path is closed.

  /// Returns the first point of the path.
  Vec2 begin() const { return curves.front().at(0); }
  /// Returns the last point of the path.
  Vec2 end() const { return curves.back().at(1); }
};

/// Counts the contents of a drawing that are ignored.
class Ignored {
 public:
  /// Counts one object that is ignored.
  /// @param one, many  what the object is, for a note about one and about several objects
  /// @param location   text about the location of the object; empty: unknown
  void add(const std::string& one, const std::string& many, const std::string& location = "");
  /// Returns a sentence about each kind of object.
  std::vector<std::string> notes() const;

 private:
  struct Kind {
    std::string one, many, location;
    int count = 0;
  };
  std::vector<Kind> kinds_;
};

/// The contents of a drawing.
struct Drawing {
  std::vector<Path> paths;          ///< Closed and open paths.
  std::optional<double> unit = {};  ///< Length of one unit [m], if the file gives it.
  Ignored ignored = {};             ///< Contents that are not in `paths`.
};

/// Returns the straight line between two points.
Curve line(const Vec2& from, const Vec2& to);
/// Returns the arc of an ellipse with the half-axes `major` and `minor` between two angles [rad].
Curve arc(const Vec2& center, const Vec2& major, const Vec2& minor, double from, double to);

/// A rational B-spline in the form of drawing files.
struct Spline {
  unsigned degree = 3;          ///< Degree of the polynomials.
  std::vector<double> knots;    ///< Knots, ascending (n_points + degree + 1).
  std::vector<Vec2> points;     ///< Control points (n_points).
  std::vector<double> weights;  ///< Weights, positive (n_points).
};
/// Returns the segments of a spline between its knots, in their order.
/// @throws Error (input) when the numbers of knots and points do not fit, when knots are not
///         ascending, or when weights are not positive.
std::vector<Curve> spline(Spline s);

/// Returns the closed curves of a drawing; open curves are joined end to end.
/// @param unit  length of one unit of the drawing [m]
/// @throws Error (input) as read_drawing(), without the path.
DrawnOutlines closed_rings(Drawing drawing, double unit);

/// Largest number of curves that a drawing may have.
constexpr std::size_t kMaxCurves = 100'000;
/// Returns the contents of a DXF file.
/// @param layers  layers that are read; empty: all
Drawing read_dxf(const std::string& text, const std::vector<std::string>& layers);
/// Returns the names of the layers of a DXF file on which something is drawn.
std::vector<std::string> dxf_layers(const std::string& text);
/// Returns the contents of an SVG file.
Drawing read_svg(const std::string& text);

}  // namespace drawing
}  // namespace flexmorph::io
