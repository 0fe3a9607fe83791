/* upsample.c - spectra of colours. [JH19] W. Jakob, J. Hanika, "A Low-Dimensional Function Space for
 * Efficient Spectral Upsampling", Computer Graphics Forum 38(2), 2019.
 * The polynomial runs over w = (nm - 360) / 470 and not over nm, which keeps its coefficients in the range
 * of a float's digits. Single colours are solved for, from where the table has them; images go through the table alone.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>
#include <string.h>

#include "optics/color.h"
#include "optics/upsample_solve.h"
#include "optics/upsample_table.h"

/* Below it the 0.002 by which the table is off are more than a sixtieth of a reflectance. */
#define DARK 0.125f

/* S(x) = 1/2 + x / (2 sqrt(1 + x^2)), [JH19] (4). Written so that dark colours keep their digits: with
 * s = sqrt(1 + x^2), 1 - S(|x|) = S(-|x|) = 1 / (2 s (s + |x|)). */
static inline Lanes sigmoid(Lanes x)
{
    Lanes zero = lanes_all(0), size = lanes_select_less(x, zero, lanes_sub(zero, x), x);
    Lanes s = lanes_sqrt(lanes_add(lanes_mul(x, x), lanes_all(1)));
    Lanes tail = lanes_div(lanes_all(0.5f), lanes_mul(lanes_add(size, s), s));
    return lanes_select_less(x, zero, tail, lanes_rest(tail));
}

Lanes upsample_at(const float coefficients[3], Lanes wavelength_nm)
{
    const float per_nm = 1 / (SPECTRUM_MAX_NM - SPECTRUM_MIN_NM);
    Lanes w = lanes_scale(lanes_sub(wavelength_nm, lanes_all(SPECTRUM_MIN_NM)), per_nm);
    Lanes x = lanes_add(lanes_scale(w, coefficients[2]), lanes_all(coefficients[1]));
    x = lanes_add(lanes_mul(x, w), lanes_all(coefficients[0]));
    return sigmoid(x);
}

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

static bool is_grey(const double rgb[3])
{
    return rgb[0] == rgb[1] && rgb[0] == rgb[2];
}

static Spectrum sigmoid_spectrum(SpectrumKind kind, double scale, const double rgb[3])
{
    const float rgb_f[3] = {(float)rgb[0], (float)rgb[1], (float)rgb[2]};
    float near[3];
    UpsampleSolver solver;
    upsample_solver_init(&solver);
    upsample_coefficients(rgb_f, near);
    double coefficients[3] = {(double)near[0], (double)near[1], (double)near[2]};
    upsample_solve_near(&solver, rgb, coefficients);
    return (Spectrum){.kind = kind,
                      .scale = (float)scale,
                      .value = {(float)coefficients[0], (float)coefficients[1], (float)coefficients[2]}};
}

Spectrum spectrum_from_reflectance(const double rgb[3])
{
    double clamped[3];
    for (int c = 0; c < 3; c++) clamped[c] = clamp(rgb[c], 0, 1);
    if (is_grey(clamped)) return spectrum_constant((float)clamped[0]);
    return sigmoid_spectrum(SPECTRUM_SIGMOID, 1, clamped);
}

/* A colour of any size is one with its largest channel at 1/2, where spectra are smooth, times a scale. */
Spectrum spectrum_from_light(const double rgb[3])
{
    double clamped[3], largest = 0;
    for (int c = 0; c < 3; c++) {
        clamped[c] = fmax(rgb[c], 0);
        largest = fmax(largest, clamped[c]);
    }
    /* S is exactly 1 here: no rounding comes between a grey light and white */
    if (is_grey(clamped))
        return (Spectrum){.kind = SPECTRUM_LIGHT, .scale = (float)largest, .value = {(float)upsample_constant(1)}};
    for (int c = 0; c < 3; c++) clamped[c] /= 2 * largest;
    return sigmoid_spectrum(SPECTRUM_LIGHT, 2 * largest, clamped);
}

/* table = -ln(transmittance) / depth */
static Spectrum absorption_from_transmittance(const double rgb[3], double depth, float *table)
{
    Spectrum transmittance = spectrum_from_reflectance(rgb);
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        float nm = SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM);
        table[i] = (float)(-log((double)spectrum_at_one(&transmittance, nm)) / depth);
    }
    return (Spectrum){.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
}

