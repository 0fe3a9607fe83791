/* processors.c - what the system lets a process have of its processors.
 * SPDX-License-Identifier: Apache-2.0 */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* sched_getaffinity */
#endif
#include "base/processors.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#if defined(__linux__)
#include <sched.h>
#endif

/* Longer names of groups are not looked for: they have no quota then. */
enum { LONGEST = 4096, MOST = 1024 };

static bool read_line(const char *path, char line[LONGEST])
{
    FILE *file = fopen(path, "r");
    if (!file) return false;
    bool good = fgets(line, LONGEST, file) != NULL;
    return fclose(file) == 0 && good;
}

/* Of one group, whose files are in `folder`; 0: none. */
static double quota_of_group(const char *folder)
{
    char path[LONGEST + 32], line[LONGEST], period_line[LONGEST];
    double quota = 0, period = 0;
    (void)snprintf(path, sizeof path, "%s/cpu.max", folder);
    if (read_line(path, line)) return sscanf(line, "%lf %lf", &quota, &period) == 2 && period > 0 ? quota / period : 0;
    (void)snprintf(path, sizeof path, "%s/cpu.cfs_quota_us", folder);
    if (!read_line(path, line)) return 0;
    (void)snprintf(path, sizeof path, "%s/cpu.cfs_period_us", folder);
    if (!read_line(path, period_line)) return 0;
    if (sscanf(line, "%lf", &quota) != 1 || sscanf(period_line, "%lf", &period) != 1) return 0;
    return quota > 0 && period > 0 ? quota / period : 0; /* -1: none */
}

/* The least one of a group and of those that it is in, up to the mount itself. Within a container the group's name may be that
 * outside of it, where nothing is here; the container's own is the mount then. */
static double quota_of_branch(const char *mount, const char *group)
{
    char folder[LONGEST];
    double least = 0;
    size_t length = strlen(mount);
    if (snprintf(folder, sizeof folder, "%s%s", mount, group) >= (int)sizeof folder) return 0;
    for (char *end = folder + strlen(folder);; *end = '\0') {
        double quota = quota_of_group(folder);
        if (quota > 0 && (least == 0 || quota < least)) least = quota;
        end = strrchr(folder, '/');
        if (!end || (size_t)(end - folder) < length) return least;
    }
}

/* Whether "cpu" is in a list as "cpu,cpuacct". */
static bool lists_cpu(const char *list)
{
    for (; *list; list += strcspn(list, ","), list += *list == ',')
        if (strcspn(list, ",") == 3 && memcmp(list, "cpu", 3) == 0) return true;
    return false;
}

double processors_quota(const char *groups, const char *mounts)
{
    char line[LONGEST], mount[LONGEST];
    double least = 0;
    FILE *file = fopen(groups, "r");
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        char *list = strchr(line, ':'), *group = list ? strchr(list + 1, ':') : NULL; /* number:list:group */
        if (!group || group[1] != '/') continue;
        *group++ = '\0';
        list++;
        bool unified = *list == '\0';
        if (!unified && !lists_cpu(list)) continue;
        if (snprintf(mount, sizeof mount, "%s%s%s", mounts, unified ? "" : "/", list) >= (int)sizeof mount) continue;
        double quota = quota_of_branch(mount, group);
        if (quota > 0 && (least == 0 || quota < least)) least = quota;
    }
    if (file) (void)fclose(file);
    return least;
}

unsigned processors_usable(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
#if defined(__linux__)
    cpu_set_t set; /* of the first 1,024, which is as many as are used */
    if (sched_getaffinity(0, sizeof set, &set) == 0) n = CPU_COUNT(&set);
    double quota = processors_quota("/proc/self/cgroup", "/sys/fs/cgroup");
    if (quota > 0 && ceil(quota) < (double)n) n = (long)ceil(quota);
#endif
    return n < 1 ? 1 : n > MOST ? MOST : (unsigned)n;
}
