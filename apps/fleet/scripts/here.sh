#!/usr/bin/env bash
# Does the whole plan on this machine, one recording after the other: the same steps as on a cluster.
set -uo pipefail
cd "$(dirname "$0")" || exit 1
trap 'exit 130' INT
trap 'exit 143' TERM
for ((number = 1; number <= $(wc -l <jobs.tsv); ++number)); do
  ./step.sh recording "$number" &
  step=$!
  trap 'kill -TERM "$step"; wait "$step"; exit 143' TERM INT
  wait "$step"
done
trap - TERM INT
./step.sh merge
./step.sh report
