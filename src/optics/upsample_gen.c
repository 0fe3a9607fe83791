/* upsample_gen.c - writes the table of upsample_table.h as C source, at build time.
 *     upsample_gen FILE
 * Each column of knots is solved outwards from its middle, every knot starting from its neighbour's
 * coefficients ([JH19] section 4). Takes about a second.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>

#include "optics/upsample_solve.h"
#include "optics/upsample_table.h"

typedef double Column[UPSAMPLE_KNOTS][3];

/* All z of one pair of ratios; returns the largest error. */
static double solve_column(const UpsampleSolver *solver, int largest, int second, int first, Column column)
{
    const int middle = UPSAMPLE_KNOTS / 2;
    double worst = 0;
    for (int direction = -1; direction <= 1; direction += 2) {
        double coefficients[3];
        for (int knot = middle; knot >= 0 && knot < UPSAMPLE_KNOTS; knot += direction) {
            double z = upsample_z_of_knot(knot), rgb[3];
            rgb[largest] = z;
            rgb[(largest + 1) % 3] = z * upsample_ratio_of_knot(first);
            rgb[(largest + 2) % 3] = z * upsample_ratio_of_knot(second);
            double error = (knot == middle ? upsample_solve : upsample_solve_near)(solver, rgb, coefficients);
            worst = fmax(worst, error);
            for (int i = 0; i < 3; i++) column[knot][i] = coefficients[i];
        }
    }
    return worst;
}

static double solve_table(float *table)
{
    UpsampleSolver solver;
    upsample_solver_init(&solver);
    double worst = 0;
    const size_t n = UPSAMPLE_KNOTS;
    for (int largest = 0; largest < 3; largest++)
        for (int second = 0; second < UPSAMPLE_KNOTS; second++)
            for (int first = 0; first < UPSAMPLE_KNOTS; first++) {
                Column column;
                worst = fmax(worst, solve_column(&solver, largest, second, first, column));
                for (size_t z = 0; z < n; z++)
                    for (size_t i = 0; i < 3; i++)
                        table[((((size_t)largest * n + z) * n + (size_t)second) * n + (size_t)first) * 3 + i] =
                            (float)column[z][i];
            }
    return worst;
}

/* Hexadecimal floats: exact, whatever reads them. */
static bool write_table(FILE *out, const float *table)
{
    fputs("/* Made by upsample_gen; see optics/upsample_table.h. */\n#include \"optics/upsample_table.h\"\n\n"
          "const float upsample_table[3][UPSAMPLE_FLOATS + 1] = {\n",
          out);
    for (int largest = 0; largest < 3; largest++) {
        fputs("{\n", out);
        for (int knot = 0; knot < UPSAMPLE_FLOATS; knot += UPSAMPLE_FACTORS, table += UPSAMPLE_FACTORS)
            fprintf(out, "%af,%af,%af,\n", (double)table[0], (double)table[1], (double)table[2]);
        fputs("0},\n", out);
    }
    fputs("};\n", out);
    return !ferror(out);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: upsample_gen FILE\n", stderr);
        return 2;
    }
    float *table = calloc(3 * (size_t)UPSAMPLE_KNOTS * UPSAMPLE_KNOTS * UPSAMPLE_KNOTS * 3, sizeof *table);
    if (!table) {
        fputs("upsample_gen: out of memory\n", stderr);
        return 1;
    }
    double worst = solve_table(table);
    bool well = worst < 1e-6;
    if (!well) fprintf(stderr, "upsample_gen: a knot misses its colour by %g\n", worst);
    FILE *out = well ? fopen(argv[1], "w") : NULL;
    if (well && !out) perror(argv[1]);
    if (out) {
        well = write_table(out, table);
        if (fclose(out) != 0 || !well) {
            fprintf(stderr, "upsample_gen: cannot write %s\n", argv[1]);
            well = false;
        }
    }
    free(table);
    return out && well ? 0 : 1;
}
