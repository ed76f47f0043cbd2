#pragma once

#include <optional>
#include <span>
#include <string>

#include "geometry/parts/part_mesh.h"

/// Pictures of results on the mesh of a part.
namespace flexmorph::io {

/// A picture of a field on a displaced part. Values from zero up to `upper` are shown with the
/// colours of map_color().
struct PartPicture {
  std::string title = {};  ///< Title above the picture.
  std::string unit = {};   ///< Unit of the values.

  /// Values at the nodes (n), linear between corners and middles of sides.
  std::span<const double> values = {};
  std::span<const double> displacement = {};  ///< Displacements (2 n) [m]; empty: none.
  double upper = 0;  ///< Value with the lightest colour, which larger values have, too; > 0.
  double magnification = 1;  ///< Factor by which displacements are magnified.

  std::optional<Vec2> marked = {};  ///< Position of a node that a circle marks [m].
  std::string mark = {};            ///< Meaning of the circle, beside the bar of colours.

  /// Value 1 for triangles that are not shown displaced.
  std::span<const signed char> left_out = {};
};

/// Returns an SVG page with the picture as an image: the undisplaced part in grey, the displaced
/// part in colours above it, and a bar that explains the colours.
/// @throws Error (numerical) when the number of values is wrong, a value is not finite, or `upper`
///         is not positive.
std::string part_svg(const PartMesh& mesh, const PartPicture& picture);

/// Returns a factor to magnify the displacements of a part (2 n) [m]: 1, 2 or 5 times a power of
/// ten, such that the largest displacement is at most an eighth of the size of the part; 1 if there
/// is none.
double clear_magnification(const PartMesh& mesh, std::span<const double> displacement);

}  // namespace flexmorph::io
