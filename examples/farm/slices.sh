#!/bin/sh
# One picture in slices: a job array of Slurm, and a job that merges them when all are done.
# usage: examples/farm/slices.sh SCENE OUTPUT.exr SAMPLES SLICES [OPTION...]     options go to `meniscus render`
# Scene and output are in folders that all nodes share. A slice whose file is there is left out when this is run again. One that
# is stopped, as its time ends or its node is wanted for something else, has a checkpoint, and is put into the queue again.
# MENISCUS: the program; SBATCH: sbatch with what the cluster wants, such as "sbatch --partition=long --time=4:00:00".
# SPDX-License-Identifier: Apache-2.0
set -eu
[ $# -ge 4 ] || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }
scene=$1 output=$2 samples=$3 slices=$4
shift 4
[ "$slices" -ge 1 ] && [ "$slices" -le "$samples" ] || { echo "$0: $slices slices of $samples samples" >&2; exit 2; }
stem=${output%.exr}
name=$(basename "$stem")
folder=$(cd "$(dirname "$0")" && pwd)
MENISCUS=${MENISCUS:-meniscus}
export MENISCUS

parts='' i=0
while [ $i -lt "$slices" ]; do
    i=$((i + 1))
    parts="$parts $stem.$i.exr"
done
array=$(${SBATCH:-sbatch} --parsable --array="1-$slices" --requeue --signal=B:TERM@60 --job-name="$name" --open-mode=append \
    --output="$stem.%a.log" "$folder/slice.job" "$scene" "$stem" "$samples" "$slices" "$@")
merge=$(${SBATCH:-sbatch} --parsable --dependency="afterok:$array" --kill-on-invalid-dep=yes --job-name="$name-merge" \
    --output="$stem.merge.log" --wrap="'$MENISCUS' merge -o '$output'$parts")
echo "$output: slices by job $array, the merge by job $merge"
