/* pool.c - the thread pool: one job at a time. Each thread has its share of the tasks and takes from others when that is
 * done, so that of the same tasks, again and again, as of the passes over a picture, a thread does the same ones: what
 * they write is still near it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/pool.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/processors.h"

typedef struct PoolThread {
    Pool *pool;
    unsigned worker;
    pthread_t thread;
} PoolThread;

/* A thread's part of a job: the number of its next task, and in the upper half of the word that of the first which is not
 * its own any more. */
typedef struct Share {
    _Alignas(MEMORY_APART) atomic_uint_fast64_t left;
} Share;

struct Pool {
    unsigned n_threads;  /* the calling thread included */
    PoolThread *threads; /* n_threads - 1 of them were started */
    unsigned n_started;
    pthread_mutex_t mutex;
    pthread_cond_t job_posted, job_finished;
    uint64_t job; /* counts jobs, so that a thread knows a new one from the one it has done */
    unsigned n_busy;
    bool closing;
    void (*task)(void *context, uint32_t index, unsigned worker);
    void *context;
    Share *shares; /* one per thread */
};

static uint32_t count_left(uint64_t left)
{
    return (uint32_t)(left >> 32) - (uint32_t)left;
}

/* A thread's own next task, from the beginning of its share; false: there is none. */
static bool take_own(Share *share, uint32_t *index)
{
    uint64_t left = atomic_load_explicit(&share->left, memory_order_relaxed);
    do {
        if (count_left(left) == 0) return false;
        *index = (uint32_t)left;
    } while (!atomic_compare_exchange_weak_explicit(&share->left, &left, left + 1, memory_order_relaxed,
                                                    memory_order_relaxed));
    return true;
}

/* One from the end of whichever share has most; false: all are empty. */
static bool take_other(const Pool *pool, uint32_t *index)
{
    for (;;) {
        Share *share = NULL;
        uint64_t left = 0;
        for (unsigned i = 0; i < pool->n_threads; i++) {
            uint64_t one = atomic_load_explicit(&pool->shares[i].left, memory_order_relaxed);
            if (count_left(one) <= count_left(left)) continue;
            left = one;
            share = &pool->shares[i];
        }
        if (!share) return false;
        *index = (uint32_t)(left >> 32) - 1;
        if (atomic_compare_exchange_strong_explicit(&share->left, &left, left - (UINT64_C(1) << 32),
                                                    memory_order_relaxed, memory_order_relaxed))
            return true;
    }
}

static void work(Pool *pool, unsigned worker)
{
    uint32_t index;
    while (take_own(&pool->shares[worker], &index) || take_other(pool, &index))
        pool->task(pool->context, index, worker);
}

/* Of n tasks as many to each thread, one after the other. */
static void share_out(Pool *pool, uint32_t n)
{
    uint64_t first = 0;
    for (unsigned i = 0; i < pool->n_threads; i++) {
        uint64_t end = ((uint64_t)i + 1) * n / pool->n_threads;
        atomic_store_explicit(&pool->shares[i].left, end << 32 | first, memory_order_relaxed);
        first = end;
    }
}

static void *thread_main(void *argument)
{
    PoolThread *self = argument;
    Pool *pool = self->pool;
    uint64_t done = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (!pool->closing && pool->job == done) pthread_cond_wait(&pool->job_posted, &pool->mutex);
        if (pool->closing) break;
        done = pool->job;
        pthread_mutex_unlock(&pool->mutex);
        work(pool, self->worker);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->n_busy == 0) pthread_cond_signal(&pool->job_finished);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

Status pool_new(unsigned n_threads, Pool **out, Error *error)
{
    *out = NULL;
    if (n_threads == 0) n_threads = processors_usable();
    Pool *pool = calloc(1, sizeof *pool);
    PoolThread *threads = calloc(n_threads, sizeof *threads);
    Share *shares = memory_apart(n_threads, sizeof *shares);
    if (!pool || !threads || !shares) {
        free(pool);
        free(threads);
        free(shares);
        return fail_memory(error, sizeof *pool + n_threads * (sizeof *threads + sizeof *shares), "threads");
    }
    pool->n_threads = n_threads;
    pool->threads = threads;
    pool->shares = shares;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->job_posted, NULL);
    pthread_cond_init(&pool->job_finished, NULL);
    for (unsigned i = 0; i + 1 < n_threads; i++) {
        threads[i] = (PoolThread){.pool = pool, .worker = i + 1};
        int code = pthread_create(&threads[i].thread, NULL, thread_main, &threads[i]);
        if (code) {
            pool_free(pool);
            return fail(error, STATUS_RENDER, "cannot start thread %u of %u: %s", i + 2, n_threads, strerror(code));
        }
        pool->n_started++;
    }
    *out = pool;
    return STATUS_OK;
}

void pool_free(Pool *pool)
{
    if (!pool) return;
    pthread_mutex_lock(&pool->mutex);
    pool->closing = true;
    pthread_cond_broadcast(&pool->job_posted);
    pthread_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i < pool->n_started; i++) pthread_join(pool->threads[i].thread, NULL);
    pthread_cond_destroy(&pool->job_posted);
    pthread_cond_destroy(&pool->job_finished);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->threads);
    free(pool->shares);
    free(pool);
}

unsigned pool_threads(const Pool *pool)
{
    return pool ? pool->n_threads : 1;
}

void pool_run(Pool *pool, uint32_t n, void (*task)(void *context, uint32_t index, unsigned worker), void *context)
{
    if (!pool || n < 2) {
        for (uint32_t i = 0; i < n; i++) task(context, i, 0);
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->task = task;
    pool->context = context;
    share_out(pool, n);
    pool->n_busy = pool->n_started;
    pool->job++;
    pthread_cond_broadcast(&pool->job_posted);
    pthread_mutex_unlock(&pool->mutex);
    work(pool, 0);
    pthread_mutex_lock(&pool->mutex);
    while (pool->n_busy) pthread_cond_wait(&pool->job_finished, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}
