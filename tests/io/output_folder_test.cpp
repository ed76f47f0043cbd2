// Shows that an output folder is filled by one process at a time, that no files of the user are
// changed, and that previous contents are moved and not removed.
#include "io/output_folder.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "geometry/base.h"
#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

namespace fs = std::filesystem;

std::string refusal_of(const std::string& path) {
  try {
    const OutputFolder folder(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    return error.what();
  }
  return "";
}

/// Asks for the refusal of a folder that is not empty and contains no run.
::testing::AssertionResult refused_as_foreign(const std::string& path) {
  return says(refusal_of(path), "", {"'" + path + "'", "not empty", "-o"});
}

void fill(const std::string& path, const std::string& text) {
  OutputFolder folder(path);
  std::ofstream(folder.file("run.json")) << text;
}

TEST(OutputFolder, KeepsAListOfItsFiles) {
  const Scratch scratch;
  {
    OutputFolder folder(scratch / "run/");
    EXPECT_EQ(folder.path(), scratch / "run");
    EXPECT_EQ(folder.moved_to(), "");
    std::ofstream(folder.file("design/frame_00001.vti")) << "frame";
    folder.file("design/frame_00001.vti");  // a file is listed once
    folder.file("history.csv");
  }
  const std::string list = contents_of(scratch / "run/.flexmorph");
  EXPECT_TRUE(list.starts_with("flexmorph, process " + std::to_string(getpid()))) << list;
  EXPECT_TRUE(list.ends_with("\ndesign/frame_00001.vti\nhistory.csv\n")) << list;
  EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), 3);
}

TEST(OutputFolder, MovesWhatWasThereWhole) {
  const Scratch scratch;
  fill(scratch / "run", "first");
  scratch.write("run/my_notes.txt", "mine");
  scratch.write("run/design_of_mine.svg", "mine as well");
  OutputFolder second(scratch / "run");
  EXPECT_EQ(second.moved_to(), scratch / "run.previous");
  EXPECT_EQ(contents_of(scratch / "run.previous/run.json"), "first");
  EXPECT_EQ(contents_of(scratch / "run.previous/my_notes.txt"), "mine");
  EXPECT_EQ(contents_of(scratch / "run.previous/design_of_mine.svg"), "mine as well");
  EXPECT_FALSE(fs::exists(scratch / "run/run.json"));
}

TEST(OutputFolder, RemovesNoRun) {
  const Scratch scratch;
  for (const char* text : {"first", "second", "third", "fourth"}) fill(scratch / "run", text);
  EXPECT_EQ(contents_of(scratch / "run/run.json"), "fourth");
  EXPECT_EQ(contents_of(scratch / "run.previous/run.json"), "first");
  EXPECT_EQ(contents_of(scratch / "run.previous.2/run.json"), "second");
  EXPECT_EQ(contents_of(scratch / "run.previous.3/run.json"), "third");
}

// A folder with a file run.json is not a run; an empty folder may be used.
TEST(OutputFolder, LeavesForeignFoldersAlone) {
  const Scratch scratch;
  fs::create_directories(scratch / "foreign");
  scratch.write("foreign/run.json", "{}");
  EXPECT_TRUE(refused_as_foreign(scratch / "foreign"));
  EXPECT_EQ(contents_of(scratch / "foreign/run.json"), "{}");
  EXPECT_FALSE(fs::exists(scratch / "foreign/.flexmorph"));
  fs::create_directories(scratch / "empty");
  EXPECT_EQ(refusal_of(scratch / "empty"), "");
  // A link to a list elsewhere does not make a folder a run.
  fill(scratch / "run", "");
  fs::create_directories(scratch / "linked");
  fs::create_symlink(scratch / "run/.flexmorph", scratch / "linked/.flexmorph");
  EXPECT_TRUE(refused_as_foreign(scratch / "linked"));
  scratch.write("file", "");
  EXPECT_NE(refusal_of(scratch / "file"), "");
  EXPECT_EQ(contents_of(scratch / "file"), "");
}

/// A process that fills a folder until it is killed by the destructor.
class Filler {
 public:
  explicit Filler(const std::string& folder) {
    int ready[2];
    if (pipe(ready) != 0) return;
    pid_ = fork();
    if (pid_ == 0) fill_and_wait(folder, ready[1]);
    close(ready[1]);  // so that read() ends when the child ends
    char byte = 0;
    begun_ = read(ready[0], &byte, 1) == 1;
    close(ready[0]);
  }
  ~Filler() { end(); }
  Filler(const Filler&) = delete;
  Filler& operator=(const Filler&) = delete;

