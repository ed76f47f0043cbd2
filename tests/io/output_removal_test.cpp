// Shows that only files which a run has written are removed: no files of the user, nothing behind
// symbolic links, nothing outside of the folder, and nothing while a process fills the folder.
#include <gtest/gtest.h>

#include <fstream>

#include "geometry/base.h"
#include "io/output_folder.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

namespace fs = std::filesystem;

void fill(const std::string& path) {
  OutputFolder folder(path);
  std::ofstream(folder.file("run.json")) << "12345678";
  std::ofstream(folder.file("design/frame.vti")) << "1234";
}

TEST(OwnedFiles, AreCountedAndRemoved) {
  const Scratch scratch;
  fill(scratch / "run");
  const OwnedFiles counted = owned_files(scratch / "run");
  EXPECT_EQ(counted.files, 2u);
  EXPECT_EQ(counted.bytes, 12);
  EXPECT_TRUE(counted.others.empty());
  EXPECT_TRUE(fs::exists(scratch / "run/design/frame.vti"));
  const OwnedFiles removed = remove_owned_files(scratch / "run");
  EXPECT_EQ(removed.files, 2u);
  EXPECT_EQ(removed.bytes, 12);
  EXPECT_FALSE(fs::exists(scratch / "run"));
}

TEST(OwnedFiles, FilesOfTheUserStay) {
  const Scratch scratch;
  fill(scratch / "run");
  scratch.write("run/notes.txt", "mine");
  scratch.write("run/design/mine.svg", "mine");
  EXPECT_EQ(remove_owned_files(scratch / "run").others.size(), 2u);
  EXPECT_EQ(contents_of(scratch / "run/notes.txt"), "mine");
  EXPECT_EQ(contents_of(scratch / "run/design/mine.svg"), "mine");
  EXPECT_FALSE(fs::exists(scratch / "run/run.json"));
  EXPECT_FALSE(fs::exists(scratch / "run/design/frame.vti"));
  EXPECT_FALSE(has_output_list(scratch / "run"));  // the rest is a folder of the user
}

TEST(OwnedFiles, LinksAreNotFollowed) {
  const Scratch scratch;
  fs::create_directories(scratch / "elsewhere");
  scratch.write("elsewhere/frame.vti", "precious");
  fill(scratch / "run");
  // A folder, and a file, of the run were replaced by links.
  fs::remove_all(scratch / "run/design");
  fs::create_directory_symlink(scratch / "elsewhere", scratch / "run/design");
  fs::remove(scratch / "run/run.json");
  fs::create_symlink(scratch / "elsewhere/frame.vti", scratch / "run/run.json");
  EXPECT_EQ(remove_owned_files(scratch / "run").files, 0u);
  EXPECT_EQ(contents_of(scratch / "elsewhere/frame.vti"), "precious");
  EXPECT_TRUE(fs::is_symlink(scratch / "run/design"));
  // A link to the folder of a run is no folder of a run.
  fill(scratch / "other");
  fs::create_directory_symlink(scratch / "other", scratch / "link");
  EXPECT_FALSE(has_output_list(scratch / "link"));
  EXPECT_THROW(remove_owned_files(scratch / "link"), Error);
  EXPECT_TRUE(fs::exists(scratch / "other/run.json"));
  // Neither does a link to a list make a folder one.
  fs::create_directories(scratch / "mine");
  scratch.write("mine/run.json", "mine");
  fs::create_symlink(scratch / "other/.flexmorph", scratch / "mine/.flexmorph");
  EXPECT_FALSE(has_output_list(scratch / "mine"));
  EXPECT_THROW(remove_owned_files(scratch / "mine"), Error);
  EXPECT_EQ(contents_of(scratch / "mine/run.json"), "mine");
}

TEST(OwnedFiles, NamesThatLeaveTheFolderAreIgnored) {
  const Scratch scratch;
  fill(scratch / "run");
  scratch.write("precious.txt", "mine");
  std::ofstream(scratch / "run/.flexmorph", std::ios::app)
      << "../precious.txt\n/etc/hostname\n.\n..\n./\n";
  remove_owned_files(scratch / "run");
  EXPECT_EQ(contents_of(scratch / "precious.txt"), "mine");
  EXPECT_FALSE(fs::exists(scratch / "run"));
}

TEST(OwnedFiles, OtherFoldersAreRefused) {
  const Scratch scratch;
  fs::create_directories(scratch / "mine");
  scratch.write("mine/run.json", "mine");
  EXPECT_FALSE(has_output_list(scratch / "mine"));
  EXPECT_THROW(owned_files(scratch / "mine"), Error);
  EXPECT_THROW(remove_owned_files(scratch / "mine"), Error);
  EXPECT_THROW(remove_owned_files(scratch / "missing"), Error);
  EXPECT_EQ(contents_of(scratch / "mine/run.json"), "mine");
}

TEST(OwnedFiles, StayWhileAProcessFillsTheFolder) {
  const Scratch scratch;
  OutputFolder folder(scratch / "run");
  std::ofstream(folder.file("run.json")) << "running";
  EXPECT_THROW(remove_owned_files(scratch / "run"), Error);
  EXPECT_EQ(contents_of(scratch / "run/run.json"), "running");
}

// A run within the folder of another run is a run of its own.
TEST(OwnedFiles, FoldersOfOtherRunsStay) {
  const Scratch scratch;
  fill(scratch / "run");
  fill(scratch / "run/inner");
  EXPECT_EQ(owned_files(scratch / "run").files, 2u);
  EXPECT_EQ(remove_owned_files(scratch / "run").others.size(), 1u);
  EXPECT_TRUE(fs::exists(scratch / "run/inner/run.json"));
  remove_owned_files(scratch / "run/inner");
  EXPECT_FALSE(fs::exists(scratch / "run/inner"));
}

}  // namespace
}  // namespace flexmorph::io
