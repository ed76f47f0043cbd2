// Shows that shipped cases with published or closed-form numbers, unchanged except for one cycle of
// each design, satisfy their table [expect]. Cases without a design must give no warnings.

#include <gtest/gtest.h>

#include <string>

#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

namespace flexmorph::test {
namespace {

/// Time limit of a run [s], below that of a benchmark.
constexpr double kSeconds = 590;

class PublishedCase : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Cases, PublishedCase,
                         ::testing::Values("andrews", "deploying_beam", "lee_frame",
                                           "satellite_booms", "spin_up", "free_beam_heated",
                                           "slider_crank_heated", "beam_heated_static",
                                           "beam_heated_held", "clamped_expansion", "heated_boom",
                                           "heated_boom_held"),
                         [](const auto& test) { return test.param; });

TEST_P(PublishedCase, EndsAsItExpects) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const bool designed = GetParam().starts_with("heated_boom");
  Words words = {"run", GetParam(), "-o", folder, "--quiet", "--set", "output.vtk=false"};
  if (designed) words.insert(words.end(), {"--set", "cycle.max_cycles=1"});
  const Ended ended = start(scratch, words).end(kSeconds);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json written = run_json(folder);
  ASSERT_FALSE(written["expect"].empty());
  for (const auto& [name, expected] : written["expect"].items())
    EXPECT_TRUE(expected["holds"].get<bool>()) << name << ": " << expected;
  if (!designed) {
    EXPECT_TRUE(written["warnings"].empty()) << written["warnings"];
  }
}

}  // namespace
}  // namespace flexmorph::test
