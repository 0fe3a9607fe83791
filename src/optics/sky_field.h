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
/* The radiance that arrives at a place (from the middle of the earth) from a unit direction above the horizon. */
void sky_field_radiance(const SkyField *field, Vec3 from, Vec3 direction, Vec3 sun, float radiance[AIR_BANDS]);

#endif
