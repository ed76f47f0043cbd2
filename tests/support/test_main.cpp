// main() of every test program.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/watchdog.h"

namespace {

/// Every test has the same random numbers (Eigen's Random()), whatever ran before it.
class SeedForEveryTest : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo&) override { std::srand(1); }
};

}  // namespace

int main(int argc, char** argv) {
  return flexmorph::testing::run_watched(argv, [&] {
    testing::InitGoogleTest(&argc, argv);
    testing::UnitTest::GetInstance()->listeners().Append(new SeedForEveryTest);  // which owns it
    return RUN_ALL_TESTS();
  });
}
