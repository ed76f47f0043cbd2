#!/bin/sh
# tests/sanitize.sh [debug | thread] : builds with sanitizers and runs the tests of tests/run.sh.
# debug: addresses, undefined behaviour and assertions (build-debug/). thread: data races, with clang
# (build-thread/); it needs Debian's clang-16, libclang-rt-16-dev and libomp-16-dev.
set -eu
cd "$(dirname "$0")/.."
preset=${1-debug}
case "$preset" in
  debug | thread) ;;
  *) sed -n '2,/^set -eu/s/^# //p' tests/sanitize.sh && exit 2 ;;
esac
cmake --preset "$preset"
cmake --build --preset "$preset"
exec ctest --preset "$preset" -j "$(nproc)"
