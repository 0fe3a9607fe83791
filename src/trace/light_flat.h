/* light_flat.h - quads and discs, which shine to one side, or into a cone about their normal.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_FLAT_H
#define MEN_LIGHT_FLAT_H

#include "trace/light.h"

/* A point on it, uniform in area. */
Vec3 light_flat_point(const SceneLight *light, const Affine *to_world, const float u[2]);
double light_flat_area(const SceneLight *light, const Affine *to_world);
/* Its area times the projected solid angle of the cone that it shines into; one that moves as it is at rest. */
double light_flat_extent(const SceneLight *light);
/* A line along which it shines, or a LIGHT_POINT, uniform in its area and in the projected solid angle of its cone. */
void light_flat_send(const SceneLight *light, const Affine *to_world, const float u[2], const float v[2], Vec3 *origin,
                     Vec3f *direction);
/* Samples the part of it that may shine at a point; radiance: in relation to that along the normal. */
void light_flat_sample(const SceneLight *light, const Affine *to_world, Vec3 from, const float u[2],
                       LightSample *sample, float *radiance);
/* The density (per steradian) of that for the place where a ray has hit it. */
float light_flat_pdf(const SceneLight *light, const Affine *to_world, Vec3 from, const Ray *ray, const Hit *hit);
/* How bright it is towards the start of a ray that has come to it, in relation to along the normal. */
float light_flat_radiance(const SceneLight *light, const Affine *to_world, Vec3f direction);
/* Cuts the stretch of a line, from *begin to *end, to where the light may shine; false: nowhere. */
bool light_flat_reach(const SceneLight *light, const Affine *to_world, Vec3 origin, Vec3f direction, double *begin,
                      double *end);
/* Cuts a stretch of a line, origin + t direction, to where it is within the cone about the axis (unit) whose tip is at 0; of
 * the half angle of that cosine, which is >= 0. */
bool light_cut_to_cone(Vec3 origin, Vec3 direction, Vec3 axis, double cosine, double *begin, double *end);

#endif
