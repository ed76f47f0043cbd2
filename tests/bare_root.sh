#!/bin/sh
# tests/bare_root.sh [bookworm | trixie] [--first-steps | --packages]
# Runs both commands of README.md in a bare root folder of Debian: debootstrap creates it in a
# temporary folder ($TMPDIR, or /tmp) from the mirror that this machine's apt uses, the committed
# state of this tree is cloned into it, and cases/run.sh and tests/run.sh run there. --first-steps
# stops when the packages of both commands are installed and CMake has configured. --packages also
# makes the Debian packages (cases/cmake/packages.sh) and installs, uses and removes them in a second
# bare root folder (tests/installed_packages.sh).
#
# It needs root, debootstrap, git and 12 GB of disk. If one of the first three is missing, it prints
# so and ends with exit code 77. Processes and mounts are in separate namespaces and end with this
# command.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

absent() { echo "tests/bare_root.sh: skipped: $1" && exit 77; }
stop() { echo "tests/bare_root.sh: $1" >&2 && exit 1; }

# Prints the mirror of Debian's main archive in the sources of this machine's apt.
mirror() {
  cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null |
    sed -nE 's/^(URIs:|deb( +\[[^]]*\])?) +([^ ]*\/debian)\/?( .*)?$/\3/p' | sed -n 1p
}

# in_root COMMAND : runs a line of shell in the home folder of root, without the environment of this
# machine.
in_root() {
  env -i HOME=/root TERM=dumb PATH=/usr/sbin:/usr/bin:/sbin:/bin chroot "$bare" \
    sh -euc "cd && $1" </dev/null
}

# make_root SUITE MIRROR : makes the root folder $bare.
make_root() {
  echo "Making a bare root folder of $1 in $bare"
  debootstrap --variant=minbase "$1" "$bare" "$2" </dev/null >"$bare.log" 2>&1 ||
    { tail -n 5 "$bare.log" >&2 && stop "debootstrap failed"; }
  # Services of installed packages do not start.
  printf '#!/bin/sh\nexit 101\n' >"$bare/usr/sbin/policy-rc.d"
  chmod +x "$bare/usr/sbin/policy-rc.d"
  apt-config dump | grep -E '^Acquire::https?::Proxy' >"$bare/etc/apt/apt.conf.d/proxy" || true
  mount -t proc proc "$bare/proc"
  mount --rbind /dev "$bare/dev"
}

# fill SUITE MIRROR LAST : makes root folders and runs the commands; called in namespaces.
fill() {
  make_root "$1" "$2"
  git -c safe.directory='*' clone -q --no-hardlinks "$root" "$bare/root/flexmorph"
  if [ "$3" = first ]; then
    # `root` is set by cases/run.sh and tests/run.sh before they read setup.sh.
    in_root 'cd flexmorph && root=$PWD && . cases/cmake/setup.sh && with_tests=1 && check_disk 4 &&
             install_packages && cmake -S . -B build -G Ninja -DFLEXMORPH_TESTS=ON'
    return
  fi
  in_root 'cd flexmorph && cases/run.sh'
  in_root 'cd flexmorph && tests/run.sh'
  [ "$3" = packages ] || return 0
  in_root 'apt-get install -y --no-install-recommends lintian dpkg-dev file >lintian.log &&
           flexmorph/cases/cmake/packages.sh flexmorph/build && lintian --fail-on error flexmorph/build/*.deb'
  made="$bare/root/flexmorph"
  bare="$bare-of-a-user"
  make_root "$1" "$2"
  mkdir "$bare/root/packages"
  cp "$made"/build/*.deb "$made/tests/installed_packages.sh" "$bare/root/packages"
  in_root packages/installed_packages.sh
}

if [ "${1-}" = --in-namespaces ]; then
  bare=$2
  shift 2
  fill "$@"
  exit
fi

suite=bookworm
last=all
for option in "$@"; do
  case "$option" in
    bookworm | trixie) suite=$option ;;
    --first-steps) last=first ;;
    --packages) last=packages ;;
    -h | --help) sed -n '2,/^set -eu/s/^# \{0,1\}//p' "$0" && exit 0 ;;
    *) echo "tests/bare_root.sh: unknown option '$option'" >&2 && exit 2 ;;
  esac
done
[ "$(id -u)" = 0 ] || absent "only root can make a root folder"
for command in debootstrap git; do
  command -v "$command" >/dev/null || absent "$command is not installed"
done
git -c safe.directory='*' -C "$root" rev-parse -q --verify HEAD >/dev/null ||
  absent "$root is no git repository"
unshare --mount --pid --fork true 2>/dev/null || absent "namespaces are not permitted here"
from=$(mirror)
[ -n "$from" ] || stop "no mirror of Debian was found in /etc/apt"
folder=$(mktemp -d "${TMPDIR:-/tmp}/flexmorph_root_XXXXXX")
inner=
# The mounts are in the namespace of the inner process; after its end the folder contains files
# only.
finish() {
  trap - EXIT INT TERM HUP
  if [ -n "$inner" ]; then kill -s KILL "$inner" 2>/dev/null && wait "$inner" || true; fi
  rm -rf --one-file-system "$folder" || { sleep 2 && rm -rf --one-file-system "$folder"; }
  exit "$1"
}
trap 'finish $?' EXIT
trap 'finish 130' INT TERM HUP
free=$(df -Pk "$folder" | sed -n '2s/^.* \([0-9][0-9]*\)  *[0-9][0-9]*% .*/\1/p')
[ "$free" -ge 12000000 ] || stop "$((free / 1000000)) GB are free in $folder, and 12 GB are needed"
unshare --mount --pid --fork --kill-child "$0" --in-namespaces "$folder/$suite" "$suite" "$from" "$last" &
inner=$!
code=0
wait "$inner" || code=$?
inner=
exit "$code"
