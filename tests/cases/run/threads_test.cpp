// Shows that runs with several threads write the bytes of a run with one thread: motions in
// parallel, files written in the background, cells and loads shared between threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>

#include "tests/cases/page_text.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

/// Returns the text of a file without run times and without the number of threads.
std::string timeless(const fs::path& file, std::string text) {
  if (file.filename() == "history.csv") {
    std::string out;
    for (const std::string& line : lines_of(text)) {
      size_t end = line.size();
      for (int k = 0; k < 7; ++k) end = line.rfind(',', end - 1);
      out += line.substr(0, end) + "\n";
    }
    return out;
  }
  if (file.filename() == "report.html") return test::page_without_times(text);
  if (file.filename() != "run.json") return text;
  std::string out;
  for (const std::string& line : lines_of(text))
    if (!std::regex_search(line, std::regex("seconds|threads|memory|CPU|wall"))) out += line + "\n";
  return out;
}

std::map<std::string, std::string> files_of(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    // describes the process that wrote the folder
    if (entry.is_regular_file() && entry.path().filename() != ".flexmorph")
      out[fs::relative(entry.path(), folder)] =
          timeless(entry.path(), contents_of(entry.path().string()));
  return out;
}

/// Runs the case with each of these numbers of threads; the first one is "1".
void expect_same_bytes(const Words& numbers) {
  std::map<std::string, std::string> one;
  std::string said;
  for (const std::string& threads : numbers) {
    const Scratch scratch;
    const std::string folder = scratch / "out";
    // 47 loads form two blocks that threads share. The number is odd, therefore columns of doubles
    // have different alignments.
    Words words = short_run(
        folder, {"verify.mesh=[12,2]", "output.plots=true", "esl.every=0.005", "time.end=0.235",
                 "esl.compress=false", "design.cell=0.0025", "optimizer.max_iterations=1"});
    words.insert(words.end(), {"--threads", threads});
    const Ended ended = flexmorph(scratch, words);
    ASSERT_EQ(ended.code, kTooFew) << ended.err;
    std::string out;
    for (const std::string& line : lines_of(ended.out))  // progress depends on the clock
      if (!contains(line, " left") && !contains(line, ": iteration ") && !line.starts_with("done"))
        out += line + "\n";
    for (size_t at; (at = out.find(folder)) != std::string::npos;) out.erase(at, folder.size());
    const std::map<std::string, std::string> files = files_of(folder);
    if (one.empty()) {
      one = files;
      said = out;
      for (const char* name : {"motion.csv", "motion_uniform.csv", "motion_verified.csv",
                               "motion_verified_uniform.csv", "design/iterations.pvd"})
        EXPECT_TRUE(one.contains(name)) << name;
      continue;
    }
    EXPECT_EQ(out, said);
    EXPECT_EQ(files.size(), one.size());
    for (const auto& [name, text] : files)
      EXPECT_TRUE(one.contains(name) && one.at(name) == text) << name << ", threads " << threads;
  }
}

TEST(Threads, ChangeNoByte) { expect_same_bytes({"1", "4"}); }

TEST(LongThreads, ChangeNoByte) { expect_same_bytes({"1", "2", "3"}); }

}  // namespace
}  // namespace flexmorph::test
