#pragma once

#include <span>
#include <string>
#include <vector>

/// Many pictures on one page.
namespace flexmorph::io {

/// A column of SVG pages below a title.
struct SheetEntry {
  std::string title;
  std::vector<std::string> pictures;  ///< SVG with a viewBox
};

/// A page with the entries side by side, `columns` in a row, every picture as wide as its column.
/// @throws Error (input) for a picture without a viewBox.
std::string contact_sheet(const std::string& title, std::span<const SheetEntry> entries,
                          int columns);

}  // namespace flexmorph::io
