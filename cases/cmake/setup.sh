# Sourced by cases/run.sh and tests/run.sh, which set `root` to the top of the source tree: says what
# will be done and how long it takes, installs missing packages, configures and builds.

export LC_ALL=C
build="$root/build"
cores=$(nproc)
# Lists of Debian packages; tests/run.sh adds tests/packages.txt.
package_lists="$root/cases/cmake/packages.txt"

# step CPU_MINUTES TEXT : prints one step of a command and how long it takes on these cores.
step() {
  minutes=$((($1 + cores - 1) / cores))
  n_steps=$((${n_steps:-0} + 1))
  if [ "$minutes" -gt 1 ]; then echo "  $n_steps. $2: about $minutes minutes"
  else echo "  $n_steps. $2: about a minute"; fi
}

# announce CPU_MINUTES : prints the steps that both commands begin with; the build takes CPU_MINUTES.
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

# Prints the lines of the package lists that no installed package satisfies. Where dpkg is absent
# there are none: CMake names what it does not find.
missing_packages() {
  command -v dpkg-query >/dev/null || return 0
  # shellcheck disable=SC2086  # a list of files
  sed -e 's/#.*//' -e '/^ *$/d' $package_lists | while read -r line; do
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
      ' '*optional) echo "No package here for '$line': tests that need it are skipped." >&2 ;;
      ' '*) echo "No package can be installed here for the line '$line' of a package list." >&2 && return 1 ;;
      *) printf '%s ' "$chosen" ;;
    esac
  done
}

# apt_get WORD... : waits for the lock of other package managers, has time limits, asks nothing.
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
      echo "Tests that need one of these Debian packages are skipped: $wanted" >&2
      return 0
    fi
    echo "Debian packages are missing. Type this, then start again:" >&2
    echo "sudo apt-get install --no-install-recommends $needed" >&2
    [ -z "$wanted" ] || echo "Some tests also need: $wanted" >&2
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
