#!/bin/sh
# One picture in slices, as a job array of Slurm, and a job that merges them when all are done.
# usage: examples/farm/slices.sh SCENE OUTPUT.exr SAMPLES SLICES [OPTION...]     options go to `meniscus render`
# The folder must be one that all nodes share. A slice whose file is done is left out when this is run again; one that was
# stopped goes on, also within the same job: a node that is taken away, or a time limit, puts it into the queue again.
# MENISCUS: the program; SBATCH: sbatch, with what the cluster wants, such as "sbatch --partition=long".
# SPDX-License-Identifier: Apache-2.0
set -eu
[ $# -ge 4 ] || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }
scene=$1 output=$2 samples=$3 slices=$4
shift 4
MENISCUS=${MENISCUS:-meniscus} SBATCH=${SBATCH:-sbatch}
stem=${output%.exr}
[ "$slices" -ge 1 ] && [ "$slices" -le "$samples" ] || { echo "$0: $slices slices of $samples samples" >&2; exit 2; }
export MENISCUS scene samples slices stem

# Slice I of N holds the samples from (I - 1) * S / N + 1 to I * S / N. One minute before the time of a job ends it gets TERM,
# the program writes its checkpoint, and the job asks to be run again.
array=$($SBATCH --parsable --array="1-$slices" --requeue --signal=TERM@60 --job-name="$(basename "$stem")" --output="$stem.%a.log" \
    --open-mode=append << JOB
#!/bin/sh
i=\$SLURM_ARRAY_TASK_ID
first=\$(((i - 1) * samples / slices + 1)) last=\$((i * samples / slices))
srun --ntasks=1 "\$MENISCUS" render "$scene" --spp "\$samples" --sample-range "\$first..\$last" -o "\$stem.\$i.exr" \
    --checkpoint 5m --resume --skip-existing $*
status=\$?
case \$status in 75 | 143) scontrol requeue "\${SLURM_ARRAY_JOB_ID}_\$i" && exit 0 ;; esac
exit \$status
JOB
)
parts=
for i in $(seq "$slices"); do parts="$parts $stem.$i.exr"; done
merge=$($SBATCH --parsable --dependency="afterok:$array" --job-name="$(basename "$stem")-merge" --output="$stem.merge.log" \
    --wrap="srun --ntasks=1 $MENISCUS merge -o $output$parts")
echo "slices: job $array; merge: job $merge, which writes $output"
