// Shows that keys are declared once: readers, messages and the explained case are made from the
// declaration.
#include "io/case_files/key.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "io/case_files/case_file.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

enum class Mood { calm, wild };

const Key& kTitle = key("", "title").text("a title").otherwise("none").description("What it is.");
const Key& kTime = key("", "time").table().description("When.");
const Key& kEnd =
    key("time", "end").number(positive("an end", "s")).description("The last moment.");
const Key& kStep = key("time", "step")
                       .number(positive("a step", "s"))
                       .otherwise(0.25)
                       .description("From one to the next.");
const Key& kSpin = key("time", "spin")
                       .number(positive("a spin", "s"))
                       .otherwise_as("a tenth of `end`")
                       .description("It.");
const Choice<Mood> kMood(key("time", "mood").otherwise("calm").description("How."), "a mood",
                         {{"calm", Mood::calm}, {"wild", Mood::wild}});
const Key& kBody = key("", "body").tables_of().description("Things.");
const Key& kSize = shared_key({"body", "time"}, "size")
                       .integers("a size", 1, 9, 2, 2)
                       .otherwise(std::vector<int>{1, 2})
                       .description("Along and across.");
const Key& kAngle = key("body", "angle")
                        .number(any_number("an angle"))
                        .name_of("a drive")
                        .description("Or a drive.");
const Key& kOutput =
    key("", "output").table().otherwise_as("all defaults").description("What is kept.");
const Key& kEvery =
    key("output", "every").integer("a count", 0, 9).otherwise(3).description("How often.");
const Key& kConstants = key("", "constants").table().otherwise_as("none").description("Numbers.");
const Key& kConstant =
    key("constants", "*").number(any_number("a constant")).description("Any name.");

constexpr const char* kText = R"(# a comment
[time]
end = 1

[[body]]
angle = "turn"
size = [3, 4]

[[body]]
angle = 0.5

[constants]
speed = 2
)";

