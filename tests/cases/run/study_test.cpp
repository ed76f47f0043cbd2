// Shows that comparisons and sweeps split and combine values correctly, that peaks and data
// profiles are counted correctly, and that both commands work on a small case.

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>

#include "cases/study/statistics.h"
#include "cases/study/sweep.h"
#include "geometry/base.h"
#include "io/files.h"
#include "io/output_folder.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

using test::Ended;
using test::Words;

TEST(Median, IsTheMiddle) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_THROW(median({}), Error);
}

TEST(ToldApart, NeedsBothMediansOutside) {
  EXPECT_TRUE(distinguishable({1, 2, 3}, {4, 5, 6}));
  EXPECT_TRUE(distinguishable({1, 2, 4.5}, {4, 5, 6}));  // overlapping ranges are permitted
  EXPECT_FALSE(
      distinguishable({1, 2, 3}, {1.5, 5, 6}));  // the median 2 lies within the other range
  EXPECT_FALSE(distinguishable({1.5, 5, 6}, {1, 2, 3}));
  EXPECT_FALSE(distinguishable({2}, {2}));
  EXPECT_THROW(distinguishable({}, {1}), Error);
}

TEST(Peaks, StandOutOnBothSidesByAShareOfTheBest) {
  const std::vector<double> values = {10, 8, 6, 9, 6.5, 6, 6.05, 6, 7, 7.5, 7.4, 5, 5.5};
  const std::vector<int> one(values.size(), 0);
  // 9 and 7.5; 6.05 is too low, and nothing falls after 5.5
  EXPECT_EQ(peaks(values, one, 0.02), 2);
  // 9 stands out by 3; 7.5 stands out by only 1.5, for a best value of 6
  EXPECT_EQ(peaks(values, one, 0.3), 1);
  EXPECT_EQ(peaks(values, one, 0.6), 0);
  EXPECT_EQ(peaks({}, {}), 0);
  // A history that decreases all the time has no peak, neither at its beginning nor at its end.
  EXPECT_EQ(peaks(std::vector<double>{9, 5, 3, 2}, std::vector<int>(4, 0)), 0);
  // The required height is a fraction of the best value so far, not of the valley before: 2.4 is
  // above 2.3 by 10 % of 1.
  const std::vector<double> late = {1, 3, 2.3, 2.4, 2.3, 1};
  EXPECT_EQ(peaks(late, std::vector<int>(6, 0), 0.09), 2);
  EXPECT_EQ(peaks(late, std::vector<int>(6, 0), 0.11), 1);
  // Values that are not finite are skipped.
  const std::vector<double> gaps = {2, std::nan(""), 3, INFINITY, 2};
  EXPECT_EQ(peaks(gaps, std::vector<int>(5, 0)), 1);
}

TEST(Peaks, DoNotReachOverStages) {
  const std::vector<double> values = {6, 7, 7.5, 5, 6};
  EXPECT_EQ(peaks(values, std::vector<int>{0, 0, 0, 0, 0}), 1);
  // the decrease is the start of a new stage
  EXPECT_EQ(peaks(values, std::vector<int>{0, 0, 1, 1, 1}), 0);
  // the decrease coincides with a new stage
  EXPECT_EQ(peaks(values, std::vector<int>{0, 0, 0, 1, 1}), 0);
}

TEST(BestSoFar, CountsFeasibleRowsOfTheStage) {
  const std::vector<double> values = {5, 4, 3, 3.5, 8, 7, 9}, beyond = {0, 0, 1, 0, 0, 2e-4, 1e-4};
  const auto best = best_so_far(values, beyond, std::vector<int>{0, 0, 0, 0, 1, 1, 1}, 1e-4);
  EXPECT_EQ(best, (std::vector<double>{5, 4, 4, 3.5, 8, 8, 8}));
  const auto late = best_so_far(std::vector<double>{5, 4}, std::vector<double>{1, 0},
                                std::vector<int>{0, 0}, 1e-4);
  EXPECT_TRUE(std::isnan(late[0]));
  EXPECT_EQ(late[1], 4);
}

TEST(DataProfile, CountsProblemsSolvedToATolerance) {
  // Two solvers and two problems; the best values are 1 and 10.
  const std::vector<std::vector<SolveHistory>> runs = {
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
  EXPECT_EQ(read_varied("a= 1, 2 ").values, (Words{"1", "2"}));
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
  EXPECT_EQ(combinations({{"design.band", {"[2.0,1.5]", "[1.5]"}}})[0].name, "band=2.0_1.5");
  EXPECT_THROW(combinations({}), Error);
  EXPECT_THROW(combinations({{"a", {"1"}}, {"a", {"2"}}}), Error);
  EXPECT_THROW(combinations({{"a", {"1", "1"}}}), Error);
}

TEST(Combinations, AreOfCasesToo) {
  const auto all = combinations({{"case", {"mbb", "other/my_arm.toml"}}, {"a.b", {"1", "2"}}});
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[1].name, "case=mbb,b=2");
  EXPECT_EQ(all[1].case_name, "mbb");
  EXPECT_EQ(all[1].overrides, (Words{"a.b=2"}));
  EXPECT_EQ(all[2].name, "case=other_my_arm.toml,b=1");
  EXPECT_EQ(all[2].case_name, "other/my_arm.toml");
}

