// Shows that every number of a case file, also in lists and in overrides, may be a text: a formula
// of the constants, or a number with a unit; that names and words stay what they are; and that a
// text which gives no number is refused with its location, the reason and the units that fit.
#include <gtest/gtest.h>

#include <numbers>

#include "io/case_files/case_file.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

const Key& kPart = key("", "part").tables_of().description("A part.");
const Key& kName = key("part", "name").text("a name").otherwise("").description("Name.");
const Key& kLength = key("part", "length").number(positive("a length", "m")).description("Length.");
const Key& kSize =
    key("part", "size").numbers(positive("a size", "m"), 2, 2).description("Length and height.");
const Key& kCorners =
    key("part", "corners").rows(any_number("a corner", "m"), 2).description("xy.");
const Key& kTurn = key("part", "turn")
                       .number(any_number("an angle", "rad"))
                       .name_of("a drive")
                       .description("Angle, or a drive.");
const Key& kPush = key("part", "push")
                       .numbers_or_names(any_number("a force", "N"), "a drive", 2, 2)
                       .description("Force.");
const Key& kCount = key("part", "count").integer("a count", 1, 99).description("Number.");
const Key& kShare = key("part", "share").number(between("a share", "", 0, 1)).description("Share.");
const Key& kStep = key("part", "step")
                       .number(positive("a step", "s"))
                       .word("a step", {"adaptive"})
                       .description("Step, or adaptive.");
const Key& kMark = key("part", "mark").text("a mark").description("A text.");

constexpr const char* kText = R"([constants]
w = "2*h"
h = "5 mm"
n = 6
L = "20*w"

[[part]]
name = "plate"
length = "L"
size = ["L", 0.1]
corners = [[0, "h"], ["-w/2", "12 mm"]]
turn = "30 deg"
push = ["turn", "2 kN"]
count = "2*n"
share = "n/12"
step = "2 ms"
mark = "2*h"

[[part]]
name = "turn"
)";

class NumberTexts : public ::testing::Test {
 protected:
  Table part(const std::vector<std::string>& changes = {}) const {
    return CaseFile(scratch_.write("case.toml", kText), changes).root().tables(kPart)[0];
  }
  /// Returns the message about a key after a change; empty if there is none.
  template <class Read>
  std::string complaint(const std::string& change, Read read) const {
    try {
      read(part({change}));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), Error::Kind::input);
      return error.what();
    }
    return "";
  }
  Scratch scratch_;
};

TEST_F(NumberTexts, AreNumbersInSiUnits) {
  const Table t = part();
  EXPECT_EQ(t.number(kLength), 0.2);
  EXPECT_EQ(t.numbers(kSize), (std::vector<double>{0.2, 0.1}));
  EXPECT_EQ(t.rows(kCorners), (std::vector<std::vector<double>>{{0, 0.005}, {-0.005, 0.012}}));
  EXPECT_FALSE(t.is_string(kTurn));
  EXPECT_DOUBLE_EQ(t.number(kTurn), std::numbers::pi / 6);
  EXPECT_EQ(t.integer(kCount), 12);
  EXPECT_EQ(t.number(kShare), 0.5);
  EXPECT_EQ(t.number(kStep), 0.002);
  EXPECT_EQ(t.string(kMark), "2*h");  // a text stays a text
  const std::vector<std::string> drives = {"turn"};
  const std::vector<NumberOrName> push = t.numbers_or_names(kPush, drives);
  EXPECT_EQ(push[0].name, "turn");
  EXPECT_EQ(push[1].number, 2000);
}

TEST_F(NumberTexts, WordsAndNamesStay) {
  EXPECT_EQ(part({"part.0.step=adaptive"}).choice(kStep), "adaptive");
  const std::vector<std::string> drives = {"turn"};
  EXPECT_EQ(part({"part.0.turn=turn"}).choice(kTurn, drives), "turn");
  // A name of a constant is a number, unless something else has this name.
  EXPECT_EQ(part({"part.0.turn=n"}).number(kTurn), 6);
  EXPECT_TRUE(part({"part.0.turn=n", "part.1.name=n"}).is_string(kTurn));
}

