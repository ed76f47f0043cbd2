// main() of every test program.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/watch/watchdog.h"

namespace {

/// Resets the random numbers (Eigen's Random()) before each test, so that they do not depend on the
/// tests that ran before.
class SeedForEveryTest : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo&) override { std::srand(1); }
};

}  // namespace

int main(int argc, char** argv) {
  return flexmorph::testing::run_watched(argv, [&] {
    testing::InitGoogleTest(&argc, argv);
    testing::UnitTest::GetInstance()->listeners().Append(new SeedForEveryTest);  // takes ownership
    return RUN_ALL_TESTS();
  });
}
