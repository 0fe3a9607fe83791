/* suggest.c - the nearest word by the restricted Damerau-Levenshtein distance over bytes.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/suggest.h"

#include <string.h>

enum { LONGEST_WORD = 64, EDIT = 2, CASE_EDIT = 1 };

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static unsigned smaller(unsigned a, unsigned b)
{
    return a < b ? a : b;
}

static unsigned substitution(char a, char b)
{
    return a == b ? 0 : lower(a) == lower(b) ? CASE_EDIT : EDIT;
}

/* in half edits; both words are at most LONGEST_WORD long */
static unsigned distance(const char *a, size_t n_a, const char *b, size_t n_b)
{
    unsigned rows[3][LONGEST_WORD + 1]; /* two rows back, because a swap looks there */
    unsigned *before = rows[0], *previous = rows[1], *current = rows[2];
    for (size_t j = 0; j <= n_b; j++) previous[j] = (unsigned)j * EDIT;
    for (size_t i = 1; i <= n_a; i++) {
        current[0] = (unsigned)i * EDIT;
        for (size_t j = 1; j <= n_b; j++) {
            unsigned best = previous[j - 1] + substitution(a[i - 1], b[j - 1]);
            best = smaller(best, previous[j] + EDIT);
            best = smaller(best, current[j - 1] + EDIT);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                best = smaller(best, before[j - 2] + EDIT);
            current[j] = best;
        }
        unsigned *oldest = before;
        before = previous;
        previous = current;
        current = oldest;
    }
    return previous[n_b];
}

static int equal_but_for_case(const char *a, const char *b, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (lower(a[i]) != lower(b[i])) return 0;
    return 1;
}

const char *suggest_list(Arena *arena, const char *const *words, size_t n, const char *last)
{
    const char *text = n ? words[0] : "nothing";
    for (size_t i = 1; i < n; i++)
        text = i + 1 < n ? arena_format(arena, "%s, %s", text, words[i])
                         : arena_format(arena, "%s %s %s", text, last, words[i]);
    return text;
}

/* Is one of them the other with an 's' behind it? They are one word, as "bubble" and "bubbles" are. */
static int same_but_for_number(const char *a, const char *b)
{
    size_t n_a = strlen(a), n_b = strlen(b);
    const char *longer = n_a > n_b ? a : b;
    size_t n = n_a > n_b ? n_b : n_a;
    return n_a + n_b == 2 * n + 1 && strncmp(a, b, n) == 0 && longer[n] == 's';
}

const char *suggest_nearest(const char *wrong, const char *const *candidates, size_t n)
{
    size_t length = strlen(wrong);
    if (length == 0 || length > LONGEST_WORD) return NULL;
    /* one edit for two to four letters, two for five to seven, and so on; of a single letter only its case */
    unsigned best = 1 + (length == 1 ? CASE_EDIT : EDIT * (((unsigned)length + 1) / 3));
    const char *nearest = NULL;
    int unique = 1;
    for (size_t i = 0; i < n; i++) {
        size_t n_candidate = strlen(candidates[i]);
        if (n_candidate > LONGEST_WORD) continue;
        unsigned d = n_candidate == length && equal_but_for_case(wrong, candidates[i], length)
                         ? CASE_EDIT
                         : distance(wrong, length, candidates[i], n_candidate);
        if (d < best) {
            best = d;
            nearest = candidates[i];
            unique = 1;
        } else if (d == best && nearest && same_but_for_number(nearest, candidates[i])) {
            if (n_candidate == length)
                nearest = candidates[i]; /* two letters that changed places, and not one too many */
        } else if (d == best && nearest && strcmp(nearest, candidates[i]) != 0) {
            unique = 0;
        }
    }
    return unique ? nearest : NULL;
}
