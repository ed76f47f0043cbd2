#include "io/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

namespace flexmorph::io {
namespace {

constexpr size_t kLongestCell = 40;  // columns of a cell that is not split
constexpr size_t kShortestLast = 20;  // the last column takes the columns that are left, or these
constexpr size_t kBetween = 2;       // columns between two columns of a table

using Lines = std::vector<std::string>;

/// Splits a heading into the pieces after which a line may end.
Lines pieces_of(const std::string& heading) {
  Lines out(1);
  for (const char c : heading) {
    if (c != ' ') out.back() += c;
    if (c == ' ' || c == '.' || c == '_') out.emplace_back();
  }
  std::erase(out, "");
  return out;
}

/// Splits a heading into lines of at most `width` columns, if its pieces allow it.
Lines heading_lines(const std::string& heading, size_t width) {
  if (columns_of(heading) <= width) return {heading};
  Lines out;
  for (const std::string& piece : pieces_of(heading)) {
    const bool joins = !out.empty() && (out.back().back() == '.' || out.back().back() == '_');
    const std::string between = joins ? "" : " ";
    if (!out.empty() && columns_of(out.back() + between + piece) <= width)
      out.back() += between + piece;
    else
      out.push_back(piece);
  }
  return out;
}

/// A column of a table: its number, and its number of columns on the screen.
struct TableColumn {
  size_t index, width;
};

/// Returns the width of a column: that of its longest cell, or of the longest piece of its heading.
/// @param longest  width of cells that are not split
size_t width_of(std::span<const Lines> rows, size_t column, size_t longest) {
  size_t out = 0;
  for (const std::string& piece : pieces_of(rows[0][column]))
    out = std::max(out, columns_of(piece));
  for (const Lines& row : rows.subspan(1)) {
    if (column >= row.size()) continue;
    for (const std::string& line : wrapped(row[column], longest))
      out = std::max(out, columns_of(line));
  }
  return out;
}

/// Writes a row whose cells have several lines each.
/// @param at_bottom  true if shorter cells begin lower, as headings do
void write_row(std::span<const TableColumn> columns, const std::vector<Lines>& cells,
               bool at_bottom, std::string& out) {
  size_t height = 0;
  for (const Lines& cell : cells) height = std::max(height, cell.size());
  for (size_t i = 0; i < height; ++i) {
    std::string line;
    for (size_t c = 0; c < cells.size(); ++c) {
      const size_t above = at_bottom ? height - cells[c].size() : 0;
      const std::string text =
          i >= above && i - above < cells[c].size() ? cells[c][i - above] : std::string();
      line += text +
              std::string(
                  columns[c].width - std::min(columns[c].width, columns_of(text)) + kBetween, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
}

}  // namespace

size_t screen_width() {
  winsize size{};
  const bool known = isatty(STDOUT_FILENO) != 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
  return known && size.ws_col > 1 ? size.ws_col : kColumnsOfFiles;
}

size_t columns_of(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // not the continuation of a character
  }));
}

Lines wrapped(const std::string& text, size_t width, size_t hanging) {
  Lines lines(1);
  size_t end = 0;
  for (bool begins = true; end < text.size(); begins = false) {
    const size_t word = text.find_first_not_of(' ', end);
    if (word == std::string::npos) break;
    const std::string spaces = text.substr(end, word - end);
    end = std::min(text.size(), text.find(' ', word));
    const std::string letters = text.substr(word, end - word);
    if (begins || columns_of(lines.back() + spaces + letters) <= width)
      lines.back() += spaces + letters;
    else
      lines.push_back(std::string(hanging, ' ') + letters);
  }
  return lines;
}

std::string fitted_text(const std::string& text, size_t width, size_t hanging) {
  std::string out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (columns_of(line) <= width) {
      out += line + "\n";
      continue;
    }
    const size_t own = std::min(line.size(), line.find_first_not_of(' '));
    for (const std::string& each : wrapped(line, width, std::max(own, hanging))) out += each + "\n";
  }
  return out;
}

std::string fitted_table(std::span<const Lines> rows, size_t width, const std::string& file) {
  if (rows.empty()) return "";
  std::vector<TableColumn> columns;
  Lines left_out;
  size_t taken = 0;
  for (size_t c = 0; c < rows[0].size(); ++c) {
    const size_t before = columns.empty() ? 0 : kBetween,
                 rest = width - std::min(width, taken + before);
    const bool is_last = c + 1 == rows[0].size();
    const size_t own = width_of(rows, c, is_last ? std::max(kShortestLast, rest) : kLongestCell);
    if (columns.empty() || taken + before + own <= width) {
      columns.push_back({c, own});
      taken += before + own;
    } else {
      left_out.push_back(rows[0][c]);
    }
  }
  std::string out;
  for (size_t r = 0; r < rows.size(); ++r) {
    std::vector<Lines> cells;
    for (const auto& [c, own] : columns)
      cells.push_back(c >= rows[r].size() ? Lines()
                      : r == 0            ? heading_lines(rows[r][c], own)
                                          : wrapped(rows[r][c], own));
    write_row(columns, cells, r == 0, out);
  }
  if (left_out.empty()) return out;
  std::string names;
  for (const std::string& name : left_out) names += (names.empty() ? "" : ", ") + name;
  return out + fitted_text("(also in " + file + ": " + names + ")", width);
}

}  // namespace flexmorph::io
