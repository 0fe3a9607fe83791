/* suggest.h - did-you-mean: the one known word that is near enough to a wrong one; and words as a list.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SUGGEST_H
#define MEN_SUGGEST_H

#include "base/arena.h"

/* The candidate with the smallest edit distance (a swap of neighbours counts as one edit, a
 * change of case as half, and no more for a whole word)
 * to wrong, when it is near enough to be a slip (about one edit in three letters) and no other candidate is as
 * near; else NULL. Equal candidates count once. */
const char *suggest_nearest(const char *wrong, const char *const *candidates, size_t n);

/* "a, b and c", where last is "and"; "nothing" of none. */
const char *suggest_list(Arena *arena, const char *const *words, size_t n, const char *last);

#endif
