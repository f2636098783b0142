#!/usr/bin/env bash
# Hands the plan to Slurm: a job for each recording that is not done, then one that merges, then the report.
#   submit.sh            again after a failure: does what is missing
#   submit.sh --print    prints the calls of sbatch and makes none
set -euo pipefail
cd "$(dirname "$0")"
here=$PWD print=0
[[ ${1:-} != --print ]] || print=1
# shellcheck source=/dev/null
. ./settings.sh
mkdir -p slurm

# Jobs of an earlier call that are still there would be done twice.
if ((print == 0)) && [[ -s submitted ]]; then
  if still=$(squeue -h -j "$(paste -sd, submitted)" 2>slurm/squeue.txt); then
    if [[ -n $still ]]; then
      echo "submit.sh: jobs of an earlier call are still there; end them first: scancel $(paste -sd' ' submitted)" >&2
      exit 1
    fi
  elif ! grep -q 'Invalid job id' slurm/squeue.txt; then # which Slurm has forgotten: ended long ago
    echo "submit.sh: Slurm does not say whether jobs of an earlier call are still there: $(<slurm/squeue.txt)" >&2
    exit 1
  fi
fi

# 7 8 9 12: 7-9,12
ranges() {
  local first='' last='' number text=''
  for number in "$@" end; do
    if [[ -n $first && $number == "$((last + 1))" ]]; then last=$number; continue; fi
    if [[ -n $first ]]; then text+=,$first; ((first == last)) || text+=-$last; fi
    first=$number last=$number
  done
  echo "${text#,}"
}

# job NAME COMMAND [OPTION...]: prints its number.
job() {
  local name=$1 command=$2
  shift 2
  # A batch script is copied before it runs: the command names the folder.
  set -- sbatch --parsable --job-name="$name" "${all_options[@]}" "$@" --wrap "exec $(printf %q "$here/step.sh") $command"
  if ((print)); then printf '%q ' "$@" >&2; echo >&2; echo 0; return; fi
  "$@" | cut -d';' -f1 | tee -a submitted
}

recordings=$(wc -l <jobs.tsv)
waiting=$(./step.sh waiting)
# A cluster bounds the numbers in an array (1000 by default): beyond them they are shifted.
most=$( (scontrol show config 2>/dev/null || true) | awk '$1 == "MaxArraySize" {print $3 - 1}')
most=${most:-1000}
# The jobs are those of the plan as it is now: a later plan changes no line under them.
jobs=$here/slurm/jobs.$(date +%s).tsv
if ((print == 0)); then
  cp jobs.tsv "$jobs"
  : >submitted
fi
after=''
for ((shift = 0; shift < recordings; shift += most)); do
  numbers=()
  for waits in $waiting; do
    ((waits <= shift || waits > shift + most)) || numbers+=($((waits - shift)))
  done
  ((${#numbers[@]} > 0)) || continue
  part=$(ranges "${numbers[@]}")
  ((at_once == 0)) || part+=%$at_once
  # shellcheck disable=SC2016 # Slurm sets it
  after+=:$(job recording 'recording $((SLURM_ARRAY_TASK_ID + '"$shift"')) '"$(printf %q "$jobs")" --array="$part" \
    --output="$here/slurm/%A_%a.txt" --requeue --open-mode=append --signal=B:TERM@120 "${recording_options[@]}")
done
# afterany: what failed is left out and listed.
districts=$((district_size == 0 ? 0 : (recordings + district_size - 1) / district_size))
if ((districts > 1 && districts <= most)); then
  # shellcheck disable=SC2016 # Slurm sets it
  after=:$(job district 'district $SLURM_ARRAY_TASK_ID' --array="1-$districts" --output="$here/slurm/%A_%a.txt" \
    --requeue --open-mode=append "${merge_options[@]}" ${after:+--dependency=afterany$after})
fi
merge=$(job merge merge --output="$here/slurm/%j.txt" --requeue --open-mode=append "${merge_options[@]}" \
  ${after:+--dependency=afterany$after})
report=$(job report report --output="$here/slurm/%j.txt" --open-mode=append --dependency=afterany:"$merge")
echo "recordings: $(wc -w <<<"$waiting") of $recordings, then job $merge merges, then job $report writes index.html"
