#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "geometry/base.h"
#include "geometry/text.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::io {
namespace {

/// Returns the separator of cells: comma, semicolon or tabulator, whichever is most frequent in the
/// header.
char separator_of(std::string_view header) {
  const std::array<char, 3> known = {',', ';', '\t'};
  const auto count = [&](char c) { return std::count(header.begin(), header.end(), c); };
  return *std::max_element(known.begin(), known.end(),
                           [&](char a, char b) { return count(a) < count(b); });
}

/// Returns a cell without the spaces around it.
std::string_view trimmed(std::string_view cell) {
  const size_t first = cell.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return cell.substr(first, cell.find_last_not_of(' ') + 1 - first);
}

/// Removes the quotes of a cell in place; "" inside quotes becomes a quote.
/// @returns the end of the remaining text
char* unquote(char* begin, const char* end) {
  char* out = begin;
  bool quoted = false;
  for (const char* c = begin; c < end; ++c) {
    if (*c == '"' && quoted && c + 1 < end && c[1] == '"') {
      *out++ = *c++;
    } else if (*c == '"') {
      quoted = !quoted;
    } else {
      *out++ = *c;
    }
  }
  return out;
}

/// Returns the end of a cell: the next separator outside quotes.
char* end_of_cell(char* cell, char* line_end, char separator) {
  bool quoted = false;
  for (; cell < line_end; ++cell) {
    if (*cell == '"') quoted = !quoted;
    if (*cell == separator && !quoted) break;
  }
  return cell;
}

/// Appends the cells of one line.
/// @returns the number of cells
size_t add_cells(char* begin, char* line_end, char separator, std::vector<std::string_view>& out) {
  const size_t before = out.size();
  const bool quotes = std::find(begin, line_end, '"') != line_end;
  for (char* cell = begin;; ++cell) {
    char* const end =
        quotes ? end_of_cell(cell, line_end, separator) : std::find(cell, line_end, separator);
    out.push_back(trimmed({cell, quotes ? unquote(cell, end) : end}));
    if (end == line_end) return out.size() - before;
    cell = end;
  }
}

size_t location_of(const CsvTable& table, const std::string& column) {
  const auto found = std::find(table.columns.begin(), table.columns.end(), column);
  if (found != table.columns.end()) return static_cast<size_t>(found - table.columns.begin());
  throw Error::input("table: there is no column '" + column + "'; its columns are " +
                     joined(table.columns, ", ", "'"));
}

/// Returns the number of a text, or NaN if the text is not a number.
double number_of(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && at == end ? value : std::numeric_limits<double>::quiet_NaN();
}

/// Returns the number of a cell, which may have a decimal comma.
double number_of(std::string_view cell, bool decimal_comma) {
  if (!decimal_comma || cell.find(',') == std::string_view::npos) return number_of(cell);
  std::string with_point(cell);
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  // Of two marks in one cell, one separates thousands.
  return number_of(cell.find('.') == std::string_view::npos ? with_point : std::string());
}

bool has(std::string_view text, char c) { return text.find(c) != std::string_view::npos; }

/// Returns the position after the last row in which a cell is not empty.
char* end_of_rows(std::string& text, char separator) {
  const size_t last = text.find_last_not_of(std::string(" \t\r\n\"") + separator);
  if (last == std::string::npos) return text.data();
  return text.data() + std::min(text.find('\n', last), text.size());
}

/// Returns the location of a row: "file:line". The header is in line 1.
std::string location_of_row(const std::string& path, size_t row) {
  return path + ":" + std::to_string(row + 2);
}

}  // namespace

std::vector<std::string> CsvTable::row(size_t r) const {
  const auto first = cells_.begin() + static_cast<std::ptrdiff_t>(r * columns.size());
  return {first, first + static_cast<std::ptrdiff_t>(columns.size())};
}

std::vector<std::string> CsvTable::texts(const std::string& column) const {
  std::vector<std::string> out;
  out.reserve(n_rows());
  for (size_t i = location_of(*this, column); i < cells_.size(); i += columns.size())
    out.emplace_back(cells_[i]);
  return out;
}

std::vector<double> CsvTable::numbers(const std::string& column) const {
  std::vector<double> out;
  out.reserve(n_rows());
  for (size_t i = location_of(*this, column); i < cells_.size(); i += columns.size())
    out.push_back(number_of(cells_[i], decimal_comma));
  return out;
}

