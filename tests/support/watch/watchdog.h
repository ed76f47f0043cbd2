#pragma once

#include <functional>

namespace flexmorph::testing {

/// Runs the tests of a program and watches them: in this process if the program `watched` started
/// it, as ctest does (watched.cpp), else in a child process, which is a new start of this program.
/// Tests run with one thread and the BLAS kernels of the processor
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
/// @param run_tests  initializes GoogleTest, runs the tests, returns the exit code
/// @returns the exit code of the tests; 1 if it exceeded the limit or left a process behind
int run_watched(char** argv, const std::function<int()>& run_tests);

}  // namespace flexmorph::testing
