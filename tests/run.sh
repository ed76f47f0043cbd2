#!/bin/sh
# tests/run.sh [--all] [OPTION]...
# Installs missing packages, builds everything and runs the tests; options go to ctest, as in
# `tests/run.sh -L unit`. With --all the benchmarks too, which run the shipped cases with several
# optimizers, in a build of its own that a warning of the compiler stops. The last line says
# `N passed, N failed`; the exit code is 0 when at least one test ran and none failed.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/cases/cmake/setup.sh"

passed=0
failed=0
trap 'echo "$passed passed, $failed failed"' EXIT

if [ "${1-}" = --all ]; then
  shift
  preset=strict
  build="$root/build-strict"
  announce 29
  step 9 "runs all tests"
  step 15 "runs shipped cases with several optimizers, from the longest on, among them"
  build_targets all benchmarks
else
  case " $* " in
    *" -L "*) ;;
    *) set -- -LE benchmark "$@" ;;
  esac
  announce 27
  step 9 "runs all tests but the benchmarks (--all)"
  build_targets all
fi

# Tests run side by side, each with one thread: tests/support/test_main.cpp.
log="$build/tests.log"
ctest --test-dir "$build" --parallel "$cores" --output-on-failure "$@" 2>&1 | tee "$log"

# ctest sums up: "98% tests passed, 1 tests failed out of 57".
summary='^[0-9]*% tests passed, \([0-9]*\) tests failed out of \([0-9]*\)$'
counts=$(sed -n "s/$summary/\1 \2/p" "$log")
failed=${counts:+${counts% *}}
failed=${failed:-0}
passed=$((${counts#* } - failed))
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
