#pragma once

#include <span>
#include <string>
#include <vector>

/// Texts for the screen, whose lines are not longer than the screen is wide.
namespace flexmorph::io {

/// Number of columns of lines when the output is not a terminal.
inline constexpr size_t kColumnsOfFiles = 80;

/// Returns the number of columns of the terminal; kColumnsOfFiles if the output is not a terminal.
size_t screen_width();

/// Returns the number of columns that a text in UTF-8 takes: the number of its characters.
size_t columns_of(const std::string& text);

/// Splits a text at spaces into lines of at most `width` columns. A longer word gets a line of its
/// own. Several spaces one after the other are kept within a line.
/// @param hanging  number of spaces before all lines but the first
std::vector<std::string> wrapped(const std::string& text, size_t width, size_t hanging = 0);

/// Returns a text with every line that is longer than `width` split at spaces. The text ends with a
/// line end, unless it is empty.
/// @param hanging  number of spaces before the further lines of a line; more if the line itself
///                 begins with more
std::string fitted_text(const std::string& text, size_t width, size_t hanging = 2);

/// Returns rows as text with padded columns that are together at most `width` wide; the first row
/// is the header. Headings are split at spaces, points and underscores, long cells at spaces. If
/// the columns are too wide together, those that do not fit beside the columns before them are left
/// out, and a last line names them.
/// @param file  file that has all columns, for the last line
std::string fitted_table(std::span<const std::vector<std::string>> rows, size_t width,
                         const std::string& file);

}  // namespace flexmorph::io
