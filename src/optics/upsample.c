/* upsample.c - spectra of colours. [JH19] W. Jakob, J. Hanika, "A Low-Dimensional Function Space for
 * Efficient Spectral Upsampling", Computer Graphics Forum 38(2), 2019.
 * The polynomial runs over w = (nm - 360) / 470 and not over nm, which keeps its coefficients in the range
 * of a float's digits. Single colours are solved for, from where the table has them; images go through the table alone.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/color.h"
#include "optics/upsample_solve.h"
#include "optics/upsample_table.h"

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

/* Where t, in 0..1, lies between the knots, and the weights of the four about it: E. Catmull, R. Rom, "A
 * Class of Local Interpolating Splines" (1974). At the ends the missing knot is extrapolated from the
 * last two, which comes to adding its weight to theirs. Returns the first knot of the four. */
static int cubic_weights(double t, double weight[4])
{
    double position = t * (UPSAMPLE_KNOTS - 1);
    int knot = (int)fmin(position, UPSAMPLE_KNOTS - 2);
    double f = position - knot;
    weight[0] = f * (-0.5 + f * (1 - 0.5 * f));
    weight[1] = 1 + f * f * (-2.5 + 1.5 * f);
    weight[2] = f * (0.5 + f * (2 - 1.5 * f));
    weight[3] = f * f * (-0.5 + 0.5 * f);
    if (knot == 0) {
        /* knots -1 0 1 2 become 0 1 2 3 */
        weight[1] += 2 * weight[0];
        weight[2] -= weight[0];
        weight[0] = weight[1];
        weight[1] = weight[2];
        weight[2] = weight[3];
        weight[3] = 0;
        return 0;
    }
    if (knot == UPSAMPLE_KNOTS - 2) {
        /* knots n-3 n-2 n-1 n become n-4 n-3 n-2 n-1 */
        weight[2] += 2 * weight[3];
        weight[1] -= weight[3];
        weight[3] = weight[2];
        weight[2] = weight[1];
        weight[1] = weight[0];
        weight[0] = 0;
        return UPSAMPLE_KNOTS - 4;
    }
    return knot - 1;
}

void upsample_coefficients(const float rgb[3], float coefficients[3])
{
    double clamped[3];
    for (int c = 0; c < 3; c++) clamped[c] = clamp((double)rgb[c], 0, 1);
    if (is_grey(clamped)) {
        coefficients[0] = (float)upsample_constant(clamped[0]);
        coefficients[1] = coefficients[2] = 0;
        return;
    }
    int largest = clamped[0] >= clamped[1] ? 0 : 1;
    if (clamped[2] > clamped[largest]) largest = 2;
    double z = clamped[largest]; /* above 0: the channels differ */
    double weight_z[4], weight_first[4], weight_second[4];
    double inner = (clamp(z, UPSAMPLE_MARGIN, 1 - UPSAMPLE_MARGIN) - UPSAMPLE_MARGIN) / (1 - 2 * UPSAMPLE_MARGIN);
    int at_z = cubic_weights(upsample_inverse_smoothstep(upsample_inverse_smoothstep(inner)), weight_z);
    int at_first = cubic_weights(upsample_inverse_smoothstep(clamped[(largest + 1) % 3] / z), weight_first);
    int at_second = cubic_weights(upsample_inverse_smoothstep(clamped[(largest + 2) % 3] / z), weight_second);

    double sum[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++) {
                double weight = weight_z[i] * weight_second[j] * weight_first[k];
                const float *knot = upsample_table[largest][at_z + i][at_second + j][at_first + k];
                for (int n = 0; n < 3; n++) sum[n] += weight * (double)knot[n];
            }
    for (int n = 0; n < 3; n++) coefficients[n] = (float)sum[n];
}
