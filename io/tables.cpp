#include "io/tables.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

#include "geometry/base.h"

namespace flexmorph::io {
Cell::Cell(std::string text) : text_(std::move(text)) {
  if (text_.find_first_of(",\"\r\n") == std::string::npos) return;
  std::string quoted = "\"";
  for (const char c : text_) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  text_ = quoted + "\"";
}

CsvWriter::CsvWriter(std::string path, size_t n_columns)
    : path_(std::move(path)), n_columns_(n_columns) {}

void CsvWriter::open() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0)
    throw Error::numerical(path_ +
                           ": cannot be written: " + std::generic_category().message(errno));
}

CsvWriter::CsvWriter(std::string path, std::span<const std::string> columns,
                     std::span<const std::vector<Cell>> rows)
    : CsvWriter(std::move(path), columns.size()) {
  std::string text = line_of(std::vector<Cell>(columns.begin(), columns.end()));
  for (const std::vector<Cell>& row : rows) text += line_of(row);
  write_file(path_, text);
  open();
  size_ = static_cast<off_t>(text.size());
}

CsvWriter CsvWriter::keep_running(std::string path, size_t n_columns) {
  CsvWriter out(std::move(path), n_columns);
  out.open();
  std::ifstream file(out.path_, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  out.size_ = static_cast<off_t>(text.rfind('\n') + 1);  // 0 if there is no line end
  if (::ftruncate(out.file_, out.size_) != 0)
    throw Error::numerical(out.path_ +
                           ": cannot be written: " + std::generic_category().message(errno));
  return out;
}

CsvWriter::~CsvWriter() {
  if (file_ >= 0) ::close(file_);
}

CsvWriter::CsvWriter(CsvWriter&& other) noexcept
    : path_(std::move(other.path_)),
      n_columns_(other.n_columns_),
      file_(std::exchange(other.file_, -1)),
      size_(other.size_) {}

void CsvWriter::row(std::span<const Cell> cells) { write(line_of(cells)); }

std::string CsvWriter::line_of(std::span<const Cell> cells) const {
  if (cells.size() != n_columns_)
    throw Error::numerical(path_ + ": a row has " + std::to_string(cells.size()) +
                           " entries, but the table has " + std::to_string(n_columns_) +
                           " columns");
  std::string line;
  for (size_t i = 0; i < cells.size(); ++i) line += (i ? "," : "") + cells[i].text();
  return line + "\n";
}

void CsvWriter::write(const std::string& line) {
  for (size_t done = 0; done < line.size();) {
    const ssize_t n = ::write(file_, line.data() + done, line.size() - done);
    if (n < 0 && errno != EINTR) {
      const int why = errno;
      // If the disk is full, only a part of the row was written. It is removed, so that the file
      // ends with a whole row.
      if (::ftruncate(file_, size_) != 0) ::close(std::exchange(file_, -1));
      throw Error::numerical(path_ +
                             ": cannot be written: " + std::generic_category().message(why));
    }
    if (n > 0) done += static_cast<size_t>(n);
  }
  size_ += static_cast<off_t>(line.size());
}

std::string xml_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace flexmorph::io
