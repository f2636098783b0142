#!/usr/bin/env bash
# Tests `penumbra fleet` on a real Slurm: slurmctld and two slurmd on this machine, with a configuration, keys and
# ports of their own. 12 recordings of one street; in the middle a node is lost; another plan is cancelled and begun
# again. The same plan is done without Slurm, and every map and path must have the same bytes.
#   test.sh PENUMBRA          as root, with Debian's slurmctld, slurmd, slurm-client and munge
#   test.sh PENUMBRA --speed  measures instead how much sooner two nodes are done than one
set -euo pipefail
penumbra=$(realpath "$1")
work=$(mktemp -d)
export SLURM_CONF=$work/slurm.conf
say() { printf '== %s\n' "$*" >&2; }
fail() { echo "tests/fleet: $*" >&2; exit 1; }
tidy() {
  scancel --full --user="$(id -un)" 2>/dev/null || true
  local pid
  for pid in "$work"/*.pid; do [[ ! -e $pid ]] || kill "$(<"$pid")" 2>/dev/null || true; done
  sleep 1
  rm -rf "$work"
}
trap tidy EXIT

host=$(uname -n)
host=${host%%.*}
cat >"$work/slurm.conf" <<CONF
ClusterName=yard
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=17000
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
SlurmUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool.%n
SlurmctldPidFile=$work/ctld.pid
SlurmdPidFile=$work/slurmd.%n.pid
SlurmctldLogFile=$work/ctld.log
SlurmdLogFile=$work/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SlurmdTimeout=10
ReturnToService=2
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=1 RealMemory=2000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
mkdir "$work"/{state,spool.n1,spool.n2}
chmod 755 "$work" # munged wants a socket that others reach
head -c 1024 /dev/urandom >"$work/munge.key"
chmod 400 "$work/munge.key"
munged --force --socket="$work/munge.socket" --key-file="$work/munge.key" --pid-file="$work/munge.pid" \
  --log-file="$work/munge.log" --seed-file="$work/munge.seed"
slurmctld -c
slurmd -N n1
slurmd -N n2
for ((i = 0; i < 30; ++i)); do
  [[ $(sinfo -h -t idle -o %D) == 2 ]] && break
  sleep 1
done
[[ $(sinfo -h -t idle -o %D) == 2 ]] || fail "two nodes do not come up: $(sinfo)"

say "12 recordings of one street"
"$penumbra" synth --out "$work/street" --path block --frames 300 --size 310x94 >/dev/null
for ((i = 0; i < 12; ++i)); do
  printf 'drive-%02d street - --deterministic --frames %d:%d\n' $((i + 1)) $((20 * i)) $((20 * i + 79))
done >"$work/manifest.txt"
plan() { "$penumbra" fleet plan "$1" --out "$2" --cpus 1 --memory 500 --merge-memory 500 --program "$penumbra"; }

# wait_for PLAN: until its jobs have ended.
wait_for() {
  local i
  for ((i = 0; i < 1800; ++i)); do
    [[ -n $(squeue -h -j "$(paste -sd, "$1/submitted")" 2>/dev/null) ]] || return 0
    sleep 1
  done
  squeue
  fail "jobs do not end"
}

# speed NAME OPTION...: the recordings of a plan, from its submission to the last one's end, and what they cost.
speed() {
  local name=$1 begin
  shift
  "$penumbra" fleet plan "$work/manifest.txt" --out "$work/$name" --cpus 1 --memory 500 --merge-memory 500 \
    --program "$penumbra" "$@" >/dev/null
  begin=$EPOCHREALTIME
  "$work/$name/submit.sh" >/dev/null
  wait_for "$work/$name"
  stat -c %.Y "$work/$name"/runs/*/done | sort -g | tail -n 1 | awk -v name="$name" -v begin="$begin" \
    -v spent="$(awk -F'[:,]' '/"cpu_ms_per_frame"/ {ms += 79 * $2} END {print ms / 1e3}' "$work/$name"/runs/*/run.json)" \
    -v load="$(cut -d' ' -f1 /proc/loadavg)" \
    '{printf "%s: 12 recordings in %.1f s, which took %.1f s of the processors; load %s\n", name, $1 - begin, spent, load}'
}
if [[ ${2:-} == --speed ]]; then
  for ((round = 1; round <= 2; ++round)); do
    speed "one-node-$round" --sbatch=--exclude=n2
    speed "two-nodes-$round"
  done
  exit
