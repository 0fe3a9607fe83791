/* clock.h - time that passes.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CLOCK_H
#define MEN_CLOCK_H

#include <time.h>

/* seconds since some fixed moment */
static inline double clock_now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* processor time of all threads of the process so far */
static inline double clock_cpu_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
