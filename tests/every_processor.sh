#!/bin/sh
# tests/every_processor.sh [--builds LIST] [--kernels LIST] [--disturbances N] [--all]
# Runs the tests with the round-off of other processors: builds (release, uncontracted) times
# kernels of OpenBLAS, each with the vector registers of its processors (geometry/vector_level.h);
# then the first build with tests that integrate or optimize from starts disturbed by 1e-13 (five
# disturbances unless given; tests/support/disturbance.h). Without --builds and --kernels: release
# with Haswell, Zen, SkylakeX, Sandybridge and Prescott. --all adds the benchmarks: shipped cases
# with [expect].
#
# A row per run is printed and written to every_processor.md in the folder of the builds: verdicts,
# and how many numbers printed by tests differ from those of the first run. A kernel whose
# instructions the processor lacks is named and skipped. On two cores a build takes about fourteen
# minutes, a run of the tests about four. The last line says `N passed, N failed`, the numbers of
# runs.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/cases/cmake/setup.sh"
with_tests=1
export FLEXMORPH_TEST_SECONDS=300  # limit of one test, not of a program

builds=release
kernels=
disturbances=5
all=0
while [ $# -gt 0 ]; do
  case "$1" in
    --builds) builds=$2 && shift ;;
    --kernels) kernels=$2 && shift ;;
    --disturbances) disturbances=$2 && shift ;;
    --all) all=1 ;;
    -h | --help) sed -n '2,/^set -eu/s/^# //p' "$0" && exit 0 ;;
    *) sed -n '2p' "$0" >&2 && exit 2 ;;
  esac
  shift
done
folder="$root/build-every-processor"
mkdir -p "$folder"
table="$folder/every_processor.md"
passed=0
failed=0
first=
trap 'echo "$passed passed, $failed failed"' EXIT

# runs_here KERNEL : tests whether this processor has the instructions of the kernel.
runs_here() {
  case "$1" in
    SkylakeX | Cooperlake | SapphireRapids) word=avx512vl ;;
    Haswell | Zen) word=avx2 ;;
    Sandybridge) word=avx ;;
    *) return 0 ;;
  esac
  grep -m 1 '^flags' /proc/cpuinfo | grep -qw "$word"
}

# vectors_of KERNEL : prints the vector level of the processors that use these kernels.
vectors_of() {
  case "$1" in
    SkylakeX | Cooperlake | SapphireRapids) echo v4 ;;
    Haswell | Zen) echo v3 ;;
    *) echo baseline ;;
  esac
}

# The build `release` is the build folder of tests/run.sh.
folder_of() {
  if [ "$1" = release ]; then echo "$build"; else echo "$folder/$1"; fi
}
options() {
  case "$1" in
    release) ;;
    uncontracted) echo -DCMAKE_CXX_FLAGS=-ffp-contract=off ;;
    *) echo "every_processor.sh: builds are release, uncontracted" >&2 && exit 2 ;;
  esac
}