std::vector<double> CsvTable::all_numbers(const std::string& column) const {
  std::vector<double> out = numbers(column);
  const auto bad = std::find_if(out.begin(), out.end(), [](double x) { return std::isnan(x); });
  if (bad == out.end()) return out;
  const auto row = static_cast<size_t>(bad - out.begin());
  const std::string cell = texts(column)[row];
  std::string why = cell.empty() ? "the cell of the column '" + column + "' is empty"
                                 : "'" + cell + "' is not a number";
  if (has(cell, ',') && has(cell, '.'))
    why += "; a number has one decimal mark and no mark between thousands";
  else if (has(cell, ',') && !decimal_comma)
    why +=
        "; numbers may have a decimal comma only if the cells are separated by semicolons or "
        "tabulators";
  throw Error::input(location_of_row(path_, row) + ": " + why);
}

void CsvTable::refuse_mixed_marks() const {
  if (!decimal_comma) return;
  constexpr size_t kNotFound = std::string::npos;
  size_t comma = kNotFound, point = kNotFound;  // first cells with each decimal mark
  for (size_t i = 0; i < cells_.size() && (comma == kNotFound || point == kNotFound); ++i) {
    size_t& first = has(cells_[i], ',') ? comma : point;
    if (first == kNotFound && (has(cells_[i], ',') || has(cells_[i], '.')) &&
        !std::isnan(number_of(cells_[i], true)))
      first = i;
  }
  if (comma == kNotFound || point == kNotFound) return;
  const size_t later = std::max(comma, point), earlier = std::min(comma, point);
  const auto text = [&](size_t i) {
    std::string out = "'";
    out.append(cells_[i]).append("' has a decimal ").append(i == comma ? "comma" : "point");
    return out;
  };
  throw Error::input(location_of_row(path_, later / columns.size()) + ": " + text(later) +
                     ", but " + text(earlier) + " in line " +
                     std::to_string(earlier / columns.size() + 2) +
                     "; all numbers of a table have the same decimal mark, and no mark between "
                     "thousands");
}

CsvTable read_csv(const std::string& path) {
  CsvTable out;
  out.text_ = std::make_shared<std::string>(read_regular_file(path, "a table"));
  out.path_ = path;
  char *line = out.text_->data(), *end = line + out.text_->size();
  if (out.text_->starts_with("\xEF\xBB\xBF")) line += 3;  // skips a byte-order mark
  char separator = ',';
  for (int number = 1; line < end; ++number) {
    char *const next = std::find(line, end, '\n'), *line_end = next;
    if (line_end > line && line_end[-1] == '\r') --line_end;
    if (number == 1) {
      separator = separator_of({line, line_end});
      // Spreadsheets use semicolons as separators in languages in which the comma is the decimal
      // point.
      out.decimal_comma = separator != ',';
      std::vector<std::string_view> header;
      add_cells(line, line_end, separator, header);
      out.columns.assign(header.begin(), header.end());
      end = std::max(next, end_of_rows(*out.text_, separator));
    } else if (const size_t n = add_cells(line, line_end, separator, out.cells_);
               n != out.columns.size()) {
      std::string why = path + ":" + std::to_string(number) + ": this row has " +
                        std::to_string(n) + " values, but the header has " +
                        std::to_string(out.columns.size());
      if (n > out.columns.size() && separator == ',')
        why += "; numbers with a decimal comma need semicolons or tabulators between the cells";
      throw Error::input(why);
    }
    line = next + (next < end ? 1 : 0);
  }
  out.refuse_mixed_marks();
  return out;
}

std::string aligned_table(std::span<const std::vector<std::string>> rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c)
      line += row[c] + std::string(widths[c] - row[c].size() + 2, ' ');
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string markdown_table(std::span<const std::vector<std::string>> rows) {
  std::string out;
  for (size_t r = 0; r < rows.size(); ++r) {
    out += "|";
    for (const std::string& cell : rows[r]) out.append(" ").append(cell).append(" |");
    out += "\n";
    if (r > 0) continue;
    out += "|";
    for (size_t c = 0; c < rows[r].size(); ++c) out += " --- |";
    out += "\n";
  }
  return out;
}

}  // namespace flexmorph::io
