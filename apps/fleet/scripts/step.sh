#!/usr/bin/env bash
# One step of a fleet's plan. What is done already is not done again.
#   step.sh recording N [FILE]   maps the recording in line N of jobs.tsv, or of FILE, into runs/NAME
#   step.sh district K           makes one map of the K-th district_size recordings, as far as they are done
#   step.sh merge                makes one map of those that are done, or of their districts, in merged
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

# forget FOLDER: what was merged there, of other recordings.
forget() { rm -f "$1"/{done,fleet.map,map.ply,keyframes_tum.txt}; }

# merge_into FOLDER MAP...: FOLDER/fleet.map of those maps; not again as long as they are the same.
merge_into() {
  local into=$1 of
  shift
  of=$(stat -c '%n %s %Y' "$@")
  if [[ -e $into/done && $(<"$into/done") == "$of" ]]; then echo "$into: merged before"; return; fi
  mkdir -p "$into" && forget "$into" || return 1
  if (($# == 1)); then
    cp "$1" "$into/fleet.map" || return 1
  else
    run "$into/log.txt" "$penumbra" merge "$@" -o "$into/fleet.map" --out "$into" ||
      { echo "the merge failed, see $here/$into/log.txt"; return 1; }
  fi
  echo "$of" >"$into/done" && echo "$into: $# map$( (($# == 1)) || echo s) merged"
}

# maps_of FIRST LAST: those of the recordings in these lines that are done, a line each.
maps_of() {
  local name job number=0
  while IFS=$'\t' read -r name job; do
    ((++number >= $1 && number <= $2)) || continue
    if is_done "$name" "$job"; then echo "runs/$name/recording.map"; fi
  done <jobs.tsv
}

district() {
  local -a maps
  mapfile -t maps < <(maps_of $((($1 - 1) * district_size + 1)) $(($1 * district_size)))
  if ((${#maps[@]} > 0)); then
    merge_into "merged/district-$1" "${maps[@]}"
  else
    rm -rf "merged/district-$1"
    echo "district $1: no recording is done"
  fi
}

merge() {
  local recordings districts=0 number folder
  local -a maps=()
  recordings=$(wc -l <jobs.tsv)
  if ((district_size > 0 && recordings > district_size)); then
    districts=$(((recordings + district_size - 1) / district_size))
  fi
  for folder in merged/district-*; do # those of an earlier plan would be reported as this one's
    [[ ! -e $folder ]] || ((${folder##*-} <= districts)) || rm -rf "$folder"
  done
  if ((districts == 0)); then
    mapfile -t maps < <(maps_of 1 "$recordings")
  else
    for ((number = 1; number <= districts; ++number)); do
      district "$number" || { forget merged; return 1; }
      if [[ -e merged/district-$number/fleet.map ]]; then maps+=("merged/district-$number/fleet.map"); fi
    done
  fi
  ((${#maps[@]} > 0)) || { echo "step.sh: no recording is done: nothing to merge" >&2; return 1; }
  merge_into merged "${maps[@]}"
}

case ${1:-} in
  recording) recording "${@:2}" ;;
  district) district "${2:?which one?}" ;;
  merge) merge ;;
  report) "$penumbra" fleet report "$here" ;;
  waiting) waiting ;;
  *) sed -n '2,8s/^# //p' step.sh >&2; exit 2 ;;
esac