# moved FIRST OTHER : counts numbers at equal positions of equal tests in two logs that differ by
# more than 1e-6 of their value. Run times are left out, and values below 1e-9, which are round-off.
moved() {
  awk '
    function numbers(line, list,    n) {
      n = 0
      while (match(line, /[-+]?[0-9]+\.[0-9]+(e[-+]?[0-9]+)?/)) {
        list[++n] = substr(line, RSTART, RLENGTH) + 0
        line = substr(line, RSTART + RLENGTH)
      }
      return n
    }
    /^\[ RUN/ { test = $4 }
    /^\[/ || / ms\)?$|CPU|seconds|\/tmp\/|vtk/ { next }
    {
      n = numbers($0, x)
      for (i = 1; i <= n; ++i) {
        at = test " " ++count[FILENAME, test]
        if (FILENAME == ARGV[1]) value[at] = x[i]
        else if (at in value) {
          size = value[at] < 0 ? -value[at] : value[at]
          off = x[i] - value[at]
          off = off < 0 ? -off : off
          ++n_seen
          if (size > 1e-9 && off > 1e-6 * size) {
            ++n_moved
            if (off / size > most[test]) most[test] = off / size
          }
        }
      }
    }
    END {
      for (k in most) {
        ++tests
        for (r = 1; r <= 3; ++r)
          if (!best[r] || most[k] > most[best[r]]) {
            for (s = 3; s > r; --s) best[s] = best[s - 1]
            best[r] = k
            break
          }
      }
      printf "%d of %d numbers, in %d tests", n_moved, n_seen, tests
      for (r = 1; r <= 3; ++r)
        if (best[r]) printf "%s%s by %.2g", r == 1 ? "; most: " : ", ", best[r], most[best[r]]
    }' "$1" "$2"
}

# programs BUILD : prints the test programs, large ones first; for disturbed starts only those that
# use them.
programs() {
  find "$(folder_of "$1")/tests" -type f -perm -u+x \
    \( -name '*_test' -o -name '*_tests' -o -name '*_convergence' \) -printf '%s %p\n' |
    sort -rn | cut -d ' ' -f 2 | while read -r program; do
      case "$program" in
        *shipped_cases* | *comparison_tests) [ "$all" = 1 ] || continue ;;
      esac
      [ -z "${FLEXMORPH_DISTURBANCE-}" ] || grep -q FLEXMORPH_DISTURBANCE "$program" || continue
      echo "$program"
    done
}

# run NAME BUILD : makes one row of the table. Test programs run as a whole, because starting each
# of 1700 tests separately takes as long as the tests.
run() {
  log="$folder/$1.log"
  rm -rf "$folder/$1" && mkdir "$folder/$1"
  programs "$2" |
    xargs -P "$cores" -I{} sh -c '"$1" >"$2/${1##*/}" 2>&1 || echo "$1 ended with $?" >>"$2/${1##*/}"' \
      sh {} "$folder/$1"
  cat "$folder/$1"/* >"$log"
  n=$(grep -c '^\[       OK' "$log" || true)
  bad=$(sed -n -e 's/^\[  FAILED  \] \([^ ,]*\).* ms)$/\1/p' -e 's/^\(.*\) ended with \(.*\)/\1 (\2)/p' "$log")
  if [ "$n" -gt 0 ] && [ -z "$bad" ]; then
    passed=$((passed + 1))
    verdict="all $n pass"
  else
    failed=$((failed + 1))
    verdict="failed: $(echo "$bad" | paste -sd ' ')"
  fi
  if [ -z "$first" ]; then
    first=$log
    echo "| $1 | $verdict | (the others are compared with this one) |" | tee -a "$table"
  else
    echo "| $1 | $verdict | $(moved "$first" "$log") |" | tee -a "$table"
  fi
}

echo "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(date +%F)" >"$table"
printf '\n| build, kernels | verdicts | moved by more than 1e-6 |\n| --- | --- | --- |\n' >>"$table"
install_packages
for name in $(echo "$builds" | tr "," " "); do
  at=$(folder_of "$name")
  # shellcheck disable=SC2046  # words
  cmake -S "$root" -B "$at" -G Ninja -DCMAKE_BUILD_TYPE=Release -DFLEXMORPH_TESTS=ON \
    $(options "$name") >/dev/null
  cmake --build "$at" --parallel "$cores" >"$folder/$name.log"
  for kernel in $(echo "${kernels:-Haswell,Zen,SkylakeX,Sandybridge,Prescott}" | tr ',' ' '); do
    if runs_here "$kernel"; then
      export OPENBLAS_CORETYPE="$kernel" FLEXMORPH_VECTORS="$(vectors_of "$kernel")"
      run "$name-$kernel" "$name"
    else
      echo "| $name-$kernel | skipped: this processor lacks its instructions | |" | tee -a "$table"
    fi
  done
done
unset OPENBLAS_CORETYPE FLEXMORPH_VECTORS
k=1
while [ "$k" -le "$disturbances" ]; do
  export FLEXMORPH_DISTURBANCE="$k"
  run "${builds%%,*}-disturbed-$k" "${builds%%,*}"
  k=$((k + 1))
done
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
