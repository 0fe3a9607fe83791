/* report_table.c - rows of cells, in columns as wide as their widest cell.
 * SPDX-License-Identifier: Apache-2.0 */
#include "check/report_table.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/utf8.h"

static unsigned text_width(const char *text)
{
    unsigned width = 0;
    for (size_t n = strlen(text); n > 0;) {
        uint32_t code;
        size_t used = utf8_decode(text, n, &code);
        width += utf8_width(code);
        text += used;
        n -= used;
    }
    return width;
}

Buf *report_row(ReportTable *table)
{
    size_t n = (table->n_rows + 1) * table->n_columns;
    if (!array_reserve(&table->cells, &table->capacity, n, sizeof *table->cells)) {
        table->failed = true;
        return table->spare;
    }
    Buf *row = table->cells + table->n_rows++ * table->n_columns;
    for (unsigned i = 0; i < table->n_columns; i++) row[i] = (Buf){0};
    return row;
}

void report_print_table(ReportTable *table, Buf *out)
{
    unsigned width[REPORT_COLUMNS] = {0};
    for (size_t i = 0; i < table->n_rows * table->n_columns; i++) {
        unsigned w = text_width(buf_text(&table->cells[i])), column = (unsigned)(i % table->n_columns);
        if (w > width[column]) width[column] = w;
    }
    for (size_t row = 0; row < table->n_rows; row++) {
        size_t pending = 2; /* blanks are written only before text, so that lines do not end in them */
        for (unsigned column = 0; column < table->n_columns; column++) {
            Buf *cell = &table->cells[row * table->n_columns + column];
            unsigned blank = width[column] - text_width(buf_text(cell));
            if (cell->length) {
                buf_add_repeat(out, ' ', pending + (table->right[column] ? blank : 0));
                buf_add(out, buf_text(cell));
                pending = table->right[column] ? 0 : blank;
            } else {
                pending += width[column];
            }
            if (width[column]) pending += 2;
            buf_clear(cell);
        }
        buf_add(out, "\n");
    }
    if (table->failed) out->failed = true;
    for (unsigned i = 0; i < REPORT_COLUMNS; i++) buf_clear(&table->spare[i]);
    free(table->cells);
}
