/* light.h - sampling and evaluating light sources.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_H
#define MEN_LIGHT_H

#include "trace/world.h"

/* A direction from a point towards a light. */
typedef struct LightSample {
    Vec3f direction; /* unit */
    double distance; /* HUGE_VAL for the environment and distant lights */
    uint32_t object; /* of the light; RTC_NO_OBJECT when at infinity */
    float pdf_w;     /* per steradian, the choice of the light included; 0: nothing to gain */
    Lanes radiance;  /* actual radiance in the light's own medium */
} LightSample;

/* choice, u: uniform in [0, 1). time: of the shutter. */
LightSample light_sample(const World *world, Vec3 from, double time, float choice, const float u[2],
                         Lanes wavelength_nm);

/* The density (per steradian, choice included) with which light_sample would have found the light whose object
 * was hit at `hit` from `from`, and its radiance towards there (0 on the back of a one-sided light). */
float light_pdf_hit(const World *world, uint32_t light, Vec3 from, const Ray *ray, const Hit *hit);
Lanes light_radiance_hit(const World *world, uint32_t light, const Hit *hit, Lanes wavelength_nm);

/* What comes from infinity along direction: environment and distant lights, each with its density. A call
 * with weight_pdf >= 0 weights each by the balance heuristic against that density (per steradian) of the
 * caller's own sampling; weight_pdf < 0 takes all of it. */
Lanes light_from_infinity(const World *world, Vec3f direction, float weight_pdf, Lanes wavelength_nm);

#endif
