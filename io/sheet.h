#pragma once

#include <span>
#include <string>
#include <vector>

/// Pages with many pictures.
namespace flexmorph::io {

/// A column of SVG pictures below a title.
struct SheetEntry {
  std::string title;                  ///< Title above the pictures.
  std::vector<std::string> pictures;  ///< SVG pages with a viewBox, from top to bottom.
};

/// Returns an SVG page with the entries side by side, `columns` in a row. Every picture has the
/// width of its column.
/// @throws Error (input) for a picture without a viewBox.
std::string contact_sheet(const std::string& title, std::span<const SheetEntry> entries,
                          int columns);

}  // namespace flexmorph::io
