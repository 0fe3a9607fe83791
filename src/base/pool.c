/* pool.c - the thread pool: one job at a time, its tasks handed out by an atomic counter.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/pool.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct PoolThread {
    Pool *pool;
    unsigned worker;
    pthread_t thread;
} PoolThread;

struct Pool {
    unsigned n_threads; /* the calling thread included */
    PoolThread *threads; /* n_threads - 1 of them were started */
    unsigned n_started;
    pthread_mutex_t mutex;
    pthread_cond_t job_posted, job_finished;
    uint64_t job; /* counts jobs, so that a thread knows a new one from the one it has done */
    unsigned n_busy;
    bool closing;
    void (*task)(void *context, uint32_t index, unsigned worker);
    void *context;
    uint32_t n_tasks;
    atomic_uint_fast64_t next; /* 64 bits: threads may step past the end without wrapping */
};

static void work(Pool *pool, unsigned worker)
{
    for (;;) {
        uint_fast64_t index = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (index >= pool->n_tasks) return;
        pool->task(pool->context, (uint32_t)index, worker);
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

static unsigned processor_count(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n < 1 ? 1 : n > 1024 ? 1024 : (unsigned)n;
}

Status pool_new(unsigned n_threads, Pool **out, Error *error)
{
    *out = NULL;
    if (n_threads == 0) n_threads = processor_count();
    Pool *pool = calloc(1, sizeof *pool);
    PoolThread *threads = calloc(n_threads, sizeof *threads);
    if (!pool || !threads) {
        free(pool);
        free(threads);
        return fail_memory(error, sizeof *pool + n_threads * sizeof *threads, "threads");
    }
    pool->n_threads = n_threads;
    pool->threads = threads;
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
    pool->n_tasks = n;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    pool->n_busy = pool->n_started;
    pool->job++;
    pthread_cond_broadcast(&pool->job_posted);
    pthread_mutex_unlock(&pool->mutex);
    work(pool, 0);
    pthread_mutex_lock(&pool->mutex);
    while (pool->n_busy) pthread_cond_wait(&pool->job_finished, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}
