/* limits.h - what a scene can have too much of, as numbers and as a table: limits.def.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIMITS_H
#define MEN_LIMITS_H

#include "diag/diag.h"

enum {
#define LIMIT(name, number, what, cure) LIMIT_##name = number,
#include "diag/limits.def"
#undef LIMIT
};

typedef enum Limit {
#define LIMIT(name, number, what, cure) OVER_##name,
#include "diag/limits.def"
#undef LIMIT
    LIMIT_COUNT
} Limit;

typedef struct LimitRow {
    double number;
    const char *what, *cure;
} LimitRow;

const LimitRow *limit_row(Limit limit);
/* Adds the cure to a report that says which limit was reached. */
void limit_hint(Diag *diag, Diagnostic *report, Limit limit);

#endif
