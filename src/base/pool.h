/* pool.h - a pool of POSIX threads that work through numbered tasks.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_POOL_H
#define MEN_POOL_H

#include <stdint.h>

#include "base/status.h"

typedef struct Pool Pool;

/* n_threads 0: one per processor that this process may use. The calling thread counts as one. */
ATTR_NODISCARD Status pool_new(unsigned n_threads, Pool **pool, Error *error);
void pool_free(Pool *pool);              /* NULL is fine */
unsigned pool_threads(const Pool *pool); /* NULL: 1 */

/* Calls task(context, index, worker) for index 0 .. n - 1, each once, in any order, on any thread;
 * neighbours mostly on one, the same one in the next job of as many; worker is 0 .. threads - 1 and never runs two tasks at a
 * time. Returns when all are done. pool NULL: the calling thread does them all. Not from within a task. */
void pool_run(Pool *pool, uint32_t n, void (*task)(void *context, uint32_t index, unsigned worker), void *context);

#endif
