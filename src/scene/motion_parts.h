/* motion_parts.h - what the files share that find what moves; private to src/scene/motion*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MOTION_PARTS_H
#define MEN_MOTION_PARTS_H

#include "scene/build_parts.h"

/* The object that a texture was met on first, and the property that has it there. */
typedef struct TextureUser {
    const SceneObject *object;
    const char *property;
} TextureUser;

/* Of a lamp, see SceneLight.hangs. */
enum { HUNG_BEFORE = 1 /* at the key before */, HUNG_SO_FAR = 2 /* at all of them */ };

/* The scene as the shutter opens, and it at another moment. Rows are found by the objects that they belong to. */
typedef struct Finder {
    Scene *scene;
    Diag *diag;
    Error *error;
    const SceneText *text;
    const SceneOptions *options;
    uint32_t n_keys;
    size_t motions_capacity;
    uint32_t texture_frames_capacity;
    bool *shape_reported, projection_reported;
    /* Of each row of the scene its row at the other moment, which is key number `key`; SCENE_NONE: not met so far. */
    uint32_t *shape_then, *medium_then, *surface_then, *texture_then;
    TextureUser *texture_users;
    bool *texture_stays; /* it was told to stay as it is at first */
    uint8_t *hung;       /* of each light */
    Arena other_arena;
    Scene *other;
    uint32_t *places; /* which of its objects is which */
    uint32_t key;
    Status status;
} Finder;

/* motion.c: *motion is of a map that is `first` when the shutter opens, and `then` at the present key. */
void motion_of_map(Finder *f, uint32_t *motion, const Affine *first, const Affine *then);
/* Tells that a value stays. where NULL: nowhere in the text. */
void motion_report(Finder *f, const Span *where, const char *what, const char *name);

/* motion_lamp.c: *motion is of what shines, of a light that is at `first` when the shutter opens. */
void motion_of_lamp(Finder *f, uint32_t light, uint32_t then, uint32_t *motion, const Affine *first);
/* Lights without an object that moves for them. */
void motion_of_points(Finder *f);

/* motion_values.c: what there is beside places, of an object and of what belongs to no object. */
void motion_of_values(Finder *f);
void motion_of_matter(Finder *f, uint32_t object, uint32_t then);

/* motion_texture.c: of an object's surface, and where its textures are. */
void motion_of_surface(Finder *f, const SceneObject *object, uint32_t surface, uint32_t then);
void motion_of_texture_frame(Finder *f, SceneObject *object, const SceneObject *then);
/* When all keys are known. Returns whether any texture changes. */
bool motion_finish_textures(Finder *f);

#endif
