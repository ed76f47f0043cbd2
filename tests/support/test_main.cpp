// main() of every program of tests.
#include <gtest/gtest.h>

#include "geometry/processor.h"

int main(int argc, char** argv) {
  flexmorph::settle_processor(1, argv);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
