// Shows that small cases which are changed at random and run in separate processes end correctly:
// exit codes are those of cases/docs/commands.md and never 1, nothing crashes, a run that receives SIGTERM
// ends within its limit of processor time, and its files are complete.
//
//   FLEXMORPH_RUNS=10000 build/tests/attack/attack_tests --gtest_filter='ShortRuns.*'   default 16
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <map>
#include <regex>
#include <thread>

#include "cases/run/run.h"
#include "geometry/sanitizers.h"
#include "io/files.h"
#include "tests/attack/mutations.h"
#include "tests/attack/run_files.h"
#include "tests/cases/run_json.h"
#include "tests/io/scratch.h"

namespace flexmorph {
namespace {

namespace fs = std::filesystem;

// Processor time of a run before it receives SIGTERM [s].
constexpr double kOwn = kSanitized ? 40 : 2.5;
// The same for cases that are not changed and run to their end also on slow and busy processors.
constexpr double kUnchanged = kSanitized ? 100 : 40;
// Further processor time for its current step or iteration [s], far above that of any regular one.
constexpr double kMore = kSanitized ? 100 : 20;
// Further time for each component [s], because exact unions and their length-scale violations take
// about a millisecond each.
constexpr double kPerComponent = 2e-3;
constexpr double kMemory = 4e9;  // address space [bytes]

/// Returns a shipped case that is made small by replacements.
std::string small(const std::string& path,
                  const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = contents_of(path);
  for (const auto& [old, now] : changes) {
    const size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << path << ": " << old;
    if (at != std::string::npos) text.replace(at, old.size(), now);
  }
  return text;
}

std::vector<std::string> small_cases() {
  const std::string cases = std::string(FLEXMORPH_CASES) + "/";
  return {small(cases + "short_beam.toml", {{"cell = 0.025", "cell = 0.1"},
                                            {"min_thickness = 0.025", "min_thickness = 0.05"},
                                            {"max_iterations = 300", "max_iterations = 3"}}),
          small(cases + "cantilever_roll_up.toml",
                {{"steps = 20", "steps = 6"}, {"elements = [16, 1]", "elements = [4, 1]"}}),
          small(FLEXMORPH_SHORT_CASE, {{"end = 0.12", "end = 0.05"},
                                       {"speed = 0.5", "speed = 1.0"},
                                       {"cell = 0.005", "cell = 0.025"},
                                       {"elements = [10, 2]", "elements = [4, 1]"},
                                       {"length = 0.5", "length = 0.4"},
                                       {"every = 0.01", "every = 0.025"},
                                       {"max_iterations = 6", "max_iterations = 2"}}),
          "gravity = [0.0, -9.81]\n[time]\nend = 0.05\nstep = 5e-3\n"
          "[[rigid_body]]\nname = \"rod\"\nmass = 1.0\nsize = [1.0, 0.1]\n"
          "[[joint]]\ntype = \"revolute\"\nname = \"pin\"\nb = \"rod\"\npoint_a = [-0.5, 0.0]\n"
          "point_b = [-0.5, 0.0]\n[[drive]]\nname = \"turn\"\nformula = \"t^2\"\n[[joint]]\n"
          "type = \"angle_drive\"\nname = \"motor\"\nb = \"rod\"\nangle = \"turn\"\n[output]\n"
          "motion_every = 0.01\n"};
}

/// Returns the text with one or two numbers multiplied by a factor; the result is often still a
/// valid case.
std::string nudged(std::string text, testing::Mutations& random) {
  constexpr std::array kFactors = {0.5, 0.9, 1.1, 2.0, 5.0, 0.1, 10.0, -1.0, 0.0, 1e3, 1e-3, 1e6};
  const char* const digits = "0123456789";
  for (size_t n = 1 + random.below(2); n > 0; --n) {
    const size_t at = text.find_first_of(digits, random.below(text.size()));
    if (at == std::string::npos) continue;
    size_t first = at;
    while (first > 0 && std::string("0123456789.e").find(text[first - 1]) != std::string::npos)
      --first;
    const size_t end = std::min(text.find_first_not_of("0123456789.e-", at), text.size());
    const std::string number = text.substr(first, end - first);
    const double value = std::strtod(number.c_str(), nullptr) * kFactors[random.below(12)];
    const bool whole = number.find_first_of(".e") == std::string::npos;
    text.replace(first, end - first,
                 whole ? std::to_string(std::lround(value)) : io::to_text(value));
  }
  return text;
}

/// Runs a case as main() does and exits with its code.
[[noreturn]] void run_and_exit(const std::string& file, const std::string& folder) {
  const rlimit none{0, 0}, memory{static_cast<rlim_t>(kMemory), static_cast<rlim_t>(kMemory)};
  setrlimit(RLIMIT_CORE, &none);
  if (!kSanitized) setrlimit(RLIMIT_AS, &memory);
  if (!std::freopen("/dev/null", "w", stdout)) _exit(126);
  const std::string words = fs::path(folder).parent_path() / "words";
  if (!std::freopen(words.c_str(), "w", stderr)) _exit(126);
  cases::RunOptions options;
  options.case_name = file;
  options.directory = folder;
  options.quiet = true;
  int code = 1;
  try {
    code = cases::run_case(options);
  } catch (const Error& error) {
    code = error.kind() == Error::Kind::input ? 2 : 3;
    std::fprintf(stderr, "%s\n", error.what());
  } catch (const std::bad_alloc&) {
    code = 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "unexpected: %s\n", error.what());
  }
  std::fflush(stderr);
  _exit(code);
}

double processor_time(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Returns the number of components that a case requests: two in every box of its lattice.
double components(const std::string& text) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex("components *= *\\[ *([0-9]+) *, *([0-9]+)")))
    return 0;
  return 2 * std::stod(found[1]) * std::stod(found[2]);
}

