// Shows that the command `new` writes cases that can be checked and run without an edit, and that
// it overwrites nothing.
#include "cases/check/templates.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "cases/check/ready.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

class Templates : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kinds, Templates, ::testing::ValuesIn(cases::template_kinds()),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Every kind has a design, which is what the program is for. Each key has a comment where it
// appears first.
TEST_P(Templates, AreReadAndCommented) {
  const std::string path = cases::find_template(GetParam());
  const cases::ReadyCase ready = cases::ready_case(path, {});
  EXPECT_FALSE(ready.prepared.scene().designs.empty());
  EXPECT_TRUE(ready.prepared.scene().expect.empty());
  EXPECT_NE(cases::title_of_case(path), path);
  size_t lines = 0, comments = 0;
  for (const std::string& line : lines_of(contents_of(path))) {
    EXPECT_LE(line.size(), 100u) << line;
    lines += line.empty() ? 0 : 1;
    comments += line.find('#') == std::string::npos ? 0 : 1;
  }
  EXPECT_LT(lines, 150u);
  EXPECT_GT(3 * comments, lines);
}

TEST(TemplateKinds, AreListedByHelp) {
  const Words kinds = cases::template_kinds();
  for (const char* kind : {"arm", "boom", "bracket", "crane", "crank", "four-bar"})
    EXPECT_EQ(std::count(kinds.begin(), kinds.end(), kind), 1) << kind;
  const Scratch scratch;
  EXPECT_TRUE(testing::mentions_all(flexmorph(scratch, {"new", "--help"}).out, kinds));
}

/// Runs the program in the scratch folder.
Ended in_folder(const Scratch& scratch, const std::string& arguments, double seconds = 60) {
  return testing::run_shell(
      "cd '" + (scratch / "") + "' && '" + FLEXMORPH_PROGRAM + "' " + arguments, scratch / "",
      seconds);
}

TEST(New, WritesTheTemplateBelowAComment) {
  const Scratch scratch;
  const Ended ended = in_folder(scratch, "new my-arm_2 --kind arm");
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(testing::mentions_all(ended.out, {"my-arm_2.toml", "flexmorph check", "run"}));
  const std::string text = contents_of(scratch / "my-arm_2.toml");
  EXPECT_TRUE(ends(text, contents_of(cases::find_template("arm"))));
  EXPECT_EQ(text[0], '#');
  EXPECT_EQ(in_folder(scratch, "check my-arm_2.toml").code, 0);
  // The ending may be typed, too.
  EXPECT_EQ(in_folder(scratch, "new other.toml --kind arm").code, 0);
  EXPECT_TRUE(fs::exists(scratch / "other.toml"));
}

TEST(New, OverwritesNothing) {
  const Scratch scratch;
  scratch.write("mine.toml", "title = \"mine\"\n");
  fs::create_symlink(scratch / "missing.toml", scratch / "link.toml");
  for (const char* name : {"mine", "link"}) {
    const Ended ended = in_folder(scratch, std::string("new ").append(name).append(" --kind boom"));
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(testing::mentions_all(ended.err, {std::string(name) + ".toml", "exists"}));
  }
  EXPECT_EQ(contents_of(scratch / "mine.toml"), "title = \"mine\"\n");
  EXPECT_FALSE(fs::exists(scratch / "missing.toml"));
}

TEST(New, RefusesOtherNamesAndKinds) {
  const Scratch scratch;
  for (const char* name : {"''", "../mine", "a/b", "'a b'", "-mine", "_mine", "four_bar", "ä",
                           "'a\nb'", ".toml", "a.csv"}) {
    const Ended ended = in_folder(scratch, std::string("new ").append(name).append(" --kind arm"));
    EXPECT_EQ(ended.code, 2) << name;
  }
  EXPECT_EQ(in_folder(scratch, "new mine").code, 2);
  const Ended ended = in_folder(scratch, "new mine --kind cran");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(testing::mentions_all(ended.err, {"'cran'", "'crane'", "four-bar"}));
  for (const auto& entry : fs::directory_iterator(scratch / ""))
    EXPECT_NE(entry.path().extension(), ".toml") << entry.path();
}

class TemplateRuns : public Templates {};
INSTANTIATE_TEST_SUITE_P(LongKinds, TemplateRuns, ::testing::ValuesIn(cases::template_kinds()),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// `new`, `check` and `run` of each kind, without an edit.
TEST_P(TemplateRuns, EndWithAUsableDesign) {
  const Scratch scratch;
  ASSERT_EQ(in_folder(scratch, "new mine --kind " + GetParam()).code, 0);
  ASSERT_EQ(in_folder(scratch, "check mine.toml").code, 0);
  const Ended ended = in_folder(scratch, "run mine.toml", 280);
  EXPECT_EQ(ended.code, 0) << ended.err;
  const json run = run_json(scratch / "runs/mine");
  EXPECT_EQ(run.at("status"), "done");
  for (const json& result : run.at("results")) {
    EXPECT_TRUE(result.at("connected").get<bool>());
    EXPECT_LT(result.at("crisp_compliance").get<double>(),
              0.95 * result.at("uniform_compliance").get<double>());
  }
  RecordProperty("seconds_wall", run.at("seconds_wall").dump());
}

}  // namespace
}  // namespace flexmorph::test
