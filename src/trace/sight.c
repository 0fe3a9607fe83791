/* sight.c - what the camera's rays meet first, and what they see behind what is clear: for what a picture holds besides its colours.
 *
 * A line of sight goes the way that most light goes: it is refracted, and mirrored where reflection is total. So what is seen in a glass
 * is one thing at each place, without the noise of the choices that paths make, and without what the glass mirrors; coverage is by
 * samples, as at any edge.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/sight.h"

#include <string.h>

#include "base/attr.h"
#include "base/hash.h"
#include "nest/cross.h"
#include "optics/fresnel.h"
#include "optics/microfacet.h"
#include "optics/sampling.h"
#include "trace/shade.h"
#include "trace/texture_shade.h"
#include "trace/texture_view.h"

/* A line that has come to so many boundaries, in a gem, say, ends at the next one. */
enum { MOST_BOUNDARIES = 64 };

/* The colour of a reflectance under white light. */
static void reflectance_color(const Path *path, const Event *event, const SceneSurface *surface, float rgb[3])
{
    const ReflectedColor *color = &path->tracer->world->reflected;
    Lanes albedo[COLOR_FOURS], sum[3] = {lanes_all(0), lanes_all(0), lanes_all(0)};
    path_albedos(path, event, surface, color->nm, albedo);
    for (int i = 0; i < COLOR_FOURS; i++)
        for (int c = 0; c < 3; c++) sum[c] = lanes_add(sum[c], lanes_mul(albedo[i], color->weights[i][c]));
    for (int c = 0; c < 3; c++) rgb[c] = lanes_sum(sum[c]);
}

static float clear_part(const BsdfSpec *spec)
{
    return (1 - spec->base_metalness) * spec->transmission_weight;
}

/* Whether it is a boundary or a sheet, which may be clear. */
static bool may_be_clear(const World *world, const Event *event)
{
    return event->kind == EVENT_BOUNDARY ||
           (event->kind == EVENT_OPAQUE && scene_is_thin(world->scene, event->hit.object));
}

/* The colour of what is met, white where it is clear. Of a mix that may be clear, that of one part of it; ends: and there of what is
 * not clear alone. */
static void color_of(const Path *path, const Event *event, bool ends, float rgb[3])
{
    const World *world = path->tracer->world;
    const SceneObject *object = &world->scene->objects[event->hit.object];
    const bool boundary = event->kind == EVENT_BOUNDARY, clear = may_be_clear(world, event);
    for (int i = 0; i < 3; i++) rgb[i] = boundary ? 1 : 0;
    if (object->light != SCENE_NONE || object->surface == SCENE_NONE) return;
    const SceneSurface *surface = &world->scene->surfaces[object->surface];
    if (clear) surface = path_surface(path, event, object->surface);
    if (boundary && !surface->painted) return;
    reflectance_color(path, event, surface, rgb);
    if (!clear || ends) return;
    SurfacePlace place = path_place(path, event);
    BsdfSpec room;
    float part = clear_part(path_spec_at(path, event, surface, &place, &room));
    for (int i = 0; i < 3; i++) rgb[i] += part * (1 - rgb[i]);
}

/* ends: whether the line goes no farther, so that of what is clear in part it shows the rest. */
static void note_surface(const Path *path, const Event *event, bool ends, FirstSight *sight)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const Scene *scene = world->scene;
    *sight = (FirstSight){.object = SCENE_NONE, .medium = SCENE_NONE, .through = SCENE_NONE};
    if (event->kind != EVENT_OPAQUE && event->kind != EVENT_BOUNDARY) return;
    bool opaque = event->kind == EVENT_OPAQUE;
    const SceneObject *object = &scene->objects[event->hit.object];
    Vec3f shading = rtc_shading_normal(world->compiled->rtc, &path->ray, &event->hit);
    const NestList *list = opaque ? &tracer->list : &tracer->next;
    if (!opaque && event->behind != BEHIND_IN_NEXT && path_copy_behind(tracer, event, &tracer->next) != STATUS_OK) {
        tracer->out_of_memory = true;
        return;
    }
    sight->met = true;
    sight->object = scene_whole(scene, event->hit.object);
    sight->medium = nest_medium(list);
    sight->n_hulls = nest_list_count(list) - compiled_operands_in(world->compiled, list);
    sight->distance = event->hit.t;
    sight->position = ray_point(&path->ray, event->hit.t);
    sight->normal = event->hit.cos_normal < 0 ? shading : vec3f_negate(shading);
    texture_uv(world, &path->ray, &event->hit, sight->uv);
    color_of(path, event, ends, sight->albedo);
    if (object->surface != SCENE_NONE && surface_has_relief(&scene->surfaces[object->surface])) {
        SurfacePlace place = path_place(path, event);
        path_relief(path, event, &scene->surfaces[object->surface], (double)path->cone_width, &place);
        sight->normal = place.normal;
    }
}

void sight_note(const Path *path, const Event *event, FirstSight *sight)
{
    note_surface(path, event, false, sight);
}

/* ---- behind what is clear ---- */

