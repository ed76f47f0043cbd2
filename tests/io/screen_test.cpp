// Shows that texts and tables for the screen are not wider than asked, and lose no word.
#include "io/screen.h"

#include <gtest/gtest.h>

#include <sstream>

namespace flexmorph::io {
namespace {

using Lines = std::vector<std::string>;

Lines screen_lines(const std::string& text) {
  Lines out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

Lines pieces_in(const std::string& text) {
  Lines out;
  std::istringstream in(text);
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

size_t widest(const std::string& text) {
  size_t out = 0;
  for (const std::string& line : screen_lines(text)) out = std::max(out, columns_of(line));
  return out;
}

TEST(Columns, AreCharactersAndNotBytes) {
  EXPECT_EQ(columns_of(""), 0u);
  EXPECT_EQ(columns_of("abc"), 3u);
  EXPECT_EQ(columns_of("½ρ π"), 4u);
}

TEST(Wrapped, KeepsAllWordsWithinTheWidth) {
  const std::string text = "one two  three   four five six seven eight nine ten eleven twelve";
  for (size_t width = 8; width < 70; ++width) {
    std::string all;
    for (const std::string& line : wrapped(text, width, 2)) {
      EXPECT_LE(line.size(), width);
      all += line + "\n";
    }
    EXPECT_EQ(pieces_in(all), pieces_in(text)) << width;
  }
  EXPECT_EQ(wrapped("a b", 80), Lines{"a b"});
  EXPECT_EQ(wrapped("a      b", 80), Lines{"a      b"});  // padding within a line
  EXPECT_EQ(wrapped("", 80), Lines{""});
  EXPECT_EQ(wrapped("short averylongword", 8, 1), (Lines{"short", " averylongword"}));
}

TEST(FittedText, ChangesNoShortLines) {
  EXPECT_EQ(fitted_text("", 10), "");
  EXPECT_EQ(fitted_text("a\n\n  b", 10), "a\n\n  b\n");
  EXPECT_EQ(fitted_text("aaa bbb ccc\n", 7), "aaa bbb\n  ccc\n");
  EXPECT_EQ(fitted_text("    aaa bbb", 7), "    aaa\n    bbb\n");
  EXPECT_EQ(fitted_text("key   aaa bbb ccc", 14, 6), "key   aaa bbb\n      ccc\n");
}

TEST(FittedTable, ShowsTheColumnsThatFitAndNamesTheOthers) {
  const std::vector<Lines> rows = {
      {"variant", "design.max_volume", "status", "compliance", "crisp_compliance", "message"},
      {"a", "0.4", "done", "0.0123", "0.0125", "none"},
      {"b", "0.5", "done, 2 warnings", "0.0101", "0.0103", ""}};
  for (const size_t width : {40u, 60u, 80u, 120u}) {
    const std::string text = fitted_table(rows, width, "sweep.md");
    EXPECT_LE(widest(text), width) << text;
    // Every heading is in the table, as a whole or in pieces, or in the last sentence.
    std::string joined;
    for (const std::string& word : pieces_in(text)) joined += word;
    for (const char* cell : {"variant", "status", "done"})
      EXPECT_NE(joined.find(cell), std::string::npos) << cell << "\n" << text;
    EXPECT_EQ(width < 67, text.find("sweep.md") != std::string::npos) << text;
  }
}

TEST(FittedTable, SplitsLongCells) {
  std::string message = "word";
  for (int i = 0; i < 40; ++i) message += " word";
  const std::vector<Lines> rows = {{"name", "message"}, {"a", message}, {"b", "short"}};
  const std::string text = fitted_table(rows, 80, "x.md");
  EXPECT_LE(widest(text), 80u);
  EXPECT_GT(widest(text), 70u);
  EXPECT_EQ(pieces_in(text).size(), 2u + 42 + 2);
  EXPECT_EQ(fitted_table({}, 80, "x.md"), "");
}

}  // namespace
}  // namespace flexmorph::io
