// Shows that runs and studies that are killed at random moments (SIGKILL), repeatedly, and resumed
// have the results of undisturbed ones byte for byte, and that their files are readable at any
// time.
//
//   FLEXMORPH_KILLS=200        number of kills of shortened cases, distributed evenly over them;
//                              default 6. If set, runs are also killed at every system call of
//                              their final writing.
//   FLEXMORPH_WHOLE_KILLS=10   number of kills of full runs of rotating_plate_v01; default none
//   FLEXMORPH_SEED=1
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <optional>
#include <random>
#include <thread>

#include "geometry/sanitizers.h"
#include "tests/attack/children.h"
#include "tests/cases/run/resumed.h"

namespace flexmorph::test {
namespace {

using Clock = std::chrono::steady_clock;

int number_from(const char* name, int otherwise) {
  const char* said = std::getenv(name);
  return said ? std::atoi(said) : otherwise;
}

/// Reads all files of a folder repeatedly during the lifetime of the object.
class Reader {
 public:
  explicit Reader(std::string folder) : folder_(std::move(folder)), thread_([this] { read(); }) {}
  ~Reader() {
    ends_ = true;
    thread_.join();
    for (const std::string& file : found_) ADD_FAILURE() << "could not be read: " << file;
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  int analyses() const { return analyses_; }
  /// Number of analyses in which a file was incomplete for an instant.
  int cut() const { return cut_; }

 private:
  void read() {
    for (; !ends_; ++analyses_) {
      // If a row lies on two pages of memory, the system shows its first part an instant before the
      // second. A file that is really broken is still broken a moment later.
      const Words now = unreadable(folder_);
      if (!now.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
      for (const std::string& each : now.empty() ? now : unreadable(folder_))
        if (std::find(now.begin(), now.end(), each) != now.end()) found_.push_back(each);
      cut_ += !now.empty();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  std::string folder_;
  std::vector<std::string> found_;
  std::atomic<bool> ends_ = false;
  std::atomic<int> analyses_ = 0, cut_ = 0;
  std::thread thread_;  // last, because it uses the other members
};

/// The command that is killed: a run, or a study, which resumes by itself.
struct Victim {
  const char* name;
  std::string path;
  Words changes, vary;
  bool is_study() const { return !vary.empty(); }

  Words words(const std::string& folder, bool resume) const {
    if (!is_study()) return text_of(path, folder, changes, resume);
    Words out = {"sweep", path, "-o", folder, "--set", "expect="};
    for (const std::string& change : changes) out.insert(out.end(), {"--set", change});
    for (const std::string& key : vary) out.insert(out.end(), {"--vary", key});
    return out;
  }
};

/// @returns the number of kills
int kill_and_resume(const Victim& v, int kills, std::mt19937& engine) {
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const auto begin = Clock::now();
  const int code = flexmorph(scratch, v.words(whole, false)).code;
  const std::chrono::duration<double> took = Clock::now() - begin;
  EXPECT_TRUE(code == 0 || code == kTooFew) << v.name << " " << code;
  const auto undisturbed = lasting(whole);
  int n = 0, ends = 0, analyses = 0, cut = 0;
  while (n < kills && !::testing::Test::HasFailure()) {
    std::optional<Reader> reader(std::in_place, folder);
    bool killed = true;
    while (killed && n < kills) {
      testing::ChildProgram run = start(scratch, v.words(folder, true));
      std::this_thread::sleep_for(took * (static_cast<double>(engine()) / 4294967296.0));
      run.send(SIGKILL);
      const Ended ended = run.end();
      killed = ended.code == -1;
      n += killed;
      if (killed && v.is_study() && fs::exists(folder)) testing::wait_for_children(folder);
      expect_readable(folder);
      if (!killed) {
        EXPECT_EQ(ended.code, code) << v.name << " " << ended.err;
      }
      if (engine() % 2 == 0) break;  // kill it again, or resume it
    }
    if (killed) {
      const Ended ended = flexmorph(scratch, v.words(folder, true));
      EXPECT_EQ(ended.code, code) << v.name << " " << ended.err;
    }
    expect_same(lasting(folder), undisturbed);
    ++ends;
    analyses += reader->analyses();
    cut += reader->cut();
    reader.reset();  // reports its findings as failures
    fs::remove_all(folder);
  }
  std::cout << "  " << v.name << ": " << n << " kills, " << ends << " comparisons, " << analyses
            << " looks at all files (" << cut << " saw half a row for an instant), undisturbed "
            << took.count() << " s, all "
            << std::chrono::duration<double>(Clock::now() - begin).count() << " s" << std::endl;
  return n;
}

/// Changes of the short case that halve its run time.
const Words kCoarse = {"design.cell=0.01", "design.min_thickness=0.01", "esl.every=0.02"};

Words coarse(Words changes) {
  changes.insert(changes.end(), kCoarse.begin(), kCoarse.end());
  return changes;
}

TEST(Kills, AtRandomMomentsChangeNothing) {
  const int kills = number_from("FLEXMORPH_KILLS", 0);
  std::mt19937 engine(static_cast<unsigned>(number_from("FLEXMORPH_SEED", 1)));
  std::vector<Victim> all = {
      {"short", FLEXMORPH_SHORT_CASE, coarse({"optimizer.max_iterations=20"}), {}},
      {"sweep",
       FLEXMORPH_SHORT_CASE,
       coarse({"optimizer.max_iterations=4"}),
       {"design.max_volume=0.4,0.5"}}};
  if (kills > 0) {
    all.push_back({"plate",
                   "rotating_plate_v01",
                   {"optimizer.max_iterations=20", "time.end=0.2", "verify="},
                   {}});
    all.push_back({"platform",
                   "motion_platform",
                   {"optimizer.max_iterations=6", "time.end=0.3", "verify=", "cycle="},
                   {}});
  }
  const int each =
      kills > 0 ? (kills + static_cast<int>(all.size()) - 1) / static_cast<int>(all.size()) : 2;
  int n = 0;
  for (const Victim& v : all) n += kill_and_resume(v, each, engine);
  EXPECT_GE(n, kills);
}

/// A system call of a run: its name, and its number among the calls of this name.
struct Call {
  std::string name;
  int number;
};

constexpr const char* kChanging = "rename,renameat,renameat2,unlink,unlinkat,fsync,fdatasync";
/// Other calls by which a run changes its files: one of these or of kChanging follows a call
/// immediately.
constexpr const char* kFurther = "write,openat,close";

bool is_changing(const Call& call) {
  return (std::string(",") + kChanging + ",").find("," + call.name + ",") != std::string::npos;
}

/// Runs the program under strace with the given options of strace.
Ended trace(const Scratch& scratch, const Words& options, const Words& arguments) {
  Words words = {"strace", "-f", "-qq", "--seccomp-bpf"};
  // LeakSanitizer and strace cannot both trace one process.
  if (kSanitized) words.insert(words.end(), {"-E", "ASAN_OPTIONS=detect_leaks=0"});
  words.insert(words.end(), options.begin(), options.end());
  words.emplace_back(FLEXMORPH_PROGRAM);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return ChildProgram(words, scratch / "").end();
}

/// Returns the calls of a run after its last frame of a design was written: each call that renames,
/// removes or flushes files, and the call that follows it. A kill happens before its call,
/// therefore these are kills before and after each of the former.
std::vector<Call> calls_of_final_writing(const std::string& log) {
  std::vector<Call> out;
  std::map<std::string, int> numbers;
  std::ifstream in(log);
  for (std::string line; std::getline(in, line);) {
    const size_t begin = line.find_first_not_of("0123456789 "), end = line.find('(');
    if (begin >= end || end == std::string::npos) continue;
    const std::string name = line.substr(begin, end - begin);
    out.push_back({name, ++numbers[name]});
    if (line.find("/design/") != std::string::npos) out.clear();
  }
  std::vector<Call> chosen;
  for (size_t i = 0; i < out.size(); ++i)
    if (is_changing(out[i]) || (i > 0 && is_changing(out[i - 1]))) chosen.push_back(out[i]);
  return chosen;
}

/// Runs the program, which is killed before a call, and returns its exit code. The page is written
/// every five seconds while a run lasts; therefore a run may have a few calls less than another,
/// and is then repeated with an earlier call.
int kill_at(const Scratch& scratch, const Call& call, const Words& arguments,
            const std::string& folder) {
  int code = 0;
  for (int number = call.number; code != -1 && number > std::max(0, call.number - 10); --number) {
    fs::remove_all(folder);
    code = trace(scratch,
                 {"-o", "/dev/null", "-e",
                  "inject=" + call.name + ":signal=KILL:when=" + std::to_string(number)},
                 arguments)
               .code;
  }
  return code;
}

TEST(Kills, AtCallsOfTheFinalWritingChangeNothing) {
  if (testing::run_shell("strace -qq -o /dev/null true").code != 0)
    GTEST_SKIP() << "strace cannot watch processes here";
  const Scratch scratch;
  const Victim victim{"short", FLEXMORPH_SHORT_CASE, coarse({"optimizer.max_iterations=2"}), {}};
  const std::string whole = scratch / "whole", log = scratch / "calls";
  const int code =
      trace(scratch, {"-o", log, "-e", std::string("trace=") + kChanging + "," + kFurther},
            victim.words(whole, false))
          .code;
  const auto undisturbed = lasting(whole);
  std::vector<Call> calls = calls_of_final_writing(log);
  ASSERT_GT(calls.size(), 20u);
  if (number_from("FLEXMORPH_KILLS", 0) == 0) {
    // Only the call by which run.json says "done", and the one that removes the first log
    // afterwards.
    std::erase_if(calls, [&](const Call& call) {
      const int first = call.name == "unlink" ? 1 : -1;
      const bool last_rename =
          call.name == "rename" && std::none_of(calls.begin(), calls.end(), [&](const Call& other) {
            return other.name == "rename" && other.number > call.number;
          });
      return call.number != first && !last_rename;
    });
  }
  std::cout << "  " << calls.size() << " kills" << std::endl;
  for (const Call& call : calls) {
    const std::string folder = scratch / "out";
    EXPECT_EQ(kill_at(scratch, call, victim.words(folder, false), folder), -1)
        << call.name << " " << call.number;
    expect_readable(folder);
    const Ended ended = flexmorph(scratch, victim.words(folder, true));
    EXPECT_EQ(ended.code, code) << call.name << " " << call.number << " " << ended.err;
    expect_same(lasting(folder), undisturbed);
    if (::testing::Test::HasFailure()) break;
    fs::remove_all(folder);
  }
}

TEST(Kills, OfWholeRunsChangeNothing) {
  const int kills = number_from("FLEXMORPH_WHOLE_KILLS", 0);
  if (kills == 0) GTEST_SKIP() << "FLEXMORPH_WHOLE_KILLS";
  std::mt19937 engine(static_cast<unsigned>(number_from("FLEXMORPH_SEED", 1)));
  EXPECT_GE(kill_and_resume({"rotating_plate_v01", "rotating_plate_v01", {}, {}}, kills, engine),
            kills);
}

}  // namespace
}  // namespace flexmorph::test
