// Runs that are killed and resumed come to what a run comes to that nobody disturbed, byte for
// byte.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "io/tables.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Files of a folder by their path in it: without times, and what says who wrote them.
std::map<std::string, std::string> lasting(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (!entry.is_regular_file() || name == ".flexmorph" || name == "report.html") continue;
    std::string text = contents_of(entry.path().string());
    if (name == "run.json") {
      json run = json::parse(text);
      for (const char* key : {"seconds_wall", "seconds_cpu", "peak_memory_bytes"}) run.erase(key);
      for (json& result : run["results"]) result.erase("factorizations");
      text = run.dump();
    }
    if (name == "history.csv") {
      const io::CsvTable table = io::read_csv(entry.path().string());
      text.clear();
      for (size_t c = 0; c < table.columns.size(); ++c) {
        if (table.columns[c].starts_with("seconds")) continue;
        text += table.columns[c];
        for (const auto& cell : table.texts(table.columns[c])) text += "," + cell;
      }
    }
    out[name] = text;
  }
  return out;
}

Words words_of(const std::string& path, const std::string& folder, const Words& changes,
               bool resume = false) {
  Words out = {"run", path, "-o", folder, "--quiet", "--set", "expect="};
  for (const std::string& change : changes) out.insert(out.end(), {"--set", change});
  if (resume) out.emplace_back("--resume");
  return out;
}

