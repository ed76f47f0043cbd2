// Comparisons and sweeps: how values are split and combined, what counts as a peak, data profiles;
// and both commands on a small case, from the command line.

#include <gtest/gtest.h>

#include <filesystem>

#include "cases/statistics.h"
#include "cases/sweep.h"
#include "geometry/base.h"
#include "io/files.h"
#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;

TEST(Median, IsTheMiddle) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_THROW(median({}), Error);
}

TEST(Peaks, AreRisesThatFallAgain) {
  const std::vector<double> values = {10, 8, 6, 9, 6.5, 6, 6.05, 6, 7, 7.5, 7.4, 5, 5.5};
  const std::vector<double> band(values.size(), 1.5);
  EXPECT_EQ(peaks(values, band, 0.02), 2);  // 9 and 7.5; 6.05 is too low, 5.5 has not fallen
  EXPECT_EQ(peaks(values, band, 0.3), 1);   // 9: 7.5 rises from 6 by a quarter
  EXPECT_EQ(peaks(values, band, 0.6), 0);
  std::vector<double> stages = band;
  for (size_t i = 8; i < stages.size(); ++i) stages[i] = 1;
  EXPECT_EQ(peaks(values, stages, 0.02), 2);
  stages[9] = 0.5;
  for (size_t i = 9; i < stages.size(); ++i) stages[i] = 0.5;
  EXPECT_EQ(peaks(values, stages, 0.02), 1);  // the rise to 7.5 goes with a new band
  EXPECT_EQ(peaks({}, {}), 0);
}

TEST(DataProfile, CountsProblemsSolvedToATolerance) {
  // Two solvers, two problems: best values 1 and 10.
  const std::vector<std::vector<Progress>> runs = {
      {{{1, 2, 3}, {3, 1.04, 1}}, {{5, 9}, {12, 10}}},
      {{{1, 2, 3}, {4, 2, 1.5}}, {{5, 9}, {10.2, 10.2}}},
  };
  const auto loose = data_profile(runs, 0.05), tight = data_profile(runs, 0.01);
  EXPECT_EQ(loose[0], (std::vector<double>{2, 9}));
  EXPECT_EQ(loose[1], (std::vector<double>{5}));
  EXPECT_EQ(tight[0], (std::vector<double>{3, 9}));
  EXPECT_TRUE(tight[1].empty());
}

TEST(Varied, SplitsAtCommasOutsideOfBracketsAndQuotes) {
  const Varied v = read_varied("design.band=[2.0,1.5],[1.5]");
  EXPECT_EQ(v.key, "design.band");
  EXPECT_EQ(v.values, (Words{"[2.0,1.5]", "[1.5]"}));
  EXPECT_EQ(read_varied("a=\"x,y\",z").values, (Words{"\"x,y\"", "z"}));
  EXPECT_EQ(read_varied("a=1").values, (Words{"1"}));
  for (const char* bad : {"a", "=1", "a=", "a=1,,2", "a=[1,2"}) {
    EXPECT_THROW(read_varied(bad), Error) << bad;
  }
}

TEST(Combinations, TheLastKeyRunsFastest) {
  const auto all = combinations({{"design.a", {"1", "2"}}, {"b", {"x", "y", "z"}}});
  ASSERT_EQ(all.size(), 6U);
  EXPECT_EQ(all[0].name, "a=1,b=x");
  EXPECT_EQ(all[1].name, "a=1,b=y");
  EXPECT_EQ(all[5].name, "a=2,b=z");
  EXPECT_EQ(all[5].overrides, (Words{"design.a=2", "b=z"}));
  EXPECT_THROW(combinations({}), Error);
  EXPECT_THROW(combinations({{"a", {"1"}}, {"a", {"2"}}}), Error);
  EXPECT_THROW(combinations({{"a", {"1", "1"}}}), Error);
}

