// Shows that forty typical mistakes of a new user (typos, units, encodings, pipes, folders) end
// with the right exit code, that the message begins with the location and names the mistake, and
// that nothing is written.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>

#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

/// short_plate.toml with one change, or a command line of its own.
struct Tried {
  const char* name;
  std::string from, to;  ///< Text of the case and its replacement; empty: the case is unchanged.
  std::string location;  ///< ":line:column" after the file name; empty: no location.
  std::vector<std::string> parts;   ///< Parts of the message after its location.
  Words words = {"check", "CASE"};  ///< CASE stands for the changed case, OUT for a run folder.
  int code = 2;
  size_t lines = 1;  ///< Number of lines of the message.
};
void PrintTo(const Tried& tried, std::ostream* out) { *out << tried.name; }

const std::string kLatin = "title = \"Tr\xe4ger\"\n", kMark = "\xef\xbb\xbf";

const Tried kTyped[] = {
    {"misspelt_key",
     "thickness = 0.01",
     "thicknes = 0.01",
     ":19:12",
     {"body.thicknes = 0.01", "'thickness'"}},
    {"misspelt_table", "[optimizer]", "[optimiser]", ":57:1", {"[optimiser]", "'optimizer'"}},
    {"misspelt_word", "\"weld\"", "\"wedl\"", ":30:8", {"joint.type", "'weld'", "'weld'"}},
    {"misspelt_body",
     "body = \"plate\"\nat",
     "body = \"palte\"\nat",
     ":36:8",
     {"point_mass.body", "'plate'"}},
    {"capital", "[time]", "[Time]", ":5:1", {"[Time]", "'time'"}},
    {"comma_for_point", "width = 0.1", "width = 0,1", ":18:10", {"`width = 0,1`", "comma"}},
    {"unit_behind",
     "length = 0.5\nwidth",
     "length = 0.5 m\nwidth",
     ":17:14",
     {"`length = 0.5 m`", "unit"}},
    {"unit_in_quotes",
     "width = 0.1",
     "width = \"100 kg\"",
     ":18:9",
     {"body.width = \"100 kg\" (100): ", "[m]", "'kg'", "mm, cm"}},
    {"unknown_unit",
     "width = 0.1",
     "width = \"100 parsecs\"",
     ":18:9",
     {"body.width = \"100 parsecs\": ", "[m]", "'parsecs'", "mm, cm"}},
    {"unknown_constant",
     "elements = [10, 2]",
     "elements = [\"2*n\", 2]",
     ":23:12",
     {"body.elements = [\"2*n\", 2]: ", "'n'", "unknown"}},
    {"unknown_material",
     "youngs_modulus = 1e8\n",
     "material = \"iron\"\n",
     ":21:12",
     {"body.material = \"iron\"", "'steel'", "'aluminium'"}},
    {"no_quotes", "name = \"mma\"", "name = mma", ":58:8", {"`name = mma`", "quotes"}},
    {"open_quote", "\"mma\"", "\"mma", ":58:12", {"name =", "closing quote"}},
    {"open_bracket", "[10, 2]", "[10, 2", ":25:1", {"TOML", "']'"}},
    {"key_twice", "width = 0.1", "width = 0.1\nwidth = 0.2", ":19:9", {"TOML", "'width'"}},
    {"table_twice", "[esl]", "[time]\n[esl]", ":40:1", {"TOML", "'time'"}},
    {"semicolon", "speed = 0.5", "speed = 0.5;", ":26:12", {"`speed = 0.5;`", "semicolon"}},
    {"colon", "end = 0.12", "end: 0.12", ":6:4", {"`end: 0.12`", "'='"}},
    {"negative",
     "thickness = 0.01",
     "thickness = -0.01",
     ":19:13",
     {"body.thickness = -0.01", "positive", "[m]"}},
    {"zero_step", "step = 1e-3", "step = 0", ":7:8", {"time.step = 0", "positive", "[s]"}},
    {"step_beyond_end", "step = 1e-3", "step = 1", ":7:8", {"time.step = 1", "time.end", "[s]"}},
    {"not_a_number",
     "density = 2700.0",
     "density = nan",
     ":20:11",
     {"body.density = nan", "positive"}},
    {"infinite", "end = 0.12", "end = inf", ":6:7", {"time.end = inf", "positive", "[s]"}},
    {"half_an_element",
     "[10, 2]",
     "[10.5, 2]",
     ":23:12",
     {"body.elements = [10.5, 2]", "whole number"}},
    {"too_few", "[10, 2]", "[10]", ":23:12", {"body.elements = [10]", "list of 2"}},
    {"poisson_in_percent",
     "poisson_ratio = 0.3",
     "poisson_ratio = 30",
     ":22:17",
     {"body.poisson_ratio = 30", "0.5"}},
    {"volume_in_percent",
     "max_volume = 0.5",
     "max_volume = 50",
     ":47:14",
     {"design.max_volume = 50", "fraction", "1"}},
    {"key_missing",
     "youngs_modulus = 1e8\n",
     "",
     ":13:1",
     {"body.youngs_modulus", "missing", "[Pa]"}},
    {"joint_missing",
     "[[joint]]\ntype = \"weld\"\nbody = \"plate\"\nedge = \"root\"\nto = \"hub\"\n",
     "",
     ":13:1",
     {"body", "[[joint]]", "root"}},
    {"steps_too_many", "step = 1e-3", "step = 1e-13", ":7:8", {"time.step = 1e-13", "1.2e+12"}},
    {"memory_too_small",
     "step = 1e-3",
     "step = 1e-10",
     ":7:8",
     {"time.step = 1e-10", "memory"},
     {"run", "CASE", "-o", "OUT"}},
    {"three_mistakes",
     "length = 0.5\nwidth = 0.1\nthickness = 0.01\n",
     "length = -0.5\nwidth = \"0.1 kg\"\nthicknes = 0.01\n",
     ":17:10",
     {"body.length = -0.5", "tried.toml:18:9: body.width = \"0.1 kg\" (0.1): ", "'kg'",
      "tried.toml:19:12: body.thicknes", "'thickness'"},
     {"check", "CASE"},
     2,
     3},
    {"latin_letters", "title = \"Growing plate, short\"\n", kLatin, ":3:11", {"TOML", "UTF-8"}},
    {"empty_file", "*", "", ":1:1", {"time", "missing", "[time]"}},
    {"not_toml_at_all", "*", "<?xml version=\"1.0\"?>\n<case/>\n", ":1:1", {"TOML", "'<'"}},
    {"binary",
     "*",
     std::string("\x7f"
                 "ELF\0\0\1",
                 7),
     ":1:1",
     {"TOML"}},
    {"windows_marks",
     "*",
     kMark + "[time]\r\nend = -1\r\n",
     ":2:7",
     {"time.end = -1", "positive", "[s]"}},
    {"no_such_case", "", "", "", {"'shortbeam'", "'short_beam'"}, {"check", "shortbeam"}},
    {"a_folder", "", "", "", {".: ", "directory", "TOML"}, {"check", "."}},
    {"no_command", "", "", "", {"tried.toml'", "case", "flexmorph run"}, {"CASE"}},
    {"set_without_value",
     "",
     "",
     "",
     {"--set time.end: ", "KEY=VALUE"},
     {"check", "CASE", "--set", "time.end"}},
    {"set_of_a_wrong_key",
     "",
     "",
     "",
     {"--set body.thicknes=0.1: ", "'thickness'"},
     {"check", "CASE", "--set", "body.thicknes=0.1"}},
    {"run_folder_is_a_file", "", "", "", {"folder", "tried.toml"}, {"run", "CASE", "-o", "CASE"}},
    {"wrong_threads",
     "",
     "",
     "",
     {"--threads", "256"},
     {"run", "CASE", "-o", "OUT", "--threads", "0"}},
};
static_assert(std::size(kTyped) >= 40);

