#include <algorithm>
#include <array>
#include <cctype>

#include "cases/keys/book.h"
#include "io/screen.h"

/// The reference of keys in columns for a terminal.
namespace flexmorph::cases {
namespace {

constexpr size_t kColumns = 4;
constexpr size_t kMinWidthOfColumns = 100;  // narrower screens show no columns
using Cells = std::array<std::string, kColumns>;
using ColumnWidths = std::array<size_t, kColumns>;

void write_row(const Cells& cells, const ColumnWidths& widths, std::string& out) {
  std::array<std::vector<std::string>, kColumns> lines;
  size_t height = 0;
  for (size_t c = 0; c < kColumns; ++c) {
    lines[c] = io::wrapped(cells[c], widths[c]);
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

/// Writes a row for a screen that is too narrow for its columns: type and default beside the name,
/// and the sentence on lines of its own.
/// @param names  width of the column of names
void write_lines(const Cells& cells, size_t names, size_t width, std::string& out) {
  const std::string name = cells[0] + std::string(names - std::min(names, cells[0].size()), ' ');
  const std::string given = cells[2] == "required" ? cells[2] : "default: " + cells[2];
  out += io::fitted_text("  " + name + "  " + cells[1] + "; " + given, width, names + 4);
  out += io::fitted_text("      " + cells[3], width, 6);
}

/// Writes an explanation below the rows of a table.
void write_explanation(const std::string& text, size_t width, std::string& out) {
  std::string indent = "  ";
  for (const std::string& line : io::wrapped(text, width - 4)) {
    out += indent + line + "\n";
    indent = "    ";
  }
}

/// Writes a table and the explanations of the words that its keys allow.
/// @param explained  name of the only key whose words are explained; empty: all keys
void write_table(const KeyTable& table, size_t width, std::string& out,
                 const std::string& explained = "") {
  out += out.empty() ? "" : "\n";
  out += io::fitted_text(table.title() + (table.own ? ": " + table.own->sentence : ""), width);
  std::vector<Cells> rows;
  ColumnWidths widths{};
  for (const io::Key* key : table.keys) {
    rows.push_back({shown_name(*key), type_text(*key), default_text(*key), sentence_of(*key)});
    widths[0] = std::max(widths[0], rows.back()[0].size());
  }
  // The width that remains beside the names is divided between type, default and sentence.
  const size_t taken = 2 + widths[0] + 2 * (kColumns - 1);
  const size_t rest = std::max<size_t>(45, width > taken ? width - taken : 0);
  widths[1] = 3 * rest / 10;
  widths[2] = 2 * rest / 10;
  widths[3] = rest - widths[1] - widths[2];
  for (const Cells& cells : rows)
    if (width < kMinWidthOfColumns)
      write_lines(cells, widths[0], width, out);
    else
      write_row(cells, widths, out);
  for (const WordMeanings& each : meanings_of(table)) {
    if (!explained.empty() && each.key != explained) continue;
    for (const auto& [word, sentence] : each.words)
      write_explanation(each.key + " = \"" + word + "\": " + sentence, width, out);
    if (each.words.empty()) write_explanation(each.key + ": " + each.reference(), width, out);
  }
}

std::string in_small_letters(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Writes all keys that have a word in their name or sentence.
void write_found(const std::string& word, size_t width, std::string& out) {
  const std::string wanted = in_small_letters(word);
  const auto has_word = [&](const std::string& text) {
    return in_small_letters(text).find(wanted) != std::string::npos;
  };
  for (const KeyTable& each : key_book()) {
    KeyTable found = each;
    std::erase_if(found.keys, [&](const io::Key* key) {
      return !has_word(key->name) && !has_word(sentence_of(*key));
    });
    if (!found.keys.empty()) write_table(found, width, out, word);
  }
}

}  // namespace

std::string keys_for_terminal(const std::string& word, size_t width) {
  std::string out;
  const std::vector<std::string> tables = key_table_names();
  if (word.empty()) {
    for (const std::string& line : io::wrapped(kNumbersSentence, width)) out += line + "\n";
    for (const KeyTable& each : key_book()) write_table(each, width, out);
  } else if (std::find(tables.begin(), tables.end(), word) != tables.end()) {
    write_table(table_of_keys(word), width, out);
  } else {
    write_found(word, width, out);
    if (out.empty()) table_of_keys(word);  // names the most similar table
  }
  return out;
}

}  // namespace flexmorph::cases
