#!/bin/bash
# tests/hosts.sh [PROGRAM] : runs a sweep of 24 rows on two machines without a shared disk and on this
# one. The machines are ssh servers on other ports of the loopback address, each with its own root,
# home and processes. On the way two rows are killed, one machine stops, and the study is interrupted.
# The same command is called again until the study is complete. Its table has to be that of a study
# on this machine alone, apart from times.
#
# It needs root, ssh and sshd, GNU parallel, rsync and unshare; without them it is skipped (exit code
# 77). All files are in a temporary folder ($TMPDIR, or /tmp). PROGRAM is build/cases/flexmorph
# unless it is given.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
program=$(realpath "${1-$root/build/cases/flexmorph}")
case "${1-}" in
  -h | --help) sed -n '2,/^set -eu/s/^# \{0,1\}//p' "$0" | sed '$d' && exit 0 ;;
esac
[ "$(id -u)" = 0 ] || { echo "hosts.sh: it needs root" && exit 77; }
for needed in ssh /usr/sbin/sshd ssh-keygen parallel rsync unshare; do
  command -v "$needed" >/dev/null || { echo "hosts.sh: $needed is absent" && exit 77; }
done
unshare -m true || { echo "hosts.sh: no mounts are possible here" && exit 77; }

work=$(mktemp -d "${TMPDIR:-/tmp}/flexmorph_hosts.XXXXXX")
study=study_${work##*.}  # a name that no other process has in its command line
machines=()
finish() {
  trap - EXIT INT TERM
  for pid in "${machines[@]}"; do kill -KILL "$pid" 2>/dev/null || true; done
  wait
  if [ "$1" = 0 ]; then rm -rf "$work"; else echo "hosts.sh failed; its files: $work"; fi
  exit "$1"
}
trap 'finish $?' EXIT
trap 'finish 130' INT TERM

ssh-keygen -q -t ed25519 -N '' -f "$work/key"
free_port() {
  local port=$1
  while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((port + 1)); done
  echo "$port"
}

# start_machine NAME PORT : an ssh server in its own root. All its processes end with it.
start_machine() {
  local at=$work/$1
  mkdir -p "$at"/{etc,root,tmp,proc,dev,run/sshd,usr,var/empty}
  for link in bin sbin lib lib64; do [ ! -L "/$link" ] || ln -s "usr/$link" "$at/$link"; done
  mkdir -p "$at${program%/*}" "$at$root/cases"
  ssh-keygen -q -t ed25519 -N '' -f "$at/run/host_key"
  cp "$work/key.pub" "$at/run/keys"
  printf '%s\n' "Port $2" 'ListenAddress 127.0.0.1' 'HostKey /run/host_key' 'UsePAM no' \
    'AuthorizedKeysFile /run/keys' 'StrictModes no' 'PermitRootLogin yes' 'PidFile none' \
    'MaxStartups 100' >"$at/run/sshd_config"
  # shellcheck disable=SC2016  # the inner shell expands them
  unshare -m -p -f --kill-child=KILL sh -ec '
    at=$1 program=$2 cases=$3
    mount --make-rprivate /
    for folder in usr etc dev; do mount --rbind "/$folder" "$at/$folder"; done
    mount -t proc proc "$at/proc"
    mount --bind "$program" "$at$program"
    mount --bind "$cases" "$at$cases"
    exec chroot "$at" /usr/sbin/sshd -D -e -f /run/sshd_config' \
    sh "$at" "${program%/*}" "$root/cases" >"$work/$1.log" 2>&1 &
  machines+=($!)
}
port1=$(free_port 22301)
start_machine first "$port1"
port2=$(free_port $((port1 + 1)))
start_machine second "$port2"
login() {
  echo "ssh -p $1 -i $work/key -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null" \
    "-o LogLevel=ERROR -o ConnectTimeout=5 root@127.0.0.1"
}
for port in "$port1" "$port2"; do
  for try in $(seq 50); do
    # shellcheck disable=SC2046  # words
    if $(login "$port") true 2>/dev/null; then break; fi
    [ "$try" -lt 50 ] || { cat "$work"/*.log && exit 1; }
    sleep 0.2
  done
done
printf '1/%s\n' "$(login "$port1")" "$(login "$port2")" : >"$work/machines"

mkdir "$work/here" "$work/alone"
cp "$root/cases/plate_pendulum.toml" "$root/cases/plate_pendulum_exudyn.csv" "$work/here"
cp "$root/cases/plate_pendulum.toml" "$root/cases/plate_pendulum_exudyn.csv" "$work/alone"
words=(sweep plate_pendulum.toml --set 'body.elements=[4, 4]' --set time.end=0.5 --set expect=
  --set output.vtk=false --vary body.thickness=0.008,0.009,0.01,0.011,0.012,0.014
  --vary body.youngs_modulus=8e6,1e7,1.2e7,1.5e7 -o "$study")
on_machines() {  # in a process of its own
  cd "$work/here"
  exec "$program" "${words[@]}" --hosts "$work/machines" --program "$program"
}
# runs : numbers of the processes that compute rows of this study
runs() { pgrep -f "^[^ ]*flexmorph run .*-o $study/" || true; }

echo "first call: two rows are killed, the second machine stops, and the call is interrupted"
on_machines >"$work/first.out" 2>&1 &
call=$!
killed=0
for _ in $(seq 1200); do
  kill -0 "$call" 2>/dev/null || break
  ended=$(grep -c '^[0-9]*/24 ' "$work/first.out" || true)
  if [ "$killed" -lt 2 ] && [ "$ended" -ge $((3 * killed + 2)) ]; then
    pid=$(runs | head -n 1)
    if [ -n "$pid" ] && kill -KILL "$pid"; then killed=$((killed + 1)) && echo "killed $pid"; fi
  elif [ "$killed" = 2 ] && [ "$ended" -ge 9 ]; then
    kill -KILL "${machines[1]}" && killed=3 && echo "the second machine has stopped"
  elif [ "$killed" = 3 ] && [ "$ended" -ge 14 ]; then
    kill -TERM "$call" && killed=4
  fi
  sleep 0.1
done
code=0
wait "$call" || code=$?
cat "$work/first.out"
echo "first call: exit code $code"
[ "$killed" = 4 ] || { echo "the rows ended before they were killed" && exit 1; }
calls=1
while [ "$code" = 4 ] && [ "$calls" -lt 4 ]; do
  code=0
  calls=$((calls + 1))
  (on_machines) >"$work/call$calls.out" 2>&1 || code=$?
  cat "$work/call$calls.out"
  echo "call $calls: exit code $code"
done
[ "$code" = 0 ] || exit 1
cut -f 2-4,7-8 "$work/here/$study/parallel.log"

(cd "$work/alone" && "$program" "${words[@]}" --jobs 2 --quiet >"$work/alone.out")
# without: the columns of times in a table
without() {
  python3 - "$1" <<'TEXT'
import csv, sys
rows = list(csv.reader(open(sys.argv[1])))
for row in rows:
    print([cell for name, cell in zip(rows[0], row)
           if "seconds" not in name and "CPU" not in name and name != "peak_memory_bytes"])
TEXT
}
for table in sweep.csv rows.csv; do
  without "$work/here/$study/$table" >"$work/here.txt"
  without "$work/alone/$study/$table" >"$work/alone.txt"
  diff "$work/here.txt" "$work/alone.txt"
  echo "$table: $(wc -l <"$work/here.txt") equal lines"
done
# The machines keep nothing of the study.
[ -z "$(find "$work"/first/root "$work"/first/tmp -type f -path "*$study*")" ]
echo "complete after $calls calls; the tables are equal"