/* Which hull of the list has a medium, the topmost of several; NEST_WORLD: none. entered: that whose surface the line came to last. */
static uint32_t holder_of(const CompiledScene *compiled, const NestList *list, uint32_t medium, uint32_t entered)
{
    const NestOrder *order = &compiled->order;
    const uint32_t *items = nest_list_items(list);
    if (entered < order->n_hulls && order->top[entered].medium == medium && nest_has(order, list, entered))
        return entered;
    for (uint32_t i = list->n; i-- > 0;)
        if (items[i] < order->n_hulls && order->top[items[i]].medium == medium) return items[i];
    for (uint32_t level = 63; level > 0; level--) {
        if (!(list->point.mask >> level & 1)) continue;
        uint32_t hull = order->hull_at[level];
        if (hull < order->n_hulls && order->top[hull].medium == medium) return hull;
    }
    return NEST_WORLD;
}

/* A place where a medium of an object scatters. */
static void note_scattering(const Path *look, const Event *event, uint32_t entered, FirstSight *sight)
{
    Tracer *tracer = look->tracer;
    const CompiledScene *compiled = tracer->world->compiled;
    uint32_t hull = holder_of(compiled, &tracer->list, event->medium, entered);
    uint32_t object = hull < compiled->n_hulls ? compiled->object_of_hull[hull] : SCENE_NONE;
    *sight = (FirstSight){.object = SCENE_NONE, .medium = SCENE_NONE, .through = SCENE_NONE};
    if (object == SCENE_NONE) return;
    *sight = (FirstSight){.met = true,
                          .object = scene_whole(compiled->scene, object),
                          .medium = event->medium,
                          .scatters = true,
                          .distance = event->t,
                          .position = ray_point(&look->ray, event->t),
                          .albedo = {1, 1, 1},
                          .through = SCENE_NONE};
}

/* Whether this sample goes through where only a part is clear. */
static bool is_clear(const Path *look, const BsdfSpec *spec)
{
    float part = clear_part(spec);
    return part >= 1 || sampler_1d(&look->sampler, sampler_dimension(look->bounce, DIM_LOBE)) < part;
}

/* The normal of one of the facets of a rough boundary. */
static Vec3f facet_normal(const Path *look, const BsdfSpec *spec, Vec3f normal)
{
    float u[2], alpha_x, alpha_y;
    Vec3f x, y, view = vec3f_negate(look->ray.direction);
    bsdf_alphas(spec->specular_roughness, 0, &alpha_x, &alpha_y);
    sampler_2d(&look->sampler, sampler_dimension(look->bounce, DIM_SCATTER), u);
    sampling_basis(normal, &x, &y);
    Vec3f local = {vec3f_dot(view, x), vec3f_dot(view, y), vec3f_dot(view, normal)};
    Vec3f h = microfacet_visible(alpha_x, alpha_y, local, u);
    return vec3f_along(vec3f_along(vec3f_scale(x, h.x), h.y, y), h.z, normal);
}

/* The way on at a boundary: refracted, or mirrored where that is all. Whether it is refracted. */
static bool bend(Path *look, const Event *event, Vec3f normal, Vec3f *direction)
{
    Lanes reflectance;
    bool passes = fresnel_refract(look->ray.direction, normal, path_ior(look, event->crossing.medium_from),
                                  path_ior(look, event->crossing.medium_to), &reflectance, direction);
    if (!passes) *direction = reflect_direction(look->ray.direction, normal);
    return passes;
}

static const SceneSurface *surface_of(const Path *look, const Event *event)
{
    const ObjectLook *object = &look->tracer->world->looks[event->hit.object];
    return object->surface == SCENE_NONE ? NULL : path_surface(look, event, object->surface);
}

static bool cross_boundary(Path *look, Event *event, const SceneSurface *surface)
{
    SurfacePlace place = path_place(look, event);
    BsdfSpec room;
    const BsdfSpec *spec = path_boundary_at(look, event, surface, &place, &room);
    if (spec && surface->painted && !is_clear(look, spec)) return false;
    Vec3f direction, normal = place.normal;
    if (spec && surface->roughness > 0) normal = facet_normal(look, spec, normal);
    bool passes = bend(look, event, normal, &direction);
    /* which side the line is on then is the geometry's to say */
    if ((vec3f_dot(direction, place.geometric) < 0) != passes) passes = bend(look, event, place.geometric, &direction);
    path_leave(look, event, &place, passes, direction);
    return true;
}

/* A sheet does not bend what comes through; a boundary in which it lies does. */
static bool cross_sheet(Path *look, Event *event, const SceneSurface *surface)
{
    SurfacePlace place = path_place(look, event);
    BsdfSpec room;
    if (!surface->thin || !surface->finished || !is_clear(look, path_spec_at(look, event, surface, &place, &room)))
        return false;
    if (path_passes_into_boundary(look, event)) return cross_boundary(look, event, surface_of(look, event));
    if (!path_cross_into_next(look->tracer, event)) return false;
    path_leave(look, event, &place, true, look->ray.direction);
    return true;
}

