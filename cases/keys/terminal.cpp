#include <algorithm>
#include <array>
#include <sstream>

#include "cases/keys/book.h"

/// The reference of keys in columns for a terminal.
namespace flexmorph::cases {
namespace {

constexpr size_t kColumns = 4;
using Cells = std::array<std::string, kColumns>;
using ColumnWidths = std::array<size_t, kColumns>;

/// Returns lines of at most `width` characters; a longer word gets a separate line.
std::vector<std::string> wrapped(const std::string& text, size_t width) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    if (line.empty())
      line = word;
    else if (line.size() + 1 + word.size() <= width)
      line += " " + word;
    else
      lines.push_back(word);
  }
  return lines;
}

void write_row(const Cells& cells, const ColumnWidths& widths, std::string& out) {
  std::array<std::vector<std::string>, kColumns> lines;
  size_t height = 0;
  for (size_t c = 0; c < kColumns; ++c) {
    lines[c] = wrapped(cells[c], widths[c]);
    height = std::max(height, lines[c].size());
  }
  for (size_t i = 0; i < height; ++i) {
    std::string line = "  ";
    for (size_t c = 0; c < kColumns; ++c) {
      std::string cell = i < lines[c].size() ? lines[c][i] : "";
      cell.resize(std::max(cell.size(), widths[c]), ' ');
      line += cell + "  ";
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
}

void write_table(const KeyTable& table, size_t width, std::string& out) {
  out += (out.empty() ? "" : "\n") + table.title();
  if (table.own) out += ": " + table.own->sentence;
  out += "\n";
  std::vector<Cells> rows;
  ColumnWidths widths{};
  for (const io::Key* key : table.keys) {
    rows.push_back({shown_name(*key), type_text(*key), default_text(*key), sentence_of(*key)});
    widths[0] = std::max(widths[0], rows.back()[0].size());
  }
  // The width that remains beside the names is divided between type, default and sentence.
  const size_t taken = 2 + widths[0] + 2 * (kColumns - 1);
  const size_t rest = std::max<size_t>(60, width > taken ? width - taken : 0);
  widths[1] = 3 * rest / 10;
  widths[2] = 2 * rest / 10;
  widths[3] = rest - widths[1] - widths[2];
  for (const Cells& cells : rows) write_row(cells, widths, out);
  for (const auto& [key, word, sentence] : meanings_of(table)) {
    std::string indent = "  ";
    for (const std::string& line :
         wrapped(key + " = \"" + word + "\": " + sentence, taken + rest - 4)) {
      out += indent + line + "\n";
      indent = "    ";
    }
  }
}

}  // namespace

std::string keys_for_terminal(const std::string& table, size_t width) {
  std::string out;
  if (!table.empty())
    write_table(table_of_keys(table), width, out);
  else
    for (const KeyTable& each : key_book()) write_table(each, width, out);
  return out;
}

}  // namespace flexmorph::cases
