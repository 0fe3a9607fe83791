/* processors.h - how many processors this process may use.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PROCESSORS_H
#define MEN_PROCESSORS_H

/* 1 .. 1024: those that are on and that the process may run on (taskset, a batch system's or container's set), but no more
 * than its share of their time is worth (a container's quota), rounded up. */
unsigned processors_usable(void);

/* The least quota of the control groups that a file as /proc/self/cgroup names, and of those around them, in processors;
 * 0: none. mounts: where the groups' files are, as /sys/fs/cgroup; version 2 (cpu.max) and 1 (cpu.cfs_quota_us). */
double processors_quota(const char *groups, const char *mounts);

#endif
