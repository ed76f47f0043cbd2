// The program as a user meets it: its commands, its exit codes, its one-line complaints about bad
// input (issue line 17), the folder of a short run (design.md section 12), the same bytes twice
// (line 16), and what stays after a failure and an interruption.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/io/scratch.h"

namespace flexmorph {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using Table = std::vector<Words>;

Words lines_of(const std::string& text) {
  Words out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// Starts the program with these arguments, its output in files of the scratch folder.
pid_t start(const Scratch& scratch, const Words& arguments) {
  const std::string out = scratch / "stdout", err = scratch / "stderr";
  std::vector<char*> argv = {const_cast<char*>(FLEXMORPH_PROGRAM)};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (!std::freopen(out.c_str(), "w", stdout) || !std::freopen(err.c_str(), "w", stderr))
      _exit(126);
    execv(argv[0], argv.data());
    _exit(127);
  }
  return child;
}

struct Ended {
  int code = -1;  ///< exit code, -1 when a signal ended it
  std::string out, err;
};

Ended end_of(const Scratch& scratch, pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents_of(scratch / "stdout"),
          contents_of(scratch / "stderr")};
}

Ended flexmorph(const Scratch& scratch, const Words& arguments) {
  return end_of(scratch, start(scratch, arguments));
}

Table read_csv(const std::string& path) {
  Table rows;
  for (const std::string& line : lines_of(contents_of(path))) {
    Words row;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) row.push_back(cell);
    if (line.ends_with(',')) row.emplace_back();
    rows.push_back(row);
  }
  return rows;
}

nlohmann::json run_json(const std::string& folder) {
  return nlohmann::json::parse(contents_of(folder + "/run.json"));
}

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// Runs short_plate.toml with changes.
Words short_run(const std::string& folder, const Words& changes = {}) {
  Words words = {"run", FLEXMORPH_SHORT_CASE, "-o", folder};
  for (const std::string& change : changes) {
    words.emplace_back("--set");
    words.push_back(change);
  }
  return words;
}

