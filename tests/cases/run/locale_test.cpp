// Shows that numbers do not depend on the locale: the program writes equal bytes (except run times)
// where printf, strtod and streams use a decimal comma.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "io/tables.h"
#include "tests/cases/page_text.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

/// Programs that are started during the lifetime of an object of this class run with the locale
/// de_DE.
class GermanLocale {
 public:
  explicit GermanLocale(const Scratch& scratch) : said_(scratch / "said") {
    // The locale is created here, because few machines have it installed.
    const std::string folder = scratch / "locales";
    fs::create_directories(folder);
    made_ =
        testing::run_shell("localedef -i de_DE -f UTF-8 '" + folder + "/de_DE.UTF-8'").code == 0;
    set("LOCPATH", folder);
    set("LC_ALL", "de_DE.UTF-8");
    set("LD_PRELOAD", FLEXMORPH_COMMA_LOCALE);
    set("FLEXMORPH_SPEAKS", said_);
  }
  ~GermanLocale() {
    for (const std::string& name : names_) unsetenv(name.c_str());
  }
  GermanLocale(const GermanLocale&) = delete;
  GermanLocale& operator=(const GermanLocale&) = delete;

  /// Returns success if every started process used this locale.
  ::testing::AssertionResult spoken() const {
    if (!made_)
      return ::testing::AssertionFailure() << "localedef made no de_DE.UTF-8: package 'locales'?";
    const Words said = lines_of(contents_of(said_));
    if (said.empty()) return ::testing::AssertionFailure() << "no process said anything";
    for (const std::string& line : said)
      if (line != "printf 0,5 strtod 250 stream 1.234,5")
        return ::testing::AssertionFailure() << line;
    return ::testing::AssertionSuccess();
  }

 private:
  void set(const char* name, const std::string& value) {
    names_.emplace_back(name);
    setenv(name, value.c_str(), 1);
  }
  std::string said_;
  std::vector<std::string> names_;
  bool made_ = false;
};

/// Returns a table without its columns of run times and memory.
std::string without_times(const io::CsvTable& table) {
  std::string out;
  for (size_t c = 0; c < table.columns.size(); ++c) {
    const std::string& name = table.columns[c];
    if (name.starts_with("seconds") || name == "CPU s" || name == "peak_memory_bytes") continue;
    out += name;
    for (const auto& cell : table.texts(name)) out += "," + cell;
    out += "\n";
  }
  return out;
}

/// Returns all files of a folder by their path in it, without run times: these are removed from
/// run.json and from tables, and the output of the runs of a study and files in `timed` are left
/// out.
std::map<std::string, std::string> files_of(const std::string& folder, const Words& timed = {}) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename() == ".flexmorph" ||
        entry.path().extension() == ".log")
      continue;
    const std::string name = fs::relative(entry.path(), folder).string(),
                      path = entry.path().string();
    if (std::find(timed.begin(), timed.end(), name) != timed.end()) continue;
    std::string text = contents_of(path);
    if (name.ends_with("run.json")) {
      auto json = nlohmann::ordered_json::parse(text);
      for (const char* key :
           {"seconds_wall", "seconds_cpu", "seconds_by_phase", "peak_memory_bytes"})
        json.erase(key);
      for (auto& result : json["results"])
        if (result.contains("body_fitted")) result["body_fitted"].erase("seconds");
      text = json.dump();
    } else if (name.ends_with("report.html")) {
      text = page_without_times(text);
    } else if (name.ends_with(".csv")) {
      text = without_times(io::read_csv(path));
    }
    out[name] = text;
  }
  return out;
}

void expect_same(const std::map<std::string, std::string>& a,
                 const std::map<std::string, std::string>& b) {
  for (const auto& [name, text] : a) {
    if (!b.contains(name)) {
      ADD_FAILURE() << name << " is missing";
      continue;
    }
    if (b.at(name) == text) continue;
    const auto differ =
        std::mismatch(text.begin(), text.end(), b.at(name).begin(), b.at(name).end());
    const auto at = static_cast<size_t>(differ.first - text.begin());
    const size_t from = at < 40 ? 0 : at - 40;
    ADD_FAILURE() << name << ": ..." << text.substr(from, 80) << "... and ..."
                  << b.at(name).substr(from, 80) << "...";
  }
  EXPECT_EQ(a.size(), b.size());
}

/// Runs a command in both locales and compares the files.
/// @returns the number of compared files
size_t expect_same_files(const Words& command, const Words& timed = {}, int code = 0) {
  const Scratch scratch;
  const auto run = [&](const std::string& folder) {
    Words words = command;
    words.insert(words.end(), {"-o", folder});
    const Ended ended = flexmorph(scratch, words);
    EXPECT_EQ(ended.code, code) << ended.err;
  };
  const std::string plain = scratch / "plain" + "/out", comma = scratch / "comma" + "/out";
  run(plain);
  {
    const GermanLocale german(scratch);
    run(comma);
    EXPECT_TRUE(german.spoken());
  }
  const auto files = files_of(plain, timed);
  expect_same(files, files_of(comma, timed));
  return files.size();
}

Words with(Words command, const Words& changes) {
  for (const std::string& change : changes) command.insert(command.end(), {"--set", change});
  return command;
}

class Comma : public ::testing::Test {
  void SetUp() override {
    if (!fs::exists("/usr/share/i18n/locales/de_DE"))
      GTEST_SKIP() << "the package locales is absent";
  }
};

TEST_F(Comma, ADesignAndItsMotion) {
  EXPECT_GE(expect_same_files({"run", FLEXMORPH_SHORT_CASE}, {}, kTooFew), 30u);
}

// Cases in space, and in the plane with rigid bodies, formulas and heat.
TEST_F(Comma, ShapesInSpaceAndMechanismsWithHeat) {
  EXPECT_GE(expect_same_files(with({"run", "cantilever_roll_up"},
                                   {"body.elements=[4, 1]", "static.steps=4", "expect="})),
            6u);
  EXPECT_GE(expect_same_files(with({"run", "slider_crank_heated"}, {"time.end=0.01", "expect="})),
            6u);
}

// sweep.md, compare.md, compare.svg and the pages contain run times.
TEST_F(Comma, Studies) {
  EXPECT_GE(
      expect_same_files(with({"sweep", "plate_pendulum", "--vary", "body.thickness=0.009,0.011"},
                             {"body.elements=[2, 2]", "time.end=0.01", "output.vtk=false"}),
                        {"sweep.md", "sweep.html"}),
      10u);
  EXPECT_GE(expect_same_files(with({"compare", "short_beam", "--optimizers", "mma,ipopt",
                                    "--starts", "1", "--budget", "8"},
                                   {"design.cell=0.1", "design.min_feature=0", "output.vtk=false"}),
                              {"compare.md", "compare.svg", "compare.html"}),
            15u);
}

// The refinement series fit into the budget completely. The recommended cases are left out, because
// they depend on run times.
TEST_F(Comma, Accuracy) {
  EXPECT_GE(expect_same_files(with({"accuracy", "short_beam", "--refinements", "band", "--budget",
                                    "10min", "--no-verify", "--quiet"},
                                   {"design.cell=0.1", "design.min_feature=0",
                                    "design.components=[2, 1]", "output.tolerance=2e-3",
                                    "accuracy.quantity=volume", "accuracy.design='start'"}),
                              {"accuracy.md", "accuracy.svg", "short_beam_1pct.toml",
                               "short_beam_0.1pct.toml", "short_beam_0.01pct.toml"}),
            20u);
}

}  // namespace
}  // namespace flexmorph::test
