/* limits.c - the table of limits.
 * SPDX-License-Identifier: Apache-2.0 */
#include "diag/limits.h"

static const LimitRow rows[] = {
#define LIMIT(name, number, what, cure) {number, what, cure},
#include "diag/limits.def"
#undef LIMIT
};

const LimitRow *limit_row(Limit limit)
{
    return &rows[limit];
}

void limit_hint(Diag *diag, Diagnostic *report, Limit limit)
{
    diag_hint(diag, report, "%s", rows[limit].cure);
}
