/* lens.h - what the rays of a camera start in that has a lens, or is orthographic, where surfaces of hulls come near that.
 * The lens, or the picture plane with the lenses in it, is divided into cells. In those that no surface comes into all rays start
 * in the same hulls, which are looked for once; elsewhere they have to be looked for each time.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LENS_H
#define MEN_LENS_H

#include "scene/compile.h"

typedef struct Lens Lens;

/* Of such a camera, in a scene where nothing moves. Keeps the camera. */
ATTR_NODISCARD Status lens_new(const CompiledScene *compiled, const SceneCamera *camera, Lens **lens, Error *error);
void lens_free(Lens *lens); /* NULL is fine */
/* The list of a ray that starts at a point of it; NULL: not known. lens may be NULL. */
const NestList *lens_list_at(const Lens *lens, Vec3 origin);

#endif
