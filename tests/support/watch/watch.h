#pragma once

#include <atomic>

/// Supervision of a program of tests by another process.
namespace flexmorph::testing {

/// Time limit of one test if FLEXMORPH_TEST_SECONDS is not set [s].
inline constexpr int kDefaultTestSeconds = 300;

/// Returns the time limit of one test, FLEXMORPH_TEST_SECONDS [s of wall-clock time]; 0: no limit.
double seconds_per_test();

/// The running test, in memory that the tests write and the watching process reads.
struct RunningTest {
  std::atomic<unsigned> number;  ///< Number of tests started so far.
  char name[256];                ///< Name "Suite.Test", empty between tests.
};

/// Environment variable of the watched program: the number of the open file with the RunningTest.
inline constexpr const char* kMemoryVariable = "FLEXMORPH_WATCHDOG_FILE";

/// Maps the memory that two processes share by an open file.
RunningTest* shared_memory(int file);

/// Starts a program of tests and watches it until it ends, as run_watched() says (watchdog.h).
/// @param program  file of the program
/// @param argv     its arguments, the first one is its name
/// @returns the exit code of the program; 1 if a test exceeded the limit or left a process behind
int watch_program(const char* program, char** argv);

/// Kills every process that descends from this one and waits up to 10 s for their ends. A process
/// whose parent was killed becomes a child of this process (PR_SET_CHILD_SUBREAPER), so that none
/// is missed.
void kill_descendants();

}  // namespace flexmorph::testing
