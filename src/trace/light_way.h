/* light_way.h - where one ray of light goes: how each surface bends, mirrors and weakens it. For people who want to see what a
 * scene does with light, not for pictures.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_WAY_H
#define MEN_LIGHT_WAY_H

#include "optics/crystal.h"
#include "trace/world.h"

typedef enum LightTurn {
    LIGHT_PASSES,   /* through a boundary or a thin sheet */
    LIGHT_MIRRORED, /* in part */
    LIGHT_TOTAL,    /* all that comes there is */
    LIGHT_ENDS,     /* at what is opaque, or a lamp */
    LIGHT_LEAVES,   /* the scene */
    LIGHT_DROPPED   /* it has met so many surfaces that it is followed no farther */
} LightTurn;

/* A stretch of a way, and what is met at its end. */
typedef struct LightStep {
    LightTurn turn;
    double length;     /* of the stretch; INFINITY where it leaves the scene */
    Vec3 place;        /* its end; where it leaves, its beginning */
    Vec3f direction;   /* on from there, unit; of what leaves or ends, the stretch's own */
    uint32_t medium;   /* that the stretch is in */
    uint32_t to;       /* LIGHT_PASSES: the medium behind; the same as before the surface where that is a sheet */
    uint32_t object;   /* whose surface is met, a combination's own row; SCENE_NONE where there is none */
    float index;       /* of the medium; in a crystal, of light along the ray */
    float angle, on;   /* to the surface's normal there, radians: of the ray that comes, and of what is refracted */
    float transmitted, /* of the light that comes to the surface, by it, */
        mirrored;      /* and back from it; 0 and 0 of what ends */
    float part;        /* and what of it goes on this way: one of these, or of what a crystal splits in up to four; */
    uint32_t rank;     /* how many ways on are brighter */
    CrystalWave wave;  /* behind it, in a crystal that refracts doubly */
    float carried;     /* of the ray's first light, to the surface; where it leaves, all along */
    bool scatters;     /* the surface is rough, or not clear in all parts: the directions are those of the middle */
} LightStep;

/* A way from the ray's start, or from where it parts from another one, to its end. */
typedef struct LightWay {
    uint32_t from;     /* the way that this one parts from; SCENE_NONE: the first */
    uint32_t depth;    /* how many steps it has in common with that, */
    uint32_t rank;     /* and which of the ways on it takes behind these */
    uint32_t first, n; /* its own steps; the first of them is what it does where the other one does otherwise */
    double optical;    /* the length of all its steps that end, from the start, times the index */
} LightWay;

typedef struct LightWays {
    uint32_t start; /* the medium that owns the start */
    LightStep *steps;
    LightWay *ways;
    size_t n_steps, steps_capacity, n_ways, ways_capacity;
    bool cut; /* there were more ways than LIGHT_WAYS */
} LightWays;

enum { LIGHT_WAYS = 10000, LIGHT_STEPS = 1000 /* of one way */ };

/* Follows light of one wavelength (nm, 360..830) along the ray, which starts in free space. At each boundary it goes on as most of it
 * does; what does otherwise is a way of its own if it is at least `least` (0..1] of the ray's light. What media scatter counts as
 * absorbed; where they vary, what they leave is an estimate. STATUS_USAGE when the start is on a surface, STATUS_NOMEM. */
ATTR_NODISCARD Status light_ways_find(const World *world, const Ray *ray, float nm, float least, LightWays *ways,
                                      Error *error);
void light_ways_clear(LightWays *ways);
/* What a way does at its surface number k, from the start of the ray: its own step, or of the way that it parted from. */
const LightStep *light_ways_step(const LightWays *ways, uint32_t way, uint32_t k);

#endif
