// The shipped cases with heat, as they are, but for one cycle of each design: what they expect of
// themselves holds.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/io/scratch.h"
#include "tests/support/child_program.h"

namespace flexmorph {
namespace {

/// Time limit of a run [s], below that of a benchmark.
constexpr double kSeconds = 590;

class HeatedCase : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Cases, HeatedCase,
                         ::testing::Values("free_beam_heated", "slider_crank_heated",
                                           "beam_heated_static", "beam_heated_held",
                                           "clamped_expansion", "heated_boom", "heated_boom_held"),
                         [](const auto& test) { return test.param; });

TEST_P(HeatedCase, EndsAsItExpects) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const std::string one_cycle = " --set cycle.max_cycles=1";
  const std::string command = std::string(FLEXMORPH_PROGRAM) + " run " + GetParam() + " -o '" +
                              folder + "' --quiet --set output.vtk=false" +
                              (GetParam().starts_with("heated_boom") ? one_cycle : "");
  const int code = testing::run_shell(command, "", kSeconds).code;
  ASSERT_TRUE(code == 0) << command;
  const nlohmann::json json = nlohmann::json::parse(contents_of(folder + "/run.json"));
  ASSERT_FALSE(json["expect"].empty());
  for (const auto& [name, expected] : json["expect"].items())
    EXPECT_TRUE(expected["holds"].get<bool>()) << name << ": " << expected;
}

}  // namespace
}  // namespace flexmorph
