#pragma once

#include <sys/types.h>

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files.h"

namespace flexmorph::io {

/// One entry of a table: a number, a text, or nothing.
class Cell {
 public:
  Cell() = default;  ///< empty
  Cell(double value) : text_(to_text(value)) {}
  Cell(int value) : text_(to_text(value)) {}
  Cell(bool value) : text_(value ? "1" : "0") {}
  Cell(std::string text);  ///< in quotes when it holds a comma, a quote or a line end
  Cell(const char* text) : Cell(std::string(text)) {}

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A table of comma-separated values that can be read while it grows: a row appears as a whole, but
/// for the instant in which the system takes one that crosses two pages of memory.
/// Numbers are written in full precision, whatever the locale.
class CsvWriter {
 public:
  /// Begins a new file with its header, and rows as long as it, in a folder that is there; an old
  /// one is replaced as a whole: who reads it meanwhile sees the one or the other.
  /// @throws Error (numerical) when it cannot be written; row() likewise, whole rows stay.
  CsvWriter(std::string path, std::span<const std::string> columns,
            std::span<const std::vector<Cell>> rows = {});
  /// Goes on with a file that is there, behind its last whole row.
  static CsvWriter go_on(std::string path, size_t n_columns);
  ~CsvWriter();
  CsvWriter(CsvWriter&& other) noexcept;
  CsvWriter& operator=(CsvWriter&& other) = delete;

  /// @throws Error (numerical) when the row has another length than the header.
  void row(std::span<const Cell> cells);
  void row(std::initializer_list<Cell> cells) { row(std::span(cells.begin(), cells.size())); }

 private:
  CsvWriter(std::string path, size_t n_columns);
  void open();
  std::string line_of(std::span<const Cell> cells) const;
  void write(const std::string& line);
  std::string path_;
  size_t n_columns_;
  int file_ = -1;
  off_t size_ = 0;  // of whole rows
};

/// A table of comma-separated values as read from a file. Copies share its text.
class CsvTable {
 public:
  std::vector<std::string> columns;
  bool decimal_comma = false;  ///< a comma may stand for the point of a number

  size_t n_rows() const { return columns.empty() ? 0 : cells_.size() / columns.size(); }
  /// One row, as long as the header.
  std::vector<std::string> row(size_t r) const;
  /// @throws Error (input) for a column that is not there, naming those that are.
  std::vector<std::string> texts(const std::string& column) const;
  /// Numbers of a column; NaN where a cell is empty or no number.
  /// @throws Error (input) as texts().
  std::vector<double> numbers(const std::string& column) const;

 private:
  friend CsvTable read_csv(const std::string& path);
  std::shared_ptr<std::string> text_;    // what cells point into: no string of their own
  std::vector<std::string_view> cells_;  // row by row
};
/// Cells are separated by commas, or as the header has it by semicolons or tabulators, where
/// numbers may have decimal commas; a byte-order mark and spaces around cells do not count.
/// @throws Error (input) when the file cannot be read; file and line where a row has another length
///         than the header.
CsvTable read_csv(const std::string& path);

/// Rows of texts for a terminal: columns padded, the first row is the header.
std::string aligned_table(std::span<const std::vector<std::string>> rows);
/// The same as Markdown.
std::string markdown_table(std::span<const std::vector<std::string>> rows);

/// One part of a report: a heading, words, a table, pictures; whatever is empty is left out.
struct ReportSection {
  std::string heading = {}, words = {};
  std::vector<std::string> warnings = {};           ///< stand out
  std::vector<std::vector<std::string>> rows = {};  ///< the first one is the header
  std::vector<std::string> pictures = {};           ///< SVG, see plots.h
};

/// A page that needs no other file (.html).
std::string report_html(const std::string& title, std::span<const ReportSection> sections);

/// Text for XML and HTML, in contents and attributes.
std::string xml_escaped(const std::string& text);

}  // namespace flexmorph::io
