#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>

#include "geometry/base.h"
#include "io/tables.h"

namespace flexmorph::io {
namespace {

/// What separates the cells: of comma, semicolon and tabulator the one that the header has most of.
char separator_of(const std::string& header) {
  const std::array<char, 3> known = {',', ';', '\t'};
  const auto count = [&](char c) { return std::count(header.begin(), header.end(), c); };
  return *std::max_element(known.begin(), known.end(),
                           [&](char a, char b) { return count(a) < count(b); });
}

/// Without the spaces around it.
void trim(std::string& cell) {
  cell.erase(0, std::min(cell.find_first_not_of(' '), cell.size()));
  cell.erase(cell.find_last_not_of(' ') + 1);
}

/// Cells of one line; a quoted cell keeps its separators, "" in it is a quote.
std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += c;
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) trim(cell);
  return cells;
}

}  // namespace

std::vector<std::string> CsvTable::texts(const std::string& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) {
    std::string known;
    for (const std::string& name : columns) known += (known.empty() ? "'" : ", '") + name + "'";
    throw Error::input("table: there is no column '" + column + "'; its columns are " + known);
  }
  std::vector<std::string> out;
  for (const auto& row : rows) out.push_back(row[static_cast<size_t>(found - columns.begin())]);
  return out;
}

std::vector<double> CsvTable::numbers(const std::string& column) const {
  std::vector<double> out;
  for (std::string& text : texts(column)) {
    if (decimal_comma) std::replace(text.begin(), text.end(), ',', '.');
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    out.push_back(whole ? value : std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

CsvTable read_csv(const std::string& path) {
  // A pipe or a device may never end, or never begin.
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw Error::input(path + ": a table is read from a regular file, not from a " +
                       (std::filesystem::is_directory(status) ? "folder" : "pipe or device"));
  std::ifstream file(path);
  if (!file) throw Error::input(path + ": cannot be read");
  CsvTable out;
  std::string line;
  char separator = ',';
  for (int number = 1; std::getline(file, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte-order mark
      separator = separator_of(line);
      // Spreadsheets separate by semicolons where the comma is the decimal point.
      out.decimal_comma = separator != ',';
      out.columns = cells_of(line, separator);
      continue;
    }
    if (line.empty() && file.peek() == std::ifstream::traits_type::eof()) break;
    out.rows.push_back(cells_of(line, separator));
    if (out.rows.back().size() != out.columns.size())
      throw Error::input(path + ":" + std::to_string(number) + ": " +
                         std::to_string(out.rows.back().size()) + " values; the header has " +
                         std::to_string(out.columns.size()));
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
