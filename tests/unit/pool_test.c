/* pool_test.c - every task once, whoever is slow, neighbours on one thread, and how many threads there are by themselves.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <sys/stat.h>
#include <time.h>

#include "base/pool.h"
#include "base/processors.h"
#include "temporary.h"

enum { N = 4000, MOST_THREADS = 7 };

typedef struct Work {
    atomic_uint runs[N];
    unsigned worker[N]; /* who did it */
    atomic_bool busy[MOST_THREADS];
    uint32_t n;
    unsigned slow; /* this worker sleeps at each of its tasks */
    bool twice;    /* a worker ran two at a time */
} Work;

static void sleep_ms(long ms)
{
    nanosleep(&(struct timespec){.tv_nsec = ms * 1000000}, NULL);
}

static void task(void *context, uint32_t index, unsigned worker)
{
    Work *work = context;
    if (atomic_exchange(&work->busy[worker], true)) work->twice = true;
    if (worker == work->slow) sleep_ms(2);
    atomic_fetch_add(&work->runs[index], 1);
    work->worker[index] = worker;
    atomic_store(&work->busy[worker], false);
}

static void every_task_is_run_once(void **state)
{
    (void)state;
    static Work work;
    const uint32_t sizes[] = {0, 1, 2, 3, 5, 64, 999, N};
    for (unsigned threads = 1; threads <= MOST_THREADS; threads++) {
        Pool *pool = NULL;
        assert_int_equal(pool_new(threads, &pool, NULL), STATUS_OK);
        assert_int_equal(pool_threads(pool), threads);
        for (size_t s = 0; s < COUNT_OF(sizes); s++) {
            memset(&work, 0, sizeof work);
            work.n = sizes[s];
            work.slow = threads > 1 ? (unsigned)s % threads : MOST_THREADS; /* the others take what it leaves */
            pool_run(pool, work.n, task, &work);
            for (uint32_t i = 0; i < N; i++) assert_int_equal(work.runs[i], i < work.n);
            assert_false(work.twice);
        }
        pool_free(pool);
    }
}

/* A thread that sleeps is left with what it sleeps over: the others take its tasks from their end. */
static void a_slow_thread_is_helped(void **state)
{
    (void)state;
    static Work work;
    Pool *pool = NULL;
    assert_int_equal(pool_new(2, &pool, NULL), STATUS_OK);
    memset(&work, 0, sizeof work);
    work.n = N;
    work.slow = 1; /* 4 s, were it alone with its half */
    pool_run(pool, N, task, &work);
    uint32_t own = 0;
    for (uint32_t i = N / 2; i < N; i++) own += work.worker[i] == 1;
    assert_in_range(own, 0, N / 4);
    for (uint32_t i = N / 2; i < N / 2 + own; i++) assert_int_equal(work.worker[i], 1);
    pool_free(pool);
}

static void write_text(const char *name, const char *text)
{
    write_bytes(in_folder(name), text, strlen(text));
}

static double quota_of(const char *groups)
{
    write_text("cgroup", groups);
    char file[300];
    snprintf(file, sizeof file, "%s", in_folder("cgroup"));
    return processors_quota(file, folder);
}

static void quotas_of_control_groups(void **state)
{
    (void)state;
    const char *folders[] = {"a", "a/b", "cpu,cpuacct", "cpu,cpuacct/job"};
    for (size_t i = 0; i < COUNT_OF(folders); i++) assert_int_equal(mkdir(in_folder(folders[i]), 0700), 0);
    assert_true(quota_of("0::/a/b\n") == 0); /* nobody says anything */
    write_text("a/b/cpu.max", "max 100000\n");
    assert_true(quota_of("0::/a/b\n") == 0);
    write_text("a/cpu.max", "250000 100000\n"); /* what is around it counts */
    assert_true(quota_of("0::/a/b\n") == 2.5);
    write_text("a/b/cpu.max", "50000 100000\n");
    assert_true(quota_of("0::/a/b\n") == 0.5);
    assert_true(quota_of("0::/a\n") == 2.5);
    assert_true(quota_of("0::/elsewhere/of/the/host\n") == 0);
    write_text("cpu.max", "300000 100000\n"); /* a container's own */
    assert_true(quota_of("0::/elsewhere/of/the/host\n") == 3);
    assert_true(quota_of("0::/\n") == 3);
    write_text("cpu,cpuacct/job/cpu.cfs_quota_us", "-1\n");
    write_text("cpu,cpuacct/job/cpu.cfs_period_us", "100000\n");
    assert_true(quota_of("5:cpu,cpuacct:/job\n3:cpuset:/a/b\n") == 0);
    write_text("cpu,cpuacct/job/cpu.cfs_quota_us", "150000\n");
    assert_true(quota_of("3:cpuset:/a/b\n5:cpu,cpuacct:/job\n") == 1.5);
    assert_true(quota_of("nonsense\n::::\n0::\n\n:\n") == 0);
    assert_true(processors_quota("/there/is/no/such", folder) == 0);
}

/* As `taskset` and batch systems have it. */
static void no_more_threads_than_may_run(void **state)
{
    (void)state;
    unsigned usable = processors_usable();
    assert_in_range(usable, 1, 1024);
    Pool *pool = NULL;
    assert_int_equal(pool_new(0, &pool, NULL), STATUS_OK);
    assert_int_equal(pool_threads(pool), usable);
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_task_is_run_once),
        cmocka_unit_test(a_slow_thread_is_helped),
        cmocka_unit_test(quotas_of_control_groups),
        cmocka_unit_test(no_more_threads_than_may_run),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
