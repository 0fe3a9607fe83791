/* processes.c - what two processes cost each other, with the memory of the scene in common and with each its own.
 *
 * Two threads share more than the processes of the first kind do: locks, counters, what is written. Processes that were forked
 * when the scene was built share what is only read. So what a path takes longer beside one of these, and not beside one with a
 * scene of its own, is what the machine takes for two processors that read the same memory.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdatomic.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "measure.h"

typedef struct Both {
    atomic_uint arrived;                  /* of the two, at all places together */
    double alone_s[RUNS], beside_s[RUNS]; /* of the first one, for the same paths */
} Both;

/* Pages of a file that has no name: MAP_ANONYMOUS is not of POSIX. */
static Both *both_new(void)
{
    FILE *file = tmpfile();
    if (!file || ftruncate(fileno(file), sizeof(Both)) != 0) bench_fail("a file for two processes", NULL);
    void *pages = mmap(NULL, sizeof(Both), PROT_READ | PROT_WRITE, MAP_SHARED, fileno(file), 0);
    if (pages == MAP_FAILED) bench_fail("memory for two processes", NULL);
    fclose(file);
    return pages;
}

/* Waits until both are at the place of this number, from 1. */
static void meet(Both *both, unsigned place)
{
    atomic_fetch_add(&both->arrived, 1);
    while (atomic_load(&both->arrived) < 2 * place) nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL);
}

static double render_s(const Made *made, Pool *one, uint32_t samples)
{
    double start = clock_cpu_s();
    render_at(made->compiled, 160, 120, samples, one);
    return clock_cpu_s() - start;
}

/* Does not return. */
static void render_beside(Both *both, const Made *made, bool first)
{
    Pool *one = pool_of(1);
    unsigned place = 0;
    render_s(made, one, 2); /* so that the memory is there */
    for (int run = 0; run < RUNS; run++) {
        meet(both, ++place);
        if (first) both->alone_s[run] = render_s(made, one, 16);
        meet(both, ++place);
        double seconds = render_s(made, one, 16);
        if (first) both->beside_s[run] = seconds;
    }
    _exit(0);
}

static void wait_for_children(const char *path)
{
    int status;
    while (wait(&status) > 0)
        if (status != 0) bench_fail(path, NULL);
}

static pid_t fork_or_fail(void)
{
    pid_t child = fork();
    if (child < 0) bench_fail("another process", NULL);
    return child;
}

/* The scene is built in a child, as nothing that a library keeps for its threads is to be there before the fork. */
static void run_with_one_scene(Both *both, const char *path)
{
    if (fork_or_fail() == 0) {
        Made made;
        made_from_file(&made, path);
        for (int k = 0; k < 2; k++)
            if (fork_or_fail() == 0) render_beside(both, &made, k == 0);
        wait_for_children(path);
        _exit(0);
    }
    wait_for_children(path);
}

static void run_with_two_scenes(Both *both, const char *path)
{
    for (int k = 0; k < 2; k++)
        if (fork_or_fail() == 0) {
            Made made;
            made_from_file(&made, path);
            render_beside(both, &made, k == 0);
        }
    wait_for_children(path);
}

void processes_of(const char *path)
{
    printf("%-20s", file_name(path));
    fflush(stdout);
    for (int k = 0; k < 2; k++) {
        double ratio[RUNS];
        Both *both = both_new();
        (k == 0 ? run_with_one_scene : run_with_two_scenes)(both, path);
        for (int run = 0; run < RUNS; run++) ratio[run] = both->beside_s[run] / both->alone_s[run];
        Quartiles spread = spread_of(ratio, RUNS);
        printf("  %5.3f (%.3f .. %.3f)", spread.median, spread.low, spread.high);
        munmap(both, sizeof *both);
    }
    printf("\n");
    fflush(stdout);
}
