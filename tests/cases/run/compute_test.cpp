// Shows that a case that is computed in memory has the numbers of a run of the program, writes no
// file, keeps what came before a failure or an interruption, and knows parts that were registered.
#include "cases/run/compute.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "cases/scene/spring.h"
#include "io/case_files/key.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

using test::json;

Changes after_set(const Changes& changes) {
  Changes out;
  for (const std::string& each : changes) out.insert(out.end(), {"--set", each});
  return out;
}

TEST(Compute, HasTheMotionOfARun) {
  const Scratch scratch;
  const Changes changes{"time.end=0.05"};
  const test::Ended ended = test::run(scratch, "deploying_beam", scratch / "run", changes);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const RunResult result = compute(load_case("deploying_beam", changes));
  EXPECT_EQ(result.info.status, "done");
  ASSERT_TRUE(result.motions.motion);
  const Series& found = result.motions.motion->table;
  const io::CsvTable table = io::read_csv(scratch / "run/motion.csv");
  ASSERT_EQ(table.columns.size(), found.columns.size());
  ASSERT_GT(found.n_rows(), 10u);
  for (size_t c = 0; c < found.columns.size(); ++c)
    EXPECT_EQ(table.numbers(found.columns[c].name), found.values[c]) << found.columns[c].name;
}

TEST(Compute, HasTheDesignOfARun) {
  const Scratch scratch;
  const Changes changes{"design.cell=0.1", "design.min_feature=0", "optimizer.max_iterations=5"};
  Changes words{"run", "short_beam", "-o", scratch / "run"};
  for (const std::string& each : after_set(changes)) words.push_back(each);
  ASSERT_TRUE(test::is_done(test::flexmorph(scratch, words), scratch / "run"));
  std::vector<int> iterations;
  ComputeSettings settings;
  settings.iteration = [&](const mmc::IterationReport& r) { iterations.push_back(r.iteration); };
  const RunResult result = compute(load_case("short_beam", changes), settings);
  EXPECT_EQ(iterations, (std::vector<int>{1, 2, 3, 4, 5}));
  const json run = test::run_json(scratch / "run");
  ASSERT_EQ(result.design.outcomes.size(), 1u);
  const mmc::BodyOutcome& found = result.design.outcomes[0];
  EXPECT_EQ(run["results"][0]["compliance"].get<double>(), found.compliance);
  EXPECT_EQ(run["results"][0]["crisp_compliance"].get<double>(), found.crisp.compliance);
  EXPECT_EQ(run["status"], result.info.status);
  EXPECT_EQ(run["warnings"].size(), result.warnings.size());
}

/// Sets the current folder of the process during the lifetime of an object.
class CurrentFolder {
 public:
  explicit CurrentFolder(const std::string& folder) { std::filesystem::current_path(folder); }
  ~CurrentFolder() { std::filesystem::current_path(before_); }
  CurrentFolder(const CurrentFolder&) = delete;
  CurrentFolder& operator=(const CurrentFolder&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

TEST(Compute, WritesNoFile) {
  const Scratch scratch;
  const CurrentFolder here(scratch / "");
  const PreparedCase plate = load_case(
      FLEXMORPH_SHORT_CASE, Changes{"optimizer.max_iterations=2", "verify=", "time.end=0.1"});
  std::vector<std::string> said;
  ComputeSettings settings;
  settings.say = [&](const std::string& words) { said.push_back(words); };
  const RunResult result = compute(plate, settings);
  EXPECT_EQ(result.design.outcomes.size(), 1u);
  ASSERT_TRUE(result.motions.motion && result.motions.uniform);
  EXPECT_FALSE(said.empty());
  EXPECT_TRUE(std::filesystem::is_empty(scratch / ""));
}

TEST(Compute, KeepsWhatCameBeforeAnInterruption) {
  const PreparedCase beam = load_case("deploying_beam", Changes{"time.end=0.05"});
  int asked = 0;
  ComputeSettings settings;
  settings.keep_running = [&] { return ++asked < 8; };
  EXPECT_THROW(compute(beam, settings), Interrupted);
  asked = 0;
  const EndedRun ended = compute_as_far_as_possible(beam, settings);
  EXPECT_TRUE(ended.error);
  EXPECT_EQ(ended.result.info.status, "interrupted");
  ASSERT_TRUE(ended.result.motions.motion);
  EXPECT_EQ(ended.result.motions.motion->table.n_rows(), 9u);  // the start and eight steps
}

TEST(Compute, KeepsWhatCameBeforeAFailure) {
  const PreparedCase path = load_case("beam_heated_held", Changes{"static.max_steps=5", "expect="});
  const EndedRun ended = compute_as_far_as_possible(path);
  EXPECT_TRUE(ended.error);
  EXPECT_EQ(ended.result.info.status, "failed");
  EXPECT_FALSE(ended.result.info.message.empty());
  ASSERT_TRUE(ended.result.failure);
  EXPECT_EQ(ended.result.failure->phase, "statics");
  ASSERT_TRUE(ended.result.path);
  EXPECT_EQ(ended.result.path->table.n_rows(), 6u);  // the start and five steps
  EXPECT_THROW(compute(path), Error);
}

const io::Key& own_stiffness() {
  static const io::Key& key = io::key("spring", "half_stiffness")
                                  .number(io::positive("a stiffness", "N/m"))
                                  .when("double")
                                  .description("The spring is twice as stiff.");
  return key;
}

void read_double(const io::Table& t, Spring& spring) {
  spring.stiffness = 2 * t.number(own_stiffness());
}

std::unique_ptr<fem::ForceElement> make_double(const Spring& s, const fem::MarkerLocation& a,
                                               const fem::MarkerLocation& b, double) {
  return fem::make_spring(s.name, a, b, {.stiffness = s.stiffness});
}

const SpringRow kDouble{.name = "double",
                        .sentence = "A spring that is twice as stiff as it says.",
                        .points = true,
                        .axes = false,
                        .read = read_double,
                        .make = make_double};

// A ball of 2 kg on a spring of a type that the test registers under its own name moves as a ball
// on a shipped spring of twice the stiffness.
TEST(Compute, ReadsARegisteredSpring) {
  if (find_spring("double") == nullptr) register_spring(kDouble);
  EXPECT_THROW(register_spring(kDouble), Error);
  const SpringRow nothing{"nothing", "It has no functions.", true, false, nullptr, nullptr};
  EXPECT_THROW(register_spring(nothing), Error);
  const Scratch scratch;
  const auto positions = [&](const std::string& spring) {
    const std::string path = scratch.write("case.toml", R"toml(
[time]
start = "rigid"
step = 1e-2
end = 0.5
[[rigid_body]]
name = "ball"
mass = 2.0
inertia = 0.3
position = [0.2, 0.0]
velocity = [0.0, 0.0]
angular_velocity = 0.0
[[spring]]
a = "ball"
point_b = [0.0, 0.0]
)toml" + spring);
    return compute(load_case(path)).motions.motion->table.at("ball.x");
  };
  const std::vector<double> found = positions("type = \"double\"\nhalf_stiffness = 50.0\n");
  EXPECT_EQ(found, positions("stiffness = 100.0\n"));
  // The relative error of the period, (ω h)²/12, shifts the end by 3e-4 m.
  EXPECT_NEAR(found.back(), 0.2 * std::cos(std::sqrt(50) * 0.5), 1e-3);
}

}  // namespace
}  // namespace flexmorph::cases