/// Returns a command for a static case on 40 x 20 cells. min_feature is 0, because fillets would
/// take most of the time.
Words small(const std::string& command, const std::string& folder, const Words& more) {
  Words out = {command, "short_beam",          "-o",    folder,
               "--set", "design.cell=0.05",    "--set", "output.design_every=0",
               "--set", "design.min_feature=0"};
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
  // Progress is printed, and designs that had too few iterations are called unfinished.
  for (int n = 1; n <= 4; ++n)
    EXPECT_EQ(lines_with(first.out, std::to_string(n) + "/4 "), 1U) << first.out;
  EXPECT_EQ(table.texts("verdict"), Words(4, "unfinished"));
  EXPECT_EQ(lines_with(contents_of(folder + "/sweep.md"), ", unfinished"), 4U);
  EXPECT_EQ(lines_with(contents_of(folder + "/sweep.md"), "4 of 4"), 1U);
  EXPECT_EQ(lines_with(first.out, "4 of 4"), 1U);
  const std::string sheet = contents_of(folder + "/sweep.svg");
  EXPECT_EQ(lines_with(sheet, "max_iterations = 3 (unfinished)</text>"), 2U);

  const Ended second = test::flexmorph(scratch, small("sweep", folder, vary));
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(lines_with(second.out, ": finished"), 4U);
  EXPECT_EQ(lines_with(second.out, "started"), 0U);
  // With another setting for all runs none of them is finished.
  Words other = vary;
  other.insert(other.end(), {"--set", "design.max_volume=0.5"});
  EXPECT_EQ(lines_with(test::flexmorph(scratch, small("sweep", folder, other)).out, "started"), 4U);
}

TEST(Sweep, PutsCasesAndDeflectionsOnOnePage) {
  const Scratch scratch;
  const std::string folder = scratch / "sweep", other = scratch / "shorter.toml";
  std::string changed = contents_of(FLEXMORPH_SHORT_CASE);
  changed.replace(changed.find("end = 0.12"), 10, "end = 0.10");
  io::write_file(other, changed);
  const Words words = {"sweep",  FLEXMORPH_SHORT_CASE,
                       "-o",     folder,
                       "--set",  "optimizer.max_iterations=2",
                       "--set",  "design.cell=0.01",
                       "--set",  "esl.every=0.02",
                       "--vary", "case=" FLEXMORPH_SHORT_CASE "," + other,
                       "--vary", "design.min_thickness=0.01,0.015"};
  const Ended ended = test::flexmorph(scratch, words);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable table = io::read_csv(folder + "/sweep.csv");
  const std::vector<std::string> variants = table.texts("variant");
  const std::vector<double> largest = table.numbers("largest_tip_deflection");
  ASSERT_EQ(variants.size(), 4U);
  for (size_t k = 0; k < variants.size(); ++k) {
    const io::CsvTable motion = io::read_csv(folder + "/" + variants[k] + "/motion.csv");
    double expected = 0;
    for (const double y : motion.numbers("plate.tip_deflection"))
      expected = std::max(expected, std::abs(y));
    EXPECT_EQ(largest[k], expected);
    EXPECT_NEAR(motion.numbers("plate.length").back(), k < 2 ? 0.56 : 0.55, 1e-12);
  }
  // There is one plot of deflections per case, with both thicknesses.
  EXPECT_EQ(lines_with(contents_of(folder + "/sweep.svg"), "tip deflection [m]"), 2U);
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
  // A file with the name of a run folder prevents this run from starting.
  std::filesystem::create_directories(folder);
  io::require_study_folder(folder);
  io::write_file(folder + "/max_iterations=3", "in the way");
  const Ended ended =
      test::flexmorph(scratch, small("sweep", folder, {"--vary", "optimizer.max_iterations=3,5"}));
  EXPECT_EQ(ended.code, 3);
  EXPECT_EQ(io::read_csv(folder + "/sweep.csv").texts("status"),
            (Words{"failed", "done, not usable"}));
  EXPECT_NE(ended.err.find("max_iterations=3"), std::string::npos) << ended.err;
  EXPECT_TRUE(std::filesystem::exists(folder + "/max_iterations=5/design.svg"));
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
    EXPECT_LE(solves, 20);  // a line search is completed
  }
  // The first start is that of the case; the second one is equal for both optimizers.
  const auto lines_of_start = [&](const std::string& run) {
    Words out;
    for (const std::string& line : test::lines_of(contents_of(folder + "/" + run + "/case.toml")))
      if (line.starts_with("jitter") || line.starts_with("seed")) out.push_back(line);
    return out;
  };
  EXPECT_EQ(lines_of_start("mma_1"), Words{});
  EXPECT_EQ(lines_of_start("mma_2"), (Words{"jitter = 0.1", "seed = 1"}));
  EXPECT_EQ(lines_of_start("mma_2"), lines_of_start("ipopt_2"));
  EXPECT_NE(contents_of(folder + "/compare.svg").find("profile"), std::string::npos);
  // The optimizers cannot converge within eight solves.
  EXPECT_NE(contents_of(folder + "/compare.md").find("| mma | 2/2 | 0/2 |"), std::string::npos);
  EXPECT_EQ(lines_with(contents_of(folder + "/compare.md"), ", unfinished"), 4U);
  EXPECT_TRUE(
      testing::mentions_all(ended.out, {"optimizer", "mma", "ipopt", "4 of 4", "compare.md"}));

  // The figure of merit follows from the other columns.
  const auto figure = table.numbers("figure"), verified = table.numbers("body_fitted"),
             volume = table.numbers("body_fitted_volume"),
             error = table.numbers("body_fitted_error");
  for (size_t i = 0; i < figure.size(); ++i) {
    // after eight solves a load may act on a region that is not connected to a support
    if (std::isinf(verified[i])) {
      EXPECT_EQ(figure[i], verified[i]);
      continue;
    }
    EXPECT_NEAR(figure[i], verified[i] * volume[i] / 0.4, 1e-12 * figure[i]);  // two roundings
    EXPECT_LE(error[i], 0.005);
  }
}

