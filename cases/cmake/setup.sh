# Sourced by cases/run.sh and tests/run.sh, which set `root` to the top of the source tree: prints
# the steps and their durations, installs missing packages, configures and builds.

export LC_ALL=C
build="$root/build"
with_tests=  # set by tests/run.sh: packages of tests/packages.txt are needed, too

# quotas FILE : prints the values of a file of this process's control groups, from its own group up
# to the root. A container has its own group as the root. ($system_root is set by
# tests/scripts.cmake.)
quotas() {
  group=$(sed -n 's/^0:://p' "${system_root-}/proc/self/cgroup" 2>/dev/null) || group=
  while :; do
    group=${group%/}
    cat "${system_root-}/sys/fs/cgroup$group/$1" 2>/dev/null || true
    [ -n "$group" ] || break
    group=${group%/*}
  done
}

# parallel_jobs CORES : prints the number of parallel jobs: at most one per core, as many as the
# quota of processor time allows (cpu.max: microseconds per period), and one per 1.2 GB of available
# memory (the largest files take about 1 GB to compile); at least one.
parallel_jobs() {
  memory=$(sed -n 's/^MemAvailable: *\([0-9]*\) kB/\1/p' "${system_root-}/proc/meminfo" 2>/dev/null) ||
    memory=
  limit=$(quotas memory.max | sort -n | sed -n '/^[0-9]/{p;q;}')
  {
    echo "$1"
    [ -z "$memory" ] || echo $((memory / 1200000))
    [ -z "$limit" ] || echo $((limit / 1200000000))
    quotas cpu.max | while read -r quota period; do
      [ "$quota" = max ] || echo $(((quota + period - 1) / period))
    done
  } | sort -n | sed -n '1{s/^0$/1/;p;}'
}
# nproc would obey OMP_NUM_THREADS, which is not meant for compilers and test programs.
cores=$(parallel_jobs "$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)")

stop() { echo "$1" >&2 && exit 1; }

# check_build_folder : stops if the build folder belongs to another generator or source tree.
check_build_folder() {
  cache="$build/CMakeCache.txt"
  [ -f "$cache" ] || return 0
  generator=$(sed -n 's/^CMAKE_GENERATOR:INTERNAL=//p' "$cache")
  source=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$cache")
  made="The build folder $build was made"
  [ "$generator" = Ninja ] ||
    stop "$made with the generator '$generator', and this command needs Ninja. Remove it and start again: rm -rf '$build'"
  [ "$(cd "$source" 2>/dev/null && pwd -P)" = "$(cd "$root" && pwd -P)" ] ||
    stop "$made for the source folder '$source', which is not this one. Remove it and start again: rm -rf '$build'"
}

# disk_of FOLDER : "<free kB> <mount point>"
disk_of() { df -Pk "$1" | sed -n '2s/^.* \([0-9][0-9]*\)  *[0-9][0-9]*% */\1 /p'; }

# check_disk GB : stops if the disks cannot hold a build folder of this size, minus its present
# size, and 3 GB of missing packages.
check_disk() {
  built=$(du -sk "$build" 2>/dev/null | cut -f 1)
  missing_gb=0
  if [ "$(id -u)" = 0 ] && [ -n "$(missing_packages)" ]; then missing_gb=3; fi
  here=$(disk_of "$root")
  packages=$(disk_of /usr)
  needed=$(($1 * 1000000 - ${built:-0}))
  if [ "${here#* }" = "${packages#* }" ]; then needed=$((needed + missing_gb * 1000000)); fi
  [ "${here%% *}" -ge "$needed" ] ||
    stop "Too little disk for ${build##*/}/: $((${here%% *} / 1000)) MB are free in $root, and $((needed / 1000)) MB are needed (packages included)."
  [ "${packages%% *}" -ge $((missing_gb * 1000000)) ] ||
    stop "Too little disk for packages: $((${packages%% *} / 1000)) MB are free in /usr, and $((missing_gb * 1000)) MB are needed."
}

# step CPU_MINUTES TEXT : prints one step of a command and how long it takes on these cores.
step() {
  minutes=$((($1 + cores - 1) / cores))
  n_steps=$((${n_steps:-0} + 1))
  if [ "$minutes" -gt 1 ]; then echo "  $n_steps. $2: about $minutes minutes"
  else echo "  $n_steps. $2: about a minute"; fi
}

# announce CPU_MINUTES : prints the first steps of both commands; the build takes CPU_MINUTES.
announce() {
  echo "On $cores cores ($(uname -m)) this command"
  count=$(missing_packages | wc -l)
  # Packages are installed one after the other, however many cores there are.
  [ "$count" -eq 0 ] || step $((4 * cores)) "installs $count Debian packages and their dependencies"
  if [ -f "$build/build.ninja" ]; then
    step "$1" "builds what has changed in ${build##*/}/; a complete build would take"
  else
    step "$1" "builds into ${build##*/}/, once"
  fi
}

# is_installed PACKAGE : a package that was removed but not purged is still known to dpkg.
is_installed() {
  status=$(dpkg-query -W -f '${db:Status-Status} ' "$1" 2>/dev/null) || status=
  case " $status" in
    *" installed "*) return 0 ;;
  esac
  return 1
}

# Prints the lists of Debian packages that are needed, without comments.
package_lines() {
  sed -e 's/#.*//' -e '/^ *$/d' "$root/cases/cmake/packages.txt"
  [ -z "$with_tests" ] || sed -e 's/#.*//' -e '/^ *$/d' "$root/tests/packages.txt"
}

# Prints the lines of the package lists that no installed package satisfies. If dpkg is absent,
# nothing is printed: CMake names the libraries that it does not find.
missing_packages() {
  command -v dpkg-query >/dev/null || return 0
  package_lines | while read -r line; do
    satisfied=0
    for name in $(alternatives "$line"); do
      if is_installed "$name"; then satisfied=1; fi
    done
    [ "$satisfied" = 1 ] || echo "$line"
  done
}

# alternatives LINE : the names in a line "a | b optional".
alternatives() { echo "${1%optional}" | tr '|' ' '; }

# Reads lines of the package lists. @return the first alternative of each line that can be installed
# here. A line without one ends the command unless the line is optional.
installable() {
  while read -r line; do
    chosen=
    for name in $(alternatives "$line"); do
      if [ -z "$chosen" ] && apt-cache policy "$name" 2>/dev/null | grep -q 'Candidate: [^(]'; then
        chosen=$name
      fi
    done
    case "$chosen $line" in
      ' '*optional) echo "No package here for '$line': what needs it is left out." >&2 ;;
      ' '*) echo "No package can be installed here for the line '$line' of a package list (Ubuntu: the component universe is needed)." >&2 && return 1 ;;
      *) printf '%s ' "$chosen" ;;
    esac
  done
}