TEST(CommandLine, SaysItsVersion) {
  const Scratch scratch;
  const Ended ended = flexmorph(scratch, {"--version"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_TRUE(starts(ended.out, "flexmorph "));
  EXPECT_EQ(lines_of(ended.out).size(), 1u);
  EXPECT_EQ(ended.err, "");
}

TEST(CommandLine, ListsTheShippedCases) {
  const Scratch scratch;
  const Ended ended = flexmorph(scratch, {"cases"});
  EXPECT_EQ(ended.code, 0);
  const Words names = lines_of(ended.out);
  for (const char* name : {"rotating_plate_v01", "rotating_plate_v05"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
}

TEST(CommandLine, EveryShippedCaseChecks) {
  const Scratch scratch;
  for (const std::string& name : lines_of(flexmorph(scratch, {"cases"}).out)) {
    const Ended ended = flexmorph(scratch, {"check", name});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_TRUE(contains(ended.out, "\nactive\n"));
    EXPECT_TRUE(contains(ended.out, "\nabsent"));
  }
}

TEST(CommandLine, CheckSaysWhatIsThereAndWhatIsNot) {
  const Scratch scratch;
  const auto halves = [&](const Words& changes) {
    Words words = {"check", FLEXMORPH_SHORT_CASE};
    for (const std::string& change : changes) words.insert(words.end(), {"--set", change});
    const std::string out = flexmorph(scratch, words).out;
    const size_t middle = std::min(out.find("\nabsent"), out.size());
    return std::pair(out.substr(0, middle), out.substr(middle));
  };
  const auto [active, absent] = halves({});
  for (const char* part : {"body plate", "24 components, 168 variables", "112 x 20 cells",
                           "12 loads", "unknowns", "MB", "mma", "terms: inertia, membrane"})
    EXPECT_TRUE(contains(active, part));
  for (const char* part : {"gravity", "heat", "out-of-plane", "rigid bodies", "verification"})
    EXPECT_TRUE(contains(absent, part));
  // What is listed moves from one half to the other.
  const auto [more, less] = halves({"gravity=[0, -9.81]", "verify.mesh=[20, 4]"});
  EXPECT_TRUE(contains(more, "gravity"));
  EXPECT_FALSE(contains(less, "gravity"));
  EXPECT_TRUE(contains(more, "verification"));
  EXPECT_FALSE(contains(less, "verification"));
}

TEST(CommandLine, UnknownWordsAreBadInput) {
  const Scratch scratch;
  EXPECT_EQ(flexmorph(scratch, {}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"dance"}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"run"}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"run", "rotating_plate_v01", "--threads", "0"}).code, 2);
  EXPECT_EQ(flexmorph(scratch, {"check", "rotating_plate_v01", "--set", "nothing"}).code, 2);
}

/// A line of short_plate.toml that cannot be used, and what the complaint names.
struct Bad {
  const char* name;
  std::string line;   ///< the start of the line ...
  std::string by;     ///< ... and what stands there instead
  std::string where;  ///< key and value as the message shows them
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

const Bad kBad[] = {
    {"unknown_key", "thickness", "thicknes = 0.01", "body.thicknes = 0.01: "},
    {"wrong_type", "width", "width = \"wide\"", "body.width = \"wide\": "},
    {"negative_thickness", "thickness", "thickness = -0.002", "body.thickness = -0.002: "},
    {"no_volume", "max_volume", "max_volume = 0", "design.max_volume = 0: "},
    {"c_min_above_width", "min_thickness", "min_thickness = 0.2", "design.min_thickness = 0.2: "},
    {"no_components", "components", "components = []", "design.components = []: "},
    {"end_zero", "end", "end = 0", "time.end = 0: "},
    {"ten_million_cells", "cell ", "cell = 7.5e-5", "design.cell = 7.5e-5: "},
    {"unknown_optimizer", "name = \"mma\"", "name = \"sqp\"", "optimizer.name = \"sqp\": "},
    {"unknown_option", "move_limit", "options.asinit = 0.1", "optimizer.options.asinit = 0.1: "},
    {"option_out_of_range", "move_limit", "options.asydecr = 1.5",
     "optimizer.options.asydecr = 1.5: "},
};

class BadInput : public ::testing::TestWithParam<Bad> {};
INSTANTIATE_TEST_SUITE_P(Line17, BadInput, ::testing::ValuesIn(kBad),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(BadInput, IsOneLocatedLineAndNoFolder) {
  const Scratch scratch;
  std::string text;
  int line = 0, found = 0;
  for (std::string each : lines_of(contents_of(FLEXMORPH_SHORT_CASE))) {
    ++line;
    if (each.starts_with(GetParam().line)) each = GetParam().by, found = line;
    text += each + "\n";
  }
  ASSERT_GT(found, 0);
  const std::string file = scratch.write("bad.toml", text), folder = scratch / "out";
  for (const Words& command : {Words{"run", file, "-o", folder}, Words{"check", file}}) {
    const Ended ended = flexmorph(scratch, command);
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(starts(
        ended.err, "flexmorph: " + file + ":" + std::to_string(found) + ": " + GetParam().where));
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_FALSE(fs::exists(folder));
  }
}

TEST(BadInput, AMissingFileIsNamed) {
  const Scratch scratch;
  const std::string file = scratch / "nowhere.toml", folder = scratch / "out";
  const Ended ended = flexmorph(scratch, {"run", file, "-o", folder});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(contains(ended.err, file));
  EXPECT_TRUE(contains(ended.err, "rotating_plate_v01"));  // what there is
  EXPECT_EQ(lines_of(ended.err).size(), 1u);
  EXPECT_FALSE(fs::exists(folder));
}

TEST(BadInput, OptionsOfTheCommandLineAreNamedToo) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(scratch, {"run", "rotating_plate_v01", "-o", folder, "--set",
                                          "optimizer.options.asinit=0.1"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(starts(ended.err, "flexmorph: --set optimizer.options.asinit=0.1: "));
  EXPECT_TRUE(contains(ended.err, "asyinit"));  // what there is
  EXPECT_EQ(lines_of(ended.err).size(), 1u);
  EXPECT_FALSE(fs::exists(folder));
}

TEST(BadInput, AFolderThatCannotBeMadeIsNamed) {
  const Scratch scratch;
  const std::string below_a_file = scratch.write("file", "") + "/out";
  for (const std::string& folder : {below_a_file, scratch / "file", std::string("/proc/out")}) {
    const Ended ended = flexmorph(scratch, short_run(folder));
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(contains(ended.err, folder));
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
  }
  EXPECT_TRUE(fs::is_regular_file(scratch / "file"));
}

// Nothing is ever taken away from a folder that no run has written.
TEST(BadInput, AFolderOfSomethingElseIsLeftAlone) {
  const Scratch scratch;
  const std::string folder = scratch / "mine";
  for (const char* own : {"thesis.tex", "case.toml", "motion.csv"}) {
    fs::remove_all(folder);
    fs::create_directory(folder);
    scratch.write(std::string("mine/") + own, "years of work");
    const Ended ended = flexmorph(scratch, short_run(folder));
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(contains(ended.err, folder));
    EXPECT_EQ(lines_of(ended.err).size(), 1u) << ended.err;
    EXPECT_EQ(contents_of(folder + "/" + own), "years of work");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  }
}

constexpr const char* kHistoryHeader =
    "body,cycle,iteration,evaluations,objective,compliance,volume,violation,kkt,change,band,"
    "sharp_compliance,sharp_volume,connected,min_feature,seconds_tdf,seconds_factor,seconds_solve,"
    "seconds_sensitivity,seconds_optimizer,seconds_output";

void expect_history(const Table& history) {
  const Words& header = history[0];
  const auto column = [&](const char* name) {
    return static_cast<size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  ASSERT_GE(history.size(), 3u);
  for (size_t r = 1; r < history.size(); ++r) {
    const Words& row = history[r];
    ASSERT_EQ(row.size(), header.size());
    EXPECT_EQ(row[column("body")], "plate");
    EXPECT_EQ(row[column("iteration")], std::to_string(r));
    const double compliance = std::stod(row[column("compliance")]);
    EXPECT_NEAR(std::log(compliance), std::stod(row[column("objective")]), 1e-12);
    const bool sharp = r % 4 == 0;
    for (const char* name : {"sharp_compliance", "sharp_volume", "connected"})
      EXPECT_EQ(row[column(name)].empty(), !sharp) << name << " in row " << r;
  }
}

void expect_motion(const Table& motion) {
  EXPECT_EQ(motion[0], (Words{"time", "plate.tip_deflection", "plate.length", "energy.kinetic",
                              "energy.strain", "energy.defect"}));
  ASSERT_GE(motion.size(), 122u);  // 120 steps, the start and the header
  EXPECT_EQ(motion[1][0], "0");
  EXPECT_NEAR(std::stod(motion.back()[0]), 0.12, 1e-12);
  EXPECT_NEAR(std::stod(motion.back()[2]), 0.56, 1e-12);
}

void expect_run_json(const nlohmann::json& run) {
  for (const char* key : {"version", "libraries", "blas_kernel", "threads", "status",
                          "seconds_wall", "seconds_cpu", "peak_memory_bytes", "warnings"})
    EXPECT_TRUE(run.contains(key)) << key;
  EXPECT_EQ(run["status"], "done");
  EXPECT_EQ(run["threads"], 1);
  EXPECT_GT(run["peak_memory_bytes"].get<double>(), 1e6);
  ASSERT_EQ(run["results"].size(), 1u);
  const nlohmann::json& plate = run["results"][0];
  for (const char* key : {"compliance", "volume", "sharp_compliance", "sharp_volume",
                          "uniform_compliance", "connected", "min_feature", "dynamic_amplitude",
                          "uniform_dynamic_amplitude", "cycles", "iterations", "state_solves"})
    EXPECT_TRUE(plate.contains(key)) << key;
  EXPECT_EQ(plate["iterations"], 6);
  EXPECT_EQ(plate["cycles"], 1);
  EXPECT_EQ(plate["loads"], 12);
  for (const char* key : {"compliance", "uniform_compliance", "dynamic_amplitude"})
    EXPECT_GT(plate[key].get<double>(), 0) << key;
  ASSERT_EQ(run["motion"]["events"].size(), 1u);
  EXPECT_NEAR(run["motion"]["events"][0]["time"].get<double>(), 0.1, 1e-12);
}

TEST(Run, WritesItsFolder) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(scratch, short_run(folder));
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.err, "");

  for (const char* name :
       {"case.toml", "run.json", "history.csv", "motion.csv", "motion_uniform.csv",
        "design/iterations.pvd", "design/components.pvd", "motion/motion.pvd", "loads/plate.csv",
        "plots/convergence_plate.svg", "plots/deflection.svg", "plots/energies.svg",
        "plots/design.png", "report.html", "components.csv", "design.svg"})
    EXPECT_TRUE(fs::is_regular_file(folder + "/" + name)) << name;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();

  EXPECT_EQ(lines_of(contents_of(folder + "/history.csv"))[0], kHistoryHeader);
  const Table history = read_csv(folder + "/history.csv");
  expect_history(history);
  EXPECT_EQ(history.size(), 7u);
  for (const char* series : {"iterations", "components"}) {
    const std::string index = contents_of(folder + "/design/" + series + ".pvd");
    EXPECT_EQ(count(index, "<DataSet "), 6) << index;
  }
  EXPECT_EQ(count(contents_of(folder + "/motion/motion.pvd"), "<DataSet "), 4);  // 0, .04, .08, .12
  EXPECT_EQ(read_csv(folder + "/loads/plate.csv").size(), 13u);
  EXPECT_EQ(read_csv(folder + "/components.csv").size(), 25u);
  expect_motion(read_csv(folder + "/motion.csv"));
  expect_run_json(run_json(folder));

  // The case as it was run: it runs by itself, and checks the same.
  const Ended check = flexmorph(scratch, {"check", folder + "/case.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_TRUE(contains(check.out, "24 components, 168 variables, 112 x 20 cells"));
}

TEST(Run, WritesNothingTheSceneDidNotAskFor) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = flexmorph(
      scratch,
      short_run(folder, {"output.vtk=false", "output.plots=false", "optimizer.max_iterations=2"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  for (const char* name : {"design", "motion", "plots"})
    EXPECT_FALSE(fs::exists(folder + "/" + name)) << name;
  EXPECT_TRUE(fs::exists(folder + "/history.csv"));
}

/// Files of a folder that must not change from run to run, by their path in it.
std::map<std::string, std::string> lasting(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), folder).string();
    if (name == "run.json" || name == "report.html") continue;
    std::string text = contents_of(entry.path().string());
    if (name == "history.csv") {  // but for the seconds: the last six columns
      std::string kept;
      for (Words row : read_csv(entry.path().string())) {
        row.resize(row.size() - 6);
        for (const std::string& cell : row) kept += cell + ",";
        kept += "\n";
      }
      text = kept;
    }
    out[name] = text;
  }
  return out;
}

TEST(Run, RepeatsItselfByteForByte) {
  const Scratch scratch;
  const std::string first = scratch / "first", second = scratch / "second";
  ASSERT_EQ(flexmorph(scratch, short_run(first)).code, 0);
  // Into a folder that held another run: nothing of that one stays.
  ASSERT_EQ(flexmorph(scratch, short_run(second, {"optimizer.max_iterations=8"})).code, 0);
  ASSERT_EQ(flexmorph(scratch, short_run(second)).code, 0);
  const auto a = lasting(first), b = lasting(second);
  EXPECT_GT(a.size(), 25u);
  EXPECT_TRUE(a.contains("motion.csv") && a.contains("history.csv"));
  for (const auto& [name, text] : a) {
    ASSERT_TRUE(b.contains(name)) << name;
    EXPECT_TRUE(b.at(name) == text) << name;
  }
  EXPECT_EQ(a.size(), b.size());
}

// A hub that suddenly turns 16000 times a second tears the plate apart within a few steps.
TEST(Run, AFailureKeepsWhatCameBefore) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      flexmorph(scratch, short_run(folder, {"hub.angular_velocity=1e5", "time.start=rigid",
                                            "time.step=0.12", "body.elements=[5, 1]"}));
  EXPECT_EQ(ended.code, 3) << ended.out;
  EXPECT_TRUE(starts(ended.err, "flexmorph: "));
  const nlohmann::json run = run_json(folder);
  EXPECT_EQ(run["status"], "failed");
  const std::string message = run["message"];
  EXPECT_TRUE(contains(message, "step "));
  EXPECT_TRUE(contains(message, "t = "));
  EXPECT_TRUE(contains(ended.err, message));
  const Table motion = read_csv(folder + "/motion.csv");
  ASSERT_GE(motion.size(), 3u);
  EXPECT_EQ(motion[1][0], "0");
  for (size_t r = 1; r < motion.size(); ++r) EXPECT_EQ(motion[r].size(), motion[0].size());
  EXPECT_TRUE(fs::exists(folder + "/report.html"));
  EXPECT_TRUE(fs::exists(folder + "/case.toml"));
}

/// Waits until a file has so many lines; false after a minute.
bool has_lines(const std::string& path, size_t n) {
  for (int k = 0; k < 1200; ++k) {
    if (lines_of(contents_of(path)).size() >= n) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

TEST(Run, AnInterruptionKeepsWhatWasComputed) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const pid_t child = start(
      scratch, short_run(folder, {"optimizer.max_iterations=100000", "optimizer.kkt_tolerance=0"}));
  ASSERT_TRUE(has_lines(folder + "/history.csv", 4));
  kill(child, SIGINT);
  const Ended ended = end_of(scratch, child);
  EXPECT_EQ(ended.code, 4) << ended.err;
  const nlohmann::json run = run_json(folder);
  EXPECT_EQ(run["status"], "interrupted");
  const Table history = read_csv(folder + "/history.csv");
  expect_history(history);
  const std::string index = contents_of(folder + "/design/iterations.pvd");
  EXPECT_EQ(static_cast<size_t>(count(index, "<DataSet ")), history.size() - 1);
  // The best design so far, and the motion its loads came from.
  ASSERT_EQ(run["results"].size(), 1u);
  EXPECT_GT(run["results"][0]["sharp_compliance"].get<double>(), 0);
  EXPECT_EQ(read_csv(folder + "/components.csv").size(), 25u);
  expect_motion(read_csv(folder + "/motion.csv"));
  EXPECT_TRUE(fs::exists(folder + "/report.html"));
}

TEST(Run, AnInterruptionOfTheMotionKeepsItsSteps) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const pid_t child = start(scratch, short_run(folder, {"time.step=1e-6"}));
  ASSERT_TRUE(has_lines(folder + "/run.json", 3));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  kill(child, SIGINT);
  const Ended ended = end_of(scratch, child);
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_EQ(run_json(folder)["status"], "interrupted");
  const Table motion = read_csv(folder + "/motion.csv");
  ASSERT_GE(motion.size(), 3u);
  EXPECT_LT(std::stod(motion.back()[0]), 0.12);
}

}  // namespace
}  // namespace flexmorph
