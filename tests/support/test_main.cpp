// main() of every test program.
#include <gtest/gtest.h>

#include "geometry/processor.h"
#include "tests/support/watchdog.h"

int main(int argc, char** argv) {
  flexmorph::settle_processor(1, argv);
  return flexmorph::testing::run_watched([&] {
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
  });
}
