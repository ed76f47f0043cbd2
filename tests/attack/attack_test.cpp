// Shows that inputs which are changed at random are read and built, or refused with an Error: no
// other exception, no crash, and no endless computation. Each input has a limit of processor time
// far above that of any regular input, which grows with the elements of its meshes.
//
//   FLEXMORPH_ATTACKS=100000 nice build/tests/attack/attack_tests   number of cases, default 400;
//                                                                   of other inputs five times as
//                                                                   many
//   FLEXMORPH_SEED=2                                                seed of the changes, default 1
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "cases/assembly/build.h"
#include "cases/check/check.h"
#include "cases/check/ready.h"
#include "cases/scene/scene.h"
#include "geometry/sanitizers.h"
#include "io/case_files/formula.h"
#include "io/drawings/exports.h"
#include "io/smooth_table.h"
#include "io/tables.h"
#include "tests/attack/mutations.h"
#include "tests/attack/run_files.h"
#include "tests/io/scratch.h"

namespace flexmorph {
namespace {

using testing::Mutations;
using testing::number_of;

constexpr double kSlow = kSanitized ? 50 : 1;
constexpr double kLongest = 10 * kSlow;  // processor time for one input [s]
// Additional processor time for each element of a requested mesh, because elements are built [s].
constexpr double kPerElement = 2e-3 * kSlow;
// Allowed growth of memory in use [bytes]: what malloc keeps of the largest inputs varies by this
// much; a leak of 100 bytes per input appears after 1e6 inputs. The address sanitizer keeps 256 MB
// of freed memory, and detects leaks by itself.
constexpr double kGrowth = kSanitized ? 1e9 : 100e6;

/// Returns the memory in use [bytes].
double memory_in_use() {
  std::ifstream status("/proc/self/statm");
  double mapped = 0, used = 0;
  status >> mapped >> used;
  return used * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Tests many inputs, as texts and (if `ending` is not empty) as files.
class Attack : public ::testing::Test {
 protected:
  /// @param elements  returns the elements of the meshes that an input requests; called only for an
  /// input that takes long
  template <class Make, class Try>
  void run(const std::string& ending, size_t share, const Make& make, const Try& attempt,
           const std::function<double(const std::string&)>& elements = {}) {
    const size_t n = number_of("FLEXMORPH_ATTACKS", 400) * share,
                 seed = number_of("FLEXMORPH_SEED", 1);
    size_t accepted = 0, refused = 0;
    double before = 0, longest = 0;
    for (size_t i = 0; i < n; ++i) {
      if (i == n / 10) before = memory_in_use();  // memory of the first inputs stays in use
      Mutations random(1'000'003 * seed + i);
      const std::string text = make(random);
      const std::string file = ending.empty() ? "" : scratch_.write("input" + ending, text);
      const std::clock_t begin = std::clock();
      try {
        attempt(file, text);
        ++accepted;
      } catch (const Error& e) {
        ++refused;
        EXPECT_STRNE(e.what(), "");
      } catch (const std::exception& e) {
        report(i, text, std::string("throws ") + e.what());
      }
      const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      longest = std::max(longest, seconds);
      if (seconds > kLongest &&
          seconds > kLongest + (elements ? kPerElement * elements(file) : 0.0))
        report(i, text, "takes " + std::to_string(seconds) + " s");
    }
    const double grown = memory_in_use() - before;
    std::printf(
        "%zu inputs: %zu accepted, %zu refused; the longest took %.3f s; memory in use has "
        "grown by %.1f MB since a tenth of them\n",
        n, accepted, refused, longest, grown / 1e6);
    EXPECT_LT(grown, kGrowth) << "memory leaks";
    // An attack whose inputs are always refused, or always accepted, tests only one side of the
    // checks.
    EXPECT_GT(accepted, n / 100);
    EXPECT_GT(refused, n / 100);
  }

 private:
  void report(size_t i, const std::string& text, const std::string& what) const {
    const auto kept =
        std::filesystem::temp_directory_path() /
        ("flexmorph_attack_" + std::to_string(getpid()) + "_" +
         ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + std::to_string(i));
    std::ofstream(kept, std::ios::binary) << text;
    ADD_FAILURE() << "input " << i << " " << what << "; kept as " << kept;
  }

  Scratch scratch_;
};

std::vector<std::string> shipped_cases() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(FLEXMORPH_CASES))
    if (entry.path().extension() == ".toml") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> out;
  for (const auto& path : paths) out.push_back(contents_of(path.string()));
  return out;
}

TEST_F(Attack, Cases) {
  const std::vector<std::string> cases = shipped_cases();
  ASSERT_GT(cases.size(), 10U);
  run(
      ".toml", 1,
      [&](Mutations& random) {
        const std::string& text = cases[random.below(cases.size())];
        return random.changed(text, cases[random.below(cases.size())]);
      },
      [](const std::string& file, const std::string&) {
        cases::read_scene(io::CaseFile(file, {}));
      });
}

// Tests what `check` does after reading: bodies, joints, the start.
TEST_F(Attack, CasesAsCheckBuildsThem) {
  const std::vector<std::string> cases = shipped_cases();
  run(
      ".toml", 1,
      [&](Mutations& random) {
        const std::string& text = cases[random.below(cases.size())];
        return random.below(4) == 0 ? random.changed(text, text)
                                    : random.changed(text, "0.5 1 2 0.01 -1");
      },
      [](const std::string& file, const std::string&) { cases::check_case(file, {}, false); },
      [](const std::string& file) {
        double sum = 0;
        for (const cases::Body& body : cases::read_scene(io::CaseFile(file, {})).bodies)
          sum += double(body.elements[0]) * std::max(1, body.elements[1]);
        return sum;
      });
}

// Regression test for errors found by mutations: a crash, gigabytes of memory for a check, drives
// that were followed endlessly.
TEST(Found, InputsAreReadOrRefused) {
  const std::vector<std::array<std::string, 2>> found = {
      {"l_bracket", "domain.polygon=[0.0,0.0, 1.0,0.0, 1.0,0.4, 0.4,0.4, 0.4,1.0, 0.0,1e308]"},
      {"short_beam", "domain.size=[1e3, 1.0]"},
      {"short_beam", "domain.size=[2.0, 1e3]"},
      {"bridge", "domain.size=[1e3, 1.0]"},
      {"short_beam", "design.components=[6, 1000]"},
      {"heated_boom_held", "hub.angular_velocity=100000"},
      {"motion_platform",
       "drive.1.formula='0.5*sin(pi - (-100000*pi*(t - 1/2)^3 + 3/2*pi*t - pi/4)) + 0.4'"}};
  for (const auto& [name, change] : found) {
    const std::clock_t begin = std::clock();
    try {
      cases::check_case(name, std::vector<std::string>{change}, false);
    } catch (const Error& error) {
      EXPECT_STRNE(error.what(), "");
    }
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, kLongest) << change;
  }
  EXPECT_LT(memory_in_use(), 2e9);
}

