// Shows that tasks are done in their order, that all of them are done before wait() returns, and
// that the caller gets the exception of a task.
#include "io/background.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace flexmorph::io {
namespace {

class EveryBackground : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(OwnThread, EveryBackground, ::testing::Bool());

TEST_P(EveryBackground, KeepsTheOrder) {
  std::vector<int> done;
  {
    Background background(GetParam());
    for (int k = 0; k < 100; ++k) background.then([&done, k] { done.push_back(k); });
    background.wait();
    ASSERT_EQ(done.size(), 100u);
    for (int k = 0; k < 100; ++k) EXPECT_EQ(done[static_cast<size_t>(k)], k);
    background.then([&done] { done.push_back(100); });
  }
  EXPECT_EQ(done.size(), 101u);  // the destructor waits, too
}

TEST_P(EveryBackground, TellsWhatATaskThrew) {
  std::atomic<int> done = 0;
  Background background(GetParam());
  bool told = false;
  try {
    background.then([] { throw std::runtime_error("a full disk"); });
    background.wait();
  } catch (const std::runtime_error& error) {
    told = true;
    EXPECT_STREQ(error.what(), "a full disk");
  }
  EXPECT_TRUE(told);
  // The exception is thrown once: later tasks are executed.
  background.then([&done] { ++done; });
  background.wait();
  EXPECT_EQ(done, 1);
}

TEST(Background, DropsTasksAfterAFailure) {
  std::atomic<int> done = 0;
  std::atomic<bool> may_fail = false;
  Background background(true);
  background.then([&may_fail] {
    while (!may_fail) std::this_thread::yield();
    throw std::runtime_error("a full disk");
  });
  for (int k = 0; k < 3; ++k) background.then([&done] { ++done; });
  may_fail = true;
  EXPECT_THROW(background.wait(), std::runtime_error);
  EXPECT_EQ(done, 0);
  background.wait();
}

}  // namespace
}  // namespace flexmorph::io