class Forty : public ::testing::TestWithParam<Tried> {};
INSTANTIATE_TEST_SUITE_P(Tried, Forty, ::testing::ValuesIn(kTyped),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Forty, SaysWhereAndWhat) {
  const Scratch scratch;
  const Tried& tried = GetParam();
  std::string text = contents_of(FLEXMORPH_SHORT_CASE);
  if (tried.from == "*") {
    text = tried.to;
  } else if (!tried.from.empty()) {
    const size_t at = text.find(tried.from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, tried.from.size(), tried.to);
  }
  const std::string file = scratch.write("tried.toml", text), out = scratch / "out";
  Words words = tried.words;
  for (std::string& word : words) word = word == "CASE" ? file : word == "OUT" ? out : word;
  const Ended ended = flexmorph(scratch, words);
  EXPECT_EQ(ended.code, tried.code) << ended.err;
  EXPECT_EQ(ended.out, "");
  EXPECT_TRUE(testing::mentions_all(
      ended.err, tried.parts,
      tried.from.empty() ? "" : "flexmorph: " + file + tried.location + ": "));
  EXPECT_EQ(contents_of(file), text);  // files of the user are not changed
  EXPECT_FALSE(fs::exists(out));
  // For arguments on the command line CLI11 adds lines of its own.
  if (tried.name != std::string("wrong_threads")) {
    EXPECT_EQ(lines_of(ended.err).size(), tried.lines) << ended.err;
  }
  // FLEXMORPH_FORTY=file.md writes the messages as a table.
  if (const char* table = std::getenv("FLEXMORPH_FORTY")) {
    std::string message = ended.err.substr(0, ended.err.find_last_not_of('\n') + 1);
    for (size_t at; (at = message.find(file)) != std::string::npos;)
      message.replace(at, file.size(), "plate.toml");
    for (size_t at; (at = message.find('\n')) != std::string::npos;) message.replace(at, 1, "<br>");
    std::ofstream(table, std::ios::app) << "| " << tried.name << " | " << ended.code << " | "
                                        << (tried.location.empty() ? "-" : tried.location.substr(1))
                                        << " | `" << message << "` |\n";
  }
}

