/* thin_film.h - thin films, in which light interferes: between two media, or on a metal.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_THIN_FILM_H
#define MEN_THIN_FILM_H

#include "base/angle.h"
#include "base/lanes.h"

/* Indices are relative to any one medium, the same for the film and what it lies between. */
typedef struct ThinFilm {
    Lanes ior;   /* of the film, which absorbs nothing */
    Lanes delay; /* 4 pi times its thickness over the wavelength in that medium; above 0 */
} ThinFilm;

/* Relative to a medium: both indices are in vacuum, and so is the wavelength. */
static inline ThinFilm thin_film_make(Lanes ior, Lanes of_medium, float thickness_nm, Lanes wavelength_nm)
{
    const float thinnest = 1e-3f;
    Lanes turns = lanes_div(lanes_all(4 * (float)MEN_PI * float_max(thickness_nm, thinnest)), wavelength_nm);
    return (ThinFilm){lanes_div(ior, of_medium), lanes_mul(turns, of_medium)};
}

/* What it reflects, both its boundaries and what goes to and fro between them together, of unpolarized light from a medium of index
 * eta_i at an angle of that cosine (0..1), where eta_t + i k is what it lies on. Airy's sum of all reflections: M. Born, E. Wolf,
 * "Principles of Optics", 1.6.4 (56), with complex cosines where light is reflected totally, or met by a metal (14.4). What is
 * not reflected goes on where k is 0, and is absorbed elsewhere. Exactly 1 beyond the critical angle of eta_i and eta_t. */
Lanes thin_film_reflectance(const ThinFilm *film, float cosine, Lanes eta_i, Lanes eta_t, Lanes k);
/* Its hemispherical mean, to 0.02: for diffuse light. */
Lanes thin_film_mean_reflectance(const ThinFilm *film, Lanes eta_i, Lanes eta_t, Lanes k);

#endif