TEST_F(Attack, Formulas) {
  run(
      "", 5,
      [](Mutations& random) {
        const std::string formula = random.formula(1 + static_cast<int>(random.below(5)));
        return random.below(5) == 0 ? random.changed(formula, "((3)^(999999))^99 t*t*t sin(")
                                    : formula;
      },
      [](const std::string&, const std::string& text) {
        const io::Formula formula(text, {{"a", 0.7}});
        formula.check(1.5);
        formula.first_jump(1.5);
      });
}

TEST_F(Attack, Components) {
  const std::string table =
      "X0,Y0,half_length,angle,c1,c2,c3\n0.1,0.2,0.5,0,0.1,0.1,0.1\n0.3,0.2,0.5,0.3,0.1,0.2,0.1\n";
  run(
      ".csv", 5, [&](Mutations& random) { return random.changed(table, table); },
      [](const std::string& file, const std::string&) {
        const std::vector<Component> found = io::read_components_csv(file);
        io::write_components_csv(file + ".again", found);
        const std::vector<Component> again = io::read_components_csv(file + ".again");
        ASSERT_EQ(again.size(), found.size());
        for (size_t k = 0; k < found.size(); ++k)
          EXPECT_EQ(again[k].parameters(), found[k].parameters());
      });
}

TEST_F(Attack, Tables) {
  const std::string table = "time,x\n0,0\n0.1,0.2\n0.2,0.1\n0.3,0.7\n0.4,1\n0.5,1.5\n1,2\n";
  run(
      ".csv", 5,
      [&](Mutations& random) { return random.changed(table, "1e-9 1e308 0.1 0.3\n0,0\n"); },
      [](const std::string& file, const std::string& text) {
        const io::CsvTable csv = io::read_csv(file);
        const auto times = csv.numbers("time"), values = csv.numbers("x");
        const io::SmoothTable smooth(times, values);
        double largest = 0;
        for (const double value : values) largest = std::max(largest, std::abs(value));
        for (size_t k = 0; k < times.size(); ++k)
          EXPECT_NEAR(smooth(times[k]).value, values[k], 1e-6 * largest) << text;
      });
}

}  // namespace
}  // namespace flexmorph
