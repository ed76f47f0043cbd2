// The shipped cases with published or closed-form numbers, as they are: what they expect of
// themselves holds, and nothing is warned of: short steps of an explicit integrator are none that
// Newton's method missed.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/io/scratch.h"
#include "tests/support/child_program.h"

namespace flexmorph {
namespace {

/// Time limit of a run [s], below that of a benchmark.
constexpr double kSeconds = 590;

class PublishedCase : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Cases, PublishedCase,
                         ::testing::Values("andrews", "deploying_beam", "lee_frame",
                                           "satellite_booms", "spin_up"),
                         [](const auto& test) { return test.param; });

TEST_P(PublishedCase, EndsAsItExpects) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const std::string command = std::string(FLEXMORPH_PROGRAM) + " run " + GetParam() + " -o '" +
                              folder + "' --quiet --set output.vtk=false";
  const int code = testing::run_shell(command, "", kSeconds).code;
  ASSERT_TRUE(code == 0) << command;
  const nlohmann::json json = nlohmann::json::parse(contents_of(folder + "/run.json"));
  ASSERT_FALSE(json["expect"].empty());
  for (const auto& [name, expected] : json["expect"].items())
    EXPECT_TRUE(expected["holds"].get<bool>()) << name << ": " << expected;
  EXPECT_TRUE(json["warnings"].empty()) << json["warnings"];
}

}  // namespace
}  // namespace flexmorph
