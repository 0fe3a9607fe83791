/* array.h - growth of malloc'd arrays: ARRAY_ROOM(items, capacity, n) makes room for one more.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ARRAY_H
#define MEN_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/attr.h"

/* Grows *items (elements of size bytes) so that it holds at least n elements; doubles. Returns
 * false, with everything as it was, when memory ends or the size overflows. */
bool array_reserve(void *items_pointer, size_t *capacity, size_t n, size_t size) ATTR_NODISCARD;

/* true when items has room for element number n (0-based) */
#define ARRAY_ROOM(items, capacity, n) array_reserve(&(items), &(capacity), (n) + 1, sizeof *(items))

#endif