/// Waits until a history has so many rows; false when the run ended before.
bool has_rows(const std::string& folder, size_t n, pid_t run) {
  for (int k = 0; k < 6000; ++k) {
    if (lines_of(contents_of(folder + "/history.csv")).size() > n) return true;
    if (waitpid(run, nullptr, WNOHANG | WNOWAIT) == run) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

void expect_same(const std::map<std::string, std::string>& a,
                 const std::map<std::string, std::string>& b) {
  EXPECT_EQ(a.size(), b.size());
  for (const auto& [name, text] : a) EXPECT_TRUE(b.contains(name) && b.at(name) == text) << name;
}

struct Design {
  const char* name;
  std::string path;
  Words changes;
  std::vector<size_t> rows;  ///< after which it is killed, in turn
  size_t all;                ///< of its history
};
void PrintTo(const Design& d, std::ostream* out) { *out << d.name; }

class Resumed : public ::testing::TestWithParam<Design> {};

TEST_P(Resumed, IsAsUndisturbed) {
  const Design& d = GetParam();
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const int code = flexmorph(scratch, words_of(d.path, whole, d.changes)).code;
  ASSERT_TRUE(code == 0 || code == kTooFew) << code;
  EXPECT_FALSE(fs::exists(whole + "/evaluations.log"));
  for (const size_t rows : d.rows) {
    const pid_t run = start(scratch, words_of(d.path, folder, d.changes, true));
    if (has_rows(folder, rows, run)) kill(run, SIGKILL);
    end_of(scratch, run);
  }
  const Ended ended = flexmorph(scratch, words_of(d.path, folder, d.changes, true));
  EXPECT_EQ(ended.code, code) << ended.err;
  EXPECT_EQ(io::read_csv(folder + "/history.csv").n_rows(), d.all);
  expect_same(lasting(folder), lasting(whole));
  EXPECT_FALSE(fs::exists(folder + ".previous"));
}

INSTANTIATE_TEST_SUITE_P(
    Designs, Resumed,
    ::testing::Values(
        Design{"mma", FLEXMORPH_SHORT_CASE, {"optimizer.max_iterations=30"}, {1, 7, 8, 29}, 30},
        Design{"gcmma", FLEXMORPH_SHORT_CASE, {"optimizer.name=gcmma"}, {2, 5}, 6},
        Design{"two_bodies_three_cycles", FLEXMORPH_TWO_PLATES, {}, {3, 14, 23}, 30},
        Design{"components_that_go",
               "short_beam",
               {"optimizer.max_iterations=40", "design.drop_every=5", "design.min_feature=0.03",
                "output.design_every=3"},
               {10, 26, 33},
               40}),
    [](const auto& info) { return std::string(info.param.name); });

// Interrupted, a run is whole as far as it went; that it goes on from there changes nothing.
TEST(Resume, GoesOnAfterAnInterruption) {
  const Scratch scratch;
  const std::string whole = scratch / "whole", folder = scratch / "out";
  const Words changes = {"optimizer.max_iterations=30"};
  flexmorph(scratch, words_of(FLEXMORPH_SHORT_CASE, whole, changes));
  const pid_t run = start(scratch, words_of(FLEXMORPH_SHORT_CASE, folder, changes));
  ASSERT_TRUE(has_rows(folder, 4, run));
  kill(run, SIGTERM);
  ASSERT_EQ(end_of(scratch, run).code, 4);
  EXPECT_TRUE(fs::exists(folder + "/components.csv"));
  flexmorph(scratch, words_of(FLEXMORPH_SHORT_CASE, folder, changes, true));
  expect_same(lasting(folder), lasting(whole));
}

/// Can every file of a run be read, at any moment? Tables end with whole rows, indices name frames
/// that are there.
void expect_readable(const std::string& folder) {
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().string(), ending = entry.path().extension().string();
    if (ending == ".tmp" || !entry.is_regular_file()) continue;
    const std::string text = contents_of(path);
    if (ending == ".json") {
      EXPECT_TRUE(json::accept(text)) << path;
    }
    if (ending == ".csv" && !text.empty()) {
      EXPECT_EQ(text.back(), '\n') << path;
      EXPECT_NO_THROW(io::read_csv(path)) << path;
    }
    if (ending == ".vti" || ending == ".vtp" || ending == ".vtu") {
      EXPECT_TRUE(text.ends_with("</VTKFile>\n")) << path;
    }
    if (ending != ".pvd") continue;
    const std::string key = "file=\"";
    for (size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
      const size_t begin = at + key.size();
      const std::string frame = text.substr(begin, text.find('"', begin) - begin);
      EXPECT_TRUE(fs::exists(entry.path().parent_path() / frame)) << path << " " << frame;
    }
  }
}

// FLEXMORPH_KILLS=200 is the long form: shipped cases, shortened, in about a quarter of an hour.
TEST(Resume, AfterKillsAtRandomMoments) {
  const char* wanted = std::getenv("FLEXMORPH_KILLS");
  const int kills = wanted ? std::atoi(wanted) : 8;
  std::vector<Design> all = {
      {"short", FLEXMORPH_SHORT_CASE, {"optimizer.max_iterations=20"}, {}, 0}};
  if (wanted) {
    all.push_back({"plate",
                   "rotating_plate_v01",
                   {"optimizer.max_iterations=30", "time.end=0.2", "verify="},
                   {},
                   0});
    all.push_back({"platform",
                   "motion_platform",
                   {"optimizer.max_iterations=12", "time.end=0.3", "verify=", "cycle="},
                   {},
                   0});
  }
  std::mt19937 engine(1);
  int n = 0;
  for (const Design& d : all) {
    const Scratch scratch;
    const std::string whole = scratch / "whole", folder = scratch / "out";
    const auto begin = std::chrono::steady_clock::now();
    const int code = flexmorph(scratch, words_of(d.path, whole, d.changes)).code;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    ASSERT_TRUE(code == 0 || code == kTooFew) << d.name << " " << code;
    const auto undisturbed = lasting(whole);
    for (int k = 0; k < kills / static_cast<int>(all.size()); ++k, ++n) {
      // Mostly killed once before it goes on, sometimes again.
      const pid_t run = start(scratch, words_of(d.path, folder, d.changes, true));
      std::this_thread::sleep_for(took * (static_cast<double>(engine()) / 4294967296.0));
      kill(run, SIGKILL);
      end_of(scratch, run);
      expect_readable(folder);
      if (engine() % 3 == 0) continue;
      EXPECT_EQ(flexmorph(scratch, words_of(d.path, folder, d.changes, true)).code, code);
      expect_same(lasting(folder), undisturbed);
      fs::remove_all(folder);
    }
    fs::remove_all(folder);
  }
  EXPECT_GE(n, kills - 3);
  std::cout << "  " << n << " kills\n";
}

TEST(Resume, RefusesAnotherCase) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const pid_t run =
      start(scratch, words_of(FLEXMORPH_SHORT_CASE, folder, {"optimizer.max_iterations=300"}));
  ASSERT_TRUE(has_rows(folder, 2, run));
  kill(run, SIGKILL);
  end_of(scratch, run);
  const std::string before = contents_of(folder + "/history.csv");
  const Ended ended = flexmorph(
      scratch, words_of(FLEXMORPH_SHORT_CASE, folder, {"optimizer.max_iterations=301"}, true));
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("a run of another case"), std::string::npos) << ended.err;
  EXPECT_EQ(contents_of(folder + "/history.csv"), before);
}

TEST(Resume, LeavesWhatIsDone) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Words words = words_of(FLEXMORPH_SHORT_CASE, folder, {}, true);
  const int code = flexmorph(scratch, words).code;
  const std::string before = contents_of(folder + "/run.json");
  const Ended ended = flexmorph(scratch, words);
  EXPECT_EQ(ended.code, code) << ended.err;
  EXPECT_NE(ended.out.find("finished before"), std::string::npos) << ended.out;
  EXPECT_EQ(contents_of(folder + "/run.json"), before);
}

}  // namespace
}  // namespace flexmorph::test