/// Returns the exit code; 128 or more means a signal, 1000 that it did not end after SIGTERM.
/// @param own   processor time after which it is asked to end [s]
/// @param more  processor time that its end may take [s]
int code_of(pid_t child, double own, double more) {
  // The limits of wall time: a waiting child uses no processor time, and busy machines are slow.
  constexpr double kWall = 20, kBusy = 50;
  const auto begin = std::chrono::steady_clock::now();
  int status = 0;
  bool asked = false, hung = false;
  while (waitpid(child, &status, WNOHANG) == 0) {
    const double seconds = processor_time(child);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    const double allowed = kWall + kBusy * own;
    if ((seconds > own || wall.count() > allowed) && !asked) {
      asked = true;
      kill(child, SIGTERM);
    } else if ((seconds > own + more || wall.count() > allowed + kWall + kBusy * more) && !hung) {
      hung = true;
      kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  if (hung) return 1000;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Returns the error in the end of a run; empty if there is none.
std::string wrong(int code, const std::string& folder) {
  if (code == 1000) return "does not end when it is asked to";
  // Before the folder exists there is nothing to lose.
  if (code == 128 + SIGTERM && !fs::exists(folder)) return "";
  if (code != 0 && (code < 2 || code > 5)) return "exit code " + std::to_string(code);
  if (!fs::exists(folder)) return code == 2 || code == 3 ? "" : "there is no folder";
  const std::string broken = testing::broken_files(folder);
  if (!broken.empty()) return broken;
  const std::string status = test::run_json(folder).value("status", "");
  const bool done = code == 0 || code == 5;
  if (status.starts_with("done") != done)
    return "exit code " + std::to_string(code) + " and status " + status;
  return "";
}

TEST(ShortRuns, EndAsTheySay) {
  const Scratch scratch;
  const std::vector<std::string> cases = small_cases();
  const size_t n = testing::number_of("FLEXMORPH_RUNS", 16),
               seed = testing::number_of("FLEXMORPH_SEED", 1);
  std::map<int, size_t> codes;
  for (const std::string& text : cases) {
    const std::string file = scratch.write("case.toml", text), folder = scratch / "run";
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) run_and_exit(file, folder);
    const int code = code_of(child, kUnchanged, kMore);
    EXPECT_TRUE(code == 0 || code == 5)
        << code << text.substr(0, 80) << contents_of(scratch / "words");
    EXPECT_EQ(wrong(code, folder), "");
    fs::remove_all(folder);
  }
  for (size_t i = 0; i < n; ++i) {
    testing::Mutations random(2'000'003 * seed + i);
    const std::string& text = cases[random.below(cases.size())];
    const bool number = random.below(4) != 0;
    const std::string file = scratch.write(
                          "case.toml", number ? nudged(text, random) : random.changed(text, text)),
                      folder = scratch / "run";
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) run_and_exit(file, folder);
    const int code = code_of(child, kOwn, kMore + kPerComponent * components(contents_of(file)));
    ++codes[code];
    if (const std::string why = wrong(code, folder); !why.empty()) {
      const auto kept =
          fs::temp_directory_path() / ("flexmorph_run_" + std::to_string(getpid()) + "_" +
                                       std::to_string(seed) + "_" + std::to_string(i) + ".toml");
      fs::copy_file(file, kept, fs::copy_options::overwrite_existing);
      ADD_FAILURE() << "run " << i << ": " << why << "\n"
                    << contents_of(scratch / "words") << "kept as " << kept;
    }
    fs::remove_all(folder);
  }
  for (const auto& [code, count] : codes) std::printf("exit code %d: %zu\n", code, count);
  EXPECT_GT(codes[0] + codes[5], n / 20);
  EXPECT_GT(codes[2], n / 20);
}

}  // namespace
}  // namespace flexmorph
