/* report_table.h - rows of cells, in columns as wide as their widest cell.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_REPORT_TABLE_H
#define MEN_REPORT_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buf.h"

enum { REPORT_COLUMNS = 8 };
typedef struct ReportTable {
    Buf *cells; /* rows * n_columns */
    size_t n_rows, capacity;
    unsigned n_columns;
    bool right[REPORT_COLUMNS]; /* flush right */
    Buf spare[REPORT_COLUMNS];  /* the row when memory has ended */
    bool failed;
} ReportTable;
/* A new row's cells; one that is left empty is an empty line. */
Buf *report_row(ReportTable *table);
void report_print_table(ReportTable *table, Buf *out); /* and frees it */

#endif
