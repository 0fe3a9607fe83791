/* tally.c - short lists of things and their numbers.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/tally.h"

#include <stdlib.h>

bool tally_add(Tally *tally, uint32_t id, uint32_t n)
{
    for (uint32_t i = 0; i < tally->n; i++)
        if (tally->items[i].id == id) {
            tally->items[i].n += n;
            return true;
        }
    if (tally->n == tally->capacity) {
        uint32_t capacity = tally->capacity ? 2 * tally->capacity : 2;
        TallyItem *grown = realloc(tally->items, capacity * sizeof *grown);
        if (!grown) return false;
        tally->items = grown;
        tally->capacity = capacity;
    }
    tally->items[tally->n++] = (TallyItem){id, n};
    return true;
}

bool tally_join(Tally *tally, const Tally *next)
{
    for (uint32_t i = 0; i < next->n; i++)
        if (!tally_add(tally, next->items[i].id, next->items[i].n)) return false;
    return true;
}

void tally_clear(Tally *tally)
{
    free(tally->items);
    *tally = (Tally){0};
}

void tallies_free(Tally *tallies, size_t n)
{
    for (size_t i = 0; tallies && i < n; i++) free(tallies[i].items);
    free(tallies);
}

void tally_save(const Tally *tally, Buf *out)
{
    buf_add_bytes(out, (const char *)&tally->n, sizeof tally->n);
    buf_add_bytes(out, (const char *)tally->items, tally->n * sizeof *tally->items);
}

bool tally_load(Tally *tally, BufReader *in)
{
    uint32_t n;
    tally_clear(tally);
    if (!buf_take(in, &n, sizeof n) || n > in->left / sizeof *tally->items) return false;
    if (n == 0) return true;
    tally->items = malloc(n * sizeof *tally->items);
    if (!tally->items) return false;
    tally->n = tally->capacity = n;
    return buf_take(in, tally->items, n * sizeof *tally->items);
}
