#!/bin/sh
# The frames of an animation: a job array of Slurm, whose tasks deal the frames out among them.
# usage: examples/farm/frames.sh SCENE OUTPUT.####.exr TASKS [OPTION...]     options go to `meniscus render`
# Scene and output are in folders that all nodes share. Frames that are there are left out: run it again for those that failed.
# A frame that is stopped has a checkpoint, and goes on when the task is run again.
# MENISCUS: the program; SBATCH: sbatch with what the cluster wants, such as "sbatch --partition=long --time=4:00:00".
# SPDX-License-Identifier: Apache-2.0
set -eu
[ $# -ge 3 ] || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }
scene=$1 output=$2 tasks=$3
shift 3
folder=$(cd "$(dirname "$0")" && pwd)
MENISCUS=${MENISCUS:-meniscus}
export MENISCUS
stem=${output%.exr}
array=$(${SBATCH:-sbatch} --parsable --array="1-$tasks" --requeue --signal=B:TERM@60 --job-name="$(basename "$scene" .mns)" \
    --open-mode=append --output="$(dirname "$stem")/frames.%a.log" "$folder/frames.job" "$scene" "$output" "$tasks" "$@")
echo "$output: by job $array"