// A case that is read through a pipe has locations, too; an empty pipe is an empty file.
TEST(Pipes, AreFilesWithoutAName) {
  const Scratch scratch;
  const std::string err = scratch / "err", program = std::string("'") + FLEXMORPH_PROGRAM + "'";
  const auto ended = [&](const std::string& command) {
    return testing::run_shell(command + " >/dev/null 2>'" + err + "'").code;
  };
  EXPECT_EQ(ended("printf '[time]\\nend = -1\\n' | " + program + " check -"), 2);
  EXPECT_TRUE(starts(contents_of(err), "flexmorph: /dev/stdin:2:7: time.end = -1: "));
  EXPECT_EQ(ended("printf '' | " + program + " check -"), 2);
  EXPECT_TRUE(
      testing::mentions_all(contents_of(err), {"time", "missing"}, "flexmorph: /dev/stdin:1:1: "));
}

// At most twenty lines are printed, in the order of the file.
TEST(ManyMistakes, FillOneScreenAtMost) {
  const Scratch scratch;
  std::string text = "[time]\nend = -1\n";
  for (int k = 0; k < 30; ++k)
    text += "[[body]]\nname = \"b" + std::to_string(k) + "\"\nwidth = -1\n";
  const Ended ended = flexmorph(scratch, {"check", scratch.write("many.toml", text)});
  EXPECT_EQ(ended.code, 2);
  const Words lines = lines_of(ended.err);
  ASSERT_EQ(lines.size(), 20u);
  EXPECT_TRUE(contains(lines[0], "many.toml:2:7: time.end = -1"));
  EXPECT_TRUE(contains(lines[1], "many.toml:3:1: body.b0."));
  EXPECT_TRUE(testing::mentions_all(lines[19], {"many.toml: ", "errors"}));
}

}  // namespace
}  // namespace flexmorph::test
