#pragma once

#include <string>
#include <string_view>

/// Encodings of binary data for pages and pictures.
namespace flexmorph::io {

/// Returns bytes as text in base64, without line ends.
std::string base64(std::string_view bytes);

/// Returns bytes in the compressed format zlib (RFC 1950), which browsers can read.
/// @throws Error (numerical) when VTK cannot compress them.
std::string compressed(std::string_view bytes);

}  // namespace flexmorph::io
