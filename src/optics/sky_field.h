/* sky_field.h - light that air and ground have scattered, at every height and place, and what reaches an eye of it.
 *
 * Around a round earth what is there depends on the height and on how high the sun stands alone. For some of each, and for
 * directions all around, light is followed by orders of scattering: along straight lines it gathers what was scattered into
 * them, and what comes from all around is scattered again. Orders are added until they fall by the same factor from one to the
 * next; the sum of the others then is a geometric series. What is scattered once is computed for the eye's own lines.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SKY_FIELD_H
#define MEN_SKY_FIELD_H

#include "base/pool.h"
#include "optics/air.h"

typedef struct SkyField SkyField;

/* Per irradiance of the sun above the air, for places where it stands no more than 12 degrees higher or lower than the
 * elevation; beyond, as there. ground: albedo. STATUS_NOMEM. */
ATTR_NODISCARD Status sky_field_new(const Air *air, const float ground[AIR_BANDS], double elevation_rad, Pool *pool,
                                    SkyField **field, Error *error);
void sky_field_free(SkyField *field);
/* The radiance that arrives at a height above the ground from n directions above the horizon, unit, that all have that
 * cosine against the vertical, which is y: n * AIR_BANDS values. */
void sky_field_radiance(const SkyField *field, double height, double cosine, Vec3 sun, const Vec3 *directions, size_t n,
                        float *radiance);

#endif
