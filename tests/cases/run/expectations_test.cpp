// Shows that missed expectations ([expect]) of a case are reported on the screen, in the files, and
// by the exit code.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

TEST(Expectations, ThatAreMissedAreSaid) {
  const Scratch scratch;
  const std::string text = contents_of(FLEXMORPH_SHORT_CASE);
  const std::string file =
      scratch.write("short.toml", text +
                                      "\n[expect]\nvolume = { at_most = 0.1 }\n"
                                      "\"plate.tip_deflection.largest\" = { at_most = 1 }\n");
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(scratch, {"run", file, "-o", folder, "--set", "output.vtk=false"});
  EXPECT_EQ(ended.code, 5);
  const Words told = lines_of(ended.err);
  EXPECT_EQ(std::count_if(told.begin(), told.end(),
                          [](const std::string& line) {
                            return static_cast<bool>(testing::mentions_all(
                                line, {"expect", "volume = 0.", "0.1"}, "flexmorph: "));
                          }),
            1)
      << ended.err;
  EXPECT_EQ(ended.err.find("tip_deflection"), std::string::npos) << ended.err;
  ASSERT_FALSE(ended.out.empty());
  EXPECT_TRUE(testing::mentions_all(lines_of(ended.out).back(),
                                    {"mass 0.6", " warnings", "1 expectation"},
                                    "done, not usable: "));
  const std::string report = contents_of(folder + "/report.html");
  EXPECT_NE(report.find("<td>NOT MET</td>"), std::string::npos);
  EXPECT_LT(report.find("<td>NOT MET</td>"), report.find("<td>met</td>"));
  const json run = run_json(folder);
  EXPECT_EQ(run["status"], "done, not usable");
  EXPECT_FALSE(run["expect"]["volume"]["holds"].get<bool>());
  EXPECT_TRUE(run["expect"]["plate.tip_deflection.largest"]["holds"].get<bool>());
}

// With changes the case is another one: missed expectations are reported, but they are not a
// failure.
TEST(Expectations, OfAChangedCaseAreSaid) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(
      scratch, {"run", "beam_heated_static", "-o", folder, "--set", "body.youngs_modulus=1e9"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.err, {"--set: "}, "flexmorph: "));
  EXPECT_NE(ended.out.find("done: "), std::string::npos) << ended.out;
}

TEST(Expectations, OfNumbersThatNoRunHasAreRefused) {
  const Scratch scratch;
  const std::string text = contents_of(FLEXMORPH_SHORT_CASE) + "\n[expect]\n";
  const auto lines = static_cast<long>(std::count(text.begin(), text.end(), '\n'));
  const std::string file = scratch.write("short.toml", text + "volumes = { at_most = 1 }\n");
  const Ended ended = flexmorph(scratch, {"run", file, "-o", scratch / "out"});
  EXPECT_EQ(ended.code, 2);
  for (const std::string& word :
       {"short.toml:" + std::to_string(lines + 1), std::string("expect.\"volumes\""),
        std::string("compliance_ratio"), std::string("plate.tip_deflection")})
    EXPECT_NE(ended.err.find(word), std::string::npos) << word << ": " << ended.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
}

}  // namespace
}  // namespace flexmorph::test
