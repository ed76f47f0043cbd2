#!/bin/sh
# cases/run.sh [CASE] [OPTION]...
# Installs missing packages, builds flexmorph and runs one case (default rotating_plate_v01) into
# runs/CASE. CASE is a path or the name of a shipped case; options go to `flexmorph run`.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/cases/cmake/setup.sh"

scene=rotating_plate_v01
case "${1--}" in
  -*) ;;
  *) scene=$1 && shift ;;
esac

announce 14
step $((2 * cores)) "runs $(basename "$scene" .toml) (rotating_plate_v01, on one core)"
build_targets flexmorph
for option in "$@"; do
  case "$option" in
    -o* | --output*) exec "$build/cases/flexmorph" run "$scene" "$@" ;;
  esac
done
exec "$build/cases/flexmorph" run "$scene" -o "$root/runs/$(basename "$scene" .toml)" "$@"