class Keys : public ::testing::Test {
 protected:
  CaseFile file(const std::vector<std::string>& changes = {}, const std::string& text = kText) {
    return CaseFile(scratch_.write("case.toml", text), changes);
  }
  /// Reads all values like a reader of cases.
  static void read(const Table& root) {
    root.string(kTitle);
    const Table time = root.table(kTime);
    time.number(kStep);
    time.number(kSpin.within(0, time.number(kEnd)), 0.1 * time.number(kEnd));
    time.choice(kMood);
    for (const Table& t : root.tables(kBody)) {
      t.integers(kSize);
      if (!t.is_string(kAngle)) t.number(kAngle);
    }
    root.table_or_empty(kOutput).integer(kEvery);
    const Table constants = root.table(kConstants);
    for (const std::string& name : constants.keys()) constants.number(kConstant.named(name));
  }
  std::string error(const std::function<void(const Table&)>& read,
                    const std::vector<std::string>& changes = {}) {
    try {
      read(file(changes).root());
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
  Scratch scratch_;
};

TEST_F(Keys, ReadersTakeTheFileThenTheReaderThenTheDeclaration) {
  const CaseFile read = file();
  const Table time = read.root().table(kTime);
  EXPECT_EQ(time.number(kEnd), 1);
  EXPECT_EQ(time.number(kStep), 0.25);
  EXPECT_EQ(time.number(kStep, 0.5), 0.5);
  EXPECT_EQ(time.choice(kMood), Mood::calm);
  EXPECT_EQ(time.choice(kMood, std::optional(Mood::wild)), Mood::wild);
  EXPECT_EQ(time.integers(kSize), (std::vector<int>{1, 2}));
  const std::vector<Table> bodies = read.root().tables(kBody);
  EXPECT_EQ(bodies[0].integers(kSize), (std::vector<int>{3, 4}));
  EXPECT_EQ(bodies[0].choice(kAngle, Words{"turn"}), "turn");
  EXPECT_EQ(bodies[1].number(kAngle), 0.5);
  EXPECT_EQ(read.root().table_or_empty(kOutput).integer(kEvery), 3);
  EXPECT_EQ(read.root().table(kConstants).number(kConstant.named("speed")), 2);
}

// A value that is written in another way than the default is the default.
TEST_F(Keys, SettingsAreValuesThatDifferFromTheirDefaults) {
  const CaseFile given = file({}, R"(title = 'none'
[time]
end = 1
step = 2.5e-1
spin = 0.05
size = [1,  2]
[[body]]
angle = 0.5
size = [1, 3]
[output]
every = 4
[constants]
)");
  read(given.root());
  given.root().table(kTime).integers(kSize);
  std::vector<std::string> found;
  for (const Setting& each : given.settings()) found.push_back(each.path + " = " + each.value);
  EXPECT_EQ(found, (std::vector<std::string>{"body.size = [1, 3]", "output.every = 4"}));
  // `end` is required; the default of `spin` depends on the case.
  Words dependent;
  for (const Setting& each : given.dependent_settings())
    dependent.push_back(each.path + " = " + each.value + ": " + each.fallback);
  EXPECT_EQ(dependent, Words{"time.spin = 0.05: a tenth of `end`"});
  Words all;
  for (const Setting& each : given.values()) all.push_back(each.path + " = " + each.value);
  EXPECT_EQ(all, (Words{"title = 'none'", "time.end = 1", "time.step = 2.5e-1", "time.spin = 0.05",
                        "time.size = [1,  2]", "body.angle = 0.5", "body.size = [1, 3]",
                        "output.every = 4"}));
}

TEST_F(Keys, MessagesAreThoseOfTheDeclaration) {
  const auto time = [](const Key& key) {
    return [key](const Table& root) { root.table(kTime).number(key); };
  };
  const auto set = [&](const std::string& option, const std::function<void(const Table&)>& read,
                       const std::vector<std::string>& parts) {
    return says(error(read, {option}), "--set " + option + ": ", parts);
  };
  EXPECT_TRUE(set("time.step=-1", time(kStep), {"a step", "positive", "[s]"}));
  EXPECT_TRUE(says(error(time(kEnd), {"time.end="}),
                   scratch_ / "case.toml:", {"time.end", "missing", "an end", "positive", "[s]"}));
  EXPECT_TRUE(
      set("time.end=1", time(kEnd.within(0, 0.5)), {"an end", "0", "0.5", "0 excluded", "[s]"}));
  EXPECT_TRUE(
      set("time.end=0", time(kEnd.called("it").measured_in("min")), {"it", "positive", "[min]"}));
  // The suggestion follows the words that are allowed.
  EXPECT_TRUE(set("time.mood=wlid", [](const Table& root) { root.table(kTime).choice(kMood); },
                  {"a mood", "'calm'", "'wild'", "'wild'"}));
  EXPECT_TRUE(set("time.size=[1,2]",
                  [](const Table& root) { root.table(kTime).integers(kSize.counted(3)); },
                  {"list", "3", "a size", "whole", "1", "9"}));
}

TEST_F(Keys, AKeyIsReadWhereAndAsWhatItIsDeclared) {
  const CaseFile read = file();
  // the key belongs to [time]
  EXPECT_THROW(read.root().number(kEnd), std::logic_error);
  EXPECT_THROW(read.root().table(kTime).integer(kEnd), std::logic_error);  // the key is a number
  EXPECT_THROW(read.root().table(kTime).numbers(kEnd), std::logic_error);
}

TEST_F(Keys, TheBookKnowsThem) {
  const auto declared = [](const std::string& table, const std::string& name) {
    return std::count_if(all_keys().begin(), all_keys().end(), [&](const Key& each) {
      return each.name == name &&
             std::find(each.tables.begin(), each.tables.end(), table) != each.tables.end();
    });
  };
  EXPECT_EQ(declared("time", "end"), 1);
  EXPECT_EQ(declared("body", "size"), 1);
  EXPECT_EQ(declared("time", "size"), 1);
  EXPECT_EQ(declared("time", "angle"), 0);
  EXPECT_TRUE(kEnd.is_needed());
  EXPECT_FALSE(kSpin.is_needed());
  EXPECT_FALSE(kStep.is_needed());
  EXPECT_NE(std::string(kEnd.location.file_name()).find("key_test.cpp"), std::string::npos);
}

TEST_F(Keys, TheExplainedCaseHasAllValuesAndReadsBack) {
  const CaseFile first = file();
  read(first.root());
  const std::string text = first.explained();
  for (const char* line :
       {"title = \"none\"                  # What it is.\n", "spin = 0.1 ", "step = 0.25 ",
        "mood = \"calm\" ", "\n[output]                        # What is kept.\nevery = 3 ",
        "size = [1, 2] ", "size = [3, 4] ", "speed = 2                       # Any name.\n"})
    EXPECT_TRUE(contains(text, line)) << text;
  const CaseFile again = file({}, text);
  read(again.root());
  again.finish();
  EXPECT_EQ(again.explained(), text);
  // A value may depend on the whole case.
  again.root().table(kTime).record(kStep, 0.125);
  EXPECT_EQ(again.explained(), text) << "it is in the file by now";
  first.root().table(kTime).record(kStep, 0.125);
  EXPECT_TRUE(contains(first.explained(), "step = 0.125 "));
}

TEST_F(Keys, ValuesAsTomlSaysThem) {
  EXPECT_EQ(toml_text(true), "true");
  EXPECT_EQ(toml_text(0.1), "0.1");
  EXPECT_EQ(toml_text(std::string("a \"b\"")), "\"a \\\"b\\\"\"");
  EXPECT_EQ(toml_text(std::vector<double>{0, 1e-9}), "[0, 1e-09]");
  EXPECT_EQ(toml_text(std::vector<int>{}), "[]");
}

}  // namespace
}  // namespace flexmorph::io
