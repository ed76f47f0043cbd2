#!/bin/sh
# tests/installed_packages.sh : installs the Debian packages in the folder of this script, uses them
# as a user without rights, and removes them. It changes the system that it runs in: bare_root.sh
# calls it in a bare root folder.
set -eu
cd "$(dirname "$0")"
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8

fail() { echo "tests/installed_packages.sh: $1" >&2 && exit 1; }
megabytes() { du -smx --exclude=/proc --exclude=/dev / | cut -f 1; }

# install PACKAGE... : without the packages that apt recommends.
install() {
  before=$(megabytes) && started=$(date +%s)
  apt-get install -y --no-install-recommends "$@" >install.log 2>&1 || { tail install.log && fail "apt-get install $*"; }
  echo "installed $*: $(($(megabytes) - before)) MB, $(($(date +%s) - started)) s"
}

# as_user COMMAND : runs a line of shell in the home folder of a user without rights.
as_user() {
  echo "user: $1"
  su engineer -s /bin/sh -c "cd && $1" || fail "the command of the user failed"
}

apt-get update -qq
useradd -m engineer
install ./flexmorph_*.deb
as_user 'flexmorph --version && flexmorph keys design >/dev/null && flexmorph new arm --kind arm && flexmorph check arm.toml >/dev/null'
as_user 'mkdir anywhere && cd anywhere && flexmorph run rotating_plate_v01 --quiet && test -s runs/rotating_plate_v01/report.html'
zcat /usr/share/man/man1/flexmorph.1.gz | grep -q '^[.]TH' || fail "there is no manual page"

install ./libflexmorph[0-9]*.deb ./libflexmorph-dev_*.deb g++ cmake ninja-build
build='-S /usr/share/flexmorph/examples -G Ninja'
use='&& ./own_parts && ./compose boom && ./move_case'
as_user "cmake $build -B shared -DSHARED=ON >cmake.log && cmake --build shared >>cmake.log && cd shared $use plate_pendulum energy.kinetic time.end=0.01 | tail -n 1"
# shellcheck disable=SC2046  # a list of words
install $(dpkg-query -W -f '${Recommends}' libflexmorph-dev | tr -d ,)
as_user "cmake $build -B static -DSHARED=OFF >cmake.log && cmake --build static >>cmake.log && cd static $use /usr/share/flexmorph/cases/plate_pendulum.toml energy.kinetic time.end=0.01 | tail -n 1"

install ./python3-flexmorph_*.deb python3-scipy python3-matplotlib
for example in /usr/share/doc/python3-flexmorph/examples/*.py; do
  as_user "MPLBACKEND=agg python3 $example"
done

ours=$(dpkg-query -W -f '${Package}\n' '*flexmorph*')
# shellcheck disable=SC2086  # a list of packages
dpkg -L $ours | sort -u >files
# shellcheck disable=SC2086
apt-get purge -y $ours >install.log 2>&1 || { tail install.log && fail "apt-get purge"; }
while read -r file; do
  case $file in *flexmorph*) [ ! -e "$file" ] || fail "$file is left" ;; esac
done <files
left=$(find / -xdev -iname '*flexmorph*' ! -user engineer ! -path "$PWD/*")
[ -z "$left" ] || fail "files are left: $left"
echo "removed: $(echo "$ours" | tr '\n' ' ')"
