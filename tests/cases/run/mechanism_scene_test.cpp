// Shows that impossible mechanisms are refused with exit code 2 and leave no folder, and that
// positions which cannot be reached end with exit code 3; messages name the cause.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

using Edit = std::pair<std::string, std::string>;  // old text (empty: append), new text

/// A four-bar mechanism with rigid links of 0.15, 0.5, 0.5 and 0.55 m (ground).
const std::string kFourBar = R"(
[time]
end = 0.5
step = 1e-3

[[drive]]
name = "turn"
formula = "pi/2 + 2*t"

[[rigid_body]]
name = "crank"
mass = 0.5
size = [0.15, 0.04]
angle = 1.5707963267948966

[[rigid_body]]
name = "coupler"
mass = 1.0
size = [0.5, 0.04]
position = [0.0, 0.15]
angle = 0.7

[[rigid_body]]
name = "rocker"
mass = 1.0
size = [0.5, 0.04]
position = [0.55, 0.0]
angle = 1.91

[[joint]]
type = "revolute"
name = "A"
point_a = [0.0, 0.0]
b = "crank"

[[joint]]
type = "revolute"
name = "B"
a = "crank"
point_a = [0.15, 0.0]
b = "coupler"

[[joint]]
type = "revolute"
name = "C"
a = "coupler"
point_a = [0.5, 0.0]
b = "rocker"
point_b = [0.5, 0.0]

[[joint]]
type = "revolute"
name = "D"
point_a = [0.55, 0.0]
b = "rocker"

[[joint]]
type = "angle_drive"
name = "motor"
b = "crank"
angle = "turn"
)";

/// Two links of 0.3 m with a hand at their end that is moved along a path.
const std::string kArm = R"(
[time]
end = 1.0

[[drive]]
name = "x"
formula = "0.5 + 0.2*t"

[[drive]]
name = "shoulder"
from = "trajectory"

[[drive]]
name = "elbow"
from = "trajectory"

[[drive]]
name = "wrist"
from = "trajectory"

[trajectory]
body = "hand"
x = "x"
y = 0.0

[[rigid_body]]
name = "upper"
mass = 1.0
size = [0.3, 0.05]
angle = 0.6

[[rigid_body]]
name = "lower"
mass = 1.0
size = [0.3, 0.05]
position = [0.25, 0.17]
angle = -0.6

[[rigid_body]]
name = "hand"
mass = 1.0
size = [0.1, 0.05]
position = [0.5, 0.0]

[[joint]]
type = "revolute"
name = "at_shoulder"
point_a = [0.0, 0.0]
b = "upper"

[[joint]]
type = "revolute"
name = "at_elbow"
a = "upper"
point_a = [0.3, 0.0]
b = "lower"

[[joint]]
type = "revolute"
name = "at_wrist"
a = "lower"
point_a = [0.3, 0.0]
b = "hand"

[[joint]]
type = "angle_drive"
b = "upper"
angle = "shoulder"

[[joint]]
type = "angle_drive"
a = "upper"
b = "lower"
angle = "elbow"

[[joint]]
type = "angle_drive"
a = "lower"
b = "hand"
angle = "wrist"
)";

