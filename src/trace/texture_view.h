/* texture_view.h - where on its object a hit is, for textures.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEXTURE_VIEW_H
#define MEN_TEXTURE_VIEW_H

#include "trace/world.h"

/* A place and the maps between it and the world; of surfaces whose textures ask for the world alone, only what is about that. */
typedef struct TextureView {
    TexturePlace at;
    const Affine *to_texture; /* from the world to the frame of the object's textures: one of these two, not copied */
    RtcCoordinates coordinates;
    Affine composed;
    bool mirrored; /* to_texture mirrors */
} TextureView;

/* Of the object that the ray has hit, for the textures of a surface of it; the object has a frame for textures. Of the
 * hit, t, object, primitive, normal and the barycentric u, v count. footprint: a length in the world that details need
 * not be smaller than. */
void texture_view(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit, double footprint,
                  TextureView *view);
/* The coordinates of the surface there, whether it has textures or not: as pictures lie on it. The world has the boxes around
 * meshes, or 0 stands for those of meshes without any. */
void texture_uv(const World *world, const Ray *ray, const Hit *hit, float uv[2]);
/* The radiance of a surface whose emission is a texture; footprint: as above. */
Lanes texture_emission(const World *world, const SceneSurface *surface, const Ray *ray, const Hit *hit,
                       double footprint, Lanes wavelength_nm);

#endif
