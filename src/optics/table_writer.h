/* table_writer.h - tables as C sources, for the generators.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TABLE_WRITER_H
#define MEN_TABLE_WRITER_H

#include <stdint.h>
#include <stdio.h>

/* declaration: "float name[2][3]"; n values, `row` of them to a line. Exact, whatever reads them. */
static inline void table_write_floats(FILE *out, const char *declaration, const float *values, size_t n, size_t row)
{
    fprintf(out, "\nconst %s = {\n", declaration);
    for (size_t i = 0; i < n; i++) fprintf(out, "%af,%s", (double)values[i], (i + 1) % row ? "" : "\n");
    fputs("};\n", out);
}

static inline void table_write_packed(FILE *out, const char *declaration, const uint16_t *values, size_t n, size_t row)
{
    fprintf(out, "\nconst %s = {\n", declaration);
    for (size_t i = 0; i < n; i++) fprintf(out, "%d,%s", values[i], (i + 1) % row ? "" : "\n");
    fputs("};\n", out);
}

/* Closes the file; the exit status of the generator, with a message where not all was written. */
static inline int table_close(FILE *out, const char *generator, const char *path)
{
    int failed = ferror(out);
    if (fclose(out) == 0 && !failed) return 0;
    fprintf(stderr, "%s: cannot write %s\n", generator, path);
    return 1;
}

#endif
