#!/bin/sh
# tests/benchmark/absent_cost.sh [FOLDER]
# Measures the cost of absent features, and the saving by their absence: two Markdown tables of
# numbers, which are not assessed. FOLDER (default build-absent) keeps the build and the profiles.
#
# 1. The program is linked again without the object files of a feature: their symbols are undefined,
#    and a scene that needs them crashes. Instructions of scenes without the feature are counted by
#    valgrind's callgrind: of fem::integrate() with all its calls, and of the whole program.
# 2. Pairs of scenes that differ in one feature: unknowns, instructions and CPU time per step, from
#    runs of two lengths.
#
# Needs valgrind, which does not support AVX-512: kernels use the registers that all processors
# have. FLEXMORPH is the path of a program for the CPU times (default: the one that is built here).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=${1:-$root/build-absent}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
build=$folder/build
command -v valgrind >/dev/null || { echo "absent_cost.sh: valgrind is missing (apt-get install valgrind)" >&2; exit 2; }

cmake -G Ninja -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release \
  -DFLEXMORPH_TESTS=OFF >"$folder/build.log"
ninja -C "$build" flexmorph >>"$folder/build.log"
fast=${FLEXMORPH:-$build/cases/flexmorph}

# link NAME OBJECT... : links the program without these object files.
link() {
  to=$folder/$1
  name=$1
  shift
  rm -rf "$to"
  mkdir -p "$to"
  line=$(ninja -C "$build" -t commands cases/flexmorph | tail -n 1)
  for lib in fem/thermal/libflexmorph_thermal.a fem/libflexmorph_fem.a io/libflexmorph_io.a; do
    cp "$build/$lib" "$to/"
    line=$(echo "$line" | sed "s# $lib# $to/${lib##*/}#g")
    for object in "$@"; do ar d "$to/${lib##*/}" "$object.cpp.o"; done
  done
  replaced=
  if [ "$name" = free_lines ]; then
    replaced=$to/absent_stubs.o
    c++ -O3 -DNDEBUG -std=c++20 -I"$root" -isystem /usr/include/eigen3 -c -o "$replaced" \
      "$root/tests/benchmark/absent_stubs.cpp"
  fi
  options="-no-pie -Wl,--unresolved-symbols=ignore-all -o $to/flexmorph"
  (cd "$build" && sh -c "$(echo "$line" | sed "s# -o cases/flexmorph # $replaced $options #")")
}

# Every scene is a shipped case with changes.
in_space='body.space=space body.terms=["inertia","membrane","bending"]'
scene() {
  plate='rotating_plate_v05 esl= design= optimizer= cycle= verify= accuracy='
  held="$plate body.flow= body.element=ancf_plate"
  case $1 in
    flow) echo "$plate" ;;
    flow_space) echo "$plate $in_space" ;;
    held) echo "$held" ;;
    held_space) echo "$held $in_space" ;;
    hot_by_0) echo "$held body.heat={expansion=1e-5,rise=0.0,profile=\"step\"}" ;;
    hot_by_50) echo "$held body.heat={expansion=1e-5,rise=50.0,profile=\"step\"}" ;;
    held_rigid) echo "$held time.start=rigid" ;;
    dangling) echo "$held time.start=rigid rigid_body=[{name=\"bob\",mass=1.0,inertia=0.01,position=[2.0,0.0]}] spring=[{b=\"bob\",point_a=[2.0,1.0],stiffness=500.0}]" ;;
    fixed_line) echo 'elastic_sleeve body.line=' ;;
    free_line) echo 'elastic_sleeve' ;;
    outputs) echo "$held observe=[{name=\"a\",body=\"plate\",point=[0.5,0.05]}]" ;;
    pendulum) echo 'plate_pendulum' ;;
  esac
  [ "$1" = outputs ] && echo 'output.motion_every=0.005' || echo 'output.vtk=false output.plots=false'
}

# start PROGRAM SCENE END WRAPPER... : runs a scene up to END seconds.
start() {
  program=$1 chosen=$2 end=$3
  shift 3
  set -- "$@" "$program" run
  for word in $(scene "$chosen"); do
    case $word in
      *=*) set -- "$@" --set "$word" ;;
      *) set -- "$@" "$word" ;;
    esac
  done
  rm -rf "$folder/run"
  "$@" --set "time.end=$end" -o "$folder/run" --threads 1 --quiet >"$folder/run.log" 2>&1 ||
    { cat "$folder/run.log" >&2; echo "absent_cost.sh: $chosen failed" >&2; exit 1; }
}