Spectrum spectrum_from_tint(const double tint[3], double depth, float *table)
{
    const double darkest = 1e-4;
    double raised[3];
    for (int c = 0; c < 3; c++) raised[c] = clamp(tint[c], darkest, 1);
    if (is_grey(raised)) return spectrum_constant((float)(-log(raised[0]) / depth));
    return absorption_from_transmittance(raised, depth, table);
}

Spectrum spectrum_from_coefficients(const double rgb[3], float *table)
{
    double clamped[3], largest = 0, transmittance[3];
    for (int c = 0; c < 3; c++) {
        clamped[c] = fmax(rgb[c], 0);
        largest = fmax(largest, clamped[c]);
    }
    if (is_grey(clamped)) return spectrum_constant((float)largest);
    /* The length over which the colours agree best: long enough to be coloured, short enough that no
     * channel has gone dark. */
    const double optical_depth = 0.7;
    double length = optical_depth / largest;
    for (int c = 0; c < 3; c++) transmittance[c] = exp(-clamped[c] * length);
    return absorption_from_transmittance(transmittance, length, table);
}

/* The t at which t^2 (3 - 2 t) = x, for x in 0..1, to 4e-7 of it or of 1 - t, whichever is smaller. As a function of sqrt(x) it
 * is smooth up to the middle, from where it mirrors itself: a polynomial instead of 1/2 - sin(asin(1 - 2 x) / 3). */
static inline Lanes inverse_smoothstep(Lanes x)
{
    /* of the even powers of the root and of the odd ones, in two chains that do not wait for each other */
    const float even[] = {0.462309212f, 0.925206931f, 0.14638474f, 0.0548305874f, 0.577350446f};
    const float odd[] = {-0.974745447f, -0.43138704f, 0.0143528715f, 0.111072581f};
    const Lanes half = lanes_all(0.5f);
    Lanes square = lanes_lesser(x, lanes_rest(x)), root = lanes_sqrt(square);
    Lanes of_even = lanes_all(even[0]), of_odd = lanes_all(odd[0]);
    for (int i = 1; i < 5; i++) of_even = lanes_add(lanes_mul(of_even, square), lanes_all(even[i]));
    for (int i = 1; i < 4; i++) of_odd = lanes_add(lanes_mul(of_odd, square), lanes_all(odd[i]));
    Lanes t = lanes_mul(lanes_add(of_even, lanes_mul(of_odd, root)), root);
    return lanes_select_less(half, x, lanes_rest(t), t);
}

/* Which four knots a place on each of up to four axes is between, by the first of them, and what each weighs */
typedef struct Between {
    int32_t first[LANES];
    Lanes weight[4];
} Between;

/* At an end of an axis the missing knot is extrapolated from the last two, which comes to adding its weight to theirs. */
static void stay_within(Between *between, int axis)
{
    float weight[4];
    for (int i = 0; i < 4; i++) weight[i] = lanes_get(between->weight[i], axis);
    if (between->first[axis] < 0) {
        /* knots -1 0 1 2 become 0 1 2 3 */
        const float within[4] = {weight[1] + 2 * weight[0], weight[2] - weight[0], weight[3], 0};
        memcpy(weight, within, sizeof weight);
        between->first[axis] = 0;
    } else if (between->first[axis] > UPSAMPLE_KNOTS - 4) {
        /* knots n-3 n-2 n-1 n become n-4 n-3 n-2 n-1 */
        const float within[4] = {0, weight[0], weight[1] - weight[3], weight[2] + 2 * weight[3]};
        memcpy(weight, within, sizeof weight);
        between->first[axis] = UPSAMPLE_KNOTS - 4;
    }
    for (int i = 0; i < 4; i++) lanes_set(&between->weight[i], axis, weight[i]);
}

/* E. Catmull, R. Rom, "A Class of Local Interpolating Splines" (1974); t in 0..1 on each axis */
static inline Between knots_about(Lanes t)
{
    const float below_last = UPSAMPLE_KNOTS - 1 - 2e-6f; /* whose whole part is the last but one */
    Between between;
    Lanes position = lanes_lesser(lanes_scale(t, UPSAMPLE_KNOTS - 1), lanes_all(below_last));
    Lanes f = lanes_split(position, between.first), ff = lanes_mul(f, f);
    for (int axis = 0; axis < LANES; axis++) between.first[axis]--;
    Lanes linear = lanes_scale(f, 0.5f), cubic = lanes_mul(ff, linear);
    between.weight[0] = lanes_sub(lanes_sub(ff, linear), cubic);
    between.weight[1] = lanes_add(lanes_sub(lanes_scale(cubic, 3), lanes_scale(ff, 2.5f)), lanes_all(1));
    between.weight[2] = lanes_sub(lanes_add(lanes_scale(ff, 2), linear), lanes_scale(cubic, 3));
    between.weight[3] = lanes_sub(cubic, lanes_scale(ff, 0.5f));
    return between;
}

