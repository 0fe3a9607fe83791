/* equal.c - items are sorted into parts by the upper bits of their hashes, in order; then each part is looked through
 * with a small table of its own. Equal items are in the same part.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/equal.h"

#include <stdatomic.h>
#include <stdlib.h>

enum { LEAST_BLOCK = 1 << 14, MOST_BLOCKS = 256, ITEMS_OF_A_PART = 1 << 12, MOST_PARTS_BITS = 12 };

typedef struct Hashed {
    uint32_t hash, item;
} Hashed;

typedef struct Search {
    const EqualItems *items;
    uint32_t n, block, n_blocks;
    uint32_t part_bits;
    uint32_t *places; /* of each part and block: how many, then where the next goes */
    uint32_t *hashes;
    Hashed *sorted; /* by part */
    uint32_t *first;
    atomic_bool out_of_memory;
} Search;

static uint32_t part_of(const Search *search, uint32_t hash)
{
    return search->part_bits ? hash >> (32 - search->part_bits) : 0;
}

static uint32_t end_of_block(const Search *search, uint32_t block)
{
    return search->n - block * search->block < search->block ? search->n : (block + 1) * search->block;
}

static void count_block(void *context, uint32_t block, unsigned worker)
{
    (void)worker;
    Search *search = context;
    for (uint32_t i = block * search->block; i < end_of_block(search, block); i++) {
        uint32_t hash = search->items->hash(search->items->context, i);
        search->hashes[i] = hash;
        search->places[part_of(search, hash) * search->n_blocks + block]++;
    }
}

static void sort_block(void *context, uint32_t block, unsigned worker)
{
    (void)worker;
    Search *search = context;
    for (uint32_t i = block * search->block; i < end_of_block(search, block); i++) {
        uint32_t hash = search->hashes[i];
        search->sorted[search->places[part_of(search, hash) * search->n_blocks + block]++] = (Hashed){hash, i};
    }
}

/* Where each block's items of each part go, in order of parts and blocks. */
static void sum_places(Search *search)
{
    uint32_t sum = 0, n = search->n_blocks << search->part_bits;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t count = search->places[i];
        search->places[i] = sum;
        sum += count;
    }
}

/* After sorting, a part ends where the next place of its last block is. */
static uint32_t end_of_part(const Search *search, uint32_t part)
{
    return search->places[(part + 1) * search->n_blocks - 1];
}

static void search_part(void *context, uint32_t part, unsigned worker)
{
    (void)worker;
    Search *search = context;
    const EqualItems *items = search->items;
    uint32_t begin = part ? end_of_part(search, part - 1) : 0, end = end_of_part(search, part);
    size_t room = 16;
    while (room < 2 * (size_t)(end - begin)) room *= 2;
    uint32_t *table = calloc(room, sizeof *table); /* place in `sorted` + 1 - begin, 0: free */
    if (!table) {
        atomic_store(&search->out_of_memory, true);
        return;
    }
    for (uint32_t i = begin; i < end; i++) {
        const Hashed *here = &search->sorted[i];
        size_t slot = here->hash & (room - 1);
        for (; table[slot]; slot = (slot + 1) & (room - 1)) {
            const Hashed *other = &search->sorted[begin + table[slot] - 1];
            if (other->hash == here->hash && items->same(items->context, other->item, here->item)) break;
        }
        if (!table[slot]) table[slot] = i - begin + 1;
        search->first[here->item] = search->sorted[begin + table[slot] - 1].item;
    }
    free(table);
}

static bool reserve(Search *search)
{
    size_t n = search->n + 1UL;
    search->places = calloc((size_t)search->n_blocks << search->part_bits, sizeof *search->places);
    search->hashes = malloc(n * sizeof *search->hashes);
    search->sorted = malloc(n * sizeof *search->sorted);
    search->first = malloc(n * sizeof *search->first);
    return search->places && search->hashes && search->sorted && search->first;
}

Status equal_find(const EqualItems *items, uint32_t n, const char *what, Pool *pool, uint32_t **first, Error *error)
{
    Search search = {.items = items, .n = n, .block = n / MOST_BLOCKS + 1};
    if (search.block < LEAST_BLOCK) search.block = LEAST_BLOCK;
    search.n_blocks = n / search.block + 1;
    while (search.part_bits < MOST_PARTS_BITS && n >> search.part_bits > ITEMS_OF_A_PART) search.part_bits++;
    bool done = reserve(&search);
    if (done) {
        pool_run(pool, search.n_blocks, count_block, &search);
        sum_places(&search);
        pool_run(pool, search.n_blocks, sort_block, &search);
        pool_run(pool, 1U << search.part_bits, search_part, &search);
        done = !search.out_of_memory;
    }
    free(search.places);
    free(search.hashes);
    free(search.sorted);
    if (!done) {
        free(search.first);
        return fail_memory(error, n * (sizeof *search.sorted + 3 * sizeof(uint32_t)), what);
    }
    *first = search.first;
    return STATUS_OK;
}
