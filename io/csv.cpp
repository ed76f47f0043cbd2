#include <algorithm>
#include <array>
#include <charconv>
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

double number_of(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && at == end ? value : std::numeric_limits<double>::quiet_NaN();
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
  std::string with_point;
  for (size_t i = location_of(*this, column); i < cells_.size(); i += columns.size()) {
    std::string_view cell = cells_[i];
    if (decimal_comma && cell.find(',') != std::string_view::npos) {
      with_point = cell;
      std::replace(with_point.begin(), with_point.end(), ',', '.');
      cell = with_point;
    }
    out.push_back(number_of(cell));
  }
  return out;
}

CsvTable read_csv(const std::string& path) {
  CsvTable out;
  out.text_ = std::make_shared<std::string>(read_regular_file(path, "a table"));
  char *line = out.text_->data(), *const end = line + out.text_->size();
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
    } else if (line == line_end && end - next <= 1) {
      break;  // an empty line at the end
    } else if (const size_t n = add_cells(line, line_end, separator, out.cells_);
               n != out.columns.size()) {
      throw Error::input(path + ":" + std::to_string(number) + ": this row has " +
                         std::to_string(n) + " values, but the header has " +
                         std::to_string(out.columns.size()));
    }
    line = next + (next < end ? 1 : 0);
  }
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
