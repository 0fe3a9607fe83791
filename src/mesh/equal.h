/* equal.h - of many items, which are equal: by their hashes, in parts that a processor's caches hold.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EQUAL_H
#define MEN_EQUAL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/pool.h"
#include "base/status.h"

/* How to tell items apart that are numbered from 0. Called by several threads. */
typedef struct EqualItems {
    const void *context;
    uint32_t (*hash)(const void *context, uint32_t i); /* all 32 bits matter */
    bool (*same)(const void *context, uint32_t i, uint32_t k);
} EqualItems;

/* (*first)[i] is the first of the n items that item i is equal to, i itself where there is none before it. malloc'd.
 * `what` names the undertaking in a message that memory has ended. The pool may be NULL; the result does not depend on
 * it. */
ATTR_NODISCARD Status equal_find(const EqualItems *items, uint32_t n, const char *what, Pool *pool, uint32_t **first,
                                 Error *error);

#endif
