#!/bin/sh
# tests/run.sh [OPTION]...
# Installs missing packages, builds everything and runs all tests; options go to ctest, as in
# `tests/run.sh -L unit`. The last line says `N passed, N failed`; the exit code is 0 when at least
# one test ran and none failed.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/cases/cmake/setup.sh"

passed=0
failed=0
trap 'echo "$passed passed, $failed failed"' EXIT

build_target all

# Tests run side by side; threads inside each of them would only compete. (nproc itself counts no
# more than OMP_THREAD_LIMIT.)
jobs=$(nproc)
export OMP_THREAD_LIMIT=1 OPENBLAS_NUM_THREADS=1
log="$build/tests.log"
ctest --test-dir "$build" --parallel "$jobs" --output-on-failure "$@" 2>&1 | tee "$log"

# ctest sums up: "98% tests passed, 1 tests failed out of 57".
summary='^[0-9]*% tests passed, \([0-9]*\) tests failed out of \([0-9]*\)$'
counts=$(sed -n "s/$summary/\1 \2/p" "$log")
failed=${counts:+${counts% *}}
failed=${failed:-0}
passed=$((${counts#* } - failed))
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
