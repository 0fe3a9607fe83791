/* spectral_lines.c - wavelengths for scenes that shine in few of them. The lines' density is constant within each of some pieces,
 * of which each is within one cell of the table behind wavelengths_sample, and between two rows of all lights in rows, so that
 * the density of both together is known wherever a wavelength is from.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/spectral_lines.h"

#include <math.h>
#include <stdlib.h>

#include "optics/observer.h"

enum { CELLS = OBSERVER_WAVELENGTH_CELLS };
/* Of the power of all lights, what matters. */
#define LEAST_POWER 0.01
/* Of all lanes, those of lines that bring less, and that nothing else would find. */
#define LEAST_PART (1.0f / 32)
/* So many parts has each piece between two rows, as the density is the same all over a part. */
enum { ROW_PARTS = 4 };

/* The visible range in pieces, in each of which a light is linear. */
typedef struct Pieces {
    uint32_t n;
    float *from;               /* n + 1 */
    double *seen;              /* n: how much of the lines is seen, per nm */
    uint32_t first[CELLS + 1]; /* the first piece of each cell of the table behind wavelengths_sample */
} Pieces;

struct WavelengthLines {
    Pieces pieces;
    float part;        /* of all lanes, those of the lines */
    float *cumulative; /* pieces.n + 1: of the lines' probability, up to each piece */
    float *density;    /* per nm, of all lanes */
};

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void pieces_clear(Pieces *pieces)
{
    free(pieces->from);
    free(pieces->seen);
    *pieces = (Pieces){0};
}

/* Cells, and pieces of all lights in rows. STATUS_NOMEM. */
static Status pieces_init(const LightOfScene *lights, size_t n, Pieces *pieces, Error *error)
{
    size_t room = CELLS + 1, count = 0;
    for (size_t i = 0; i < n; i++)
        if (lights[i].spectrum && lights[i].spectrum->kind == SPECTRUM_ROWS)
            room += (size_t)ROW_PARTS * lights[i].spectrum->rows->n;
    *pieces = (Pieces){.from = malloc(room * sizeof *pieces->from), .seen = calloc(room, sizeof *pieces->seen)};
    if (!pieces->from || !pieces->seen) {
        pieces_clear(pieces);
        return fail_memory(error, room * (sizeof *pieces->from + sizeof *pieces->seen), "wavelengths");
    }
    for (; count <= CELLS; count++) pieces->from[count] = observer_wavelengths[count];
    for (size_t i = 0; i < n; i++) {
        if (!lights[i].spectrum || lights[i].spectrum->kind != SPECTRUM_ROWS) continue;
        const SpectrumRows *rows = lights[i].spectrum->rows;
        for (uint32_t r = 0; r + 1 < rows->n; r++)
            for (int k = 0; k < ROW_PARTS; k++) {
                float width = rows->row[r + 1].nm - rows->row[r].nm,
                      nm = rows->row[r].nm + width * (float)k / ROW_PARTS;
                if (nm > SPECTRUM_MIN_NM && nm < SPECTRUM_MAX_NM) pieces->from[count++] = nm;
            }
    }
    qsort(pieces->from, count, sizeof *pieces->from, compare_floats);
    size_t different = 1;
    for (size_t i = 1; i < count; i++)
        if (pieces->from[i] > pieces->from[different - 1]) pieces->from[different++] = pieces->from[i];
    pieces->n = (uint32_t)different - 1;
    for (uint32_t cell = 0, i = 0; cell <= CELLS; cell++) {
        while (i < pieces->n && pieces->from[i] < observer_wavelengths[cell]) i++;
        pieces->first[cell] = i;
    }
    return STATUS_OK;
}

static double piece_width(const Pieces *pieces, uint32_t i)
{
    return (double)(pieces->from[i + 1] - pieces->from[i]);
}

/* The size of a light's red, green and blue, per nm, in the mean over a piece. */
static double seen_of(const Spectrum *light, const Pieces *pieces, uint32_t i)
{
    double seen = 0;
    for (int k = 0; k < LANES; k++) {
        float nm = pieces->from[i] + (float)piece_width(pieces, i) * ((float)k + 0.5f) / LANES, rgb[3];
        WavelengthSample one = {lanes_all(nm), lanes_all(1.0f / LANES)};
        Lanes radiance = lanes_all(0);
        lanes_set(&radiance, 0, fmaxf(spectrum_at_one(light, nm), 0));
        color_from_lanes(radiance, &one, rgb);
        seen += (double)sqrtf(rgb[0] * rgb[0] + rgb[1] * rgb[1] + rgb[2] * rgb[2]) / LANES;
    }
    return seen;
}

/* Only what is measured can be: colours are smooth. */
static bool can_be_lines(const Spectrum *light)
{
    return light->kind == SPECTRUM_TABLE || light->kind == SPECTRUM_ROWS;
}

/* What is seen of a light in all pieces, and whether that is lines: each cell has the same probability. */
static bool find_lines(const Spectrum *light, const Pieces *pieces, double *seen, double *sum)
{
    double squares = 0;
    *sum = 0;
    for (uint32_t cell = 0; cell < CELLS; cell++)
        for (uint32_t i = pieces->first[cell]; i < pieces->first[cell + 1]; i++) {
            double width = piece_width(pieces, i);
            seen[i] = seen_of(light, pieces, i);
            *sum += seen[i] * width;
            squares +=
                seen[i] * width * seen[i] * (double)(observer_wavelengths[cell + 1] - observer_wavelengths[cell]);
        }
    return squares * CELLS > LINES_FROM * *sum * *sum;
}

