/* shade_bsdf.h - surfaces that are more than matte, and boundaries that are rough; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SHADE_BSDF_H
#define MEN_SHADE_BSDF_H

#include "trace/shade.h"

/* What scatters light at an opaque or thin surface that is more than matte, with the parameters that it has there, in the medium of
 * tracer->list; and at the boundary of an event that is rough, or not clear in all parts. */
void path_bsdf_of_finished(Path *path, const SceneSurface *surface, const BsdfSpec *spec, Bsdf *bsdf);
void path_bsdf_of_boundary(Path *path, const Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                           Lanes eta_i, Lanes eta_t, Bsdf *bsdf);
/* An opaque surface that is more than matte, and its parameters there; false: the path ends. *straight: it has gone
 * through a pane, as rays towards lights do. It counts as on its way from where it was scattered before, so that what it finds
 * is weighted against light sampling from there. */
bool path_shade_finished(Path *path, Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                         const SurfacePlace *place, bool *straight);
/* What the panes among n surfaces at one place leave of a straight ray; medium: around them. */
Lanes path_pass_panes(const Path *path, const Ray *ray, const Hit *hits, size_t n, uint32_t medium);
/* A boundary between two media that is rough, or not clear in all parts; false: the path ends. */
bool path_cross_rough(Path *path, Event *event, const SceneSurface *surface, const BsdfSpec *spec,
                      const SurfacePlace *place, Lanes eta_i, Lanes eta_t);

#endif
