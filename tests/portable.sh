#!/bin/sh
# tests/portable.sh : runs the tests as on the oldest processor of Debian's amd64: kernels of OpenBLAS
# for 2004 and no vectors beyond the baseline, with the same program files that packages contain.
set -eu
case "${1-}" in
  "") ;;
  *) sed -n '2,/^set -eu/s/^# //p' "$0" && exit 2 ;;
esac
exec "$(dirname "$0")/every_processor.sh" --builds release --kernels Prescott --disturbances 0
