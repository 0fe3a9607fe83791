/* spectral_lines.h - wavelengths for scenes that shine in few of them: sodium lamps, lasers, discharges. Of the wavelengths that
 * serve white light few are within a line of 10 nm, so that one path in ten finds what it lights. Here some lanes of each path
 * are kept for lines; the others are as ever, so that all wavelengths are found.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SPECTRAL_LINES_H
#define MEN_SPECTRAL_LINES_H

#include "optics/color.h"

/* Whether wavelengths_sample serves a light badly: a single one has more than LINES_FROM times the mean square that it would
 * have were all as bright as the mean. White has 1.3, the reddest that RGB can say 3, the lamp of sodium 50
 * as a table, and more in rows. */
#define LINES_FROM 8.0
/* STATUS_NOMEM. */
ATTR_NODISCARD Status spectrum_find_lines(const Spectrum *light, bool *lines, Error *error);

typedef struct WavelengthLines WavelengthLines;

typedef struct LightOfScene {
    const Spectrum *spectrum; /* NULL: one that is no line */
    double power;             /* what it brings to the scene, in any unit */
} LightOfScene;

/* For a scene of n lights. Three lanes are for its lines, which count alike there, whatever their power; or one, as colours of
 * white light get noisier by that, where other lights bring more than a hundredth. Where lines bring less than that, one lane in
 * 32 if some are in rows, which hardly anything else would find; else none.
 * *lines: NULL if none. STATUS_NOMEM. */
ATTR_NODISCARD Status wavelength_lines_new(const LightOfScene *lights, size_t n, WavelengthLines **lines, Error *error);
void wavelength_lines_free(WavelengthLines *lines); /* NULL is fine */

/* Lines in rows are followed row by row: their wavelengths are as exact as float's.
 * As wavelengths_sample: the lanes of u + 1/4 are those of u, the next one first; for a uniform u each lane has the density pdf. */
WavelengthSample wavelength_lines_sample(const WavelengthLines *lines, float u);

#endif
