/* light_reach.c - see light_reach.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light_reach.h"

#include <stdlib.h>
#include <string.h>

#include "trace/light.h"

/* Beyond these numbers everything counts as seen, which is never wrong: finding out would take longer than it is worth. */
enum { MOST_MEDIA = 256, MOST_PROBES = 1024, PROBES = 16 /* of each object that shines */ };
static const double most_pairs = 1e7; /* of emitters and hulls */

typedef struct Finder {
    const World *world;
    bool *far, *near; /* of each medium: some of it is at infinity; some of it may be around a light */
} Finder;

/* Whether a ball is within reach of a box. */
static bool meets(Box3 box, Vec3 middle, double radius)
{
    Vec3 nearest = vec3(fmin(fmax(middle.x, box.min.x), box.max.x), fmin(fmax(middle.y, box.min.y), box.max.y),
                        fmin(fmax(middle.z, box.min.z), box.max.z));
    Vec3 away = vec3_sub(nearest, middle);
    return vec3_dot(away, away) <= radius * radius;
}

static void find_hulls(Finder *f)
{
    const CompiledScene *compiled = f->world->compiled;
    const EmitterSet *set = &f->world->emitters;
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        uint32_t medium = compiled->order.top[h].medium;
        if (medium >= f->world->scene->n_media) continue; /* opaque */
        if (compiled->unbounded[h]) f->far[medium] = f->near[medium] = true;
        for (uint32_t i = 0; i < set->n && !f->near[medium]; i++) {
            double radius;
            Vec3 middle;
            f->near[medium] = light_tree_ball(set->tree, i, &middle, &radius) &&
                              meets(compiled->hull_bounds[h], middle, radius * (1 + 1e-5));
        }
    }
}

/* Whether one of an object's emitters, begin to end, stands in the world's medium, by some of them. */
static bool probe(const World *world, uint32_t begin, uint32_t end, HitList *hits, NestList *list, Status *status)
{
    const float middle[2] = {0.5f, 0.5f};
    uint32_t step = (end - begin) / PROBES + 1;
    for (uint32_t i = begin; i < end; i += step) {
        Vec3 place = light_pivot(world, i, 0, 0.5, middle).place;
        *status = compiled_interior(world->compiled, vec3f_from(place), 0, hits, list, NULL);
        if (*status != STATUS_OK) return true;
        uint32_t medium = nest_medium(list);
        if (!compiled_indices_differ(world->scene, medium, WORLD_MEDIUM)) return true;
    }
    return false;
}

static bool same_source(const Emitter *a, const Emitter *b)
{
    return a->kind != EMITTER_LIGHT && a->kind != EMITTER_GLOW && b->kind != EMITTER_LIGHT && b->kind != EMITTER_GLOW &&
           a->of == b->of;
}

static Status find_in_world(const World *world, bool *found, Error *error)
{
    const EmitterSet *set = &world->emitters;
    HitList hits = {0};
    NestList list;
    Status status = STATUS_OK;
    *found = world->scene->n_keys > 0 || (double)set->n_sources * PROBES > MOST_PROBES;
    for (uint32_t i = 0; i < set->n && !*found; i++) /* of what no direction finds by chance nothing may be left out */
        *found =
            set->emitters[i].kind == EMITTER_LIGHT && world->scene->lights[set->emitters[i].of].kind == LIGHT_POINT;
    nest_list_init(&list);
    for (uint32_t begin = 0, end; begin < set->n && !*found; begin = end) {
        for (end = begin + 1; end < set->n && same_source(&set->emitters[begin], &set->emitters[end]); end++) {}
        double radius;
        Vec3 middle;
        if (light_tree_ball(set->tree, begin, &middle, &radius) || end > begin + 1)
            *found = probe(world, begin, end, &hits, &list, &status);
    }
    nest_list_clear(&list);
    hit_list_clear(&hits);
    if (status != STATUS_OK) return fail_memory(error, sizeof(Hit), "lights");
    return STATUS_OK;
}

/* Straight. */
static Status find_straight(World *world, Error *error)
{
    const CompiledScene *compiled = world->compiled;
    uint32_t n = world->scene->n_media;
    NestPolicy policy = compiled->order.policy;
    memset(world->reach, REACH_FAR | REACH_NEAR, n);
    if ((policy != NEST_AUTOMATIC && policy != NEST_PRIORITY) || n > MOST_MEDIA ||
        (double)compiled->n_hulls * world->emitters.n > most_pairs)
        return STATUS_OK;
    bool far[MOST_MEDIA] = {false}, near[MOST_MEDIA] = {false};
    far[WORLD_MEDIUM] = true;
    TRY(find_in_world(world, &near[WORLD_MEDIUM], error));
    find_hulls(&(Finder){world, far, near});
    for (uint32_t m = 0; m < n; m++) {
        world->reach[m] = 0;
        for (uint32_t k = 0; k < n; k++)
            if ((far[k] || near[k]) && !compiled_indices_differ(world->scene, m, k))
                world->reach[m] |= (uint8_t)((far[k] ? REACH_FAR : 0) | (near[k] ? REACH_NEAR : 0));
    }
    return STATUS_OK;
}

/* All lights may be seen from within whatever has flat faces. But where a medium scatters light that comes straight, it is looked
 * for along the way (airlight.h), and these looks are weighed against those from places as among the same lights. */
static void find_through(World *world)
{
    const CompiledScene *compiled = world->compiled;
    memcpy(world->reach_through, world->reach, world->scene->n_media);
    for (uint32_t i = 0; i < world->scene->n_objects && world->slabs.n; i++) {
        if (world->slabs.of_object[i] == SCENE_NONE) continue;
        uint32_t medium = compiled->order.top[compiled_hull(compiled, i)].medium;
        if (medium >= world->scene->n_media || (world->scene->media[medium].scatters && world->reach[medium])) continue;
        world->reach_through[medium] |= REACH_FAR | REACH_NEAR;
    }
}

Status light_reach_find(World *world, Error *error)
{
    uint32_t n = world->scene->n_media;
    world->reach = malloc(n);
    world->reach_through = malloc(n);
    if (!world->reach || !world->reach_through) return fail_memory(error, n, "lights");
    TRY(find_straight(world, error));
    find_through(world);
    return STATUS_OK;
}
