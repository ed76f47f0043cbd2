// Shows that goals of designs (objectives, constraints and their short forms) are read as rows of
// the table of responses, and that goals without a meaning are refused with their location.

#include <gtest/gtest.h>

#include <fstream>

#include "cases/scene/design/goal.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

/// Returns the goal of short_beam with a density (2000 kg for the full plate) and without a limit
/// of the volume.
mmc::Goal goal_of(Changes changes) {
  changes.insert(changes.begin(), {"domain.density=1000.0", "design.max_volume="});
  return read("short_beam", changes).designs[0].goal;
}

std::string complaint(const Changes& changes) {
  try {
    goal_of(changes);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

TEST(Goal, ShorthandsAreRows) {
  const mmc::Goal stiff = read("short_beam").designs[0].goal;
  EXPECT_EQ(stiff.objective, &mmc::kComplianceSum);
  ASSERT_EQ(stiff.limits.size(), 1u);
  EXPECT_EQ(stiff.limits[0].row, &mmc::kVolume);
  EXPECT_EQ(stiff.limits[0].value, 0.4);
  EXPECT_FALSE(stiff.limits[0].at_least);
  EXPECT_TRUE(testing::mentions_all(goal_text(stiff), {"summed compliance", "volume", "0.4"}));

  const mmc::Goal light =
      goal_of({"design.minimize=volume", "design.loads=worst", "design.max_compliance=80.0"});
  EXPECT_EQ(light.objective, &mmc::kVolume);
  ASSERT_EQ(light.limits.size(), 1u);
  EXPECT_EQ(light.limits[0].row, &mmc::kComplianceWorst);
  EXPECT_EQ(light.limits[0].value, 80);
  EXPECT_TRUE(testing::mentions_all(goal_text(light), {"volume", "largest compliance", "80 J"}));
}

TEST(Goal, HasAnyNumberOfConstraints) {
  const mmc::Goal goal = goal_of(
      {"design.loads=worst",
       "design.constraint=[{response='mass', at_most=500.0, at_least=100.0}, "
       "{response='compliance', loads='sum', at_most=90.0}, {response='volume', at_most=0.5}]"});
  EXPECT_EQ(goal.objective, &mmc::kComplianceWorst);
  ASSERT_EQ(goal.limits.size(), 4u);
  EXPECT_EQ(goal.limits[0].row, &mmc::kMass);
  EXPECT_EQ(goal.limits[1].row, &mmc::kMass);
  EXPECT_EQ(goal.limits[1].value, 100);
  EXPECT_TRUE(goal.limits[1].at_least);
  EXPECT_EQ(goal.limits[2].row, &mmc::kComplianceSum);
  // a limit of mass is a limit of volume
  EXPECT_DOUBLE_EQ(mmc::allowed_volume(goal).value(), 0.25);
  EXPECT_TRUE(testing::mentions_all(
      limit_text(goal),
      {"mass", "500 kg", "mass", "100 kg", "summed compliance", "90 J", "volume", "0.5"}));
  EXPECT_TRUE(testing::mentions_all(goal_text(goal),
                                    {"largest compliance", "mass", "500 kg", "mass", "100 kg",
                                     "summed compliance", "90 J", "volume", "0.5"}));
}

// A limit of mass determines the start layout as the equivalent limit of volume does: the bars of
// both layouts are equally thick.
TEST(Goal, LimitOfMassMakesTheStart) {
  const Scene by_volume = read("short_beam", {"design.max_volume=0.25"});
  const Scene by_mass = read(
      "short_beam", {"domain.density=1000.0",
                     "design.max_volume=", "design.constraint=[{response='mass', at_most=500.0}]"});
  EXPECT_EQ(by_mass.designs[0].half_thickness, by_volume.designs[0].half_thickness);
}

struct Refused {
  const char* name;
  Changes changes;
  std::vector<std::string> parts;  ///< Parts of the message after its location.
};
void PrintTo(const Refused& bad, std::ostream* out) { *out << bad.name; }
class GoalRefuses : public ::testing::TestWithParam<Refused> {};
TEST_P(GoalRefuses, AndSaysWhy) {
  const std::string said = complaint(GetParam().changes);
  EXPECT_TRUE(testing::mentions_all(said, GetParam().parts,
                                    location_in(said, shipped("short_beam"), GetParam().changes)));
}
INSTANTIATE_TEST_SUITE_P(
    Table, GoalRefuses,
    ::testing::Values(
        Refused{"no_density",
                {"domain.density=", "design.constraint=[{response='mass', at_most=1.0}]"},
                {"design.constraint.response = 'mass'", "domain.density", "[kg/m^3]"}},
        Refused{"unknown",
                {"design.constraint=[{response='beauty', at_least=1.0}]"},
                {"design.constraint.response = 'beauty'", "'compliance', 'volume', 'mass'"}},
        Refused{"unnamed",
                {"design.constraint=[{at_most=0.5}]"},
                {"design.constraint.response", "missing"}},
        Refused{"no_bound",
                {"design.constraint=[{response='volume'}]"},
                {"design.constraint", "at_most", "at_least"}},
        Refused{"loads",
                {"design.constraint=[{response='volume', loads='sum', at_most=0.5}]"},
                {"design.constraint.loads = 'sum'", "compliance"}},
        Refused{"minimized",
                {"design.constraint=[{response='compliance', at_most=80.0}]"},
                {"design.constraint.response = 'compliance'", "minimized"}},
        Refused{"twice",
                {"design.max_volume=0.5", "design.constraint=[{response='volume', at_most=0.4}]"},
                {"design.constraint.response = 'volume'", "already"}},
        Refused{"lower_compliance",
                {"design.constraint=[{response='compliance', loads='worst', at_least=80.0}]"},
                {"design.constraint.at_least = 80.0", "volume", "mass"}},
        Refused{"crossed",
                {"design.constraint=[{response='volume', at_most=0.3, at_least=0.4}]"},
                {"design.constraint.at_least = 0.4", "at_most"}},
        Refused{"too_much",
                {"design.constraint=[{response='mass', at_most=2001.0}]"},
                {"design.constraint.at_most = 2001.0", "2000", "[kg]"}},
        Refused{"full",
                {"design.constraint=[{response='volume', at_least=0.4}]"},
                {"full plate", "[[design.constraint]]", "at_most", "volume"}},
        Refused{"empty",
                {"design.minimize=mass", "design.constraint=[{response='volume', at_most=0.4}]"},
                {"empty plate", "[[design.constraint]]", "at_most", "compliance", "at_least"}},
        Refused{"wrong_shorthand",
                {"design.minimize=mass", "design.max_volume=0.4", "design.max_compliance=80.0"},
                {"minimize", "compliance"}},
        Refused{"missing", {"design.minimize=mass"}, {"design.max_compliance", "missing"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Goal, ErrorsOfConstraintsAreLocated) {
  const Scratch scratch;
  const auto path = std::filesystem::path(FLEXMORPH_CASES) / "short_beam.toml";
  std::ifstream in(path);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.insert(
      text.find("[optimizer]"),
      "[[design.constraint]]\nresponse = \"compliance\"\nloads = \"worst\"\nat_most = -0.1\n\n");
  const auto line =
      std::count(text.begin(), text.begin() + static_cast<long>(text.find("-0.1")), '\n') + 1;
  std::ofstream(scratch / "constrained.toml") << text;
  try {
    read_scene(io::CaseFile(scratch / "constrained.toml"));
    ADD_FAILURE() << "is no bound";
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).rfind((scratch / "constrained.toml") + ":" +
                                              std::to_string(line) + ":11: design.constraint",
                                          0),
              0u)
        << e.what();
  }
}

}  // namespace
}  // namespace flexmorph::cases
