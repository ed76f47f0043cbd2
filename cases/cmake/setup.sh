# Sourced by cases/run.sh and tests/run.sh, which set `root` to the top of the source tree:
# installs what is missing, configures, builds.

export LC_ALL=C
build="$root/build"

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
  echo "Installing $missing(minutes; log in build/install.log)"
  mkdir -p "$build"
  export DEBIAN_FRONTEND=noninteractive
  # shellcheck disable=SC2086  # $missing is a list of words
  if ! { apt-get update && apt-get install -y --no-install-recommends $missing; } \
    >"$build/install.log" 2>&1; then
    tail -n 20 "$build/install.log" >&2
    exit 1
  fi
}

# build_target TARGET: from whatever state this machine and the build folder are in.
build_target() {
  install_packages
  cmake -S "$root" --preset release
  cmake --build "$build" --parallel "$(nproc)" --target "$1"
}
