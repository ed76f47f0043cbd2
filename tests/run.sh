#!/bin/sh
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
usage() {
  cat <<TEXT
tests/run.sh [--gate | --all] [OPTION]...
Installs missing packages, builds everything and runs the tests.
  (nothing)  tests with the labels unit, convergence, attack and install
  --gate     the same tests, built from nothing in build-gate/; a warning of the compiler or a
             skipped test that tests/skips.txt does not list is a failure
  --all      also the labels long, service (daemons, browsers, other hosts) and benchmark
  OPTION     option of ctest: -L, -LE, -R, -E, -I, --repeat (each with a value), -V,
             --rerun-failed, --stop-on-failure, --schedule-random; -L and -LE given several times
             name several labels
The whole command has a time limit: FLEXMORPH_MINUTES, by default 60 (--all: 100, or 220 where
debootstrap is installed). After it the tests that have begun and not ended are named and killed,
and what did not run has failed.
The last line says "N passed, N failed, N skipped"; the exit code is 0 if at least one test passed
and none failed.
TEXT
}
wrong() { echo "tests/run.sh: $1" >&2 && usage >&2 && exit 2; }

# Arguments are read before anything is installed or built.
mode=
case "${1-}" in
  --gate | --all) mode=${1#--} && shift ;;
esac
excluded='benchmark|service|long'
[ "$mode" != all ] || excluded=
chosen=  # labels named by -L; their tests run whatever other labels they have
others=  # labels named by -LE
n=$#
while [ "$n" -gt 0 ]; do
  option=$1
  shift
  n=$((n - 1))
  case "$option" in
    -h | --help) usage && exit 0 ;;
    -L | -LE | -R | -E | -I | --repeat)
      [ "$n" -gt 0 ] || wrong "'$option' needs a value"
      case "$option" in
        -L) chosen="$chosen${chosen:+|}$1" ;;
        -LE) others="$others${others:+|}$1" ;;
        *) set -- "$@" "$option" "$1" ;;
      esac
      shift
      n=$((n - 1))
      ;;
    -V | --rerun-failed | --stop-on-failure | --schedule-random) set -- "$@" "$option" ;;
    *) wrong "unknown option '$option'" ;;
  esac
done
if [ -n "$chosen" ]; then excluded= && set -- "$@" -L "$chosen"; fi
# If given several times, -L would select and -LE would exclude only tests that have all labels.
excluded="$excluded${excluded:+${others:+|}}$others"
[ -z "$excluded" ] || set -- "$@" -LE "$excluded"

. "$root/cases/cmake/setup.sh"
with_tests=1
targets=all
limit=60
case "$mode" in
  gate) build="$root/build-gate" && rm -rf "$build" ;;
  all)
    limit=100 targets='all benchmarks'
    # Tests in bare root folders (tests/bare_root.sh) build everything two more times.
    if [ "$(id -u)" = 0 ] && command -v debootstrap >/dev/null; then limit=220; fi
    ;;
esac
check_build_folder
check_disk 4
mkdir -p "$build"
end=$(($(date +%s) + 60 * ${FLEXMORPH_MINUTES:-$limit}))
# Seconds until the time limit of the whole command, at least 5.
left() {
  s=$((end - $(date +%s)))
  [ "$s" -ge 5 ] || s=5
  echo "$s"
}

passed=0
failed=1 # tests that have not run count as failed
skipped=0
runner=
finish() {
  trap - EXIT INT TERM HUP
  end_runner
  echo "$passed passed, $failed failed, $skipped skipped"
  exit "$1"
}
trap 'finish $?' EXIT
trap 'finish 130' INT TERM HUP

