#!/bin/sh
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
usage() {
  cat <<TEXT
cases/run.sh [CASE] [OPTION]...
Installs missing packages, builds flexmorph and runs one case into runs/CASE.
  CASE    path of a case file or name of a shipped case (default: rotating_plate_v01)
  OPTION  option of 'flexmorph run': --set KEY=VALUE, -o FOLDER, --output FOLDER, --threads N,
          --seconds N, --resume, --quiet, --condition, --explain, --open
TEXT
}

scene=rotating_plate_v01
case "${1--}" in
  -*) ;;
  *) scene=$1 && shift ;;
esac

# Arguments are read before anything is installed or built.
wrong() { echo "cases/run.sh: $1" >&2 && usage >&2 && exit 2; }
output=
value=0  # 1: the next word belongs to the option before it
for option in "$@"; do
  if [ "$value" = 1 ]; then value=0 && continue; fi
  case "$option" in
    -h | --help) usage && exit 0 ;;
    -o | --output) output=1 value=1 ;;
    -o?* | --output=*) output=1 ;;
    --set | --threads | --seconds) value=1 ;;
    --set=* | --threads=* | --seconds=* | --resume | --quiet | --condition | --explain | --open) ;;
    *) wrong "unknown option '$option'" ;;
  esac
done
[ "$value" = 0 ] || wrong "'$option' needs a value"
if [ ! -f "$scene" ] && [ ! -f "$root/cases/$scene.toml" ]; then
  wrong "no case '$scene': neither a file nor one of the shipped cases $(
    cd "$root/cases" && echo *.toml | sed 's/\.toml//g')"
fi

. "$root/cases/cmake/setup.sh"
check_build_folder
check_disk 2
announce 14
step $((2 * cores)) "runs $(basename "$scene" .toml) (rotating_plate_v01, on one core)"
install_packages
# A build folder that tests/run.sh has configured keeps its tests.
[ -f "$build/CMakeCache.txt" ] || set_tests=-DFLEXMORPH_TESTS=OFF
cmake -S "$root" --preset release ${set_tests-} </dev/null
cmake --build "$build" --parallel "$cores" --target flexmorph </dev/null
[ -n "$output" ] || set -- -o "$root/runs/$(basename "$scene" .toml)" "$@"
exec "$build/cases/flexmorph" run "$scene" "$@"
