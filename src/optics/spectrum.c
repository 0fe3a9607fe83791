/* spectrum.c - evaluation of spectra at four wavelengths.
 * This runs for every event of a path: no allocation, one branch per spectrum, none per lane.
 * [JH19] W. Jakob, J. Hanika, "A Low-Dimensional Function Space for Efficient Spectral Upsampling",
 * Computer Graphics Forum 38(2), 2019.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/spectrum.h"

#include <string.h>

#include "optics/color.h"
#include "optics/observer.h"

/* The square of the wavelength in micrometres. */
static Lanes square_um(Lanes wavelength_nm)
{
    Lanes um = lanes_scale(wavelength_nm, 1e-3f);
    return lanes_mul(um, um);
}

static Lanes table_at(const float *table, Lanes wavelength_nm)
{
    int32_t row[LANES];
    Lanes fraction = observer_rows(wavelength_nm, SPECTRUM_STEP_NM, row);
    for (int i = 0; i < LANES; i++) {
        /* A table has no padding: at 830 nm the last interval is read at its end. */
        if (LIKELY(row[i] <= SPECTRUM_SAMPLES - 2)) continue;
        row[i] = SPECTRUM_SAMPLES - 2;
        lanes_set(&fraction, i, 1);
    }
    return observer_between(table, row, fraction);
}

/* At 830 nm as in the last 5 nm. */
static float row_value(const SpectrumRows *rows, float wavelength_nm)
{
    float fraction;
    int kept = observer_row(wavelength_nm, SPECTRUM_STEP_NM, &fraction);
    if (kept > SPECTRUM_SAMPLES - 2) kept = SPECTRUM_SAMPLES - 2;
    uint32_t low = rows->first[kept], high = rows->first[kept + 1] + 1; /* row[low] <= wavelength < row[high] */
    if (high > rows->n - 1) high = rows->n - 1;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        *(rows->row[middle].nm <= wavelength_nm ? &low : &high) = middle;
    }
    const SpectrumRow *here = &rows->row[low], *next = here + 1;
    float part = (wavelength_nm - here->nm) / (next->nm - here->nm);
    part = part > 0 ? (part < 1 ? part : 1) : 0;
    return (1 - part) * here->value + part * next->value;
}

static Lanes rows_at_lanes(const SpectrumRows *rows, Lanes wavelength_nm)
{
    Lanes result = lanes_all(0);
    for (int i = 0; i < LANES; i++) lanes_set(&result, i, row_value(rows, lanes_get(wavelength_nm, i)));
    return result;
}

Lanes spectrum_varying_at(const Spectrum *spectrum, Lanes wavelength_nm)
{
    const float *value = spectrum->value;
    Lanes result;
    switch (spectrum->kind) {
    case SPECTRUM_SIGMOID: result = upsample_at(value, wavelength_nm); break;
    case SPECTRUM_LIGHT: result = lanes_mul(upsample_at(value, wavelength_nm), white_at(wavelength_nm)); break;
    case SPECTRUM_CAUCHY: {
        Lanes inverse = lanes_div(lanes_all(1), square_um(wavelength_nm));
        result = lanes_add(lanes_scale(inverse, value[2]), lanes_all(value[1]));
        result = lanes_add(lanes_mul(result, inverse), lanes_all(value[0]));
        break;
    }
    case SPECTRUM_SELLMEIER: {
        Lanes square = square_um(wavelength_nm);
        result = lanes_all(1);
        for (int i = 0; i < 3; i++) {
            Lanes distance = lanes_sub(square, lanes_all(value[3 + i]));
            result = lanes_add(result, lanes_div(lanes_scale(square, value[i]), distance));
        }
        result = lanes_sqrt(result);
        break;
    }
    case SPECTRUM_LANES: result = lanes(value[0], value[1], value[2], value[3]); break;
    case SPECTRUM_ROWS: result = rows_at_lanes(spectrum->rows, wavelength_nm); break;
    case SPECTRUM_CONSTANT: /* see spectrum_at */
    case SPECTRUM_TABLE:
    default: result = table_at(spectrum->table, wavelength_nm); break;
    }
    return lanes_scale(result, spectrum->scale);
}

float spectrum_at_one(const Spectrum *spectrum, float wavelength_nm)
{
    return lanes_get(spectrum_at(spectrum, lanes_all(wavelength_nm)), 0);
}

static bool same_rows(const SpectrumRows *a, const SpectrumRows *b)
{
    return a->n == b->n && memcmp(a->row, b->row, a->n * sizeof *a->row) == 0;
}

bool spectrum_same(const Spectrum *a, const Spectrum *b)
{
    if (a->kind == SPECTRUM_ROWS || b->kind == SPECTRUM_ROWS)
        return a->kind == b->kind && a->scale == b->scale && same_rows(a->rows, b->rows);
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        float nm = SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM);
        if (spectrum_at_one(a, nm) != spectrum_at_one(b, nm)) return false;
    }
    return true;
}

