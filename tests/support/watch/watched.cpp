// watched PROGRAM ARGUMENT... : runs a program of tests with a limit for the time of each test, see
// watch.h. ctest starts all programs of tests in this way: this program loads no library, so that
// the libraries of the tests are loaded once per test.
#include <cstdio>

#include "tests/support/watch/watch.h"

int main(int argc, char** argv) {
  if (argc > 1) return flexmorph::testing::watch_program(argv[1], argv + 1);
  std::fputs("usage: watched PROGRAM ARGUMENT...\n", stderr);
  return 2;
}
