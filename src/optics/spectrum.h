/* spectrum.h - quantities that depend on the wavelength, made once and evaluated at four wavelengths
 * at a time.
 * Wavelengths are in nm, 360 to 830, the range of the CIE 1931 observer's table.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SPECTRUM_H
#define MEN_SPECTRUM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/lanes.h"
#include "base/status.h"

#define SPECTRUM_MIN_NM 360.0f
#define SPECTRUM_MAX_NM 830.0f
enum { SPECTRUM_STEP_NM = 5, SPECTRUM_SAMPLES = 95 }; /* (830 - 360) / 5 + 1 */

/* Four of them at a time, n times. */
typedef struct Wavelengths {
    int n;
    const Lanes *nm;
} Wavelengths;

typedef enum SpectrumKind {
    SPECTRUM_CONSTANT,  /* value[0] everywhere */
    SPECTRUM_SIGMOID,   /* scale * S(c0 + c1 w + c2 w^2), w in 0..1 over the range; [JH19] */
    SPECTRUM_LIGHT,     /* the same times the working space's white illuminant, for emission */
    SPECTRUM_CAUCHY,    /* A + B / um^2 + C / um^4 */
    SPECTRUM_SELLMEIER, /* n^2 = 1 + sum B_i um^2 / (um^2 - C_i) */
    SPECTRUM_TABLE,     /* SPECTRUM_SAMPLES values, linear in between */
    SPECTRUM_ROWS,      /* values at wavelengths of their own, closer than a table's: the lines of a lamp */
    SPECTRUM_LANES /* value[0 .. 3] at the four wavelengths that it is asked for, whatever they are: a texture's value at
                        * one hit; of no use elsewhere */
} SpectrumKind;

/* A wavelength in nm, and the value there; linear in between. */
typedef struct SpectrumRow {
    float nm, value;
} SpectrumRow;

typedef struct SpectrumRows {
    uint32_t n;
    SpectrumRow *row; /* ascending; the first is not above SPECTRUM_MIN_NM, the last not below SPECTRUM_MAX_NM */
    uint32_t first[SPECTRUM_SAMPLES]; /* the last row that is not above each wavelength that a table keeps */
    float table[SPECTRUM_SAMPLES];    /* what a table keeps of them */
} SpectrumRows;

typedef struct Spectrum {
    SpectrumKind kind;
    float scale; /* multiplies the value, whatever the kind */
    float value[6];
    union {                       /* not owned */
        const float *table;       /* of SPECTRUM_TABLE */
        const SpectrumRows *rows; /* of SPECTRUM_ROWS */
    };
} Spectrum;

/* spectrum_at for all kinds but SPECTRUM_CONSTANT. */
Lanes spectrum_varying_at(const Spectrum *spectrum, Lanes wavelength_nm);
static inline Lanes spectrum_at(const Spectrum *spectrum, Lanes wavelength_nm)
{
    if (spectrum->kind == SPECTRUM_CONSTANT) return lanes_all(spectrum->scale * spectrum->value[0]);
    return spectrum_varying_at(spectrum, wavelength_nm);
}
float spectrum_at_one(const Spectrum *spectrum, float wavelength_nm);
bool spectrum_is_constant(const Spectrum *spectrum); /* the same at all wavelengths */
bool spectrum_is_zero(const Spectrum *spectrum);
bool spectrum_same(const Spectrum *a, const Spectrum *b); /* at all kept wavelengths, whatever they are made of */
/* the largest value over the range, to within the sampling of 5 nm */
float spectrum_max(const Spectrum *spectrum);

Spectrum spectrum_constant(float value);
/* Cauchy's A + B / um^2 + C / um^4 and Sellmeier's coefficients (C_i in um^2). */
Spectrum spectrum_cauchy(double a, double b_um2, double c_um4);
Spectrum spectrum_sellmeier(const double b[3], const double c_um2[3]);
/* Planck's law at kelvin K, scaled so that its luminance is that of a light of RGB (1,1,1).
 * table: SPECTRUM_SAMPLES floats of the caller's. */
Spectrum spectrum_blackbody(double kelvin, float *table);
/* Measured values: n rows of a wavelength in nm and a value, wavelengths ascending; linear in between, beyond the ends
 * as at them. Where rows lie closer than 2.5 nm to one of the kept wavelengths, it keeps the mean over the 5 nm
 * around it, so that narrow peaks count by their area. table: SPECTRUM_SAMPLES floats of the caller's. */
Spectrum spectrum_from_rows(const double *rows, size_t n, float *table);
/* Whether a table would not keep these rows as they are, but means of them. */
bool spectrum_rows_are_fine(const double *rows, size_t n);
/* The same without a table's steps. rows_kept: the caller's, with room for n + 2 in ->row. For lines of a thousandth of a nm and
 * more, below which wavelengths in float are too coarse. */
Spectrum spectrum_from_fine_rows(const double *rows, size_t n, SpectrumRows *rows_kept);
/* A spectrum in rows as the table that it would be; others as they are. */
Spectrum spectrum_smoothed(const Spectrum *spectrum);
/* Any function of the wavelength, tabulated. */
Spectrum spectrum_tabulate(double (*function)(void *context, double wavelength_nm), void *context, float *table);

#endif
