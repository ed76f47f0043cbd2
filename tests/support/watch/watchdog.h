#pragma once

#include <functional>

namespace flexmorph::testing {

/// Runs the tests of a program in a child process, which is a new start of this program, and
/// watches it. Tests run with one thread and the BLAS kernels of the processor
/// (cases/process/processor.h).
///
/// A test that exceeds its time limit is named and killed, together with every process that it
/// started; each test has the full limit. A process that a test leaves behind is named and killed
/// within seconds, and the program fails. SIGTERM and SIGINT name the running test, kill everything
/// that it started and end the program. Standard input is /dev/null. If the watching process itself
/// ends, the kernel ends the child.
///
/// The time limit is FLEXMORPH_TEST_SECONDS [s of wall-clock time], kDefaultTestSeconds if the
/// variable is not set. FLEXMORPH_TEST_SECONDS=0 runs the tests in this process without a limit,
/// for debuggers.
///
/// @param argv  arguments of main(), for the new start
/// @param run_tests  initializes GoogleTest, runs the tests, returns the exit code (in the child)
/// @returns the exit code of the child process; 1 if it exceeded the limit or left a process behind
int run_watched(char** argv, const std::function<int()>& run_tests);

/// Kills every process that descends from this one and waits up to 10 s for their ends. A process
/// whose parent was killed becomes a child of this process (PR_SET_CHILD_SUBREAPER), so that none
/// is missed.
void kill_descendants();

/// Time limit of one test if FLEXMORPH_TEST_SECONDS is not set [s].
inline constexpr int kDefaultTestSeconds = 300;

}  // namespace flexmorph::testing
