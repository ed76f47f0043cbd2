#pragma once

#include <span>
#include <string>

#include "geometry/parts/part_mesh.h"

/// Pictures of what a part does.
namespace flexmorph::io {

/// A field on a part that is displaced: values from zero on in colours, as of Picture::Colors::map.
struct PartPicture {
  std::string title = {};  ///< a line above
  std::string unit = {};   ///< of the values
  /// At the nodes (n), linear between corners and middles of sides.
  std::span<const double> values = {};
  std::span<const double> displacement = {};   ///< (2 n) [m]; empty: none
  double upper = 0;                            ///< the lightest colour, also of what is above; > 0
  double magnification = 1;                    ///< of the displacement
  std::span<const signed char> left_out = {};  ///< triangles that are not shown displaced (1)
};

/// An SVG with the picture in it, pixel by pixel: the part in its place in grey, and displaced in
/// colours above it; a bar says which.
/// @throws Error (numerical) for values that are too few, or not finite.
std::string part_svg(const PartMesh& mesh, const PartPicture& picture);

/// Times as large as the displacement of a part (2 n) can be shown: 1, 2 or 5 times a power of
/// ten, so that the largest is at most an eighth of the part; 1 without displacement.
double clear_magnification(const PartMesh& mesh, std::span<const double> displacement);

}  // namespace flexmorph::io
