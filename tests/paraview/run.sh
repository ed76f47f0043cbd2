#!/bin/sh
# tests/paraview/run.sh RUN [PICTURES]
# Opens a run folder in ParaView (see check_run.py) and writes pictures to PICTURES (default:
# RUN_pictures next to the run, because a folder in the run folder that no run has written would
# block the next run). Debian's ParaView with Python and the VTK that Flexmorph is built with
# exclude each other. Therefore ParaView gets a separate Debian 12 in PARAVIEW_ROOT
# (build/paraview), which the first check creates: 3 GB, needs root and the package debootstrap.
set -eu
export LC_ALL=C
here=$(cd "$(dirname "$0")" && pwd)
run=$(cd "${1:?the run folder}" && pwd)
pictures=${2:-${run}_pictures}
debian=${PARAVIEW_ROOT:-$here/../../build/paraview}

if [ ! -x "$debian/usr/bin/pvpython" ]; then
  mkdir -p "$debian"
  debootstrap --variant=minbase bookworm "$debian"
  DEBIAN_FRONTEND=noninteractive chroot "$debian" \
    apt-get install -y --no-install-recommends python3-paraview xvfb xauth
fi

work=$(mktemp -d "$debian/srv/check.XXXXXX")
trap 'rm -rf "$work"' EXIT
cp -r "$run" "$work/run"
cp "$here/check_run.py" "$work"

inside=/srv/$(basename "$work")
check() {
  status=0
  chroot "$debian" xvfb-run -a -w 5 pvpython "$inside/check_run.py" "$inside/run" \
    "$inside/pictures" || status=$?
}
check
# Exit codes above 1 come from the virtual display, whose start sometimes fails on a busy machine.
[ "$status" -le 1 ] || check
mkdir -p "$pictures"
cp "$work"/pictures/*.png "$pictures"
exit "$status"
