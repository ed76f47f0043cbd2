// Tests whose behaviour the watchdog (tests/support/watch/watchdog.h) must detect;
// watchdog_test.cmake runs each in a separate process.

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace {

TEST(Subject, Passes) { EXPECT_EQ(getchar(), EOF) << "standard input is /dev/null"; }

TEST(Subject, Hangs) {
  for (;;) pause();
}

TEST(Subject, LeavesAProcess) { EXPECT_EQ(std::system("setsid sleep 1000 &"), 0); }

TEST(Subject, IgnoresTheEnd) {
  EXPECT_EQ(std::system("trap '' TERM INT HUP; setsid sleep 1000; sleep 1000"), 0);
}

TEST(Subject, EndsByASignal) {
  signal(SIGSEGV, SIG_DFL);  // sanitizers handle the signal
  raise(SIGSEGV);
}

}  // namespace
