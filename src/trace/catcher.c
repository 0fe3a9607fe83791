/* catcher.c - the world of lights and shadow catchers alone, and the paths in it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/catcher.h"

#include <stdlib.h>

#include "trace/event.h"

Status catcher_world_new(const World *world, unsigned n_threads, World **out, Error *error)
{
    CompiledScene *compiled;
    *out = NULL;
    TRY(compiled_bare_new(world->compiled, n_threads, &compiled, error));
    if (!compiled) return STATUS_OK;
    World *bare = malloc(sizeof *bare);
    if (!bare) {
        compiled_bare_free(compiled);
        return fail_memory(error, sizeof *bare, "shadow catchers");
    }
    *bare = *world;
    bare->compiled = bare->own_compiled = compiled;
    bare->bare = NULL;
    bare->guide = NULL;
    bare->slabs = (Slabs){0};
    bare->beacons.any = false;
    bare->has_panes = bare->has_paint = false;
    *out = bare;
    return STATUS_OK;
}

void catcher_world_free(World *bare)
{
    if (bare) compiled_bare_free(bare->own_compiled);
    free(bare);
}

bool catcher_world_has(const World *bare, const LightSample *light)
{
    return light->emitter == EMITTER_NONE || bare->emitters.emitters[light->emitter].kind == EMITTER_LIGHT;
}

/* The list where a ray starts: it is in no hull, but for operands of combinations that catch. */
static bool start_list(Tracer *bare, const Ray *ray)
{
    const CompiledScene *compiled = bare->world->compiled;
    nest_list_empty(&bare->list);
    return !compiled->csg.n_trees || compiled_interior(compiled, vec3f_from(ray->origin), ray->time, &bare->shadow_hits,
                                                       &bare->list, NULL) == STATUS_OK;
}

/* Follows the path from the catcher that it has come to, in the bare world. What fills the way to there has been passed
 * in the other one; so the catcher is looked for along a straight line, by the same ray. False where it is not found, by
 * a rounding. */
static bool follow_bare(const Path *path, Tracer *bare, const Event *met, Lanes *radiance)
{
    Path other = *path;
    Event event;
    other.tracer = bare;
    other.fork = NULL;
    other.probing.guide.share = 0;
    other.ray.t_min = 0; /* what it has passed on its way, and what it starts at, may not be there */
    other.ray.left = NULL;
    other.ray.n_left = 0;
    other.ray.least_slope = INFINITY;
    other.ray.at_edge = false;
    if (!start_list(bare, &other.ray)) {
        bare->out_of_memory = true;
        return false;
    }
    Path look = other;
    look.straight = true;
    look.looks = false;
    path_next_event(&look, &event);
    if (event.kind != EVENT_OPAQUE || event.hit.object != met->hit.object) return false;
    other.ray = look.ray;
    path_follow_from_event(&other, &event);
    *radiance = other.radiance;
    return true;
}

void catcher_meet(Path *path, const Event *event)
{
    Tracer *tracer = path->tracer;
    if (!tracer->world->looks[event->hit.object].catches) return;
    Catching *catching = path->catching;
    Tracer *bare = tracer_lend_into(tracer, tracer->world->bare, &tracer->barer);
    path->catching = NULL;
    if (UNLIKELY(!bare)) return;
    catching->part = lanes_mean(path->beta) / lanes_mean(path->ratio);
    catching->front = path->radiance;
    path->radiance = lanes_all(0);
    catching->alike = !follow_bare(path, bare, event, &catching->bare);
    tracer_take_back_from(tracer, bare);
}
