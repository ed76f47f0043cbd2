#pragma once

#include <array>
#include <string>
#include <vector>

/// Pictures of pixels.
namespace flexmorph::io {

/// Rows from the top; of one value (grey) or three (red, green, blue) per pixel.
struct Pixels {
  int width = 0, height = 0, channels = 3;
  std::vector<unsigned char> values = {};  ///< (width height channels)
};

/// The picture as the bytes of a .png file. @throws Error (numerical) when VTK cannot encode it.
std::string png(const Pixels& pixels);

/// Dark violet, blue, green, yellow: rising lightness, readable without colour.
/// @param share  0 to 1
std::array<unsigned char, 3> map_color(double share);

}  // namespace flexmorph::io
