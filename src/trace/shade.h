/* shade.h - what happens to a path at a surface, a boundary, or a place within a medium; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SHADE_H
#define MEN_SHADE_H

#include "trace/event.h"

/* A surface by its number, or one of those that it is a mix of, by its weight. */
const SceneSurface *path_surface_of_mix(const Path *path, const Event *event, const SceneSurface *surface);
static inline const SceneSurface *path_surface(const Path *path, const Event *event, uint32_t number)
{
    const SceneSurface *surface = &path->tracer->world->scene->surfaces[number];
    return LIKELY(!surface->mixed) ? surface : path_surface_of_mix(path, event, surface);
}

/* Where a surface is met. Both normals are on the side that the path comes from. */
typedef struct SurfacePlace {
    Vec3 position;
    Vec3f normal, geometric; /* for shading: on the geometric one's side, and against the path's direction */
    bool apart; /* it is on the path's ray, in front of the surfaces that that has come to: rays start in free space */
} SurfacePlace;
SurfacePlace path_place_of(const World *world, const Ray *ray, const Hit *hit);
static inline SurfacePlace path_place(const Path *path, const Event *event)
{
    return path_place_of(path->tracer->world, &path->ray, &event->hit);
}
/* Whether straight rays go on through a surface that is there with n in all: a pane, of a combination where it is alone. */
static inline bool path_is_pane(const World *world, uint32_t object, size_t n)
{
    return scene_is_pane(world->scene, object) && (n == 1 || world->scene->objects[object].part_of == SCENE_NONE);
}
/* A light to look at from a place; choices, normal: as light_sample takes them. */
void path_choose_light(const Path *path, const LightChoices *choices, Vec3 from, Vec3f normal, LightSample *light);
/* What may be chosen where the path is scattered. any: whatever the medium: light may come from the other side of a surface, or
 * several surfaces are there. */
static inline const LightChoices *path_lights(const Path *path, bool any)
{
    const World *world = path->tracer->world;
    return any ? world_lights(world) : world_lights_through(world, nest_medium(&path->tracer->list));
}
/* Where light is looked for; looks at one of the lights there, each of which counts by its own density. See slab_lamp.h. */
typedef struct LookPlace {
    Event *event; /* NULL: in a medium; the place is apart then */
    const SurfacePlace *place;
    const LightChoices *choices;
    Vec3f normal; /* as LightQuery's */
} LookPlace;
/* SKY_LOOKS: by ways into one medium, of two */
enum { SKY_LOOKS = 8, MOST_LIGHT_LOOKS = 2 * SKY_LOOKS + 3 };
typedef struct LightLooks {
    LightSample lights[MOST_LIGHT_LOOKS];
    uint32_t n;
    Lanes arrives[MOST_LIGHT_LOOKS]; /* what lights[i].arrives is, where it is any */
} LightLooks;
void path_look_at_light(Path *path, const LookPlace *from, LightLooks *looks);
/* As path_shadow, to the place of a light, of which the ray is told; of light from infinity what comes through bodies with parallel
 * faces, too: see slab_look.h. */
bool path_sees_light(Path *path, const LightSample *light, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light);
/* What comes straight along the ray from a light, as basic radiance; false: nothing. The ray becomes aimed at the light. */
bool path_light_arrives(Path *path, const LightSample *light, Ray *ray, Lanes *basic);
/* Adds that, scattered by the factor, weighted against finding the light by a direction of density pdf_w, or by the guide. */
void path_add_direct_light(Path *path, const LightSample *light, Ray *ray, Lanes scattered, float pdf_w);
/* After so many total reflections in a row a path meets the face itself, not its smooth normal: see let_out in shade.c. */
enum { PATH_MOST_TOTAL = 8 };
/* True with that probability: by a random number of its own at boundaries, one after another. */
bool path_decide(Path *path, float probability);
/* path_start_ray where an event has several surfaces. */
void path_start_ray_of_several(const Path *path, const Event *event, bool through, Vec3f direction, Ray *next);
/* A ray from the place of an event's surfaces, through them (not where the place is apart) or back, while the path waits there; at
 * most one at a time. Not for the place of a boundary of several hulls: see path_cross_towards. */
static inline void path_start_ray(const Path *path, const Event *event, const SurfacePlace *place, bool through,
                                  Vec3f direction, Ray *next)
{
    size_t one = 1;
    Tracer *tracer = path->tracer;
    if (UNLIKELY(place->apart)) {
        double time = path->ray.time;
        ray_begin(next, place->position, direction);
        next->time = time;
    } else if (UNLIKELY(event->n_cluster > 1)) {
        path_start_ray_of_several(path, event, through, direction, next);
    } else {
        rtc_leave(tracer->world->compiled->rtc, &path->ray, tracer->hits.items, &one, through, direction, next);
    }
}
/* Sends the path on from the surfaces that it has come to: through them, or back. */
void path_leave(Path *path, Event *event, const SurfacePlace *place, bool through, Vec3f direction);
/* Radiance given in a medium, as basic radiance. */
Lanes path_basic_radiance(const World *world, Lanes radiance, uint32_t medium, Lanes wavelength_nm);
/* Adds what reaches the camera of a radiance seen at the end of the path, and returns it. Whoever adds light tells the tracer which
 * group of lights it is of, where that is asked for: path_add_to_group. */
Lanes path_add_radiance(Path *path, Lanes factor, Lanes basic);
static inline void path_add_to_group(const Path *path, Lanes more, uint32_t group)
{
    Lanes *sum = &path->tracer->grouped[group];
    *sum = lanes_add(*sum, more);
}
/* The reflectance of an opaque surface where it was hit, at all the wavelengths of a ReflectedColor. */
void path_albedos(const Path *path, const Event *event, const SceneSurface *surface,
                  const Lanes wavelength_nm[COLOR_FOURS], Lanes albedo[COLOR_FOURS]);
/* A place within a medium where the path is scattered. */
void path_scatter_in_medium(Path *path, const Event *event);
/* What an opaque surface that was hit shines by itself. */
void path_add_emission(Path *path, const Hit *hit);
/* A hit of an opaque surface. Returns whether the path goes on. */
bool path_shade_opaque(Path *path, Event *event);
/* A boundary between two dielectrics. Where it is smooth, one of the two ways is taken, with the probability of the
 * hero's Fresnel reflectance. Returns whether the path goes on. */
bool path_cross_boundary(Path *path, Event *event);

/* A direction mirrored by the surface as it is. */
static inline Vec3f path_mirror(const SurfacePlace *place, Vec3f direction)
{
    return vec3f_along(direction, -2 * vec3f_dot(direction, place->geometric), place->geometric);
}
/* Whether the shading normal is another than the geometric one. */
static inline bool path_is_bent(const SurfacePlace *place)
{
    return vec3f_dot(place->normal, place->geometric) < 0.999999f;
}
/* How bright it is where light would come from: mirrored at a boundary, and refracted by it, or straight on where both sides
 * are of index eta_i. It is taken that what the light then leaves by is parallel to the boundary, and leads to the world's
 * own medium. The same whatever wavelength is the hero. False: no difference between the two is known. */
bool path_look_ahead(Path *path, const SurfacePlace *place, Lanes eta_i, float brightness[2]);

#endif