std::string edited(std::string text, const std::vector<Edit>& edits) {
  for (const auto& [from, to] : edits) {
    const size_t at = from.empty() ? text.size() : text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return text;
}

std::string shipped(const std::string& name) {
  return contents_of(std::string(FLEXMORPH_CASES) + "/" + name + ".toml");
}

struct Told : Ended {
  bool left_behind = false;  ///< True if a run folder exists.
};

Told run_text(const std::string& text, const Scratch& scratch) {
  const std::string file = scratch / "scene.toml", folder = scratch / "out";
  std::ofstream(file) << text;
  Told told{flexmorph(scratch, {"run", file, "-o", folder, "--quiet"})};
  told.left_behind = fs::exists(folder);
  return told;
}

struct Bad {
  std::string name;
  std::string text;                ///< Text of the case.
  std::vector<Edit> edits;         ///< Changes that make it invalid.
  std::vector<std::string> parts;  ///< Parts of the message.
  int code = 2;
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

std::string joint(const std::string& type, const std::string& rest) {
  return "\n[[joint]]\ntype = \"" + type + "\"\n" + rest + "\n";
}

std::vector<Bad> bad_ones() {
  const std::string platform = shipped("motion_platform"), rocker = shipped("four_bar");
  const std::string plate =
      "\n[[body]]\nname = \"spare\"\nelement = \"ancf_plate\"\nterms = [\"inertia\", "
      "\"membrane\"]\n"
      "length = 0.4\nwidth = 0.1\nthickness = 0.01\ndensity = 1150.0\nyoungs_modulus = 2e9\n"
      "poisson_ratio = 0.3\nelements = [4, 1]\n";
  return {
      {"rigid_body_without_joint",
       kFourBar,
       {{"", "\n[[rigid_body]]\nname = \"lost\"\nmass = 1.0\ninertia = 1.0\n"}},
       {"rigid_body.lost.name = \"lost\"", "[[joint]]", "[[spring]]"}},
      {"plate_without_joint", rocker, {{"", plate}}, {"body.spare.name", "[[joint]]"}},
      {"joint_to_nobody",
       kFourBar,
       {{"point_a = [0.15, 0.0]\nb = \"coupler\"", "point_a = [0.15, 0.0]\nb = \"copler\""}},
       {"joint.B.b", "copler", "coupler"}},
      {"two_drives_on_one_dof",
       kFourBar,
       {{"", joint("angle_drive", "name = \"second\"\nb = \"rocker\"\nangle = 1.9")}},
       {"contradict", "drives", "'motor', 'second'"}},
      {"drives_of_different_speed",
       kFourBar,
       {{"", joint("angle_drive", "name = \"second\"\nb = \"crank\"\nangle = 1.5707963267948966")}},
       {"[joint.second]", "'second', 'motor'", "contradict", "m/s"}},
      {"drive_of_a_bar_that_follows",
       platform,
       {{"[esl]", joint("angle_drive", "name = \"turn_B\"\nb = \"B\"\nangle = 2.65") + "[esl]"}},
       {"trajectory", "drives", "'turn_B'", "'angle of the trajectory'"}},
      {"contradictory",
       kFourBar,
       {{"", joint("revolute", "name = \"off\"\npoint_a = [0.57, 0.0]\nb = \"rocker\"")}},
       {"[joint.off]", "'off', 'D'", "contradict", "0.02 m"}},
      {"bar_too_short",
       platform,
       {{"to = \"C\"\npoint = [-0.05, 0.0]", "to = \"C\"\npoint = [-0.4, 0.0]"}},
       {"body.bar1.flow.min_length = 0.03", "0.0031 m"}},
      {"mass_of_nothing", kFourBar, {{"mass = 0.5", "mass = 0.0"}}, {"crank.mass = 0", "positive"}},
      {"negative_mass",
       kFourBar,
       {{"mass = 0.5", "mass = -0.5"}},
       {"crank.mass = -0.5", "positive"}},
      {"drive_from_a_path_for_nothing",
       platform,
       {{"[[rigid_body]]", "[[drive]]\nname = \"spare\"\nfrom = \"trajectory\"\n\n[[rigid_body]]"}},
       {"trajectory", "drive 'spare'", "flow", "distance"}},
      {"path_that_nothing_follows",
       kFourBar,
       {{"", "\n[trajectory]\nbody = \"rocker\"\nx = 0.55\ny = 0.0\n"}},
       {"trajectory", "from = \"trajectory\""}},
      {"length_starts_elsewhere",
       rocker,
       {{"element = \"ancf_plate\"", "element = \"ale_ancf_plate\""},
        {"elements = [8, 2]",
         "elements = [8, 2]\n\n[body.flow]\nlength = \"grow\"\nmax_length = 0.1\n"},
        {"[[rigid_body]]", "[[drive]]\nname = \"grow\"\nformula = \"0.5 + t\"\n\n[[rigid_body]]"}},
       {"length", "starts at 0.5", "0.4"}},
      {"drive_of_no_name",
       kFourBar,
       {{"angle = \"turn\"", "angle = \"trun\""}},
       {"joint.motor.angle", "trun", "turn"}},
      {"length_of_no_name",
       platform,
       {{"length = \"L1\"", "length = \"L7\""}},
       {"body.bar1.flow.length", "L7", "L1"}},
      {"spring_to_nobody",
       kFourBar,
       {{"", "\n[[spring]]\nb = \"mount\"\nstiffness = 100.0\n"}},
       {"spring", "mount", "crank"}},
      {"plate_in_space",
       rocker,
       {{"space = \"plane\"", "space = \"space\""}},
       {"body.space = \"space\"", "plane"}},
      {"spin_up_of_a_hub",
       kFourBar,
       {{"step = 1e-3", "step = 1e-3\nstart = \"hub_at_rest\""}},
       {"time.start", "drives"}},
      {"free_line_in_a_hub",
       rocker,
       {{"", plate +
                 "\n[[body.line]]\nindex = 2\nfree = true\n\n[[hub]]\nname = \"hub\"\n"
                 "angular_velocity = 0.0\n" +
                 joint("weld", "body = \"spare\"\nedge = \"line 2\"\nto = \"hub\"")}},
       {"edge = \"line 2\"", "rigid body"}},
      {"dofs_not_at_rest",
       shipped("telescopic_crane"),
       {{"position = [0.764, -0.064]", "position = [0.51, 0.077]\nangle = -1.0"},
        {"[time]\n", "[time]\nstart = \"prestretched\"\n"}},
       {"time.start = \"prestretched\"", "m/s²", "start = \"rigid\""}},
      // The path passes the largest reach of 0.6 m at 0.5 s.
      {"path_out_of_reach", kArm, {}, {"trajectory", "t = 0.49999", " s", "'at_elbow'"}, 3},
      {"path_never_in_reach",
       kArm,
       {{"0.5 + 0.2*t", "5 + 0.2*t"}},
       {"trajectory", "t = 0 s", "'"},
       3},
  };
}

class BadMechanism : public ::testing::TestWithParam<Bad> {};

TEST_P(BadMechanism, IsRefusedWithWords) {
  const Bad& bad = GetParam();
  const Scratch scratch;
  const Told told = run_text(edited(bad.text, bad.edits), scratch);
  EXPECT_EQ(told.code, bad.code) << told.out << told.err;
  EXPECT_FALSE(told.left_behind);
  EXPECT_TRUE(testing::mentions_all(told.err, bad.parts));
}
INSTANTIATE_TEST_SUITE_P(Cases, BadMechanism, ::testing::ValuesIn(bad_ones()),
                         [](const auto& test) { return test.param.name; });

/// The rocker is driven; it cannot move beyond the position where crank and coupler are in line.
const std::vector<Edit> kDeadCentre = {{"b = \"crank\"\nangle", "b = \"rocker\"\nangle"},
                                       {"pi/2 + 2*t", "1.911 - 0.5*t"}};
/// Time at which the outer pins of crank and coupler are 0.65 m apart, by the cosine rule.
const double kDeadTime =
    (1.911 -
     (std::numbers::pi - std::acos((0.55 * 0.55 + 0.25 - 0.65 * 0.65) / (2 * 0.55 * 0.5)))) /
    0.5;

double time_in(const std::string& message) {
  const size_t at = message.find("t = ");
  return at == std::string::npos ? -1 : std::stod(message.substr(at + 4));
}

TEST(DeadCentre, IsFoundBeforeTheRunStarts) {
  const Scratch scratch;
  const Told told = run_text(edited(kFourBar, kDeadCentre), scratch);
  EXPECT_EQ(told.code, 3) << told.err;
  EXPECT_FALSE(told.left_behind);
  EXPECT_TRUE(testing::mentions_all(told.err, {"[joint.motor]", "singular", "'motor'"}));
  EXPECT_NEAR(time_in(told.err), kDeadTime, 1e-6);
}

/// A pendulum without a drive: positions of mechanisms with free motions are not checked before.
const std::string kPendulum =
    "\n[[rigid_body]]\nname = \"bob\"\nmass = 0.1\ninertia = 0.001\nposition = [0.25, 0.3]\n" +
    joint("revolute",
          "name = \"hook\"\na = \"coupler\"\npoint_a = [0.25, 0.0]\nb = \"bob\"\n"
          "point_b = [0.0, 0.1]");

TEST(DeadCentre, EndsARunWithTimeAndJoints) {
  const Scratch scratch;
  std::vector<Edit> edits = kDeadCentre;
  edits.push_back({"step = 1e-3", "step = 1e-3\nstart = \"rigid\""});
  edits.push_back({"", kPendulum});
  const Told told = run_text(edited(kFourBar, edits), scratch);
  EXPECT_EQ(told.code, 3) << told.err;
  EXPECT_TRUE(testing::mentions_all(told.err, {"condition number", "'motor'"}));
  EXPECT_NEAR(time_in(told.err), kDeadTime, 2e-3);
  const auto time = io::read_csv(scratch / "out/motion.csv").numbers("time");
  EXPECT_NEAR(time.back(), kDeadTime, 2e-3);
}

/// A parallelogram is singular at its change point, which is passed within 5e-7 rad at step 50.
TEST(NearlySingular, WarnsWithTimeAndJoints) {
  const Scratch scratch;
  const Told told = run_text(
      edited(kFourBar, {{"step = 1e-3", "step = 1e-3\nstart = \"rigid\""},
                        {"end = 0.5", "end = 0.05"},
                        {"pi/2 + 2*t", "3.1415921535897932 - 2*(0.05 - t)"},
                        {"angle = 1.5707963267948966", "angle = 3.0415921"},
                        {"position = [0.0, 0.15]\nangle = 0.7", "position = [-0.149, 0.015]"},
                        {"angle = 1.91", "angle = 3.0415921"},
                        {"point_b = [0.5, 0.0]", "point_b = [0.15, 0.0]"},
                        {"position = [0.55, 0.0]", "position = [0.5, 0.0]"},
                        {"point_a = [0.55, 0.0]", "point_a = [0.5, 0.0]"},
                        {"", kPendulum}}),
      scratch);
  ASSERT_EQ(told.code, 0) << told.err;
  const json written = run_json(scratch / "out");
  ASSERT_EQ(written["warnings"].size(), 1u);
  const std::string warning = written["warnings"][0];
  EXPECT_NEAR(time_in(warning), 0.05, 1e-12);
  // All pins lie on one line, along which the forces in the links are undetermined.
  EXPECT_TRUE(testing::mentions_all(warning, {"condition number", "'A'", "'B'", "'C'", "'D'"}));
}

TEST(GoodMechanism, RunsWithoutWarnings) {
  const Scratch scratch;
  const Told told = run_text(kFourBar, scratch);
  ASSERT_EQ(told.code, 0) << told.err;
  EXPECT_TRUE(run_json(scratch / "out")["warnings"].empty());
}

}  // namespace
}  // namespace flexmorph::test
