// Shows that checkpoints of motions that cannot be used are refused with the reason.
#include "cases/output/motion_checkpoint.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cases/scene/version.h"
#include "tests/cases/scenes.h"
#include "tests/io/scratch.h"
#include "tests/support/errors.h"

namespace flexmorph::cases {
namespace {

class Checkpoints : public ::testing::Test {
 protected:
  Checkpoints() : scene_(read("four_bar")), folder_(scratch_ / "run", scene_) {
    folder_.write_text("case.toml", "title = \"one\"\n");
    one().write(memory_, "", {});
  }
  MotionCheckpoint one(const std::string& about = "a design") {
    return {folder_, "motion.checkpoint", about, 1};
  }
  std::string path() const { return scratch_ / "run/motion.checkpoint"; }
  std::string text() const { return contents_of(path()); }
  void put(const std::string& text) const {
    std::ofstream(path(), std::ios::binary | std::ios::trunc) << text;
  }
  std::string refusal(const std::string& about = "a design") {
    std::string why = "?";
    EXPECT_FALSE(one(about).read(why));
    return why;
  }

  const Scratch scratch_;
  const Scene scene_;
  RunFolder folder_;
  const std::string memory_ = std::string("numbers\0 and more\n", 18);
};

TEST_F(Checkpoints, GiveBackWhatTheyKeep) {
  std::string why = "?";
  EXPECT_EQ(one().read(why), memory_);
  EXPECT_EQ(why, "");
  one().write("lat", "er", {});
  EXPECT_EQ(one().read(why), "later");
}

TEST_F(Checkpoints, MayBeMissing) {
  std::filesystem::remove(path());
  EXPECT_EQ(refusal(), "");
}

TEST_F(Checkpoints, AreRefusedWhereAnyByteIsAnother) {
  const std::string whole = text();
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    put(damaged);
    EXPECT_NE(refusal(), "") << i;
  }
}

TEST_F(Checkpoints, AreRefusedWhereTheyEndTooSoon) {
  const std::string whole = text();
  for (size_t n = 0; n < whole.size(); ++n) {
    put(whole.substr(0, n));
    EXPECT_NE(refusal(), "") << n;
  }
  put(whole.substr(0, whole.size() - 1));
  EXPECT_TRUE(contains(refusal(), "damaged"));
}

TEST_F(Checkpoints, AreThoseOfOneVersion) {
  const std::string whole = text();
  std::string other = whole;
  const size_t at = other.find(kVersion), end = other.find('\n');
  other.replace(at, end - at, "0.0.1");
  put(other);
  EXPECT_TRUE(testing::mentions_all(refusal(), {"0.0.1", kVersion}));
  put("flexmorph motion 0, " + whole.substr(whole.find(kVersion)));
  EXPECT_TRUE(contains(refusal(), "format"));
}

TEST_F(Checkpoints, AreThoseOfOneCaseAndDesign) {
  EXPECT_TRUE(contains(refusal("another design"), "another case or design"));
  folder_.write_text("inputs/turn.csv", "0, 0\n");
  EXPECT_TRUE(contains(refusal(), "another case or design"));
  one().write(memory_, "", {});
  folder_.write_text("inputs/turn.csv", "0, 1\n");
  EXPECT_TRUE(contains(refusal(), "another case or design"));
}

TEST_F(Checkpoints, NeedTheirFrames) {
  folder_.write_text("motion/a.vtu", "");
  one().write("", memory_, {"motion/a.vtu"});
  std::string why;
  EXPECT_EQ(one().read(why), memory_) << why;
  std::filesystem::remove(folder_.path() + "/motion/a.vtu");
  EXPECT_TRUE(contains(refusal(), "motion/a.vtu"));
}

}  // namespace
}  // namespace flexmorph::cases