static inline Lanes mix_of_four(const float *knots, const float weight[4])
{
    Lanes sum = lanes_scale(lanes_load(knots), weight[0]);
    for (int k = 1; k < 4; k++) sum = lanes_add(sum, lanes_scale(lanes_load(knots + UPSAMPLE_FACTORS * k), weight[k]));
    return sum;
}

/* Three lanes are a knot's; what the fourth has, of the knot that follows, goes by unused. */
static inline void look_up_knots(const float *table, const Between *between, float coefficients[3])
{
    const ptrdiff_t row = (ptrdiff_t)UPSAMPLE_FACTORS * UPSAMPLE_KNOTS, layer = row * UPSAMPLE_KNOTS;
    const int32_t *first = between->first;
    table += first[0] * layer + first[2] * row + (ptrdiff_t)first[1] * UPSAMPLE_FACTORS;
    float along_first[4];
    for (int k = 0; k < 4; k++) along_first[k] = lanes_get(between->weight[k], 1);
    Lanes sum = lanes_all(0);
    for (int i = 0; i < 4; i++) {
        Lanes of_layer = lanes_all(0);
        for (int j = 0; j < 4; j++)
            of_layer = lanes_add(of_layer, lanes_scale(mix_of_four(table + i * layer + j * row, along_first),
                                                       lanes_get(between->weight[j], 2)));
        sum = lanes_add(sum, lanes_scale(of_layer, lanes_get(between->weight[i], 0)));
    }
    for (int n = 0; n < UPSAMPLE_FACTORS; n++) coefficients[n] = lanes_get(sum, n);
}

void upsample_coefficients(const float rgb[3], float coefficients[3])
{
    float clamped[3];
    for (int c = 0; c < 3; c++) clamped[c] = float_min(float_max(rgb[c], 0), 1);
    if (clamped[0] == clamped[1] && clamped[0] == clamped[2]) {
        coefficients[0] = (float)upsample_constant((double)clamped[0]);
        coefficients[1] = coefficients[2] = 0;
        return;
    }
    int largest = clamped[0] >= clamped[1] ? 0 : 1;
    if (clamped[2] > clamped[largest]) largest = 2;
    const float margin = (float)UPSAMPLE_MARGIN, z = clamped[largest]; /* above 0: the channels differ */
    float inner = (float_min(float_max(z, margin), 1 - margin) - margin) / (1 - 2 * margin);
    Lanes t = inverse_smoothstep(
        lanes(float_min(inner, 1), clamped[(largest + 1) % 3] / z, clamped[(largest + 2) % 3] / z, 0));
    lanes_set(&t, 0, lanes_get(inverse_smoothstep(t), 0)); /* z's is one of another */
    Between between = knots_about(t);
    for (int axis = 0; axis < 3; axis++) stay_within(&between, axis);
    look_up_knots(upsample_table[largest], &between, coefficients);
}

static float largest_of(const float rgb[3])
{
    return float_max(float_max(float_max(rgb[0], rgb[1]), rgb[2]), 0);
}

/* As spectrum_from_light has them. */
float upsample_light(const float rgb[3], float coefficients[3])
{
    float largest = largest_of(rgb), scaled[3];
    if (rgb[0] == rgb[1] && rgb[0] == rgb[2]) {
        coefficients[0] = (float)upsample_constant(1);
        coefficients[1] = coefficients[2] = 0;
        return largest;
    }
    for (int c = 0; c < 3; c++) scaled[c] = rgb[c] / (2 * largest);
    upsample_coefficients(scaled, coefficients);
    return 2 * largest;
}

float upsample_reflectance(const float rgb[3], float coefficients[3])
{
    if (largest_of(rgb) < DARK) return upsample_light(rgb, coefficients);
    upsample_coefficients(rgb, coefficients);
    return 1;
}
