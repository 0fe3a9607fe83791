/* texture_shade.h - what textures make of a surface at a hit: its parameters, and its shading normal; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEXTURE_SHADE_H
#define MEN_TEXTURE_SHADE_H

#include "trace/shade.h"

/* The cone around the path, as wide as it is where the event is. */
void path_reach(Path *path, const Event *event);
/* Where the path goes on after an event: the cone around it widens with the directions that it could have taken. */
void path_widen(Path *path);
/* The size of what need not be told apart of a surface that a path has come to. mask: light goes through parts of it. What is behind a
 * mask is not what is behind its mean: paths that come right from where they were scattered see it as sharp as looks for lights
 * do, which are weighed against them. */
static inline double path_footprint(const Path *path, bool mask)
{
    return mask && path->scatter_pdf > 0 ? 0 : (double)path->cone_width;
}
/* A shading normal such that nothing that comes from `view` is mirrored into the surface. */
Vec3f path_bend_normal(Vec3f view, Vec3f geometric, Vec3f normal);
/* What bumps and normal maps make of the shading normal; footprint: the size of what need not be told apart. At smooth
 * boundaries it is 0: a normal that depends on how far a path has come would let light into total reflections that it
 * never gets out of. */
void path_relief(const Path *path, const Event *event, const SceneSurface *surface, double footprint,
                 SurfacePlace *place);
/* The parameters that a surface with textures has where it was hit, for the four wavelengths given and no others; and
 * what path_relief does. */
void path_read_textures(const Path *path, const Event *event, const SceneSurface *surface, SurfacePlace *place,
                        Lanes wavelength_nm, BsdfSpec *spec);
/* The parameters that any surface has there. room: for those of one with textures, which has what path_read_textures does. */
static inline const BsdfSpec *path_spec_at(const Path *path, const Event *event, const SceneSurface *surface,
                                           SurfacePlace *place, BsdfSpec *room)
{
    if (LIKELY(!surface_has_textures(surface))) return &surface->spec;
    path_read_textures(path, event, surface, place, path->wavelengths.nm, room);
    return room;
}
/* What a boundary has there that a path crosses, its relief among it; surface may be NULL. Returns its parameters where it is rough or
 * not clear in all parts, else NULL: by its relief alone, which is not smoothed then. */
static inline const BsdfSpec *path_boundary_at(const Path *path, const Event *event, const SceneSurface *surface,
                                               SurfacePlace *place, BsdfSpec *room)
{
    if (!surface) return NULL;
    if (!surface_is_clear(surface)) return path_spec_at(path, event, surface, place, room);
    if (surface_has_relief(surface)) path_relief(path, event, surface, 0, place);
    return NULL;
}
/* The parameters of a surface with textures and without relief where a ray hits it; footprint: the size of what need not be
 * told apart. */
void texture_read_spec(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit,
                       double footprint, Lanes wavelength_nm, BsdfSpec *spec);
/* The part of a mix that is its second surface there. */
float texture_mix_weight(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit,
                         double footprint);
/* path_albedos of a surface with textures. */
void path_read_albedos(const Path *path, const Event *event, const SceneSurface *surface,
                       const Lanes wavelength_nm[COLOR_FOURS], Lanes albedo[COLOR_FOURS]);

#endif
