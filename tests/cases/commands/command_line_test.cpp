// Shows the behaviour of the commands of the program: their outputs, exit codes, and one-line
// messages about bad input, after which no run folder exists.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "cases/check/ready.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

TEST(CommandLine, SaysItsVersion) {
  const Scratch scratch;
  const Ended ended = flexmorph(scratch, {"--version"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_TRUE(starts(ended.out, "flexmorph "));
  EXPECT_EQ(lines_of(ended.out).size(), 1u);
  EXPECT_EQ(ended.err, "");
}

TEST(CommandLine, SaysWhatWasProbablyMeant) {
  const Scratch scratch;
  struct Meant {
    Words words;
    std::vector<std::string> parts;
  };
  for (const Meant& each :
       std::vector<Meant>{{{"chek", "short_beam"}, {"'chek'", "command", "'check'"}},
                          {{"short_beam"}, {"'short_beam'", "case", "flexmorph run short_beam"}},
                          {{"run", "shortbeam"}, {"'shortbeam'", "case", "'short_beam'"}},
                          {{"run", "four-bar.toml"}, {"'four-bar.toml'", "case", "'four_bar'"}},
                          {{"check", "."}, {".: ", "directory", "TOML"}},
                          {{"keys", "boddy"}, {"'boddy'", "'body'"}}}) {
    const Ended ended = flexmorph(scratch, each.words);
    EXPECT_EQ(ended.code, 2) << each.words[0];
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    EXPECT_TRUE(testing::mentions_all(ended.err, each.parts));
  }
  const Ended help = flexmorph(scratch, {"help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_TRUE(testing::mentions_all(help.out, {"run", "check", "verify", "--version"}));
}

// A case may be read from a pipe. If the output cannot be written, the exit code is 2.
TEST(CommandLine, ReadsStandardInputAndMissesAFullDisk) {
  const Scratch scratch;
  const std::string out = scratch / "checked", program = std::string("'") + FLEXMORPH_PROGRAM +
                                                         "' check - <'" + FLEXMORPH_SHORT_CASE +
                                                         "' ";
  ASSERT_EQ(testing::run_shell(program + ">'" + out + "'").code, 0);
  EXPECT_TRUE(contains(contents_of(out), "\nactive\n"));
  const std::string err = scratch / "err";
  EXPECT_EQ(testing::run_shell(program + ">/dev/full 2>'" + err + "'").code, 2);
  EXPECT_TRUE(testing::mentions_all(contents_of(err), {"output", "No space left on device"}));
}

// Files of components are found next to the case that names them; files named by --set are found in
// the current folder.
TEST(CommandLine, FindsFilesBesideTheCase) {
  const Scratch scratch;
  scratch.write("start.csv", "X0,Y0,half_length,angle,c1,c2,c3\n0.3,0.5,0.2,0,0.2,0.2,0.2\n");
  std::string text = contents_of(std::string(FLEXMORPH_CASES) + "/short_beam.toml");
  const size_t at = text.find("components = ");
  ASSERT_NE(at, std::string::npos);
  text.insert(at, "start = \"start.csv\"\n");
  const std::string beside = scratch.write("beside.toml", text);
  EXPECT_EQ(flexmorph(scratch, {"check", beside}).code, 0);
  const Ended elsewhere =
      flexmorph(scratch, {"check", beside, "--set", "design.start=\"start.csv\""});
  EXPECT_EQ(elsewhere.code, 2);
  EXPECT_TRUE(testing::mentions_all(elsewhere.err, {"start.csv"},
                                    "flexmorph: --set design.start=\"start.csv\": "));
}

/// Returns the first word of each line.
Words shipped_names(const std::string& text) {
  Words out;
  for (const std::string& line : lines_of(text)) out.push_back(line.substr(0, line.find(' ')));
  return out;
}

TEST(CommandLine, ListsTheShippedCases) {
  const Scratch scratch;
  const Ended ended = flexmorph(scratch, {"cases"});
  EXPECT_EQ(ended.code, 0);
  const Words names = shipped_names(ended.out);
  for (const char* name : {"rotating_plate_v01", "rotating_plate_v05"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  // Each name is followed by the title of its case.
  EXPECT_TRUE(contains(ended.out, "four_bar  ")) << ended.out;
  EXPECT_TRUE(contains(ended.out, cases::title_of_case("four_bar") + "\n")) << ended.out;
}

TEST(CommandLine, EveryShippedCaseChecks) {
  const Scratch scratch;
  for (const std::string& name : shipped_names(flexmorph(scratch, {"cases"}).out)) {
    const Ended ended = start(scratch, {"check", name}).end();
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(wide_lines(ended.out), Words{}) << name;
    EXPECT_TRUE(contains(ended.out, "\nactive\n"));
    EXPECT_TRUE(contains(ended.out, "\nabsent"));
  }
}

TEST(CommandLine, CheckSaysWhatIsThereAndWhatIsNot) {
  const Scratch scratch;
  const auto halves = [&](const Words& changes) {
    Words words = {"check", FLEXMORPH_SHORT_CASE};
    for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
    const std::string out = flexmorph(scratch, words).out;
    const size_t middle = std::min(out.find("\nabsent"), out.size());
    return std::pair(out.substr(0, middle), out.substr(middle));
  };
  const auto [active, absent] = halves({});
  for (const char* part : {" s, step ", "body plate", "24 components", "168 variables", "112 x 20",
                           "12 loads", "unknowns", "MB", "mma", "inertia, membrane", "forces"})
    EXPECT_TRUE(contains(active, part));
  for (const char* part : {"gravity", "heat", "out-of-plane", "rigid bodies", "verification",
                           "free material lines", "adaptive steps", "observed points", "loads"})
    EXPECT_TRUE(contains(absent, part));
  // Changes of the case move entries from one list to the other.
  const auto [more, less] = halves({"gravity=[0, -9.81]", "verify.mesh=[20, 4]",
                                    "time.step=\"adaptive\"", "output.plots=false"});
  EXPECT_FALSE(contains(less, "adaptive steps"));
  EXPECT_TRUE(contains(less, "plots"));
  EXPECT_TRUE(contains(more, "gravity"));
  EXPECT_FALSE(contains(less, "gravity"));
  EXPECT_TRUE(contains(more, "verification"));
  EXPECT_FALSE(contains(less, "verification"));
}

TEST(CommandLine, UnknownWordsAreBadInput) {
  const Scratch scratch;
  EXPECT_EQ(flexmorph(scratch, {}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"dance"}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"run"}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"run", "rotating_plate_v01", "--threads", "0"}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"check", "rotating_plate_v01", "--set", "nothing"}).code, 2);
}

/// A line of short_plate.toml with an invalid value, and the key and value that the message names.
struct Bad {
  const char* name;
  std::string line;   ///< Start of the line to replace.
  std::string by;     ///< The replacement.
  std::string where;  ///< Key and value as the message shows them.
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

const Bad kBad[] = {
    {"unknown_key", "thickness", "thicknes = 0.01", "body.thicknes = 0.01: "},
    {"wrong_type", "width", "width = \"wide\"", "body.width = \"wide\": "},
    {"negative_thickness", "thickness", "thickness = -0.002", "body.thickness = -0.002: "},
    {"no_volume", "max_volume", "max_volume = 0", "design.max_volume = 0: "},
    {"c_min_above_width", "min_thickness", "min_thickness = 0.2", "design.min_thickness = 0.2: "},
    {"no_components", "components", "components = []", "design.components = []: "},
    {"end_zero", "end", "end = 0", "time.end = 0: "},
    {"ten_million_cells", "cell ", "cell = 7.5e-5", "design.cell = 7.5e-5: "},
    {"unknown_optimizer", "name = \"mma\"", "name = \"sqp\"", "optimizer.name = \"sqp\": "},
    {"unknown_option", "move_limit", "options.asinit = 0.1", "optimizer.options.asinit = 0.1: "},
    {"option_out_of_range", "move_limit", "options.asydecr = 1.5",
     "optimizer.options.asydecr = 1.5: "},
};

class BadInput : public ::testing::TestWithParam<Bad> {};
INSTANTIATE_TEST_SUITE_P(Line17, BadInput, ::testing::ValuesIn(kBad),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(BadInput, IsOneLocatedLineAndNoFolder) {
  const Scratch scratch;
  std::string text;
  int line = 0, found = 0;
  for (std::string each : lines_of(contents_of(FLEXMORPH_SHORT_CASE))) {
    ++line;
    if (each.starts_with(GetParam().line)) each = GetParam().by, found = line;
    text += each + "\n";
  }
  ASSERT_GT(found, 0);
  const std::string file = scratch.write("bad.toml", text), folder = scratch / "out";
  const size_t column = GetParam().by.find("= ") + 3;  // column of the value, counted from 1
  for (const Words& command : {Words{"run", file, "-o", folder}, Words{"check", file}}) {
    const Ended ended = flexmorph(scratch, command);
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(starts(ended.err, "flexmorph: " + file + ":" + std::to_string(found) + ":" +
                                      std::to_string(column) + ": " + GetParam().where));
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_FALSE(fs::exists(folder));
  }
}

TEST(BadInput, AMissingFileIsNamed) {
  const Scratch scratch;
  const std::string file = scratch / "nowhere.toml", folder = scratch / "out";
  const Ended ended = flexmorph(scratch, {"run", file, "-o", folder});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(contains(ended.err, file));
  EXPECT_TRUE(contains(ended.err, "rotating_plate_v01"));  // the existing cases
  EXPECT_EQ(lines_of(ended.err).size(), 1u);
  EXPECT_FALSE(fs::exists(folder));
}

TEST(BadInput, OptionsOfTheCommandLineAreNamedToo) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(scratch, {"run", "rotating_plate_v01", "-o", folder, "--set",
                                          "optimizer.options.asinit=0.1"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(starts(ended.err, "flexmorph: --set optimizer.options.asinit=0.1: "));
  EXPECT_TRUE(contains(ended.err, "asyinit"));  // the existing options
  EXPECT_EQ(lines_of(ended.err).size(), 1u);
  EXPECT_FALSE(fs::exists(folder));
}

TEST(BadInput, AFolderThatCannotBeMadeIsNamed) {
  const Scratch scratch;
  const std::string below_a_file = scratch.write("file", "") + "/out";
  for (const std::string& folder : {below_a_file, scratch / "file", std::string("/proc/out")}) {
    const Ended ended = flexmorph(scratch, short_run(folder));
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(contains(ended.err, folder));
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
  }
  EXPECT_TRUE(fs::is_regular_file(scratch / "file"));
}

// Nothing is removed from a folder that no run has written.
TEST(BadInput, AFolderOfSomethingElseIsLeftAlone) {
  const Scratch scratch;
  const std::string folder = scratch / "mine";
  for (const char* own : {"thesis.tex", "case.toml", "motion.csv"}) {
    fs::remove_all(folder);
    fs::create_directory(folder);
    scratch.write(std::string("mine/") + own, "years of work");
    const Ended ended = flexmorph(scratch, short_run(folder));
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(contains(ended.err, folder));
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    EXPECT_EQ(contents_of(folder + "/" + own), "years of work");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  }
}

}  // namespace
}  // namespace flexmorph::test