bool spectrum_is_constant(const Spectrum *spectrum)
{
    const float *value = spectrum->value;
    if (spectrum_is_zero(spectrum)) return true;
    switch (spectrum->kind) {
    case SPECTRUM_CONSTANT: return true;
    case SPECTRUM_SIGMOID:
    case SPECTRUM_CAUCHY: return value[1] == 0 && value[2] == 0;
    case SPECTRUM_SELLMEIER: return value[0] == 0 && value[1] == 0 && value[2] == 0;
    case SPECTRUM_TABLE:
        for (int i = 1; i < SPECTRUM_SAMPLES; i++)
            if (spectrum->table[i] != spectrum->table[0]) return false;
        return true;
    case SPECTRUM_ROWS: /* what is the same everywhere needs none */
    case SPECTRUM_LIGHT:
    default: return false;
    }
}

static float largest_row(const SpectrumRows *rows)
{
    float largest = -HUGE_VALF;
    for (uint32_t i = 0; i < rows->n; i++) largest = fmaxf(largest, rows->row[i].value);
    return largest;
}

bool spectrum_is_zero(const Spectrum *spectrum)
{
    if (spectrum->scale == 0) return true;
    if (spectrum->kind == SPECTRUM_CONSTANT) return spectrum->value[0] == 0;
    if (spectrum->kind == SPECTRUM_ROWS) return !(largest_row(spectrum->rows) > 0);
    if (spectrum->kind != SPECTRUM_TABLE) return false;
    for (int i = 0; i < SPECTRUM_SAMPLES; i++)
        if (spectrum->table[i] != 0) return false;
    return true;
}

float spectrum_max(const Spectrum *spectrum)
{
    float largest = -HUGE_VALF;
    if (spectrum->kind == SPECTRUM_ROWS) return spectrum->scale * largest_row(spectrum->rows);
    for (int i = 0; i < SPECTRUM_SAMPLES; i += LANES) {
        float nm = SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM), step = (float)SPECTRUM_STEP_NM;
        /* the last group reaches past 830 nm */
        Lanes wavelength_nm = lanes(nm, fminf(nm + step, SPECTRUM_MAX_NM), fminf(nm + 2 * step, SPECTRUM_MAX_NM),
                                    fminf(nm + 3 * step, SPECTRUM_MAX_NM));
        largest = fmaxf(largest, lanes_max(spectrum_at(spectrum, wavelength_nm)));
    }
    return largest;
}

Spectrum spectrum_constant(float value)
{
    return (Spectrum){.kind = SPECTRUM_CONSTANT, .scale = 1, .value = {value}};
}

Spectrum spectrum_cauchy(double a, double b_um2, double c_um4)
{
    return (Spectrum){.kind = SPECTRUM_CAUCHY, .scale = 1, .value = {(float)a, (float)b_um2, (float)c_um4}};
}

Spectrum spectrum_sellmeier(const double b[3], const double c_um2[3])
{
    return (Spectrum){
        .kind = SPECTRUM_SELLMEIER,
        .scale = 1,
        .value = {(float)b[0], (float)b[1], (float)b[2], (float)c_um2[0], (float)c_um2[1], (float)c_um2[2]}};
}

