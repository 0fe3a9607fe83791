/* color.c - from wavelengths to linear Rec.709, and which wavelengths a path carries.
 * [WNDWH14] A. Wilkie, S. Nawaz, M. Droske, A. Weidlich, J. Hanika, "Hero Wavelength Spectral Sampling",
 * Computer Graphics Forum 33(4), 2014: one wavelength chosen, the others rotated from it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/color.h"

#include <math.h>

#include "optics/observer.h"

void color_matching(float wavelength_nm, float xyz[3])
{
    float fraction;
    int row = observer_row(wavelength_nm, SPECTRUM_STEP_NM, &fraction);
    for (int k = 0; k < 3; k++) xyz[k] = (1 - fraction) * observer_xyz[row][k] + fraction * observer_xyz[row + 1][k];
}

Lanes white_at(Lanes wavelength_nm)
{
    int32_t row[LANES];
    Lanes fraction = observer_rows(wavelength_nm, 2 * SPECTRUM_STEP_NM, row);
    return lanes_scale(observer_between(observer_d65, row, fraction), (float)OBSERVER_WHITE_SCALE);
}

/* The inverse of the distribution is a table over equal steps of u, so a look-up needs no search, and
 * the density is constant within a cell and known exactly: 1 / (cells * width). The four wavelengths
 * lie a quarter of the table apart, at the same place in their cells.
 *
 * [WNDWH14] leave the distribution open. What counts for colour noise is the sum over the four lanes,
 * and a density can be had for which that sum hardly depends on u: while one lane leaves the blue
 * peak the next one enters it, and the same for green and red. Standard deviation of R, G, B per path
 * for white light of radiance 1 (measured; tests/unit/color_test.c prints the last line again), and
 * of a lone dispersed wavelength (root mean square of the three; here less means rather little):
 *     uniform                                      0.774 0.414 0.814    2.74
 *     sech^2((w - 538 nm) 0.0072), as in pbrt-v4   0.151 0.031 0.579    2.19
 *     x + y + z times D65, plus a floor            0.385 0.249 0.285    1.94
 *     root of r^2 + g^2 + b^2, times D65           0.303 0.162 0.299    1.80
 *     this table                                   0.026 0.015 0.028    1.87 */
WavelengthSample wavelengths_sample(float u)
{
    float position = u * (float)OBSERVER_WAVELENGTH_CELLS;
    int cell = (int)position;
    Lanes fraction = lanes_all(position - (float)cell);
    const int quarter = OBSERVER_WAVELENGTH_CELLS / LANES, all = OBSERVER_WAVELENGTH_CELLS - 1;
    const float *at[LANES];
    for (int i = 0; i < LANES; i++) at[i] = &observer_wavelengths[(cell + i * quarter) & all];
    Lanes from = lanes(at[0][0], at[1][0], at[2][0], at[3][0]), to = lanes(at[0][1], at[1][1], at[2][1], at[3][1]);
    Lanes width = lanes_sub(to, from);
    return (WavelengthSample){.nm = lanes_add(from, lanes_mul(fraction, width)),
                              .pdf = lanes_div(lanes_all(1), lanes_scale(width, (float)OBSERVER_WAVELENGTH_CELLS))};
}

static Lanes observer_row_lanes(const float row[4])
{
    return lanes(row[0], row[1], row[2], row[3]);
}

void color_from_lanes(Lanes radiance, const WavelengthSample *wavelengths, float rgb[3])
{
    Lanes weight = lanes_div(radiance, lanes_scale(wavelengths->pdf, (float)LANES));
    Lanes sum = lanes_all(0); /* x, y, z, 0 */
    int32_t row[LANES];
    Lanes fractions = observer_rows(wavelengths->nm, SPECTRUM_STEP_NM, row);
    for (int i = 0; i < LANES; i++) {
        float fraction = lanes_get(fractions, i);
        Lanes xyz = lanes_add(lanes_scale(observer_row_lanes(observer_xyz[row[i]]), 1 - fraction),
                              lanes_scale(observer_row_lanes(observer_xyz[row[i] + 1]), fraction));
        sum = lanes_add(sum, lanes_scale(xyz, lanes_get(weight, i)));
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)observer_rgb_from_xyz[c][0] * lanes_get(sum, 0) +
                 (float)observer_rgb_from_xyz[c][1] * lanes_get(sum, 1) +
                 (float)observer_rgb_from_xyz[c][2] * lanes_get(sum, 2);
}

void reflected_color_init(ReflectedColor *color)
{
    double sum[3] = {0};
    for (int i = 0; i < COLOR_FOURS; i++) {
        WavelengthSample wavelengths = wavelengths_sample(((float)i + 0.5f) / (LANES * COLOR_FOURS));
        Lanes light = white_at(wavelengths.nm);
        color->nm[i] = wavelengths.nm;
        for (int lane = 0; lane < LANES; lane++) {
            Lanes alone = lanes_all(0);
            float rgb[3];
            lanes_set(&alone, lane, lanes_get(light, lane));
            color_from_lanes(alone, &wavelengths, rgb);
            for (int c = 0; c < 3; c++) {
                lanes_set(&color->weights[i][c], lane, rgb[c]);
                sum[c] += (double)rgb[c];
            }
        }
    }
    for (int i = 0; i < COLOR_FOURS; i++)
        for (int c = 0; c < 3; c++) color->weights[i][c] = lanes_scale(color->weights[i][c], (float)(1 / sum[c]));
}

/* Between two rows, and two of the observer's, both are linear: Simpson's rule is exact. */
static double y_of_piece(const SpectrumRow *row, double from, double to)
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        float xyz[3];
        double nm = from + (to - from) * i / 2, start = (double)row[0].nm;
        double part = (nm - start) / ((double)row[1].nm - start);
        color_matching((float)nm, xyz);
        sum += (i == 1 ? 4 : 1) * (double)xyz[1] * ((1 - part) * (double)row[0].value + part * (double)row[1].value);
    }
    return sum * (to - from) / 6;
}

static double luminance_of_rows(const SpectrumRows *rows)
{
    double sum = 0, from = (double)SPECTRUM_MIN_NM, step = from;
    for (uint32_t i = 0; i + 1 < rows->n; i++) {
        double end = fmin((double)rows->row[i + 1].nm, (double)SPECTRUM_MAX_NM);
        while (from < end) {
            while (step <= from) step += SPECTRUM_STEP_NM;
            double to = fmin(end, step);
            sum += y_of_piece(&rows->row[i], from, to);
            from = to;
        }
    }
    return sum;
}

double spectrum_luminance(const Spectrum *spectrum)
{
    bool in_rows = spectrum->kind == SPECTRUM_ROWS;
    double weighted = 0, total = 0;
    for (int node = 0; node < OBSERVER_NODES; node++) {
        float xyz[3], nm = (float)observer_node(node);
        color_matching(nm, xyz);
        if (!in_rows) weighted += (double)xyz[1] * (double)spectrum_at_one(spectrum, nm);
        total += (double)xyz[1];
    }
    if (in_rows) weighted = (double)spectrum->scale * luminance_of_rows(spectrum->rows) / OBSERVER_NODE_WEIGHT;
    return weighted / total;
}
