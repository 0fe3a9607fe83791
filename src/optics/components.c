/* components.c - many spectra as mixtures of a few: their principal components, by Jacobi's method.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/components.h"

#include <math.h>
#include <string.h>

enum { BANDS = ENVIRONMENT_BANDS, SWEEPS = 30 };

/* A symmetric matrix, and the directions that it has been turned to so far. */
typedef struct Turning {
    double matrix[BANDS][BANDS], axes[BANDS][BANDS];
} Turning;

/* Two numbers by an angle of that cosine and sine. */
static void turn(double *a, double *b, double c, double s)
{
    double x = *a, y = *b;
    *a = c * x - s * y;
    *b = s * x + c * y;
}

/* Turns axes p and q so that the matrix has nothing between them. */
static void turn_pair(Turning *turning, int p, int q)
{
    double between = turning->matrix[p][q];
    if (between == 0) return;
    double twice = (turning->matrix[q][q] - turning->matrix[p][p]) / (2 * between);
    double tangent = (twice >= 0 ? 1 : -1) / (fabs(twice) + sqrt(twice * twice + 1));
    double c = 1 / sqrt(tangent * tangent + 1), s = tangent * c;
    for (int k = 0; k < BANDS; k++) turn(&turning->matrix[k][p], &turning->matrix[k][q], c, s);
    for (int k = 0; k < BANDS; k++) turn(&turning->matrix[p][k], &turning->matrix[q][k], c, s);
    for (int k = 0; k < BANDS; k++) turn(&turning->axes[k][p], &turning->axes[k][q], c, s);
}

static void add_products(Turning *turning, const float *spectrum, double luminance)
{
    double parts[BANDS];
    for (int k = 0; k < BANDS; k++) parts[k] = (double)spectrum[k] / luminance;
    for (int i = 0; i < BANDS; i++)
        for (int k = 0; k < BANDS; k++) turning->matrix[i][k] += parts[i] * parts[k];
}

/* The axis along which there is most, and that is not among those taken. */
static int longest_axis(const Turning *turning, unsigned taken)
{
    int longest = -1;
    for (int i = 0; i < BANDS; i++)
        if (!(taken >> i & 1) && (longest < 0 || turning->matrix[i][i] > turning->matrix[longest][longest]))
            longest = i;
    return longest;
}

void components_find(const float *spectra, const float *luminance, size_t n, Components *components)
{
    Turning turning;
    memset(&turning, 0, sizeof turning);
    for (int i = 0; i < BANDS; i++) turning.axes[i][i] = 1;
    for (size_t i = 0; i < n; i++)
        if (luminance[i] > 0) add_products(&turning, spectra + i * BANDS, (double)luminance[i]);
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int p = 0; p < BANDS; p++)
            for (int q = p + 1; q < BANDS; q++) turn_pair(&turning, p, q);
    unsigned taken = 0;
    for (int i = 0; i < COMPONENTS; i++) {
        int axis = longest_axis(&turning, taken);
        taken |= 1U << axis;
        for (int k = 0; k < BANDS; k++) components->of[i][k] = turning.axes[k][axis];
    }
}

void components_split(const Components *components, const float *spectra, const float *luminance, size_t n,
                      float *mixtures)
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < COMPONENTS; k++) {
            double sum = 0;
            for (int band = 0; band < BANDS && luminance[i] > 0; band++)
                sum += components->of[k][band] * (double)spectra[i * BANDS + (size_t)band];
            mixtures[i * COMPONENTS + (size_t)k] = luminance[i] > 0 ? (float)(sum / (double)luminance[i]) : 0;
        }
}