fi

say "On this machine, without Slurm"
plan "$work/manifest.txt" "$work/here"
begin=$SECONDS
"$work/here/here.sh" >"$work/here.log" 2>&1 || { cat "$work/here.log"; fail "here.sh"; }
echo "$((SECONDS - begin)) s: $(tail -n 1 "$work/here.log")"

# same PLAN OTHER
same() {
  local file
  for file in merged/fleet.map $(cd "$1" && ls runs/*/recording.map runs/*/trajectory_tum.txt); do
    cmp "$1/$file" "$2/$file" || fail "$file differs"
  done
}

say "By Slurm on two nodes, of which one is lost in the middle"
plan "$work/manifest.txt" "$work/two"
begin=$SECONDS
"$work/two/submit.sh"
until (($(ls "$work"/two/runs/*/done 2>/dev/null | wc -l) >= 3)); do sleep 0.2; done
until lost=$(squeue -h -t running -w n2 -o %A | head -n 1) && [[ -n $lost ]]; do sleep 0.1; done
kill -KILL "$(<"$work/slurmd.n2.pid")"
# What ran on it: the daemon of the job and all below it.
pkill -KILL -f "slurmstepd: \[$lost\." || true
for process in $(pgrep -f "$penumbra slam"); do
  if tr '\0' '\n' <"/proc/$process/environ" 2>/dev/null | grep -qx SLURMD_NODENAME=n2; then kill -KILL "$process"; fi
done
rm "$work/slurmd.n2.pid"
wait_for "$work/two"
echo "$((SECONDS - begin)) s: $(tail -n 1 "$work"/two/slurm/"$(tail -n 1 "$work/two/submitted")".txt)"
same "$work/here" "$work/two"
grep -l "on n2" "$work"/two/runs/*/log.txt >/dev/null || fail "n2 did nothing before it was lost"
[[ $(grep -h -c "^== " "$work"/two/runs/*/log.txt | sort -n | tail -n 1) == 2 ]] ||
  fail "expected a recording that was begun twice"
"$work/two/submit.sh" | grep "^0 of 12" || fail "what is done would be done again"
wait_for "$work/two"

say "Cancelled in the middle, and begun again"
slurmd -N n2
{ head -n 3 "$work/manifest.txt"; echo "torn torn -"; } >"$work/small.txt"
mkdir "$work/torn"
printf 'sensor: stereo\nfx: 100\n' >"$work/torn/calibration.yaml"
plan "$work/small.txt" "$work/again"
sed -i 's/--frames 0:79/--frames 0:299/' "$work/again/jobs.tsv" # long enough to be met while it runs
"$work/again/submit.sh"
until [[ -s $work/again/runs/drive-01/log.txt ]]; do sleep 0.2; done
sleep 2
scancel "$(head -n 1 "$work/again/submitted")"
wait_for "$work/again"
grep -q '"interrupted by SIGTERM' "$work/again/runs/drive-01/run.json" || fail "what was there is not kept"
grep -q $'^drive-01\tstopped' "$work/again/table.tsv" || { cat "$work/again/table.tsv"; fail "expected: stopped"; }
sed -i 's/--frames 0:299/--frames 0:79/' "$work/again/jobs.tsv"
"$work/again/submit.sh"
wait_for "$work/again"
cat "$work/again/table.tsv"
grep -q $'^torn\tfailed.*calibration.yaml' "$work/again/table.tsv" || fail "expected the torn one with its error"
(($(grep -c $'^drive-0[123]\tdone' "$work/again/table.tsv") == 3)) || fail "expected three that are done"
for name in drive-01 drive-02 drive-03; do
  cmp "$work/here/runs/$name/recording.map" "$work/again/runs/$name/recording.map" || fail "$name differs"
done
say "All is well"
