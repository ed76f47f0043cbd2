#pragma once

#include <array>
#include <string>
#include <vector>

/// Pixel images and the colours of values.
namespace flexmorph::io {

/// A pixel image: rows from the top, with one value (grey) or three (red, green, blue) per pixel.
struct Pixels {
  int width = 0, height = 0, channels = 3;  ///< Number of columns, rows and values per pixel.

  /// Values of all pixels, row by row (width height channels).
  std::vector<unsigned char> values = {};
};

/// Returns an image as the bytes of a .png file.
/// @throws Error (numerical) when VTK cannot encode it.
std::string png(const Pixels& pixels);

/// Returns a colour between dark violet, blue, green and yellow. The lightness increases, therefore
/// the scale can also be read without colours.
/// @param share  position in the scale, 0 to 1
std::array<unsigned char, 3> map_color(double share);

}  // namespace flexmorph::io
