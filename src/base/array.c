/* array.c - growth of malloc'd arrays.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/array.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

bool array_reserve(void *items_pointer, size_t *capacity, size_t n, size_t size)
{
    if (n <= *capacity) return true;
    size_t wanted = *capacity ? *capacity : 8;
    while (wanted < n) {
        if (wanted > SIZE_MAX / 2) return false;
        wanted *= 2;
    }
    if (wanted > SIZE_MAX / size) return false;
    void *items; /* copied in and out as bytes: the pointer's own type is the caller's */
    memcpy(&items, items_pointer, sizeof items);
    items = realloc(items, wanted * size);
    if (!items) return false;
    memcpy(items_pointer, &items, sizeof items);
    *capacity = wanted;
    return true;
}