// Without a budget the optimizer of the case gives the design and the verdict of a normal run.
TEST(Compare, RunsTheOptimizerOfTheCaseAsARunDoes) {
  const Scratch scratch;
  const std::string compared = scratch / "compare", folder = scratch / "run";
  const Words fewer = {"--set", "optimizer.max_iterations=9"};
  Words words = {"--optimizers", "mma", "--starts", "1", "--quiet"};
  words.insert(words.end(), fewer.begin(), fewer.end());
  ASSERT_EQ(test::flexmorph(scratch, small("compare", compared, words)).code, 0);
  const Ended ended = test::flexmorph(scratch, small("run", folder, fewer));
  EXPECT_TRUE(test::is_done(ended, folder));
  EXPECT_EQ(contents_of(compared + "/mma_1/components.csv"),
            contents_of(folder + "/components.csv"));
  const auto verdict_of = [](const std::string& run) {
    return test::run_json(run)["results"][0]["verdict"];
  };
  EXPECT_EQ(verdict_of(compared + "/mma_1"), verdict_of(folder));
}

TEST(Compare, RefusesNamesThatAreUnknownOrTwice) {
  const Scratch scratch;
  const std::string folder = scratch / "none";
  for (const char* names : {"nobody", "mma,mma", "mma,nobody"}) {
    const Ended ended = test::flexmorph(scratch, small("compare", folder, {"--optimizers", names}));
    EXPECT_EQ(ended.code, 2) << names;
    EXPECT_EQ(test::lines_of(ended.err).size(), 1U) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(folder));
  }
}

// An interruption of the study interrupts the current run, which keeps its results, and prevents
// the next one.
TEST(Compare, StopsWhenInterruptedAndGoesOnLater) {
  const Scratch scratch;
  const std::string folder = scratch / "compare";
  const Words words = small("compare", folder,
                            {"--optimizers", "mma", "--starts", "2", "--budget", "1000000", "--set",
                             "optimizer.kkt_tolerance=0"});
  testing::ChildProgram study = test::start(scratch, words);
  // The study runs until it is interrupted. If it ends earlier, the test fails.
  ASSERT_TRUE(testing::eventually(study, [&] {
    return test::lines_of(contents_of(folder + "/mma_1/history.csv")).size() >= 3;
  })) << study.end().err;
  study.send(SIGTERM);
  const Ended ended = study.end();
  EXPECT_EQ(ended.code, 4) << ended.err;
  const io::CsvTable table = io::read_csv(folder + "/compare.csv");
  EXPECT_EQ(table.texts("status"), (Words{"interrupted", "missing"}));
  EXPECT_FALSE(std::filesystem::exists(folder + "/mma_2"));
}

}  // namespace
}  // namespace flexmorph::cases
