// Designs of a rod between two pins, as cases ask for them: without any support, too, the rod has
// less strain energy than uniform material in the motion of its cells; what a link needs and does
// not take is said by the key that is wrong.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

// As shipped, with reactions at its pins, the rod is a benchmark (tests/benchmark).
TEST(FloatingLink, IsStifferInItsMotion) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, "slider_crank_designed", folder,
          {"design.0.support=\"floating\"", "time.end=0.15", "optimizer.max_iterations=150",
           "cycle.max_cycles=2", "output.plots=false", "output.design_every=0"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto found = nlohmann::json::parse(contents_of(folder + "/run.json"));
  const nlohmann::json &result = found["results"][0], &motion = found["motion"];
  EXPECT_TRUE(result["connected"].get<bool>());
  EXPECT_LE(result["sharp_volume"].get<double>(), 0.5 * (1 + 1e-3));
  EXPECT_LT(motion["strain_energy_integral"].get<double>(),
            0.85 * motion["uniform_strain_energy_integral"].get<double>());
  EXPECT_TRUE(result["dynamic_amplitude"].is_null());  // a link has no tip
}

struct Wrong {
  const char *name, *scene;
  std::string change, says;
};
void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }

class WrongLink : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongLink, IsBadInput) {
  const Scratch scratch;
  const Ended ended = flexmorph(
      scratch, {"check", GetParam().scene, "--set", GetParam().change, "--set", "expect="});
  EXPECT_EQ(ended.code, 2) << ended.out;
  EXPECT_NE(ended.err.find(GetParam().says), std::string::npos) << ended.err;
}

constexpr const char* kRod = "slider_crank_designed";
INSTANTIATE_TEST_SUITE_P(
    Table, WrongLink,
    ::testing::Values(
        Wrong{"no_such_support", kRod, "design.0.support=\"moving_root\"", "pins"},
        Wrong{"rooted", "four_bar", "design.0.support=\"pins\"", "is welded at its root"},
        Wrong{"between_nodes", kRod, "joint.2.point_b=[0.026, 0.0]",
              "at a node of its design mesh"},
        Wrong{"one_pin", kRod, "joint.3.point_b=[0.025, 0.0]", "is held at 1"},
        Wrong{"in_the_void", kRod, "design.0.solid.1.disc=[0.3, 0.0, 0.01]",
              "needs solid material"},
        Wrong{"stiffness", kRod, "esl.definition=\"stiffness\"", "is a link between two pins"}),
    [](const auto& wrong) { return std::string(wrong.param.name); });

}  // namespace
}  // namespace flexmorph::test
