// Shows that no line on the screen is longer than 80 columns when the output is no terminal: help
// texts, lists, summaries, progress, warnings, and tables of studies.
#include <gtest/gtest.h>

#include "cases/check/templates.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

void expect_narrow(const std::string& text, const std::string& where) {
  EXPECT_EQ(wide_lines(text), Words{}) << where;
}

/// Runs the program and returns its output as it is on the screen.
Ended output_of(const Scratch& scratch, const Words& arguments) {
  return start(scratch, arguments).end();
}

TEST(ScreenWidth, HoldsForHelpAndLists) {
  const Scratch scratch;
  const std::string help = output_of(scratch, {"--help"}).out;
  expect_narrow(help, "--help");
  EXPECT_TRUE(testing::mentions_all(help, {"Exit codes", "0", "5", "flexmorph COMMAND --help"}));
  size_t commands = 0;
  for (const std::string& line : lines_of(help.substr(help.find("Subcommands:")))) {
    if (!line.starts_with("  ") || line[2] == ' ') continue;
    const std::string name = line.substr(2, line.find(' ', 2) - 2);
    if (name == "help") break;
    const std::string text = output_of(scratch, {name, "--help"}).out;
    expect_narrow(text, name + " --help");
    EXPECT_TRUE(testing::mentions_all(text, {"Example", "flexmorph " + name, "Exit codes"}));
    ++commands;
  }
  EXPECT_GE(commands, 14u);
  const std::string run = output_of(scratch, {"run", "--help"}).out;
  EXPECT_TRUE(testing::mentions_all(run, {"KEY=VALUE", "default", "short_beam"}));
  for (const Words& words :
       {Words{"keys"}, Words{"keys", "design"}, Words{"keys", "length"}, Words{"cases"}})
    expect_narrow(output_of(scratch, words).out, words.front());
}

// Summaries of the shipped cases: CommandLine.EveryShippedCaseChecks.
TEST(ScreenWidth, HoldsForSummaries) {
  const Scratch scratch;
  for (const std::string& kind : cases::template_kinds()) {
    const std::string path = cases::find_template(kind);
    expect_narrow(output_of(scratch, {"check", path}).out, "check " + kind);
  }
  expect_narrow(output_of(scratch, {"modes", "plate_pendulum", "-o", scratch / "modes"}).out,
                "modes");
}

TEST(ScreenWidth, HoldsForRunsAndTheirWarnings) {
  const Scratch scratch;
  const Ended ended = output_of(scratch, short_run(scratch / "out"));
  expect_narrow(ended.out, "run");
  expect_narrow(ended.err, "warnings");
  EXPECT_NE(ended.err, "");
}

// The table shows the varied keys and the status of each variant, and warnings follow.
TEST(ScreenWidth, HoldsForStudies) {
  const Scratch scratch;
  const Ended ended =
      output_of(scratch, {"sweep", FLEXMORPH_SHORT_CASE, "-o", scratch / "sweep", "--vary",
                          "design.max_volume=0.45,0.5", "--vary", "optimizer.move_limit=0.05",
                          "--set", "optimizer.max_iterations=2", "--set", "output.vtk=false",
                          "--set", "output.plots=false"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_narrow(ended.out, "sweep");
  EXPECT_TRUE(testing::mentions_all(
      ended.out, {"variant", "status", "0.45", "done", "0.5", "done", "warnings", "sweep.md"}));
}

}  // namespace
}  // namespace flexmorph::test
