/* fresnel.h - what a smooth boundary does to a wave: between two dielectrics, and at a conductor.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FRESNEL_H
#define MEN_FRESNEL_H

#include <stdbool.h>

#include "base/attr.h"
#include "base/lanes.h"
#include "base/vec3.h"

/* Unpolarized reflectance of light in a medium of index eta_i that meets one of eta_t at an angle of
 * cosine cos_i (0..1) to the normal. Exact Fresnel equations, to 1e-6. Exactly 1 beyond the critical angle, where
 * refract_direction gives false (for the same float cosine), and exactly 0 between equal indices, at any angle. */
float fresnel_dielectric(float cos_i, float eta_i, float eta_t);
/* The same per wavelength. */
Lanes fresnel_dielectric_lanes(float cos_i, Lanes eta_i, Lanes eta_t);
/* Of light polarized across the plane of incidence, and along it. Their mean is the same. */
void fresnel_dielectric_polarized(float cos_i, Lanes eta_i, Lanes eta_t, Lanes reflectance[2]);
/* The same where both cosines (above 0) of a refracted ray are known, per wavelength. */
Lanes fresnel_dielectric_pair(Lanes cos_i, Lanes cos_t, Lanes eta_i, Lanes eta_t);
/* How often reflection is to be chosen by a path, where what is not reflected goes on, and it is so bright in the two
 * directions; per wavelength. Between equals, as often as it reflects. Reflection that leads to light is not chosen more
 * often than every second time, nor that which leads away from it less than a fifth as often: something may be in between. */
static inline Lanes fresnel_choice(Lanes reflectance, float mirrored, float passed)
{
    const float most = 0.5f, least = 0.2f;
    if (LIKELY(mirrored == passed)) return reflectance;
    Lanes back = lanes_scale(reflectance, mirrored), on = lanes_scale(lanes_rest(reflectance), passed);
    Lanes chosen = lanes_div(back, lanes_add(back, on));
    chosen = lanes_lesser(chosen, lanes_greater(reflectance, lanes_all(most)));
    return lanes_greater(chosen, lanes_scale(reflectance, least));
}
/* Reflectance of a conductor of index n + i k relative to the medium in front of it, per wavelength, at an angle of cosine
 * 0..1: exact, in the real form of "Optical Properties of Metals", M. Born, E. Wolf, "Principles of Optics", 14.2.
 * n, k >= 0. */
Lanes fresnel_conductor(float cos_i, Lanes n, Lanes k);
/* Its hemispherical mean, to 0.003 where k is at least 1, as metals' are. */
Lanes fresnel_conductor_mean(Lanes n, Lanes k);
/* Hemispherical mean reflectance for diffuse light coming from eta_i, 2 * integral F cos dcos;
 * closed form of Walsh (1926) / Duntley, or a fit with the stated error. */
float fresnel_dielectric_mean(float eta_i, float eta_t);

/* direction travels towards the surface (unit), normal is on the side it comes from (unit). */
static inline Vec3f reflect_direction(Vec3f direction, Vec3f normal)
{
    return vec3f_along(direction, -2 * vec3f_dot(direction, normal), normal);
}
/* false beyond the critical angle; *refracted is a unit vector, between equal indices direction itself. Snell's law in
 * vector form. The cosine is -vec3f_dot(direction, normal). */
bool refract_direction(Vec3f direction, Vec3f normal, float eta_i, float eta_t, Vec3f *refracted);
/* Both at once, of a ray with four wavelengths: the reflectance of each, and where the first of them, the hero, is
 * refracted to; false: its reflection is total, and *refracted is not set. */
bool fresnel_refract(Vec3f direction, Vec3f normal, Lanes eta_i, Lanes eta_t, Lanes *reflectance, Vec3f *refracted);

#endif