# Ends every process of the session that `logged` has started.
end_runner() {
  [ -n "$runner" ] || return 0
  for signal in TERM KILL; do
    for stat in /proc/[0-9]*/stat; do
      # Fields after the name of the program: state, parent, group, session.
      { read -r line <"$stat"; } 2>/dev/null || continue
      # shellcheck disable=SC2086  # words
      set -- ${line##*) }
      [ "${4-}" = "$runner" ] && [ "$1" != Z ] || continue
      pid=${stat#/proc/}
      kill -s "$signal" "${pid%/stat}" 2>/dev/null && found=1 || true
    done
    [ -n "${found-}" ] || break
    [ "$signal" = KILL ] || sleep 2
  done
  runner=
}

# logged LOG COMMAND... : runs a command in a session of its own until the time limit and shows its
# output, which goes to the file. @return the command's exit code; 124 at the time limit
logged() {
  log=$1
  shift
  : >"$log"
  setsid timeout -k 20 "$(left)" "$@" </dev/null >"$log" 2>&1 &
  runner=$!
  tail -n +1 -f --pid="$runner" "$log" &
  follower=$!
  code=0
  wait "$runner" || code=$?
  wait "$follower" || true
  end_runner
  return "$code"
}

announce 27
step 9 "runs the tests"
[ "$mode" != all ] || step 15 "runs shipped cases with several optimizers"
started=$(date +%s)
install_packages
packages_end=$(date +%s)
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DFLEXMORPH_TESTS=ON </dev/null
# shellcheck disable=SC2086  # a list of targets
if ! logged "$build/build.log" cmake --build "$build" --parallel "$cores" --target $targets; then
  echo "The build failed or exceeded the time limit."
  exit 1
fi
build_end=$(date +%s)
if [ "$mode" = gate ] && grep -n 'warning:' "$build/build.log"; then
  echo "The compiler warns (${build##*/}/build.log): the gate fails."
  exit 1
fi

# Tests run in parallel, each with one thread (tests/support/test_main.cpp). Colours would disturb
# the counting of results below.
export CLICOLOR_FORCE=0
wanted=$(ctest --test-dir "$build" -N "$@" | sed -n 's/^Total Tests: //p')
code=0
logged "$build/tests.log" ctest --test-dir "$build" --parallel "$cores" --timeout 120 \
  --output-on-failure --test-output-size-failed 20000 "$@" || code=$?

# A line of ctest: " 12/2900 Test #12: Suite.Name ...   Passed    0.02 sec".
count() { grep -cE "^ *[0-9]+/[0-9]+ Test +#[0-9]+: .*$1" "$build/tests.log" || true; }
passed=$(count ' Passed +[0-9.]+ sec')
skipped=$(count '\*\*\*Skipped')
failed=$((${wanted:-1} - passed - skipped))
if [ "$code" -ge 124 ]; then
  echo "The time limit of the command is over. Tests that had begun and not ended:"
  awk '/^ *Start +[0-9]+: / { sub(":", "", $2); name[$2] = $3 }
       /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: / { n = $0; sub(/.*#/, "", n); sub(/:.*/, "", n); delete name[n] }
       END { for (n in name) print "  " name[n] }' "$build/tests.log"
fi

# skip_is_listed TEST : prints the reason if tests/skips.txt allows that this test is skipped on
# this machine.
skip_is_listed() {
  sed -e 's/#.*//' -e '/^ *$/d' "$root/tests/skips.txt" | while read -r pattern condition reason; do
    echo "$1" | grep -qxE "$pattern" || continue
    if [ "$condition" = always ] || ! is_installed "$condition"; then echo "$reason" && break; fi
  done | grep .
}
for test in $(sed -nE 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([^ ]+) .*\*\*\*Skipped.*/\1/p' "$build/tests.log"); do
  if reason=$(skip_is_listed "$test"); then
    echo "skipped: $test: $reason"
  elif [ "$mode" = gate ]; then
    echo "failed: $test was skipped, and tests/skips.txt does not list it for this machine"
    skipped=$((skipped - 1))
    failed=$((failed + 1))
  else
    echo "skipped: $test"
  fi
done

minutes() { echo "$((($2 - $1 + 30) / 60))"; }
echo "Minutes on $cores cores: packages $(minutes "$started" "$packages_end")," \
  "build $(minutes "$packages_end" "$build_end"), tests $(minutes "$build_end" "$(date +%s)")"
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