# apt_get WORD... : waits for the lock of other package managers, has time limits, asks no
# questions.
apt_get() {
  timeout 1200 apt-get -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 \
    -o Acquire::http::Timeout=60 -o Dpkg::Options::=--force-confold "$@" </dev/null
}

install_packages() {
  missing=$(missing_packages)
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    needed=$(echo "$missing" | sed -e '/optional$/d' -e 's/ *|.*//' | tr '\n' ' ')
    wanted=$(echo "$missing" | sed -n 's/ *|.*//; s/ *optional$//p' | tr '\n' ' ')
    if [ -z "$needed" ]; then
      echo "What needs one of these Debian packages is left out: $wanted" >&2
      return 0
    fi
    echo "Debian packages are missing. Type this, then start again:" >&2
    echo "sudo apt-get install --no-install-recommends $needed" >&2
    [ -z "$wanted" ] || echo "Parts that may be left out also need: $wanted" >&2
    exit 1
  fi
  mkdir -p "$build"
  export DEBIAN_FRONTEND=noninteractive
  apt_get update >"$build/install.log" 2>&1 || true
  packages=$(echo "$missing" | installable) || exit 1
  [ -n "$packages" ] || return 0
  echo "Installing $packages(log in ${build##*/}/install.log)"
  # shellcheck disable=SC2086  # a list of words
  if ! apt_get install -y --no-install-recommends $packages >>"$build/install.log" 2>&1; then
    tail -n 20 "$build/install.log" >&2
    exit 1
  fi
}
