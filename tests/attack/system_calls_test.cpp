// Shows that no system call of a run (watched by strace) changes files outside of the run folder,
// and that files of a user in this folder are preserved byte for byte.
//
//   FLEXMORPH_WATCHED=all build/tests/attack/attack_tests --gtest_filter='SystemCalls.*'
//   all shipped cases, shortened, and studies; or the name of one; by default four commands
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "cases/check/ready.h"
#include "geometry/sanitizers.h"
#include "tests/attack/run_files.h"
#include "tests/io/scratch.h"
#include "tests/support/child_program.h"

namespace flexmorph {
namespace {

namespace fs = std::filesystem;
using testing::ChildEnd;
using testing::ChildProgram;
using Words = std::vector<std::string>;

const char* const kCalls =
    "trace=open,openat,openat2,creat,rename,renameat,renameat2,unlink,unlinkat,mkdir,mkdirat,rmdir,"
    "truncate,ftruncate,link,linkat,symlink,symlinkat,chmod,fchmod,fchmodat,chown,fchown,lchown,"
    "fchownat,utimensat,utime,utimes,futimesat,mknod,mknodat,setxattr,lsetxattr,fsetxattr,"
    "removexattr,lremovexattr,fremovexattr,fallocate,mount,umount2,chroot,swapon";

/// Returns whether a file may be changed although it is not in the run folder. Ipopt of Debian 13
/// loads Open MPI, which loads UCX, which creates an empty folder in that of the session before
/// main() runs.
bool of_the_system(const std::string& path) {
  if (path.starts_with("/run/user/") && path.ends_with("/ucx")) return true;
  return path == "/dev/null" || path == "/dev/tty" || path.starts_with("/proc/self/");
}

/// Returns all quoted texts of a line.
Words names_in(const std::string& line) {
  Words out;
  for (size_t at = line.find('"'); at != std::string::npos;) {
    const size_t end = line.find('"', at + 1);
    if (end == std::string::npos) break;
    out.push_back(line.substr(at + 1, end - at - 1));
    at = line.find('"', end + 1);
  }
  return out;
}

/// Returns the first word after the number of the process.
std::string call_of(const std::string& line) {
  const size_t begin = line.find_first_not_of("0123456789 "), end = line.find('(');
  // "+++ exited with 0 +++", "--- SIGCHLD ...", "<... openat resumed>" are no new calls.
  const bool is_call = begin < end && end != std::string::npos && std::isalpha(line[begin]);
  return is_call ? line.substr(begin, end - begin) : "";
}

struct Watched {
  size_t calls = 0, changing = 0;
  std::string beyond;  ///< Lines of calls that change files outside.
};

/// Analyses the output of strace.
/// @param roots  paths that may be changed, with everything below them
Watched look(const std::string& log, const Words& roots) {
  Watched out;
  std::ifstream in(log);
  for (std::string line; std::getline(in, line);) {
    const std::string call = call_of(line);
    if (call.empty()) continue;
    ++out.calls;
    const bool opens = call.starts_with("open") || call == "creat";
    if (opens && call != "creat" && line.find("O_WRONLY") == std::string::npos &&
        line.find("O_RDWR") == std::string::npos && line.find("O_CREAT") == std::string::npos &&
        line.find("O_TRUNC") == std::string::npos)
      continue;
    ++out.changing;
    Words names = names_in(line);
    if (call == "ftruncate" || call == "fallocate" || call == "fchmod" || call == "fchown") {
      const size_t at = line.find('<'), end = line.find('>');
      names = {line.substr(at + 1, end - at - 1)};
    }
    bool inside = !names.empty();
    for (const std::string& name : names) {
      const std::string path = fs::absolute(name).lexically_normal().string();
      bool mine = of_the_system(path);
      for (const std::string& root : roots)
        mine = mine || path == root || path.starts_with(root + "/");
      inside = inside && mine;
    }
    if (!inside) out.beyond += line + "\n";
  }
  return out;
}

/// Returns whether strace exists and may trace processes.
bool can_watch(const Scratch& scratch) {
  const ChildEnd end =
      ChildProgram({"strace", "-f", "-o", scratch / "trial", "true"}, scratch / "").end();
  return end.code == 0;
}

/// Runs the command under strace. @param folder  its run folder; NAME.previous may be changed, too
Watched watch(const Scratch& scratch, const Words& words, const std::string& folder) {
  const std::string log = scratch / "calls";
  Words all = {"strace", "-f", "-y", "-s", "4096", "-o", log, "-e", kCalls};
  // LeakSanitizer and strace cannot both trace one process.
  if (kSanitized) all.insert(all.end(), {"-E", "ASAN_OPTIONS=detect_leaks=0"});
  all.emplace_back(FLEXMORPH_PROGRAM);
  all.insert(all.end(), words.begin(), words.end());
  all.insert(all.end(), {"-o", folder, "--quiet"});
  const ChildEnd end = ChildProgram(all, scratch / "").end();
  EXPECT_TRUE(end.code == 0 || end.code == 3 || end.code == 5)
      << words[1] << ": " << end.code << "\n"
      << end.err;
  return look(log, {folder, folder + ".previous"});
}

/// Names that a run, or a cleanup after it, might mistake for its own files.
const char* const kTempting[] = {
    "design_mine.txt", "components_old.csv", "history.csv.bak", "run.json.orig",
    "plots/mine.svg",  "loads/notes.csv",    "motion/my.vtu",   "motion/frame_99999.vtu",
    "design/mine.vti", "design.dxf~",        "inputs/mine.csv", "case.toml.tmp2",
    "evaluations.txt", "report_mine.html",   ".hidden",         "my folder/file.md"};

void put_files(const std::string& folder) {
  for (const char* name : kTempting) {
    fs::create_directories((fs::path(folder) / name).parent_path());
    std::ofstream(folder + "/" + name) << "mine: " << name;
  }
}

void expect_files(const std::string& folder) {
  for (const char* name : kTempting)
    EXPECT_EQ(contents_of(folder + "/" + name), std::string("mine: ") + name) << folder;
}

struct Command {
  std::string name;
  Words words;
  bool study = false;
};

/// Returns the words of a shortened run: few loads and iterations, short times.
Words short_text(const std::string& name) {
  std::string path = FLEXMORPH_CASES;
  path.append("/").append(name).append(".toml");
  const std::string text = contents_of(path);
  const auto has = [&](const char* part) { return text.find(part) != std::string::npos; };
  Words out = {"run", name, "--set", "expect=", "--set", "accuracy="};
  if (has("[optimizer]")) out.insert(out.end(), {"--set", "optimizer.max_iterations=2"});
  // A tenth of the motion, except where cells must divide a length that is reached at its end.
  std::smatch end;
  if (name != "motion_platform" && name != "telescopic_crane" &&
      std::regex_search(text, end, std::regex("\\[time\\]\\nend = ([0-9.]+)")))
    out.insert(out.end(), {"--set", "time.end=" + std::to_string(0.1 * std::stod(end[1]))});
  if (has("[verify]")) out.insert(out.end(), {"--set", "verify="});
  return out;
}

std::vector<Command> commands() {
  const std::string small = FLEXMORPH_SHORT_CASE;
  // The meshes are coarse, because the written files do not depend on them.
  std::vector<Command> out = {
      {"a design in a motion", {"run", small}},
      {"a path",
       {"run", "cantilever_roll_up", "--set", "body.elements=[4,1]", "--set", "static.steps=4",
        "--set", "expect="}},
      {"a sweep",
       {"sweep", small, "--vary", "time.step=1e-3,2e-3", "--set", "optimizer.max_iterations=1",
        "--set", "design.cell=0.01", "--set", "design.min_thickness=0.01", "--set",
        "esl.every=0.02"},
       true},
      {"a comparison",
       {"compare", "short_beam", "--optimizers", "mma,gcmma", "--starts", "1", "--budget", "3",
        "--set", "design.cell=0.1", "--set", "design.min_feature=0"},
       true}};
  const char* watched = std::getenv("FLEXMORPH_WATCHED");
  if (!watched) return out;
  for (const std::string& name : cases::shipped_cases()) out.push_back({name, short_text(name)});
  out.push_back(
      {"accuracy", {"accuracy", "cantilever_roll_up", "--budget", "5s", "--no-verify"}, true});
  out.push_back({"stability", {"stability", "plate_pendulum", "--suites", "step"}, true});
  if (watched != std::string("all"))
    std::erase_if(out, [&](const Command& c) { return c.name != watched; });
  return out;
}

TEST(SystemCalls, ChangeNothingBeyondTheFolder) {
  if (kThreadSanitized) GTEST_SKIP() << "the sanitizer has files of its own";
  const Scratch scratch;
  if (!can_watch(scratch)) GTEST_SKIP() << "strace is not there, or may not watch";
  for (const Command& command : commands()) {
    const std::string folder = scratch / "run";
    const Watched first = watch(scratch, command.words, folder);
    EXPECT_EQ(first.beyond, "") << command.name;
    EXPECT_GT(first.changing, 5u) << command.name;
    put_files(folder);
    const Watched again = watch(scratch, command.words, folder);
    EXPECT_EQ(again.beyond, "") << command.name << ", again";
    // A run moves the whole folder, a study continues in it.
    expect_files(command.study ? folder : folder + ".previous");
    std::printf("%s: %zu and %zu calls, %zu and %zu that change files\n", command.name.c_str(),
                first.calls, again.calls, first.changing, again.changing);
    std::fflush(stdout);
    for (const char* ending : {"", ".previous"}) fs::remove_all(folder + ending);
  }
}

// The analysis of strace's output finds the calls that it must find.
TEST(SystemCalls, AreSeen) {
  const Scratch scratch;
  scratch.write("log",
                "12 openat(AT_FDCWD</x>, \"/a/run/f.csv\", O_WRONLY|O_CREAT, 0666) = 3</a/run/f>\n"
                "12 openat(AT_FDCWD</x>, \"/etc/passwd\", O_RDONLY) = 3</etc/passwd>\n"
                "12 rename(\"/a/run/f.tmp\", \"/a/run/../precious\") = 0\n"
                "12 unlink(\"/a/runs\") = 0\n"
                "12 ftruncate(3</a/run/f.csv>, 0) = 0\n"
                "12 ftruncate(3</b/f.csv>, 0) = 0\n"
                "12 +++ exited with 0 +++\n");
  const Watched seen = look(scratch / "log", {"/a/run"});
  EXPECT_EQ(seen.changing, 5u);
  EXPECT_TRUE(contains(seen.beyond, "precious"));
  EXPECT_TRUE(contains(seen.beyond, "/a/runs"));
  EXPECT_TRUE(contains(seen.beyond, "/b/f.csv"));
  EXPECT_FALSE(contains(seen.beyond, "f.csv\", O_WRONLY"));
}

}  // namespace
}  // namespace flexmorph