# count PROGRAM SCENE END : instructions of the whole program, and of integrate().
count() {
  (
    # One process, whose symbols are resolved before it starts.
    export FLEXMORPH_THREADS=1 OMP_NUM_THREADS=1 OMP_THREAD_LIMIT=1 OPENBLAS_NUM_THREADS=1 LD_BIND_NOW=1
    start "$1" "$2" "$3" env FLEXMORPH_VECTORS=baseline valgrind --tool=callgrind --callgrind-out-file="$folder/$2.callgrind"
  )
  callgrind_annotate --inclusive=yes --threshold=100 --show-percs=no "$folder/$2.callgrind" 2>/dev/null |
    tr -d , | awk '
      /PROGRAM TOTALS/ { total = $1 }
      /flexmorph::fem::integrate\(/ && !part { part = $1 }
      END { printf "%d %d\n", total, part }'
}

# seconds SCENE END : CPU seconds of the whole program, the least of three.
seconds() {
  for k in 1 2 3; do
    start "$fast" "$1" "$2"
    sed -n 's/.*"seconds_cpu": \([^,]*\),/\1/p' "$folder/run/run.json"
  done | sort -g | head -n 1
}

without() {  # FEATURE, SCENE, OBJECT...
  feature=$1 absent_in=$2
  shift 2
  link "$feature" "$@"
  eval "whole=\$whole_$absent_in"
  echo "$feature $absent_in $whole $(count "$folder/$feature/flexmorph" "$absent_in" 0.02)" | awk '{
    printf "| `%s` | `%s` | %d | %d | %.4f | %.4f |\n",
      $1, $2, $4, $6, 100 * ($4 / $6 - 1), 100 * ($3 / $5 - 1) }'
}

link all
whole_flow=$(count "$folder/all/flexmorph" flow 0.02)
whole_pendulum=$(count "$folder/all/flexmorph" pendulum 0.02)
echo '| without | scene | `integrate()`, whole | without | more by % | program, more by % |'
echo '| --- | --- | --- | --- | --- | --- |'
without bending flow bending
without free_lines flow eulerian_work line_drive
without rigid_bodies flow rigid_body rigid pair_joint body_joints pair_force_element springs
without heat flow heated temperature thermal_displacement thermal_force
without beams flow ancf_beam beam
without loads flow dead_loads follower_loads
without adaptive flow step_control dense_output
without energy_momentum flow energy_momentum
without minimal_coordinates flow minimal_coordinates coordinate_partition acceleration_solver klu_solver
without statics flow static_path
without files flow vtk surfaces plane_frames exports sheet
without free_lines pendulum eulerian_work line_drive
without heat pendulum heated temperature thermal_displacement thermal_force

per_step() {  # of $chosen
  unknowns=$(
    set -- check
    for word in $(scene "$chosen"); do
      case $word in *=*) set -- "$@" --set "$word" ;; *) set -- "$@" "$word" ;; esac
    done
    "$fast" "$@" | sed -n 's/.* \([0-9]*\) unknowns.*/\1/p' | awk '{ n += $1 } END { print n }'
  )
  short=$(count "$build/cases/flexmorph" "$chosen" 0.02)
  long=$(count "$build/cases/flexmorph" "$chosen" 0.06)
  echo "$unknowns $short $long $(seconds "$chosen" 0.02) $(seconds "$chosen" 0.22)"
}

echo
echo '| scene | unknowns | instructions per step, millions | ms per step | against | instructions | ms |'
echo '| --- | --- | --- | --- | --- | --- | --- |'
for chosen in flow flow_space held held_space hot_by_0 hot_by_50 outputs held_rigid dangling \
  fixed_line free_line; do
  set -- $(per_step)
  # unknowns, whole and integrate() of 20 steps, of 60 steps, seconds of 20 and 220 steps
  this="$1 $(echo "$*" | awk '{ printf "%.3f %.3f", ($4 - $2) / 40e6, ($7 - $6) / 0.2 }')"
  eval "of_$chosen=\$this"
  case $chosen in
    flow_space) against=flow base=$of_flow ;;
    held_space | hot_by_0 | hot_by_50 | outputs) against=held base=$of_held ;;
    dangling) against=held_rigid base=$of_held_rigid ;;
    free_line) against=fixed_line base=$of_fixed_line ;;
    *) against= base= ;;
  esac
  echo "$chosen $this $against $base" | awk '{
    printf "| `%s` | %d | %.3f | %.3f | ", $1, $2, $3, $4
    if (NF > 4) printf "`%s` | x %.2f | x %.2f |\n", $5, $3 / $7, $4 / $8
    else print " | | |" }'
done
