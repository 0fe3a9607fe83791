/* tally.h - how many samples of a pixel have to do with each of some things.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TALLY_H
#define MEN_TALLY_H

#include <stdint.h>

#include "base/buf.h"

typedef struct TallyItem {
    uint32_t id, n;
} TallyItem;

/* In the order in which they came. */
typedef struct Tally {
    TallyItem *items;
    uint32_t n, capacity;
} Tally;

/* false when memory ends. */
bool tally_add(Tally *tally, uint32_t id, uint32_t n);
bool tally_join(Tally *tally, const Tally *next);
void tally_clear(Tally *tally);
/* n of them, and the array; NULL is fine. */
void tallies_free(Tally *tallies, size_t n);

/* As bytes, and from them: over what is there. false where that cannot be, or memory ends. */
void tally_save(const Tally *tally, Buf *out);
bool tally_load(Tally *tally, BufReader *in);

#endif