Spectrum spectrum_tabulate(double (*function)(void *context, double wavelength_nm), void *context, float *table)
{
    for (int i = 0; i < SPECTRUM_SAMPLES; i++)
        table[i] = (float)function(context, (double)SPECTRUM_MIN_NM + i * SPECTRUM_STEP_NM);
    return (Spectrum){.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
}

/* The first row whose wavelength is not below. */
static size_t row_from(const double *rows, size_t n, double wavelength_nm)
{
    size_t low = 0, high = n;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (rows[2 * middle] < wavelength_nm)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static double rows_at(const double *rows, size_t n, double wavelength_nm)
{
    size_t i = row_from(rows, n, wavelength_nm);
    if (i == n) return rows[2 * n - 1];
    if (i == 0 || rows[2 * i] == wavelength_nm) return rows[2 * i + 1];
    double t = (wavelength_nm - rows[2 * i - 2]) / (rows[2 * i] - rows[2 * i - 2]);
    return (1 - t) * rows[2 * i - 1] + t * rows[2 * i + 1];
}

/* The mean over from .. to, exactly: trapezia between the rows. */
static double rows_mean(const double *rows, size_t n, double from, double to)
{
    double x = from, y = rows_at(rows, n, from), area = 0;
    for (size_t i = row_from(rows, n, from); i < n && rows[2 * i] < to; i++) {
        area += (rows[2 * i] - x) * (y + rows[2 * i + 1]) / 2;
        x = rows[2 * i];
        y = rows[2 * i + 1];
    }
    area += (to - x) * (y + rows_at(rows, n, to)) / 2;
    return area / (to - from);
}

typedef struct RowSet {
    const double *rows;
    size_t n;
} RowSet;

/* Whether there are rows about a kept wavelength that it does not stand for by itself. */
static bool is_fine_about(const RowSet *set, double wavelength_nm)
{
    const double half = SPECTRUM_STEP_NM / 2.0;
    size_t first = row_from(set->rows, set->n, wavelength_nm - half),
           end = row_from(set->rows, set->n, wavelength_nm + half);
    return end > first + 1 || (end == first + 1 && set->rows[2 * first] != wavelength_nm);
}

static double sample_rows(void *context, double wavelength_nm)
{
    const RowSet *set = context;
    const double half = SPECTRUM_STEP_NM / 2.0;
    return is_fine_about(set, wavelength_nm) ? rows_mean(set->rows, set->n, wavelength_nm - half, wavelength_nm + half)
                                             : rows_at(set->rows, set->n, wavelength_nm);
}

bool spectrum_rows_are_fine(const double *rows, size_t n)
{
    RowSet set = {rows, n};
    for (int i = 0; i < SPECTRUM_SAMPLES; i++)
        if (is_fine_about(&set, (double)SPECTRUM_MIN_NM + i * SPECTRUM_STEP_NM)) return true;
    return false;
}

Spectrum spectrum_from_rows(const double *rows, size_t n, float *table)
{
    RowSet set = {rows, n};
    return spectrum_tabulate(sample_rows, &set, table);
}

/* Rows that become one wavelength in float are a step, which takes the next one. */
static void add_row(SpectrumRows *rows, double nm, double value)
{
    SpectrumRow row = {(float)nm, (float)value};
    if (rows->n > 0 && !(row.nm > rows->row[rows->n - 1].nm)) row.nm = nextafterf(rows->row[rows->n - 1].nm, HUGE_VALF);
    rows->row[rows->n++] = row;
}

Spectrum spectrum_from_fine_rows(const double *rows, size_t n, SpectrumRows *kept)
{
    kept->n = 0;
    if (rows[0] > (double)SPECTRUM_MIN_NM) add_row(kept, (double)SPECTRUM_MIN_NM, rows[1]);
    for (size_t i = 0; i < n; i++) add_row(kept, rows[2 * i], rows[2 * i + 1]);
    if (rows[2 * n - 2] < (double)SPECTRUM_MAX_NM) add_row(kept, (double)SPECTRUM_MAX_NM, rows[2 * n - 1]);
    for (uint32_t k = 0, i = 0; k < SPECTRUM_SAMPLES; k++) {
        while (i + 1 < kept->n && kept->row[i + 1].nm <= SPECTRUM_MIN_NM + (float)(k * SPECTRUM_STEP_NM)) i++;
        kept->first[k] = i;
    }
    spectrum_from_rows(rows, n, kept->table);
    return (Spectrum){.kind = SPECTRUM_ROWS, .scale = 1, .rows = kept};
}

Spectrum spectrum_smoothed(const Spectrum *spectrum)
{
    if (spectrum->kind != SPECTRUM_ROWS) return *spectrum;
    return (Spectrum){.kind = SPECTRUM_TABLE, .scale = spectrum->scale, .table = spectrum->rows->table};
}

/* Planck's law relative to its value at 830 nm: (830 / w)^5 (e^(c/830) - 1) / (e^(c/w) - 1) with c the
 * second radiation constant over the temperature. Written with negative exponents only, so that nothing
 * overflows at any temperature. */
static double planck_relative(double kelvin, double wavelength_nm)
{
    const double second_constant_nm = 1.438776877e7; /* h c / k, in nm K; CODATA 2018, exact */
    double c = second_constant_nm / kelvin, end = (double)SPECTRUM_MAX_NM, ratio = end / wavelength_nm;
    double square = ratio * ratio;
    return square * square * ratio * exp(c / end - c / wavelength_nm) * expm1(-c / end) / expm1(-c / wavelength_nm);
}

Spectrum spectrum_blackbody(double kelvin, float *table)
{
    double shape[SPECTRUM_SAMPLES], largest = 0;
    if (!(kelvin >= 1)) kelvin = 1; /* colder is black in any float */
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        shape[i] = planck_relative(kelvin, (double)SPECTRUM_MIN_NM + i * SPECTRUM_STEP_NM);
        largest = fmax(largest, shape[i]);
    }
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) table[i] = (float)(shape[i] / largest);
    Spectrum blackbody = {.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
    /* White has luminance 1, and so must this. */
    double luminance = spectrum_luminance(&blackbody);
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) table[i] = (float)(shape[i] / largest / luminance);
    return blackbody;
}
