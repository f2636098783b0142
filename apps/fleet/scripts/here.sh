#!/usr/bin/env bash
# Does the whole plan on this machine, one recording after the other: the same steps as on a cluster. Exit code 0
# where all recordings are done and merged.
set -uo pipefail
cd "$(dirname "$0")" || exit 1
stopped=0 step=
trap 'stopped=1' INT # of a terminal it reaches penumbra, too
trap 'stopped=1; [[ -z $step ]] || kill -TERM "$step" 2>/dev/null' TERM HUP

# do_step WORDS...: a signal ends it with what it has, and then this script.
do_step() {
  ./step.sh "$@" &
  step=$!
  while kill -0 "$step" 2>/dev/null; do wait "$step"; done
  wait "$step"
  local status=$?
  step=
  ((stopped == 0)) || { echo "here.sh: stopped; call it again to go on" >&2; exit 130; }
  return "$status"
}

for ((number = 1; number <= $(wc -l <jobs.tsv); ++number)); do do_step recording "$number"; done
do_step merge
do_step report
