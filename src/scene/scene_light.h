/* scene_light.h - a light of the scene description, and how it shines to different directions.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SCENE_LIGHT_H
#define MEN_SCENE_LIGHT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/vec3.h"
#include "diag/source.h"
#include "optics/spectrum.h"

/* Measured intensities of a lamp by two angles in degrees, linear in between; candela by 683 lm per watt. The letters are
 * those of goniophotometers. In the lamp's frame, whose axis is +y, up is -z and the right is -x. */
typedef enum ProfileType {
    PROFILE_C, /* vertical: from the axis; horizontal: about it, from +x over +z. What is not given by symmetry is dark. */
    PROFILE_B, /* horizontal: to the right of the plane that the axis and up span; vertical: about the right, upwards */
    PROFILE_A /* vertical: above the plane that the axis and the right span; horizontal: about up, to the right. Of both,
                * angles from 0 on stand for those below 0, too, and behind the lamp it is dark. */
} ProfileType;

typedef struct LightProfile {
    ProfileType type;
    const float *vertical, *horizontal; /* ascending */
    const float *intensity;             /* n_vertical for each horizontal angle */
    uint32_t n_vertical, n_horizontal;
} LightProfile;

typedef enum LightKind {
    LIGHT_RECT,   /* one-sided, |x| <= half_width, |z| <= half_height in the plane y = 0 of the object, shining to +y */
    LIGHT_DISC,   /* one-sided, radius half_width, shining to +y */
    LIGHT_SPHERE, /* radius half_width */
    LIGHT_DISTANT, /* from a cone of directions at infinity, as the sun */
    LIGHT_POINT,   /* without size: to all sides, into a cone about +y, or by a profile */
    LIGHT_PORTAL /* no light, but where the environment's comes in: a LIGHT_RECT in place and form, without an object */
} LightKind;

typedef struct SceneLight {
    LightKind kind;
    const char *name;
    Span span;
    /* W / (m^2 sr) up to the scene's common scale; the actual radiance in the light's own medium. LIGHT_POINT: intensity
     * along its axis, or where the profile is 1: radiance times square scene units */
    Spectrum radiance;
    double half_width, half_height;
    uint32_t object; /* SCENE_NONE for LIGHT_DISTANT, LIGHT_POINT and LIGHT_PORTAL */
    uint32_t motion; /* of LIGHT_POINT, as SceneObject's; others move with their object */
    uint64_t identity;
    Affine to_world;             /* rigid: rotation and translation */
    uint32_t group;              /* of the scene's light_groups */
    bool hidden;                 /* the camera looks past it */
    bool hangs;                  /* along its node's y axis: how it is turned about its own is of no meaning */
    Vec3 towards;                /* LIGHT_DISTANT: unit, from the scene to the light */
    double cos_angle;            /* LIGHT_DISTANT: of the cone's half angle */
    bool mirrored;               /* by its transforms, as of a profile shows: z is the other way round in it */
    const LightProfile *profile; /* LIGHT_POINT: NULL, or instead of what cos_full says; cos_none bounds it */
    double cos_full,
        cos_none; /* as bright as ever within the first angle from +y, dark beyond the other; 0 of LIGHT_RECT and LIGHT_DISC
                   * that shine to all of one side, and of what has no direction */
} SceneLight;

static inline bool light_is_flat(const SceneLight *light)
{
    return light->kind == LIGHT_RECT || light->kind == LIGHT_DISC;
}
/* Places on a light that has a surface, in the world, and which way it shines there: the middle of one that is flat, and halfway to
 * its corners, first two that are opposite. */
enum { LIGHT_PLACES = 5 };
void light_some_places(const SceneLight *light, Vec3 places[LIGHT_PLACES], Vec3 up[LIGHT_PLACES]);
/* Whether it is flat, and shines into a cone alone. */
static inline bool light_is_focused(const SceneLight *light)
{
    return light->cos_none > 0 && light_is_flat(light);
}
/* How bright a LIGHT_POINT, a LIGHT_RECT or a LIGHT_DISC is towards a direction (unit, in its own frame), its axis being 1. */
float light_shape(const SceneLight *light, Vec3 direction);
/* The integral of that over all directions, in steradians; of what is flat times the cosine to its normal. */
double light_beam(const SceneLight *light);

#endif
