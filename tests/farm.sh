#!/bin/sh
# The jobs of examples/farm, under a Slurm of one node that is started for it: slices of which one is stopped and put into the
# queue again, the merge, and frames. Needs root and the packages slurmctld, slurmd, slurm-client and munge; not part of make check.
# usage: tests/farm.sh MENISCUS
# SPDX-License-Identifier: Apache-2.0
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
case $1 in /*) MENISCUS=$1 ;; *) MENISCUS=$PWD/$1 ;; esac
export MENISCUS
for needed in slurmctld slurmd munged sbatch; do
    command -v $needed > /dev/null || { echo "farm: no $needed here, skipped"; exit 0; }
done
[ "$(id -u)" = 0 ] || { echo "farm: not root, skipped"; exit 0; }
scratch=$(mktemp -d) || exit 2
cd "$scratch" || exit 2
mkdir spool
host=$(hostname -s)
cat > slurm.conf << CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
StateSaveLocation=$scratch/spool
SlurmdSpoolDir=$scratch/spool/d
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/slurmd.pid
SlurmctldLogFile=$scratch/slurmctld.log
SlurmdLogFile=$scratch/slurmd.log
SlurmctldPort=16817
SlurmdPort=16818
MpiDefault=none
SchedulerParameters=sched_interval=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
SLURM_CONF=$scratch/slurm.conf
export SLURM_CONF
finish() {
    for daemon in slurmd slurmctld; do [ ! -s "$scratch/$daemon.pid" ] || kill "$(cat "$scratch/$daemon.pid")"; done
    sleep 1
    rm -rf "$scratch"
}
trap finish EXIT
mkdir -p /run/munge && chown munge /run/munge
pgrep -x munged > /dev/null || runuser -u munge -- munged || exit 2
slurmctld && slurmd || exit 2

n_passed=0 n_failed=0
verdict() { if [ "$2" = yes ]; then n_passed=$((n_passed + 1)); else n_failed=$((n_failed + 1)); echo "not ok - $1"; fi; }
# wait_for SECONDS COMMAND...: until it succeeds
wait_for() {
    left=$1
    shift
    until "$@" > /dev/null 2>&1; do
        left=$((left - 1))
        [ $left -gt 0 ] || return 1
        sleep 1
    done
}
same() { if cmp -s "$1" "$2"; then echo yes; else echo no; fi; }
queue_is_empty() { [ -z "$(squeue -h -a)" ]; }
runs_last_slice() { squeue -h -t R -o %K | grep -qx 3 && [ -s out.3.log ] && grep -q Progress out.3.log; }

cat > kept.mns << 'SCENE'
meniscus 1.0 unit cm
medium glass { ior = 1.5  state = solid }
sphere { center = <0, 5, 0>  radius = 4  interior = glass }
ground { surface = surface { albedo = .5 } }
environment { color = 1 }
camera { from = <0, 10, -30 + 5 * clock>  to = <0, 4, 0>  fov = 30 }
film { size = <160, 120> }
SCENE
"$MENISCUS" render kept.mns -s 900 -o whole.exr -q
wait_for 60 sinfo -h -t idle
sh "$root/examples/farm/slices.sh" kept.mns out.exr 900 3
if wait_for 200 runs_last_slice; then scancel --signal=TERM --batch "$(squeue -h -t R -o '%F_%K' | grep '_3$')"; fi
wait_for 400 queue_is_empty # Slurm waits for two minutes before it runs a job again
verdict "a slice that is stopped goes on" "$(if grep -q 'going on from' out.3.log; then echo yes; else echo no; fi)"
verdict "the picture of slices is the whole" "$(same out.exr whole.exr)"

echo 'animation { frames = 5 }' >> kept.mns
"$MENISCUS" render kept.mns -s 20 -o 'frame-whole.#.exr' -q
sh "$root/examples/farm/frames.sh" kept.mns 'frame.#.exr' 2 -s 20
wait_for 200 queue_is_empty
for i in 1 2 3 4 5; do verdict "frame $i" "$(same frame.$i.exr frame-whole.$i.exr)"; done
echo "$n_passed passed, $n_failed failed"
[ $n_failed -eq 0 ]
