// Shows that numbers in tables and reports are preserved bit for bit in any locale, that rows can
// be read while the table grows, that a JSON parser reads the JSON, and that files are replaced as
// a whole.
#include "io/tables.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "geometry/base.h"
#include "io/json.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(line);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

std::vector<double> awkward_numbers() {
  std::vector<double> numbers = {0.1, 1.0 / 3, -0.0, 1e-300, 5e-324, 1.7976931348623157e308, 1e22};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  for (int i = 0; i < 1000; ++i)
    numbers.push_back(std::ldexp(mantissa(random), static_cast<int>(random() % 600) - 300));
  return numbers;
}

TEST(Csv, NumbersReadBackExactlyInAnyLocale) {
  const Scratch scratch;
  const CommaLocale comma;
  const std::vector<double> numbers = awkward_numbers();
  {
    CsvWriter table(scratch / "history.csv", std::vector<std::string>{"i", "value"});
    for (size_t i = 0; i < numbers.size(); ++i) table.row({static_cast<int>(i), numbers[i]});
  }
  const auto lines = split(contents_of(scratch / "history.csv"), '\n');
  ASSERT_EQ(lines.size(), numbers.size() + 1);
  EXPECT_EQ(lines[0], "i,value");
  for (size_t i = 0; i < numbers.size(); ++i) {
    const std::string text = split(lines[i + 1], ',').at(1);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    EXPECT_EQ(std::signbit(back), std::signbit(numbers[i]));
    EXPECT_EQ(back, numbers[i]);
  }
}

TEST(Csv, EmptyCellsQuotesAndNonFiniteNumbers) {
  const Scratch scratch;
  CsvWriter table(scratch / "t.csv", std::vector<std::string>{"a", "b", "c", "d"});
  table.row({Cell(), "plate", "says \"no, never\"", true});
  table.row({std::nan(""), -std::numeric_limits<double>::infinity(), Cell(), Cell()});
  // The rows can be read at once, while the table is still open.
  EXPECT_EQ(contents_of(scratch / "t.csv"),
            "a,b,c,d\n,plate,\"says \"\"no, never\"\"\",1\nnan,-inf,,\n");
  EXPECT_THROW(table.row({1, 2}), Error);
}

// A process that reads an old table while a new one replaces it gets the old one to its end.
TEST(CsvWriter, ReplacesAnOldTableAsAWhole) {
  const Scratch scratch;
  const std::string path = scratch / "t.csv";
  const std::vector<std::string> columns = {"a", "b"};
  CsvWriter old(path, columns, std::vector<std::vector<Cell>>{{1, 0.5}, {2, "x"}});
  old.row({3, 4});
  std::ifstream reader;
  reader.rdbuf()->pubsetbuf(nullptr, 0);  // without a buffer, so that nothing was read ahead
  reader.open(path);
  std::string header, rest;
  std::getline(reader, header);
  CsvWriter table(path, columns);
  table.row({5, 6});
  rest.assign(std::istreambuf_iterator<char>(reader), {});
  EXPECT_EQ(header + "\n" + rest, "a,b\n1,0.5\n2,x\n3,4\n");
  EXPECT_EQ(contents_of(path), "a,b\n5,6\n");
}

// These are tables of a spreadsheet with a decimal comma.
TEST(Csv, ReadsSemicolonsDecimalCommasAndByteOrderMarks) {
  const Scratch scratch;
  for (const char* text :
       {"\xEF\xBB\xBFtime;angle\r\n0;1,5\r\n0,25;-2e-3\r\n", "time\tangle\n0\t1,5\n0,25\t-2e-3\n",
        "time, angle\n0 , 1.5\n0.25, -2e-3"}) {
    const CsvTable table = read_csv(scratch.write("t.csv", text));
    EXPECT_EQ(table.columns, (std::vector<std::string>{"time", "angle"})) << text;
    EXPECT_EQ(table.numbers("time"), (std::vector<double>{0, 0.25})) << text;
    EXPECT_EQ(table.numbers("angle"), (std::vector<double>{1.5, -2e-3})) << text;
  }
  try {
    read_csv(scratch.write("t.csv", "Time;Angle\n0;1\n")).numbers("time");
    FAIL();
  } catch (const Error& error) {
    EXPECT_TRUE(says(error.what(), "", {"'time'", "'Time'", "'Angle'"}));
  }
}

/// Returns the message with which a table is refused when the numbers of its column x are read.
std::string complaint_about(const Scratch& scratch, const std::string& text) {
  try {
    read_csv(scratch.write("t.csv", text)).all_numbers("x");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    return error.what();
  }
  return "";
}

