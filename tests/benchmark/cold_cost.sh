#!/bin/sh
# tests/benchmark/cold_cost.sh [FOLDER]
# What heat costs scenes that have none: builds the program with FLEXMORPH_HEAT=ON and OFF in FOLDER
# (default build-cold), moves cold scenes under valgrind's callgrind, and prints instructions of the
# whole run and of fem::integrate() with all it calls. Differences are printed, not judged.
#
# Needs valgrind. Both builds are portable, because valgrind does not know AVX-512; their
# binaries differ where heat is only. Minutes to build, about one to run.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=${1:-$root/build-cold}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
command -v valgrind >/dev/null || { echo "cold_cost.sh: valgrind is missing (apt-get install valgrind)" >&2; exit 2; }

for heat in ON OFF; do
  cmake -S "$root" -B "$folder/$heat" -DCMAKE_BUILD_TYPE=Release -DFLEXMORPH_NATIVE=OFF \
    -DFLEXMORPH_TESTS=OFF -DFLEXMORPH_HEAT=$heat >"$folder/$heat.log"
  cmake --build "$folder/$heat" --target flexmorph >>"$folder/$heat.log"
done

# rotating_plate_v05 without its design.
{
  sed '/^\[esl\]/,$d' "$root/cases/rotating_plate_v05.toml"
  printf '[output]\nvtk = false\nplots = false\n'
} >"$folder/plate.toml"
cp "$root/cases/plate_pendulum.toml" "$folder/pendulum.toml"

# Instructions in all, and those of integrate() with what it calls.
counts() {
  callgrind_annotate --inclusive=yes --threshold=100 --show-percs=no "$1" 2>/dev/null |
    tr -d , | awk '
      /PROGRAM TOTALS/ { total = $1 }
      /flexmorph::fem::integrate\(/ && !part { part = $1 }
      END { print total, part }'
}

export FLEXMORPH_THREADS=1 OMP_NUM_THREADS=1 OMP_THREAD_LIMIT=1 OPENBLAS_NUM_THREADS=1
printf '%-10s %16s %16s %12s   %16s %16s %12s\n' scene "whole, ON" "whole, OFF" "ON/OFF - 1" \
  "integrate, ON" "integrate, OFF" "ON/OFF - 1"
for scene in plate pendulum; do
  case $scene in
    plate) end=0.02 ;;   # 20 steps
    pendulum) end=0.01 ;;
  esac
  for heat in ON OFF; do
    out=$folder/$scene.$heat
    rm -rf "$out.callgrind" "$folder/run"
    valgrind --tool=callgrind --callgrind-out-file="$out.callgrind" \
      "$folder/$heat/cases/flexmorph" run "$folder/$scene.toml" -o "$folder/run" --threads 1 \
      --quiet --set output.vtk=false --set time.end=$end >"$out.log" 2>&1 ||
      { cat "$out.log" >&2; exit 1; }
  done
  set -- $(counts "$folder/$scene.ON.callgrind") $(counts "$folder/$scene.OFF.callgrind")
  echo "$scene $1 $2 $3 $4" | awk '{ printf "%-10s %16d %16d %12.2e   %16d %16d %12.2e\n",
    $1, $2, $4, $2 / $4 - 1, $3, $5, $3 / $5 - 1 }'
done
