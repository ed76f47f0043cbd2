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
  Cell() = default;  ///< Creates an empty entry.

  /// Creates the entry of a number.
  Cell(double value) : text_(to_text(value)) {}
  Cell(int value) : text_(to_text(value)) {}
  /// Creates the entry 1 (true) or 0 (false).
  Cell(bool value) : text_(value ? "1" : "0") {}
  /// Creates the entry of a text, in quotes if it contains a comma, a quote or a line end.
  Cell(std::string text);
  Cell(const char* text) : Cell(std::string(text)) {}

  /// Returns the entry as it is written to the file.
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// A writer for a table of comma-separated values that can be read while it grows. A reader sees
/// whole rows only, except in the short time in which the system writes a row that crosses a memory
/// page. Numbers are written in full precision, in every locale.
class CsvWriter {
 public:
  /// Creates a file with a header and rows of its length, in an existing folder. An old file is
  /// replaced as a whole, therefore readers see either the old or the new file.
  /// @throws Error (numerical) when the file cannot be written; row() throws it, too, and whole
  ///         rows are kept.
  CsvWriter(std::string path, std::span<const std::string> columns,
            std::span<const std::vector<Cell>> rows = {});
  /// Continues an existing file after its last whole row.
  static CsvWriter keep_running(std::string path, size_t n_columns);
  ~CsvWriter();
  /// Takes the file of another writer.
  CsvWriter(CsvWriter&& other) noexcept;
  CsvWriter& operator=(CsvWriter&& other) = delete;

  /// Appends a row to the file.
  /// @throws Error (numerical) when the row has another length than the header, or cannot be
  ///         written.
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
  off_t size_ = 0;  // size of all whole rows [bytes]
};

/// A table of comma-separated values that was read from a file. Copies share its text.
class CsvTable {
 public:
  std::vector<std::string> columns;  ///< Names of the columns.
  bool decimal_comma = false;        ///< True if numbers may have a decimal comma.

  /// Returns the number of rows below the header.
  size_t n_rows() const { return columns.empty() ? 0 : cells_.size() / columns.size(); }
  /// Returns the cells of one row, as many as the header has.
  std::vector<std::string> row(size_t r) const;
  /// Returns the cells of a column.
  /// @throws Error (input) for an unknown column, with the names of all columns.
  std::vector<std::string> texts(const std::string& column) const;
  /// Returns the numbers of a column; NaN where a cell is empty or not a number.
  /// @throws Error (input) as texts().
  std::vector<double> numbers(const std::string& column) const;
  /// Returns the numbers of a column in which every cell is a number.
  /// @throws Error (input) as texts(), or with file, line and the first cell that is not a number.
  std::vector<double> all_numbers(const std::string& column) const;

 private:
  void refuse_mixed_marks() const;
  friend CsvTable read_csv(const std::string& path);
  std::string path_;                     // path of the file, for messages
  std::shared_ptr<std::string> text_;    // text of the file, into which the cells point
  std::vector<std::string_view> cells_;  // row by row
};
/// Returns a table from a file. Cells are separated by commas, or, if the header has more of them,
/// by semicolons or tabulators; then numbers may have decimal commas. A byte-order mark, spaces
/// around cells and rows without contents at the end of the file are ignored.
/// @throws Error (input) when the file cannot be read, or with file and line when a row has another
///         length than the header, or when one number has a decimal comma and another one a decimal
///         point.
CsvTable read_csv(const std::string& path);

/// Returns rows as text with padded columns for a terminal; the first row is the header.
std::string aligned_table(std::span<const std::vector<std::string>> rows);
/// Returns rows as a Markdown table; the first row is the header.
std::string markdown_table(std::span<const std::vector<std::string>> rows);

/// Returns a text with escaped characters for the contents and attributes of XML and HTML.
std::string xml_escaped(const std::string& text);

}  // namespace flexmorph::io
