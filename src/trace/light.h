/* light.h - sampling and evaluating light sources.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_H
#define MEN_LIGHT_H

#include "trace/world.h"

/* A direction from a point towards a light. */
typedef struct LightSample {
    Vec3f direction;    /* unit */
    double distance;    /* how far to look for what is in the way; HUGE_VAL for the environment and distant lights; */
    double short_of;    /* by how much that ends in front of the place: see light_short_of */
    uint32_t object;    /* that a ray to there is aimed at, see Ray; RTC_NO_OBJECT: none */
    uint32_t primitive; /* of it; RTC_NO_OBJECT: all */
    float pdf_w;        /* per steradian, the choice of the light included; 0: nothing to gain */
    const Glow *glow;   /* NULL, or the medium whose place this is, if that has not gone to another one there */
    uint32_t emitter;   /* of world->emitters; EMITTER_NONE: from infinitely far */
    uint32_t distant;   /* of what is infinitely far and not of_sky: which of the scene's lights */
    float choice;       /* of pdf_w, what is the choice of the light */
    /* > 0: the place is on the surface of an operand, which need not be the combination's there; the surface is met at up to this
     * part of the distance beyond it. The object is the operand then */
    float slack;
    bool delta;  /* a light without size: no direction finds it by chance, and pdf_w is that of its choice */
    bool of_sky; /* from the environment, whose radiance is left for light_sample_radiance */
    EnvironmentPlace sky;
    const Lanes *arrives; /* NULL, or what is known to arrive of it, as basic radiance: see slab_lamp.h */
    Lanes radiance;       /* actual radiance in the light's own medium; of a delta light its irradiance from there */
} LightSample;

/* How far in front of a place on a light's surface, which is met at that cosine, looks for what hides it end. The direction is rounded to float, so
 * that the ray meets the surface a little beside the place: nothing that near to it blocks, nor anything that is at one place with
 * it, over which the light wins (scene/ties.h), and a wall right behind a flat light is not reached. */
static inline double light_short_of(double distance, double cosine, Vec3 place)
{
    return double_min((4e-7 * distance + rtc_rounding(place)) / cosine, 0.5 * distance);
}

/* The radiance, also of the environment: looked up when nothing is in the way, as it may be far away in memory. */
static inline Lanes light_sample_radiance(const World *world, const LightSample *sample, Lanes wavelength_nm)
{
    if (!sample->of_sky) return sample->radiance;
    return environment_radiance_at(world->scene->environment, &sample->sky, wavelength_nm);
}

/* The scene's group of lights that it is of, and that of what shines at a hit. */
uint32_t light_sample_group(const World *world, const LightSample *sample);
uint32_t light_hit_group(const World *world, const Hit *hit);

/* Where light is looked for, when, and by which random numbers. */
typedef struct LightQuery {
    Vec3 from;
    /* unit, of the surface at `from`, if it takes light from its one side only; zero where light may come from anywhere (media,
     * surfaces that let light through) */
    Vec3f normal;
    double time; /* of the shutter, 0 .. 1 */
    /* uniform in [0, 1), for choosing a light, and then what that leaves of its digits, for what takes more than u; where there
     * are many lights, it needs more digits than a float has */
    double rest;
    float u[2]; /* uniform in [0, 1), for the place on the light */
    Lanes wavelength_nm;
} LightQuery;

/* Afterwards query->rest is what is left of it. */
void light_sample(const World *world, const LightChoices *choices, LightQuery *query, LightSample *sample);
/* The same with an entry of the choices that was chosen already. */
void light_sample_choice(const World *world, const LightChoice *chosen, LightQuery *query, LightSample *sample);
/* The same with an emitter of world->emitters; pdf_w is then without its choice, and so is choice. The normal does not matter. */
void light_sample_emitter(const World *world, uint32_t emitter, const LightQuery *query, LightSample *sample);
/* The object that the sampled place is on; RTC_NO_OBJECT: on none. It is sample->object but for what may stand in its own light, as
 * a ring does, and which rays are therefore not aimed at. */
uint32_t light_sample_object(const World *world, const LightSample *sample);
/* Of a sample on an operand's surface: whether a hit of its ray is at the place, on the side that shines. */
bool light_is_met(const World *world, const LightSample *sample, const Hit *hit);
/* Of an emitter that is flat and shines into a cone: area times projected solid angle of what it shines into, as if it were as
 * bright to all of that; one that moves as it is at rest. 0 of others. */