// A point between thousands in a table with decimal commas would be read as a number that is a
// thousand times too small.
TEST(Csv, RefusesMixedMarks) {
  const Scratch scratch;
  struct Mixed {
    const char* text;
    int line;
    std::vector<std::string> parts;
  };
  const Mixed all[] = {
      {"time;x\n0,0000;0\n0,0200;998\n0,0400;1.005\n", 4, {"'1.005'", "'0,0000'", "line 2"}},
      {"time;x\n0;1.5\n1;2\n2;3,5\n", 4, {"'3,5'", "'1.5'", "line 2"}},
      {"time;x\n0;1,5\n1;1.005,25\n", 3, {"'1.005,25'", "thousands"}},
      {"time;x\n0;1\n1;1.005.250\n", 3, {"'1.005.250'", "number"}},
      {"time,x\n0,1\n1,\"1,005\"\n", 3, {"'1,005'", "comma", "semicolons"}},
      {"time,x\n0,0,1\n0,02,1,5\n", 2, {"3 values", "2"}},
      {"time,x\n0,00,1,00\n0,02,1,50\n", 2, {"4 values", "2", "comma", "semicolons"}},
      {"time;x\n0;1\n1;\n", 3, {"'x'", "empty"}},
      {"time;x\n0;1\n1;one\n", 3, {"'one'", "number"}}};
  for (const Mixed& each : all)
    EXPECT_TRUE(says(complaint_about(scratch, each.text),
                     scratch / ("t.csv:" + std::to_string(each.line) + ": "), each.parts))
        << each.text;
  // Texts are no numbers, and a table of whole numbers and points alone is not mixed.
  for (const char* good : {"part;x\nv1.2;1,5\na, b.;2\n", "time;x\n0.5;1\n0.75;1000\n"})
    EXPECT_EQ(complaint_about(scratch, good), "") << good;
}

// Spreadsheets write rows without contents below the last one.
TEST(Csv, IgnoresBlankRowsAtTheEnd) {
  const Scratch scratch;
  for (const char* end : {"  ", "\n\n", ";", ";\n;\n", " ; \r\n;\r\n\r\n", "\"\";\"\"\n", "\t\n"}) {
    const CsvTable table = read_csv(scratch.write("t.csv", std::string("t;x\n1;2\n3;4\n") + end));
    EXPECT_EQ(table.n_rows(), 2u) << end;
    EXPECT_EQ(table.numbers("x"), (std::vector<double>{2, 4})) << end;
  }
  EXPECT_EQ(read_csv(scratch.write("t.csv", "t;x\n;\n")).n_rows(), 0u);
  // A row with one value is not blank.
  EXPECT_EQ(read_csv(scratch.write("t.csv", "t;x\n1;2\n;5\n")).n_rows(), 2u);
  EXPECT_EQ(read_csv(scratch.write("t.csv", "t;x\n1;2\n3;\n")).n_rows(), 2u);
}

/// Returns the cells of one line, read one character after the other.
std::vector<std::string> plain_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && line.substr(i, 2) == "\"\"") {
      cells.back() += line[i++];
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  for (std::string& cell : cells) {
    cell.erase(0, std::min(cell.find_first_not_of(' '), cell.size()));
    cell.erase(cell.find_last_not_of(' ') + 1);
  }
  return cells;
}

// Cells are read in place in the file; the expected cells come from a reader that copies every
// character.
TEST(Csv, ReadsWhatAPlainReaderReads) {
  const Scratch scratch;
  std::mt19937 random(5);
  const std::string letters = "\"\", 1e-.x";
  for (int trial = 0; trial < 300; ++trial) {
    std::string text = "a,b\n";
    std::vector<std::string> expected;
    bool ragged = false;
    for (int row = 0; row < 4; ++row) {
      std::string line = "q";  // no line is empty
      for (auto n = random() % 12; n > 0; --n) line += letters[random() % letters.size()];
      if (std::count(line.begin(), line.end(), ',') == 0) line += ",2";
      const std::vector<std::string> cells = plain_cells(line);
      ragged = ragged || cells.size() != 2;
      expected.insert(expected.end(), cells.begin(), cells.end());
      text += line + (row % 2 ? "\r\n" : "\n");
    }
    const std::string path = scratch.write("t.csv", text);
    if (ragged) {
      EXPECT_THROW(read_csv(path), Error) << text;
      continue;
    }
    const CsvTable table = read_csv(path);
    ASSERT_EQ(table.n_rows(), 4u) << text;
    for (size_t r = 0; r < 4; ++r) {
      EXPECT_EQ(table.row(r),
                std::vector<std::string>(expected.begin() + 2 * r, expected.begin() + 2 * r + 2))
          << text;
      EXPECT_EQ(table.texts("b")[r], expected[2 * r + 1]) << text;
    }
  }
}

