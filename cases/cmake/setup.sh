# Sourced by cases/run.sh and tests/run.sh, which set `root` to the top of the source tree:
# says what will be done and how long it takes, installs what is missing, configures, builds.

export LC_ALL=C
preset=release
build="$root/build"
cores=$(nproc)

# step CPU_MINUTES TEXT : one step of what a command does, and how long it takes on these cores.
step() {
  minutes=$((($1 + cores - 1) / cores))
  n_steps=$((${n_steps:-0} + 1))
  if [ "$minutes" -gt 1 ]; then echo "  $n_steps. $2: about $minutes minutes"
  else echo "  $n_steps. $2: about a minute"; fi
}

# announce CPU_MINUTES : the steps that both commands begin with; the build takes so long.
announce() {
  echo "On $cores cores ($(uname -m)) this command"
  count=$(missing_packages | wc -w)
  # However many cores there are, packages come one after the other.
  [ "$count" -eq 0 ] || step $((4 * cores)) "installs $count Debian packages, and what they need"
  if [ -f "$build/build.ninja" ]; then
    step "$1" "builds what has changed in ${build##*/}/; were it all"
  else
    step "$1" "builds into ${build##*/}/, once"
  fi
}

missing_packages() {
  grep -v '^#' "$root/cases/cmake/packages.txt" | while read -r package; do
    # A package that was removed but not purged is still known, so ask for its status.
    status=$(dpkg-query -W -f '${db:Status-Status} ' "$package" 2>/dev/null) || status=
    case " $status" in
      *" installed "*) ;;
      *) printf '%s ' "$package" ;;
    esac
  done
}

# Where dpkg is absent nothing is done here: CMake names what it does not find.
install_packages() {
  command -v dpkg-query >/dev/null || return 0
  missing=$(missing_packages)
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    echo "Debian packages are missing. Type this, then start again:" >&2
    echo "sudo apt-get install --no-install-recommends $missing" >&2
    exit 1
  fi
  echo "Installing $missing(log in ${build##*/}/install.log)"
  mkdir -p "$build"
  export DEBIAN_FRONTEND=noninteractive
  # shellcheck disable=SC2086  # $missing is a list of words
  if ! { apt-get update && apt-get install -y --no-install-recommends $missing; } \
    >"$build/install.log" 2>&1; then
    tail -n 20 "$build/install.log" >&2
    exit 1
  fi
}

# build_targets TARGET...: from whatever state this machine and the build folder are in.
build_targets() {
  install_packages
  cmake -S "$root" --preset "$preset"
  cmake --build "$build" --parallel "$cores" --target "$@"
}