Status spectrum_find_lines(const Spectrum *light, bool *lines, Error *error)
{
    const LightOfScene one = {light, 1};
    Pieces pieces;
    double sum;
    *lines = false;
    if (!can_be_lines(light)) return STATUS_OK;
    TRY(pieces_init(&one, 1, &pieces, error));
    *lines = find_lines(light, &pieces, pieces.seen, &sum);
    pieces_clear(&pieces);
    return STATUS_OK;
}

/* The lines of all lights count alike, whatever their power. */
typedef struct Powers {
    double lines, others;
    bool exact; /* of some lines nothing is found without lanes for them */
} Powers;

static Status add_lights(const LightOfScene *lights, size_t n, Pieces *pieces, Powers *powers, Error *error)
{
    double *seen = malloc(pieces->n * sizeof *seen), sum;
    if (!seen) return fail_memory(error, pieces->n * sizeof *seen, "wavelengths");
    for (size_t i = 0; i < n; i++) {
        const LightOfScene *light = &lights[i];
        if (!(light->power > 0)) continue;
        if (!light->spectrum || !can_be_lines(light->spectrum) || !find_lines(light->spectrum, pieces, seen, &sum)) {
            powers->others += light->power;
            continue;
        }
        powers->lines += light->power;
        powers->exact = powers->exact || light->spectrum->kind == SPECTRUM_ROWS;
        for (uint32_t k = 0; k < pieces->n; k++) pieces->seen[k] += seen[k] / sum;
    }
    free(seen);
    return STATUS_OK;
}

static void settle(WavelengthLines *lines)
{
    const Pieces *pieces = &lines->pieces;
    double all = 0, sum = 0;
    for (uint32_t i = 0; i < pieces->n; i++) all += pieces->seen[i] * piece_width(pieces, i);
    for (uint32_t cell = 0; cell < CELLS; cell++)
        for (uint32_t i = pieces->first[cell]; i < pieces->first[cell + 1]; i++) {
            double cell_width = (double)(observer_wavelengths[cell + 1] - observer_wavelengths[cell]);
            lines->cumulative[i] = (float)(sum / all);
            sum += pieces->seen[i] * piece_width(pieces, i);
            lines->density[i] =
                (float)((1 - (double)lines->part) / (CELLS * cell_width) + (double)lines->part * pieces->seen[i] / all);
        }
    lines->cumulative[pieces->n] = 1;
}

Status wavelength_lines_new(const LightOfScene *lights, size_t n, WavelengthLines **out, Error *error)
{
    Powers powers = {0};
    WavelengthLines *lines = calloc(1, sizeof *lines);
    *out = NULL;
    if (!lines) return fail_memory(error, sizeof *lines, "wavelengths");
    Status status = pieces_init(lights, n, &lines->pieces, error);
    if (status == STATUS_OK) status = add_lights(lights, n, &lines->pieces, &powers, error);
    bool enough = powers.lines > LEAST_POWER * (powers.lines + powers.others);
    if (status != STATUS_OK || !(enough || powers.exact)) {
        wavelength_lines_free(lines);
        return status;
    }
    size_t n_pieces = lines->pieces.n;
    lines->part = !enough ? LEAST_PART : powers.others > LEAST_POWER * powers.lines ? 1.0f / LANES : 1 - 1.0f / LANES;
    lines->cumulative = malloc((n_pieces + 1) * sizeof *lines->cumulative);
    lines->density = malloc(n_pieces * sizeof *lines->density);
    if (!lines->cumulative || !lines->density) {
        wavelength_lines_free(lines);
        return fail_memory(error, n_pieces * 2 * sizeof(float), "wavelengths");
    }
    settle(lines);
    *out = lines;
    return STATUS_OK;
}

void wavelength_lines_free(WavelengthLines *lines)
{
    if (!lines) return;
    pieces_clear(&lines->pieces);
    free(lines->cumulative);
    free(lines->density);
    free(lines);
}

/* The last of low .. high - 1 that is not above value; the first is not. */
static uint32_t last_not_above(const float *ascending, uint32_t low, uint32_t high, float value)
{
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        *(ascending[middle] <= value ? &low : &high) = middle;
    }
    return low;
}

/* Of one lane, at u in [0, 1]. */
static float wavelength_at(const WavelengthLines *lines, float u, float *pdf)
{
    const Pieces *pieces = &lines->pieces;
    float rest = 1 - lines->part;
    if (u < rest) {
        float position = u / rest * CELLS;
        int cell = position < CELLS ? (int)position : CELLS - 1;
        float from = observer_wavelengths[cell];
        float nm = from + fminf(position - (float)cell, 1) * (observer_wavelengths[cell + 1] - from);
        *pdf = lines->density[last_not_above(pieces->from, pieces->first[cell], pieces->first[cell + 1], nm)];
        return nm;
    }
    float v = (u - rest) / lines->part;
    uint32_t i = last_not_above(lines->cumulative, 0, pieces->n, v);
    float from = lines->cumulative[i], width = lines->cumulative[i + 1] - from;
    float position = width > 0 ? fminf((v - from) / width, 1) : 0;
    *pdf = lines->density[i];
    return pieces->from[i] + position * (pieces->from[i + 1] - pieces->from[i]);
}

WavelengthSample wavelength_lines_sample(const WavelengthLines *lines, float u)
{
    WavelengthSample sample;
    for (int i = 0; i < LANES; i++) {
        float at = u + (float)i / LANES, pdf;
        lanes_set(&sample.nm, i, wavelength_at(lines, at < 1 ? at : at - 1, &pdf));
        lanes_set(&sample.pdf, i, pdf);
    }
    return sample;
}