// The shell removes quotes.
TEST_F(NumberTexts, OverridesWorkAlike) {
  for (const char* value : {"100 mm", "\"100 mm\"", "'100 mm'", "10 cm", "10*w", "10 * (w)", "0.1",
                            "\"0.1\"", "+0.1", "1e-4 km"})
    EXPECT_DOUBLE_EQ(part({std::string("part.0.length=") + value}).number(kLength), 0.1) << value;
  EXPECT_EQ(part({"part.0.length=L"}).number(kLength), 0.2);
  EXPECT_EQ(part({"constants.h=10 mm"}).number(kLength), 0.4);
  EXPECT_EQ(part({"constants.h=0.01"}).number(kLength), 0.4);
}

TEST_F(NumberTexts, RefusalsNamePlaceValueAndUnits) {
  const auto length = [](const Table& t) { t.number(kLength); };
  const auto refused = [&](const std::string& change, const auto& read,
                           const std::vector<std::string>& parts) {
    EXPECT_TRUE(says(complaint(change, read), "--set " + change, parts)) << change;
  };
  refused("part.0.length=5 kg", length, {"positive [m]", "'kg'", "mm, cm"});
  refused("part.0.length=5 foo", length, {"'foo'", "unit", "mm, cm"});
  refused("part.0.length=wide", length, {"'wide'", "constants"});
  refused("part.0.length=2*t", length, {"time t"});
  refused("part.0.length=2 +", length, {"character"});
  refused("part.0.length=0.01 - h*2 - h", length, {"(-0.005)", "positive"});
  refused("part.0.length=-3 mm", length, {"(-0.003)", "positive"});
  refused("part.0.size=[1, \"2 deg\"]", [](const Table& t) { t.numbers(kSize); },
          {"list of 2", "'deg'", "mm"});
  refused("part.0.corners=[[1, \"2 s\"]]", [](const Table& t) { t.rows(kCorners); }, {"'s'", "mm"});
  refused("part.0.turn=30 mm", [](const Table& t) { t.number(kTurn); }, {"'mm'", "deg"});
  refused("part.0.share=30 mm", [](const Table& t) { t.number(kShare); }, {"'mm'", "formula"});
  refused("part.0.count=n/4", [](const Table& t) { t.integer(kCount); }, {"(1.5)", "whole"});
  refused("part.0.count=3 mm", [](const Table& t) { t.integer(kCount); }, {"whole"});
  const std::vector<std::string> drives = {"turn"};
  refused("part.0.turn=30 foo", [&](const Table& t) { t.choice(kTurn, drives); },
          {"'turn'", "'foo'"});
  // The other errors of the file are found without a reader.
  const CaseFile file(scratch_.write("case.toml", kText),
                      std::vector<std::string>{"part.0.size=[1, \"2 kg\"]"});
  EXPECT_TRUE(says(file.with_others("first"), "first", {"--set part.0.size", "'kg'", "mm"}));
}

TEST_F(NumberTexts, ConstantsMustNotDependOnEachOther) {
  const auto read = [](const Table& t) { t.number(kLength); };
  EXPECT_TRUE(says(complaint("constants.h=w/2", read), "", {"part.plate.length", "'"}));
  const auto constant = [&](const std::vector<std::string>& changes) -> std::string {
    const CaseFile file(scratch_.write("case.toml", kText), changes);
    return file.with_others("first");
  };
  EXPECT_TRUE(says(constant({"constants.h=w/2"}), "first", {"'w'", "'h'", "each other"}));
  EXPECT_TRUE(says(constant({"constants.h=h"}), "first", {"'h'", "itself"}));
  EXPECT_TRUE(says(constant({"constants.h=2 parrots"}), "first", {"'parrots'"}));
}

// A kept case has the texts and the constants, and gives the same numbers.
TEST_F(NumberTexts, AreKeptAsTheyAreWritten) {
  const CaseFile file(scratch_.write("case.toml", kText));
  EXPECT_EQ(file.text(), kText);
  const CaseFile changed(scratch_.write("case.toml", kText),
                         std::vector<std::string>{"part.0.length=3*L", "constants.h=1 cm"});
  const CaseFile again(scratch_.write("again.toml", changed.text()));
  EXPECT_NE(changed.text().find("length = \"3*L\""), std::string::npos);
  EXPECT_DOUBLE_EQ(again.root().tables(kPart)[0].number(kLength), 1.2);
  EXPECT_EQ(again.root().tables(kPart)[0].numbers(kSize)[0], 0.4);
}

}  // namespace
}  // namespace flexmorph::io
