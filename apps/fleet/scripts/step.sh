#!/usr/bin/env bash
# One step of a fleet's plan. What is done already is not done again.
#   step.sh recording N [FILE]   maps the recording in line N of jobs.tsv, or of FILE, into runs/NAME
#   step.sh merge                makes one map of those that are done, in merged
#   step.sh report               writes table.tsv and index.html
#   step.sh waiting              prints the lines of recordings that are not done
# Slurm runs it (submit.sh), or this machine alone (here.sh).
set -uo pipefail
cd "$(dirname "$0")" || exit 1
here=$PWD
# shellcheck source=/dev/null
. ./settings.sh
# A node's other processors are other jobs'.
[[ -z ${SLURM_CPUS_PER_TASK:-} ]] || export OMP_NUM_THREADS=$SLURM_CPUS_PER_TASK

# run LOG COMMAND...: a signal goes to the command, which then ends with what it has.
run() {
  local log=$1 child status
  shift
  echo "== $(date '+%F %T') on ${SLURMD_NODENAME:-$(uname -n)}: $*" >>"$log"
  "$@" >>"$log" 2>&1 &
  child=$!
  # What was sent: penumbra may have got it, too, and takes the same one that comes twice at once for one.
  trap 'kill -TERM "$child" 2>/dev/null' TERM
  trap 'kill -INT "$child" 2>/dev/null' INT
  trap 'kill -HUP "$child" 2>/dev/null' HUP
  while kill -0 "$child" 2>/dev/null; do wait "$child"; done
  wait "$child"
  status=$?
  trap - TERM INT HUP
  ((status == 0)) || echo "ended with exit code $status" >>"$log"
  return "$status"
}

# Whether the recording of this name is done as the plan now wants it.
is_done() { [[ -e runs/$1/done && $(<"runs/$1/done") == "$2" ]]; }

recording() {
  local name job folder arguments
  (($# > 0)) || { echo "step.sh: which recording?" >&2; exit 2; }
  local -a words
  IFS=$'\t' read -r name job < <(sed -n "${1}p" "${2:-jobs.tsv}")
  [[ -n $name ]] || { echo "step.sh: ${2:-jobs.tsv} has no line $1" >&2; exit 2; }
  IFS=$'\t' read -r folder arguments <<<"$job"
  mkdir -p "runs/$name" || exit 1
  # Held by penumbra, too, as long as it runs: two must not write one folder. A lost node's is let go after a while.
  exec 9>"runs/$name/lock"
  flock -w 300 -E 99 9
  (($? != 99)) || { echo "$name: is at work elsewhere" >&2; exit 1; }
  if is_done "$name" "$job"; then echo "$name: done before"; return; fi
  rm -f "runs/$name/done" && cd "$folder" || exit 1
  eval "words=($arguments)" # quoted by `penumbra fleet plan`
  run "$here/runs/$name/log.txt" "$penumbra" slam "${words[@]}" --out "$here/runs/$name" \
    --save-map "$here/runs/$name/recording.map" || { echo "$name: not done, see $here/runs/$name/log.txt"; exit 1; }
  cd "$here/runs/$name" && echo "$job" >done.new && mv done.new done && echo "$name: done"
}

waiting() {
  local name job number=0
  while IFS=$'\t' read -r name job; do
    ((++number))
    is_done "$name" "$job" || echo "$number"
  done <jobs.tsv
}

merge() {
  local name job of
  local -a maps=()
  while IFS=$'\t' read -r name job; do
    if is_done "$name" "$job"; then maps+=("runs/$name/recording.map"); fi
  done <jobs.tsv
  ((${#maps[@]} > 0)) || { echo "step.sh: no recording is done: nothing to merge" >&2; exit 1; }
  of=$(stat -c '%n %s %Y' "${maps[@]}")
  if [[ -e merged/done && $(<merged/done) == "$of" ]]; then echo "merged before"; return; fi
  mkdir -p merged && rm -f merged/done merged/fleet.map || exit 1 # of other recordings
  if ((${#maps[@]} == 1)); then
    cp "${maps[0]}" merged/fleet.map || exit 1
  else
    run merged/log.txt "$penumbra" merge "${maps[@]}" -o merged/fleet.map --out merged ||
      { echo "the merge failed, see $here/merged/log.txt"; exit 1; }
  fi
  echo "$of" >merged/done && echo "merged ${#maps[@]} maps"
}

case ${1:-} in
  recording) recording "${@:2}" ;;
  merge) merge ;;
  report) "$penumbra" fleet report "$here" ;;
  waiting) waiting ;;
  *) sed -n '2,7s/^# //p' step.sh >&2; exit 2 ;;
esac
