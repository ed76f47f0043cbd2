// Shows that a run in a limited address space (ulimit -v) which does not fit is refused with
// numbers or ends with a sentence; no run hangs, and none reports an "unexpected" error.
//
//   FLEXMORPH_LIMITS=12 build/tests/attack/attack_tests --gtest_filter='LongMemory.*'
//   number of limits between the least in which the program starts and 3.9 GB, default 3
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "cases/process/blas_buffers.h"
#include "geometry/sanitizers.h"
#include "tests/attack/run_files.h"
#include "tests/io/scratch.h"
#include "tests/support/child_program.h"

extern "C" void* blas_memory_alloc(int purpose);  // of OpenBLAS
extern "C" void blas_memory_free(void* buffer);

namespace flexmorph {
namespace {

using testing::ChildEnd;
using testing::ChildProgram;
using Words = std::vector<std::string>;

struct Large {
  const char* name;
  Words words;
};

std::vector<Large> large_runs() {
  const std::string short_case = FLEXMORPH_SHORT_CASE;
  return {
      {"cells of 5 mm, two threads",
       {"short_beam", "--set", "design.cell=0.005", "--set", "design.min_feature=0", "--set",
        "optimizer.max_iterations=1", "--threads", "2"}},
      {"cells of 2.5 mm, and nothing but the start",
       {"short_beam", "--set", "design.cell=0.0025", "--set", "optimizer.max_iterations=0"}},
      {"a growing plate of 40 x 20 elements",
       {"rotating_plate_v01", "--set", "design=", "--set", "optimizer=", "--set", "cycle=", "--set",
        "verify=", "--set", "esl=", "--set", "accuracy=", "--set", "body.elements=[40,20]", "--set",
        "body.flow.max_length=0.02", "--set", "time.end=0.003"}},
      {"a load every two milliseconds on cells of 1 mm",
       {short_case, "--set", "esl.every=0.002", "--set", "design.cell=0.001", "--set",
        "optimizer.max_iterations=1"}}};
}

/// Returns the least address space [bytes], within a factor of 1.3, in which the program starts:
/// its libraries are loaded and main() runs. With OpenCASCADE they map 230 MB. OpenBLAS of Debian
/// 13 maps its first buffer of 128 MiB while it is loaded, and retries endlessly if that fails.
double least_address_space(const Scratch& scratch) {
  for (double bytes = 2.6e8; bytes < 2e9; bytes *= 1.3)
    if (ChildProgram({FLEXMORPH_PROGRAM, "cases"}, scratch / "", {.address_space = bytes})
            .end(5)
            .code == 0)
      return bytes;
  return 0;
}

/// Runs with `n` limits between the least address space and `largest` [bytes].
void expect_sentences(const std::vector<Large>& runs, size_t n, double largest) {
  const Scratch scratch;
  ASSERT_GT(n, 1u);
  const double least = least_address_space(scratch);
  ASSERT_GT(least, 0) << "the program does not begin in 2 GB";
  std::printf("The program begins in %.0f MB.\n", least / 1e6);
  for (const Large& run : runs) {
    std::map<int, int> codes;
    for (size_t k = 0; k < n; ++k) {
      // Uniformly distributed in the logarithm.
      const double bytes =
          least * std::pow(largest / least, static_cast<double>(k) / static_cast<double>(n - 1));
      const std::string what = std::string(run.name) + " in " + std::to_string(bytes / 1e6) + " MB";
      Words words = {FLEXMORPH_PROGRAM, "run"};
      words.insert(words.end(), run.words.begin(), run.words.end());
      const std::string folder = scratch / "run";
      words.insert(words.end(), {"--set", "expect=", "-o", folder, "--quiet"});
      const ChildEnd end = ChildProgram(words, scratch / "", {.address_space = bytes}).end();
      ++codes[end.code];
      EXPECT_FALSE(end.timed_out) << what;
      EXPECT_TRUE(end.code == 0 || end.code == 2 || end.code == 3 || end.code == 5)
          << what << ": exit code " << end.code << ", signal " << end.signal << "\n"
          << end.err;
      if (end.code == 2 || end.code == 3) {
        EXPECT_TRUE(contains(end.err, "flexmorph: ")) << what;
      }
      EXPECT_FALSE(contains(end.err, "unexpected")) << what;
      if (std::filesystem::exists(folder)) {
        EXPECT_EQ(testing::broken_files(folder), "") << what;
      }
      std::filesystem::remove_all(folder);
    }
    std::string counts;
    for (const auto& [code, count] : codes)
      counts += ", exit code " + std::to_string(code) + ": " + std::to_string(count);
    std::printf("%s, %zu limits%s\n", run.name, n, counts.c_str());
  }
}

// Within the larger limit some runs fit, and others are refused.
TEST(Archive, EndsWithASentence) {
  if (kSanitized) GTEST_SKIP() << "sanitizers map terabytes";
  expect_sentences(large_runs(), 2, 8e8);
}

TEST(LongMemory, EndsWithASentence) {
  if (kSanitized) GTEST_SKIP() << "sanitizers map terabytes";
  std::vector<Large> runs = large_runs();
  runs.push_back(
      {"cells of 5 mm, with fillets",
       {"short_beam", "--set", "design.cell=0.005", "--set", "optimizer.max_iterations=2"}});
  expect_sentences(runs, testing::number_of("FLEXMORPH_LIMITS", 3), 3.9e9);
}

/// Returns the address space mapped by this process [bytes].
double mapped() {
  std::ifstream status("/proc/self/statm");
  double pages = 0;
  status >> pages;
  return pages * 4096;
}

// kBlasBuffer is the buffer size of the BLAS library in use: the reserved buffers are enough for
// this number of simultaneous calls, and no further memory is mapped for them.
TEST(Archive, ReservedBuffersAreThoseOfBlas) {
  const double before = mapped();
  reserve_blas(3);
  const double reserved = mapped();
  EXPECT_LE(reserved - before, 3 * kBlasBuffer + 2 * 80e6);  // stacks and arenas of threads
  // OpenBLAS keeps every buffer: if the test is repeated, buffers of the previous test exist as
  // well.
  std::vector<void*> buffers;
  while (buffers.size() < 50 && mapped() <= reserved) buffers.push_back(blas_memory_alloc(0));
  EXPECT_GE(buffers.size(), 3u + 1);  // the last one was not reserved
  EXPECT_GT(mapped(), reserved);
  EXPECT_LE(mapped(), reserved + kBlasBuffer);
  for (void* buffer : buffers) blas_memory_free(buffer);
}

}  // namespace
}  // namespace flexmorph
