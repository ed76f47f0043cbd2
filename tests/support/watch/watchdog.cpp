#include "tests/support/watch/watchdog.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "cases/process/processor.h"
#include "tests/support/watch/watch.h"

namespace flexmorph::testing {
namespace {

/// Writes the name of each test into the shared memory when the test starts.
class NameListener : public ::testing::EmptyTestEventListener {
 public:
  explicit NameListener(RunningTest& running) : running_(running) {}

 private:
  void OnTestStart(const ::testing::TestInfo& info) override {
    std::snprintf(running_.name, sizeof running_.name, "%s.%s", info.test_suite_name(),
                  info.name());
    ++running_.number;
  }

  RunningTest& running_;
};

}  // namespace

int run_watched(char** argv, const std::function<int()>& run_tests) {
  if (const int null = open("/dev/null", O_RDONLY); null >= 0) {
    dup2(null, STDIN_FILENO);
    close(null);
  }
  const char* const number = std::getenv(kMemoryVariable);
  if (!number && seconds_per_test() > 0) return watch_program("/proc/self/exe", argv);
  set_up_processor(1, argv);
  if (number) {
    const int file = static_cast<int>(std::strtol(number, nullptr, 10));
    RunningTest* const running = shared_memory(file);
    close(file);
    unsetenv(kMemoryVariable);
    ::testing::UnitTest::GetInstance()->listeners().Append(new NameListener(*running));
  }
  return run_tests();
}

}  // namespace flexmorph::testing
