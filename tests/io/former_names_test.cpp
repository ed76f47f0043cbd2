// Shows that keys and words of the last version are read with a warning, in files and in overrides,
// and that words which other programs use are answered.
#include <gtest/gtest.h>

#include "io/case_files/case_file.h"
#include "io/case_files/other_terms.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

const Key& kLamp = key("", "lamp").tables_of().description("Lamps of the test.");
const Key& kHeight = key("lamp", "height")
                         .formerly("altitude")
                         .number(positive("a height", "m"))
                         .description("Height of a lamp.");
const Key& kColour = key("lamp", "colour")
                         .renames({{"vermilion", "red"}})
                         .word("a colour", {"red", "green"})
                         .description("Colour of a lamp.");
const Key& kLimits =
    key("", "limits").table().otherwise_as("none").description("Limits of the test.");
const Key& kLimit = key("limits", "*")
                        .renames({{"glow", "brightness"}})
                        .number(any_number("a limit"))
                        .description("A limit of this name.");

class FormerNames : public ::testing::Test {
 protected:
  CaseFile file(const std::string& text, const std::vector<std::string>& changes = {}) {
    return CaseFile(scratch_.write("lamps.toml", text), changes);
  }
  /// Expects one warning that contains all of the parts.
  static void expect_warning(const CaseFile& read, const std::vector<std::string>& parts) {
    ASSERT_EQ(read.former_names().size(), 1U);
    for (const std::string& part : parts)
      EXPECT_NE(read.former_names()[0].find(part), std::string::npos) << read.former_names()[0];
  }
  Scratch scratch_;
};

TEST_F(FormerNames, OfKeysAreReadWithAWarning) {
  const CaseFile read = file("[[lamp]]\naltitude = 3.5\ncolour = \"green\"\n");
  EXPECT_EQ(read.root().tables(kLamp)[0].number(kHeight), 3.5);
  expect_warning(read, {"lamps.toml:2:", "lamp.altitude = 3.5", "height"});
  EXPECT_TRUE(read.gives("lamp.height"));
}

TEST_F(FormerNames, OfWordsAndOfFreeNamesAreReadWithAWarning) {
  const CaseFile read = file("[[lamp]]\nheight = 1\ncolour = \"vermilion\"\n");
  EXPECT_EQ(read.root().tables(kLamp)[0].choice(kColour), "red");
  expect_warning(read, {"lamps.toml:3:", "'vermilion'", "'red'"});
  const CaseFile limits = file("[limits]\nglow = 4\n");
  EXPECT_EQ(limits.root().table(kLimits).number(kLimit.named("brightness")), 4);
  expect_warning(limits, {"lamps.toml:2:", "limits.glow", "brightness"});
}

TEST_F(FormerNames, OfOverridesReplaceTheValueOfTheFile) {
  const CaseFile read = file("[[lamp]]\nheight = 1\n", {"lamp.altitude=2"});
  EXPECT_EQ(read.root().tables(kLamp)[0].number(kHeight), 2);
  expect_warning(read, {"--set lamp.altitude=2", "height"});
}

TEST_F(FormerNames, BesideThePresentNameAreUnknownKeys) {
  const CaseFile read = file("[[lamp]]\nheight = 1\naltitude = 2\ncolour = \"red\"\n");
  const Table lamp = read.root().tables(kLamp)[0];
  EXPECT_EQ(lamp.number(kHeight), 1);
  EXPECT_EQ(lamp.choice(kColour), "red");
  EXPECT_THROW(read.finish(), Error);
}

TEST_F(FormerNames, PresentNamesGiveNoWarning) {
  EXPECT_TRUE(file("[[lamp]]\nheight = 1\ncolour = \"red\"\n").former_names().empty());
}

TEST(OtherTerms, AreAnsweredByTheWordsOfCaseFiles) {
  const std::vector<std::string> joints = {"weld", "slider", "revolute", "clamp"};
  EXPECT_EQ(word_for_term("prismatic", joints), "slider");
  EXPECT_EQ(word_for_term("fixed", joints), "weld");
  EXPECT_EQ(word_for_term("hinge", joints), "revolute");
  EXPECT_EQ(word_for_term("sliding", joints), "");
  const std::vector<std::string> others = {"clamp", "pin"};
  EXPECT_EQ(word_for_term("fixed", others), "clamp");
  EXPECT_EQ(word_for_term("prismatic", others), "");
  for (const char* key : {"friction", "material", "angle_deg"}) EXPECT_NE(answer_to_key(key), "");
  EXPECT_EQ(answer_to_key("thickness"), "");
}

}  // namespace
}  // namespace flexmorph::io