/* Whether the line goes on behind what it has come to. */
static bool look_through(Path *look, Event *event)
{
    if (event->kind != EVENT_BOUNDARY && event->kind != EVENT_OPAQUE) return false;
    if (look->tracer->world->looks[event->hit.object].light != SCENE_NONE) return false;
    const SceneSurface *surface = surface_of(look, event);
    if (event->kind == EVENT_OPAQUE) return surface && cross_sheet(look, event, surface);
    return cross_boundary(look, event, surface);
}

/* How far a line has come in each of the media that fill objects; of more than there is room for, the first ones. */
typedef struct Ways {
    uint32_t n, media[8];
    double lengths[8];
} Ways;

static void add_way(Ways *ways, uint32_t medium, double length)
{
    uint32_t i = 0;
    if (medium == WORLD_MEDIUM) return;
    while (i < ways->n && ways->media[i] != medium) i++;
    if (i == COUNT_OF(ways->media)) return;
    if (i == ways->n) {
        ways->media[ways->n++] = medium;
        ways->lengths[i] = 0;
    }
    ways->lengths[i] += length;
}

static void note_ways(const Ways *ways, FirstSight *sight)
{
    for (uint32_t i = 0; i < ways->n; i++) {
        if (!(ways->lengths[i] > sight->way)) continue;
        sight->way = ways->lengths[i];
        sight->through = ways->media[i];
    }
}

/* Which things a line has come to, each counted once; of more than there is room for, the first ones. So a bubble is told from
 * none, and two of them from one, but not a line that is mirrored ten times within a gem from one that is eleven times. */
typedef struct Things {
    uint32_t n, objects[8];
} Things;

static void add_thing(Things *things, const World *world, const Event *event, float passed[3])
{
    if (event->kind != EVENT_BOUNDARY && event->kind != EVENT_OPAQUE) return;
    const Scene *scene = world->scene;
    const uint32_t whole = world->looks[event->hit.object].whole;
    uint32_t i = 0;
    while (i < things->n && things->objects[i] != whole) i++;
    if (i < things->n || i == COUNT_OF(things->objects)) return;
    things->objects[things->n++] = whole;
    const SceneObject *object = &scene->objects[whole];
    uint32_t material = object->medium != SCENE_NONE ? object->medium : scene->n_media + object->surface;
    for (uint32_t k = 0; k < 3; k++) passed[k] += 0.25f + 0.75f * hash_to_unit_f(hash_combine(material, k));
}

/* From the first thing that the line has come to. Media in front of that do not scatter it, and neither does what is outside of all
 * objects. */
static void look_behind(Path *look, Event *event, FirstSight *behind)
{
    Tracer *tracer = look->tracer;
    const bool textured = tracer->world->scene->n_textures > 0;
    Ways ways = {.n = 0};
    Things things = {.n = 0};
    float passed[3] = {0, 0, 0};
    double distance = 0;
    uint32_t entered = NEST_WORLD;
    for (uint32_t i = 0; i < MOST_BOUNDARIES && look_through(look, event); i++) {
        if (textured) path_widen(look);
        entered = compiled_hull(tracer->world->compiled, event->hit.object);
        add_thing(&things, tracer->world, event, passed);
        distance += event->hit.t;
        look->bounce++;
        look->straight = nest_medium(&tracer->list) == WORLD_MEDIUM;
        path_next_event(look, event);
        if (textured) path_reach(look, event);
        if (event->kind == EVENT_SCATTER)
            add_way(&ways, event->medium, event->t);
        else if (event->kind == EVENT_BOUNDARY || event->kind == EVENT_OPAQUE)
            add_way(&ways, event->medium, event->hit.t);
    }
    if (!things.n) { /* nothing is looked through */
        *behind = tracer->first_sight;
        if (may_be_clear(tracer->world, event)) note_surface(look, event, true, behind);
        return;
    }
    if (event->kind == EVENT_SCATTER)
        note_scattering(look, event, entered, behind);
    else
        note_surface(look, event, true, behind);
    add_thing(&things, tracer->world, event, passed); /* what is seen behind them, at last */
    memcpy(behind->passed, passed, sizeof passed);
    behind->distance += distance;
    note_ways(&ways, behind);
    if (behind->scatters)
        behind->through = behind->medium; /* most of what is seen is from there, however thin a layer tells */
}

void sight_look(const Path *path, double t)
{
    Tracer *tracer = path->tracer;
    const PathCounters counters = tracer->counters;
    Path look = *path;
    Event event;
    NestList kept;
    nest_list_init(&kept);
    look.straight = true;
    look.looks = false;
    look.fork = NULL;
    if (t > 0) look.ray.t_min = t;
    tracer->out_of_memory = nest_list_copy(&kept, &tracer->list) != STATUS_OK || tracer->out_of_memory;
    if (!tracer->out_of_memory) {
        path_next_event(&look, &event);
        if (tracer->world->scene->n_textures > 0) path_reach(&look, &event);
        sight_note(&look, &event, &tracer->first_sight);
        if (tracer->notes_behind) look_behind(&look, &event, &tracer->behind);
        if (nest_list_copy(&tracer->list, &kept) != STATUS_OK) tracer->out_of_memory = true;
    }
    tracer->counters = counters;
    nest_list_clear(&kept);
}