double light_send_extent(const World *world, uint32_t emitter);
/* A line along which such an emitter shines, or a LIGHT_POINT with a cone, all alike. u, v: uniform in [0, 1). */
void light_send(const World *world, uint32_t emitter, double time, const float u[2], const float v[2], Vec3 *origin,
                Vec3f *direction);
/* An entry of the choices, of which there are some; *choice: uniform in [0, 1), and what is left of its digits. */
const LightChoice *light_choose(const LightChoices *choices, double *choice);

/* About what the light of an emitter falls off with the squared distance. */
typedef struct LightPivot {
    Vec3 place;
    double softening2; /* square of a distance within which it does not fall off any more */
} LightPivot;
/* Of the place that light_sample_emitter, given the same numbers, looks at from anywhere; or for what is round, its middle. */
LightPivot light_pivot(const World *world, uint32_t emitter, double time, double rest, const float u[2]);
/* The same for a place on it that is known. */
LightPivot light_pivot_at(const World *world, uint32_t emitter, double time, Vec3 place);
/* The light that an emitter is; NULL: it is none. */
static inline const SceneLight *light_of_emitter(const World *world, uint32_t emitter)
{
    const Emitter *e = &world->emitters.emitters[emitter];
    return e->kind == EMITTER_LIGHT ? &world->scene->lights[e->of] : NULL;
}
/* A place of an EMITTER_LIGHT that is flat, uniform in its area; of others their middle, and area 0. u: uniform in [0, 1). */
Vec3 light_even_place(const World *world, uint32_t emitter, double time, const float u[2], double *area);
/* That area alone. */
double light_even_area(const World *world, uint32_t emitter, double time);
/* Whether it shines straight from there towards a point. */
bool light_shines_at(const World *world, uint32_t emitter, double time, Vec3 place, Vec3 point);
/* Cuts the stretch of a line, from *begin to *end along its direction, to where an emitter may shine; false: nowhere. Of a
 * spot that is its cone, of what is flat and shines to one side the space before it. */
bool light_reach(const World *world, uint32_t emitter, double time, Vec3 origin, Vec3f direction, double *begin,
                 double *end);

/* Whether the surface that the ray has hit shines, and its radiance towards there; of a texture the mean over a footprint, as
 * texture_view has it. */
bool light_radiance_hit(const World *world, const Ray *ray, const Hit *hit, double footprint, Lanes wavelength_nm,
                        Lanes *radiance);
/* The density (per steradian, choice included) with which light_sample, given the same choices, `from` and normal,
 * would have found the place that was hit; 0 for places that are found by chance only. */
float light_pdf_hit(const World *world, const LightChoices *choices, Vec3 from, Vec3f normal, const Ray *ray,
                    const Hit *hit);

/* The same for a place of a medium that shines. choice: of the glow (light_choice); density: of choosing the place in it
 * (glow_density); and the square of how far it is. Its sample's radiance is what a way as long as glow->across would
 * gain. */
static inline float light_pdf_glow(const Glow *glow, float choice, double density, double distance2)
{
    return choice * (float)(density * distance2 * glow->across);
}
/* The probability with which light_sample chooses an emitter of world->emitters. */
static inline float light_choice(const World *world, const LightChoices *choices, uint32_t emitter, Vec3 from,
                                 Vec3f normal)
{
    if (!(choices->near > 0)) return 0;
    return choices->near * light_tree_probability(world->emitters.tree, emitter, from, normal);
}

/* A direction that was not found by light_sample, which could have found it, too: as from there, with these choices. */
typedef struct LightRival {
    const LightChoices *choices;
    Vec3 from;
    Vec3f normal; /* as LightQuery's */
    float pdf_w;  /* density of the direction as it was found, per steradian; < 0: nothing competes with it */
} LightRival;

/* What comes from infinity along direction: environment and distant lights, each weighted by the balance heuristic, or all of it where
 * nothing competes; sight: those that are hidden to cameras do not count. group: of the scene's light_groups, or LIGHT_GROUPS_ALL. */
#define LIGHT_GROUPS_ALL UINT32_MAX
Lanes light_from_infinity(const World *world, const LightRival *rival, Vec3f direction, bool sight, uint32_t group,
                          Lanes wavelength_nm);

/* The environment's part of light_sample, without the choice of the environment itself: by the environment's own
 * brightness, or through one of the portals that are seen from there. pdf_w is the density of all these ways together. */
void light_sample_environment(const World *world, const LightQuery *query, LightSample *sample);

#endif