  pid_t pid() const { return pid_; }
  bool begun() const { return begun_; }
  void end() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

 private:
  /// Runs in the child, which ends without GoogleTest, at the latest after a minute.
  [[noreturn]] static void fill_and_wait(const std::string& path, int ready) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    alarm(60);
    const int null = open("/dev/null", O_RDWR);
    for (int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, file);
    try {
      OutputFolder folder(path);
      std::ofstream(folder.file("run.json")) << "running";
      if (write(ready, "x", 1) == 1)
        for (;;) pause();
    } catch (...) {
    }
    _exit(1);
  }

  pid_t pid_ = -1;
  bool begun_ = false;
};

// A killed process leaves no lock.
TEST(OutputFolder, IsFilledByOneProcess) {
  const Scratch scratch;
  Filler filler(scratch / "run");
  ASSERT_TRUE(filler.begun());
  EXPECT_TRUE(is_being_filled(scratch / "run"));
  std::array<char, 256> machine{};
  gethostname(machine.data(), machine.size() - 1);
  EXPECT_TRUE(says(refusal_of(scratch / "run"), "",
                   {"'" + (scratch / "run") + "'", "process " + std::to_string(filler.pid()),
                    std::string("'") + machine.data() + "'", "-o"}));
  EXPECT_EQ(contents_of(scratch / "run/run.json"), "running");
  EXPECT_FALSE(fs::exists(scratch / "run.previous"));
  filler.end();
  EXPECT_FALSE(is_being_filled(scratch / "run"));
  EXPECT_EQ(refusal_of(scratch / "run"), "");
  EXPECT_EQ(contents_of(scratch / "run.previous/run.json"), "running");
}

// A study continues with the contents of its folder, but only one process at a time.
TEST(FolderLock, LeavesWhatIsThere) {
  const Scratch scratch;
  fs::create_directories(scratch / "study");
  {
    const FolderLock lock(scratch / "study");
    scratch.write("study/compare.csv", "rows");
    EXPECT_TRUE(is_being_filled(scratch / "study"));
    EXPECT_THROW(FolderLock(scratch / "study"), Error);
  }
  EXPECT_FALSE(is_being_filled(scratch / "study"));
  const FolderLock again(scratch / "study");
  EXPECT_EQ(contents_of(scratch / "study/compare.csv"), "rows");
}

// A study must not overwrite a compare.csv of the user, nor the files of a run.
TEST(FolderLock, LeavesFoldersThatNoStudyHasFilled) {
  const Scratch scratch;
  fs::create_directories(scratch / "mine");
  scratch.write("mine/compare.csv", "precious");
  EXPECT_THROW(FolderLock(scratch / "mine"), Error);
  EXPECT_FALSE(fs::exists(scratch / "mine/.flexmorph"));
  { OutputFolder(scratch / "run").file("run.json"); }
  const std::string list = contents_of(scratch / "run/.flexmorph");
  EXPECT_THROW(FolderLock(scratch / "run"), Error);
  EXPECT_EQ(contents_of(scratch / "run/.flexmorph"), list);

  // fractions of a study may run in it before there is a whole study
  fs::create_directories(scratch / "several");
  require_study_folder(scratch / "several");
  require_study_folder(scratch / "several");
  const FolderLock lock(scratch / "several");
}

TEST(OutputFolder, MakesNoPathThatLeavesIt) {
  const Scratch scratch;
  OutputFolder folder(scratch / "run");
  for (const std::string name : {"../precious", "loads/../../precious", "/etc/precious", "", ".",
                                 "..", ".flexmorph", "loads/", "two\nlines", "a/./b"})
    EXPECT_THROW(folder.file(name), Error) << name;
  EXPECT_THROW(folder.file(std::string(201, 'a')), Error);
  EXPECT_EQ(folder.file(std::string(200, 'a')), (scratch / "run/") + std::string(200, 'a'));
  EXPECT_EQ(contents_of(scratch / "run/.flexmorph").find("precious"), std::string::npos);
}

}  // namespace
}  // namespace flexmorph::io
