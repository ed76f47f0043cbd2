#!/bin/sh
# tests/strict.sh : compiles everything with clang, reads every file of the program with clang-tidy,
# and takes every warning of either as an error (preset `tidy`, build-tidy/). It needs Debian's
# clang-16, clang-tidy-16 and libomp-16-dev, because clang 14 has no std::source_location.
set -eu
cd "$(dirname "$0")/.."
case "${1-}" in
  "") ;;
  *) sed -n '2,/^set -eu/s/^# //p' tests/strict.sh && exit 2 ;;
esac
cmake --preset tidy -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
exec cmake --build --preset tidy