/// A static case of a few hundredths of a second.
Words small(const std::string& command, const std::string& folder, const Words& more) {
  Words out = {command, "short_beam",       "-o",    folder,
               "--set", "design.cell=0.05", "--set", "output.design_every=0"};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

size_t lines_with(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (const std::string& line : test::lines_of(text))
    if (line.find(part) != std::string::npos) ++count;
  return count;
}

TEST(Sweep, RunsCollectsAndSkips) {
  const Scratch scratch;
  const std::string folder = scratch / "sweep";
  const Words vary = {"--vary", "design.min_thickness=0.02,0.03",
                      "--vary", "optimizer.max_iterations=3,5",
                      "--jobs", "2"};
  const Ended first = test::flexmorph(scratch, small("sweep", folder, vary));
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(lines_with(first.out, ": done"), 4U);
  const io::CsvTable table = io::read_csv(folder + "/sweep.csv");
  EXPECT_EQ(table.texts("design.min_thickness"), (Words{"0.02", "0.02", "0.03", "0.03"}));
  EXPECT_EQ(table.numbers("iterations"), (std::vector<double>{3, 5, 3, 5}));
  const std::string sheet = contents_of(folder + "/sweep.svg");
  EXPECT_EQ(lines_with(sheet, "max_iterations=3</text>"), 2U);

  const Ended second = test::flexmorph(scratch, small("sweep", folder, vary));
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(lines_with(second.out, "finished before"), 4U);
  EXPECT_EQ(lines_with(second.out, "started"), 0U);
  // Another setting of all of them: nothing is finished.
  Words other = vary;
  other.insert(other.end(), {"--set", "design.max_volume=0.5"});
  EXPECT_EQ(lines_with(test::flexmorph(scratch, small("sweep", folder, other)).out, "started"), 4U);
}

TEST(Sweep, RunsOneByItsIndexAndListsThem) {
  const Scratch scratch;
  const std::string folder = scratch / "sweep";
  const Words vary = {"--vary", "optimizer.max_iterations=3,5"};
  Words words = vary;
  words.push_back("--list");
  EXPECT_EQ(test::flexmorph(scratch, small("sweep", folder, words)).out,
            "1 max_iterations=3\n2 max_iterations=5\n");
  EXPECT_FALSE(std::filesystem::exists(folder));
  words = vary;
  words.insert(words.end(), {"--index", "2"});
  EXPECT_EQ(test::flexmorph(scratch, small("sweep", folder, words)).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder + "/max_iterations=5/run.json"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/max_iterations=3"));
  words.back() = "3";
  EXPECT_EQ(test::flexmorph(scratch, small("sweep", folder, words)).code, 2);
}

TEST(Sweep, RefusesABadValueBeforeAnythingIsWritten) {
  const Scratch scratch;
  const std::string folder = scratch / "sweep";
  const Ended bad =
      test::flexmorph(scratch, small("sweep", folder, {"--vary", "design.min_thickness=0.02,-1"}));
  EXPECT_EQ(bad.code, 2);
  EXPECT_EQ(test::lines_of(bad.err).size(), 1U) << bad.err;
  EXPECT_NE(bad.err.find("min_thickness"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(Sweep, KeepsTheOthersWhenOneFails) {
  const Scratch scratch;
  const std::string folder = scratch / "sweep";
  // A file where a run folder should be: that run cannot start.
  std::filesystem::create_directories(folder);
  io::write_file(folder + "/max_iterations=3", "in the way");
  const Ended ended =
      test::flexmorph(scratch, small("sweep", folder, {"--vary", "optimizer.max_iterations=3,5"}));
  EXPECT_EQ(ended.code, 3);
  EXPECT_EQ(io::read_csv(folder + "/sweep.csv").texts("status"), (Words{"missing", "done"}));
}

TEST(Compare, MakesATableOfOptimizersFromTheSameStarts) {
  const Scratch scratch;
  const std::string folder = scratch / "compare";
  const Words words = {"--optimizers", "mma,ipopt", "--starts", "2", "--budget", "8", "--quiet"};
  const Ended ended = test::flexmorph(scratch, small("compare", folder, words));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable table = io::read_csv(folder + "/compare.csv");
  EXPECT_EQ(table.texts("run"), (Words{"mma_1", "mma_2", "ipopt_1", "ipopt_2"}));
  for (const double solves : table.numbers("state_solves")) {
    EXPECT_GE(solves, 8);
    EXPECT_LE(solves, 20);  // a line search is finished
  }
  // The same first start: the first rows of both histories agree.
  const auto first_row = [&](const std::string& run) {
    return io::read_csv(folder + "/" + run + "/history.csv").numbers("compliance").front();
  };
  EXPECT_GT(first_row("mma_1"), 0);
  EXPECT_NE(first_row("mma_1"), first_row("mma_2"));
  EXPECT_NE(contents_of(folder + "/compare.svg").find("Data profile"), std::string::npos);
  EXPECT_NE(contents_of(folder + "/compare.md").find("| mma | 2/2 |"), std::string::npos);
  EXPECT_EQ(test::lines_of(ended.out).size(), 4U) << ended.out;

  EXPECT_EQ(
      test::flexmorph(scratch, small("compare", scratch / "none", {"--optimizers", "nobody"})).code,
      2);
  EXPECT_FALSE(std::filesystem::exists(scratch / "none"));
}

}  // namespace
}  // namespace flexmorph::cases