// A copy of a table remains valid after its original. Empty lines at the end are ignored; elsewhere
// they are rows of one cell.
TEST(Csv, CopiesAndLineEnds) {
  const Scratch scratch;
  for (const char* text :
       {"t,x\n1,2\n3,4", "t,x\n1,2\n3,4\n", "t,x\n1,2\n3,4\n\n", "t,x\r\n1,2\r\n3,4\r\n\r\n"}) {
    CsvTable copy;
    {
      const CsvTable table = read_csv(scratch.write("t.csv", text));
      copy = table;
    }
    EXPECT_EQ(copy.numbers("x"), (std::vector<double>{2, 4})) << text;
  }
  EXPECT_EQ(read_csv(scratch.write("t.csv", "x\n1\n\n3\n")).n_rows(), 3u);
  EXPECT_EQ(read_csv(scratch.write("t.csv", "")).n_rows(), 0u);
  const auto complaint = [&](const char* text) -> std::string {
    try {
      read_csv(scratch.write("t.csv", text));
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const std::string third = scratch / "t.csv:3: ";
  EXPECT_TRUE(says(complaint("t,x\n1,2\n3\n"), third, {"1 values", "2"}));
  EXPECT_TRUE(says(complaint("t,x\n1,2\n\n3,4\n"), third, {"1 values", "2"}));
}

TEST(Csv, UnwritableLocationIsNoInputError) {
  const Scratch scratch;
  scratch.write("file", "");
  const std::vector<std::string> header = {"a"};
  try {
    CsvWriter table(scratch / "file/t.csv", header);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::numerical);  // results computed before are kept
    EXPECT_TRUE(says(e.what(), scratch / "file/t.csv: ", {"written"}));
  }
}

TEST(JsonText, IsWhatAParserReads) {
  const CommaLocale comma;
  const nlohmann::ordered_json run = {{"status", "stopped"},
                                      {"seconds", 12345.678},
                                      {"words", "a \"b\" \\ \n \x01 \xC3\xA9"},
                                      {"broken", "\xC3("},
                                      {"kkt", std::nan("")}};
  const std::string text = json_text(run);
  EXPECT_EQ(text.back(), '\n');
  const auto parsed = nlohmann::ordered_json::parse(text);
  EXPECT_EQ(parsed["seconds"].get<double>(), 12345.678);
  EXPECT_EQ(parsed["words"], "a \"b\" \\ \n \x01 \xC3\xA9");
  EXPECT_EQ(parsed["broken"], "\xEF\xBF\xBD(");
  EXPECT_TRUE(parsed["kkt"].is_null());
  EXPECT_EQ(parsed.begin().key(), "status");
}

TEST(Files, AppearWholeAndReplaceOldOnes) {
  const Scratch scratch;
  const std::string path = scratch / "a/b/run.json";
  // A folder that was removed is not created again.
  EXPECT_THROW(write_file(path, "old"), Error);
  EXPECT_FALSE(std::filesystem::exists(scratch / "a"));
  EXPECT_THROW(sync_file(path), Error);
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  write_file(path, "old");
  write_file(path, "old", Sync::now);
  sync_file(path);
  EXPECT_EQ(contents_of(path), "old");
  write_file(path, std::string("new\0bytes", 9));
  EXPECT_EQ(contents_of(path), std::string("new\0bytes", 9));
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
  EXPECT_THROW(write_file(path + "/below_a_file", ""), Error);
}

// Reading a pipe without a writer or an endless device would never end.
TEST(Csv, IsReadFromRegularFiles) {
  const Scratch scratch;
  const std::string pipe = scratch / "pipe.csv";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto complaint = [](const std::string& path) -> std::string {
    try {
      read_csv(path);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_TRUE(says(complaint(pipe), pipe + ": ", {"table", "regular file", "pipe"}));
  EXPECT_TRUE(says(complaint("/dev/zero"), "/dev/zero: ", {"table", "regular file", "device"}));
  EXPECT_TRUE(says(complaint(scratch / "."), scratch / ".: ", {"regular file", "folder"}));
  EXPECT_TRUE(says(complaint(scratch / "none.csv"), scratch / "none.csv: ", {"cannot"}));
}

TEST(Text, OfNumbers) {
  const CommaLocale comma;
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(1234567), "1234567");
  EXPECT_EQ(to_text(0.031234567, 3), "0.0312");
  EXPECT_EQ(to_text(1.25e-5, 3), "1.25e-05");
}

}  // namespace
}  // namespace flexmorph::io
