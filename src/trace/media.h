/* media.h - media that vary from place to place, shine or mix: where their volumes are, what they give off, and places
 * in them that shine, for light sampling.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MEDIA_H
#define MEN_MEDIA_H

#include "scene/compile.h"

/* From the world to lattice coordinates of a medium's volumes, where it has them. */
typedef struct MediumMaps {
    Affine to_density, to_temperature;
    double stretch; /* of lengths cubed, by to_density */
} MediumMaps;

/* Where the volumes of a medium are in one hull that it fills. One that shines without a density has cells in its place:
 * all that is said of the density's lattice is then said of theirs. */
typedef struct MediumPlace {
    uint32_t hull; /* NEST_WORLD: where no hull is */
    uint32_t medium;
    bool moves;                                    /* while the shutter is open: */
    const Affine *keys;                            /* NULL, or where the frame is then */
    const Affine *density_keys, *temperature_keys; /* NULL, or where the volumes are in the frame */
    Affine frame_to_world;                         /* of what does not move, or when the shutter opens; */
    MediumMaps maps;                               /* these, too */
    Affine from_density;                           /* the inverse of maps.to_density, */
    bool has_inverse;                              /* if there is one */
    bool has_cells;
    int32_t n_cells[3];
    Affine to_cells; /* from the frame */
} MediumPlace;

/* A hull whose medium shines: light sampling looks for its bright places. Brick i of its density, shares[i] of the way up
 * to the next one, has that part of its light; within a brick any place is as likely. Of one without a density, cells are
 * the bricks. */
typedef struct Glow {
    const MediumPlace *place;
    double *shares; /* ascending, from that of brick 0 up to 1 */
    size_t n_bricks;
    int32_t edge, n_edges[3], n_along[3]; /* of a brick; of all of them; how many bricks */
    Box3 box;                             /* around all that shines, in lattice coordinates */
    double across;                        /* a typical way through it, in scene units */
    double power; /* luminance in all directions, as lights': W / m^2 times square scene units */
} Glow;

typedef struct WorldMedia {
    bool vary;               /* some medium does, shines or mixes; else the rest does not matter */
    bool *varies;            /* of each medium: its density does, or it shines */
    NestState *mixing_state; /* of each medium, see scene_mixing_state */
    MediumPlace *places;
    uint32_t n_places;
    uint32_t *place_of_hull; /* SCENE_NONE: its medium has no volumes; [n_hulls] is the world's */
    Glow *glows;
    uint32_t n_glows;
    uint32_t *glow_of_place; /* SCENE_NONE: light sampling does not look there */
} WorldMedia;

ATTR_NODISCARD Status media_find(const CompiledScene *compiled, WorldMedia *media, Error *error);
void media_clear(WorldMedia *media);

/* Whether the medium of a place is there where the list holds: it owns the point, or mixes with what does. */
bool media_is_there(const CompiledScene *compiled, const WorldMedia *media, const MediumPlace *place,
                    const NestList *list);
/* Where the volumes of a place are at a time of the shutter; room is for those that move. */
const MediumMaps *media_maps(const Scene *scene, const MediumPlace *place, double time, MediumMaps *room);
/* The inverse of to_density of those maps; NULL: there is none. */
const Affine *media_from_density(const MediumPlace *place, const MediumMaps *maps, Affine *room);
/* The place of the volumes of a hull's medium (NEST_WORLD: the world's); NULL: it has none. */
static inline const MediumPlace *media_place(const WorldMedia *media, const CompiledScene *compiled, uint32_t hull)
{
    uint32_t number = media->place_of_hull[hull == NEST_WORLD ? compiled->n_hulls : hull];
    return number == SCENE_NONE ? NULL : &media->places[number];
}

/* How much brighter than at medium->reference_k a place at that temperature is: quotients of Planck's law. */
Lanes media_planck_ratio(const SceneMedium *medium, float kelvin, Lanes wavelength_nm);

/* ---- glow.c ---- */

/* Fills in glows and glow_of_place, once all places are known; part of media_find. */
ATTR_NODISCARD Status glows_find(const CompiledScene *compiled, WorldMedia *media, Error *error);
/* Around all of a glow, at a time of the shutter; in the world. */
Box3 glow_box(const Scene *scene, const Glow *glow, double time);
/* A place that shines; digits, u: uniform in [0, 1). */
typedef struct GlowPoint {
    Vec3 position;
    double density;       /* of choosing it, per cubic scene unit */
    float amount, kelvin; /* density of the medium there, temperature */
} GlowPoint;
GlowPoint glow_sample(const Scene *scene, const Glow *glow, double time, double digits, const float u[2]);
/* The density of choosing a place, per cubic scene unit, maps being those of its place; 0 where none is chosen. */
double glow_density(const Glow *glow, const MediumMaps *maps, Vec3 position);

#endif
