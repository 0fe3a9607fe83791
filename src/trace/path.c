/* path.c - the path integrator.
 *
 * A path goes from event to event: an opaque surface, a boundary between two media, or out of the scene.
 * Between events it may pass any number of silent crossings, which change the interior list and nothing else.
 *
 * Wavelengths: lane 0 is the hero; the path is sampled for it alone. `beta` is the throughput of each lane
 * over the hero's density, `ratio` the density with which the same path would have been sampled with that
 * lane as the hero, over the hero's. A contribution counts beta / mean(ratio): the balance heuristic over
 * the wavelengths ([WNDWH14] A. Wilkie et al., "Hero Wavelength Spectral Sampling", EGSR 2014, eq. 5).
 * Where glass disperses, a path from the camera bends all four by the indices of one of them: see sample.c.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <stdlib.h>

#include "trace/airlight.h"
#include "trace/backdrop.h"
#include "trace/catcher.h"
#include "trace/event.h"
#include "trace/probe.h"
#include "trace/shade.h"
#include "trace/sight.h"
#include "trace/slab_look.h"
#include "trace/slab_sky.h"
#include "trace/texture_shade.h"

/* Paths that carry less than this are left to Russian roulette. A picture is looked at by its relative error, and what
 * is seen through a drink is dark as a whole: ended earlier, its paths are its noise. Measured on the examples, by the
 * error after equal time (bench sampling): from 0.02 to 0.2 there is little difference; 1 is worse by up to a factor of 2. */
#define ROULETTE_BELOW 0.1f
/* What is reflected totally, again and again, carries on as it was; some of it leaves after ten thousand bounces, and some never.
 * Where a scene has no limit of its own, beyond so many bounces the n-th ends one path in n: of those that never leave half are
 * there after twice as many bounces, and those that leave late count by no more than how much later that is. Ended sooner, one in
 * twenty each time, their light would be in one pixel of very many: in even light a ball in a ball whose facets are a little off
 * the other's had lost 8 parts in 100,000, and 2 % in its darkest pixel, with that from 2,048 bounces on. */
enum { LONG_WAY = 256 };
/* In a medium without an end that takes no light a path would be scattered for ever, and nobody could stop it: where it was so
 * often, the n-th event ends three paths in n, so that one is half as long again on the mean. Milk takes some ten thousand. */
enum { NO_END = 1 << 15 };

void tracer_init(Tracer *tracer, const World *world)
{
    *tracer = (Tracer){.world = world};
    nest_list_init(&tracer->list);
    nest_list_init(&tracer->next);
    nest_list_init(&tracer->before);
    nest_list_init(&tracer->aside);
    nest_list_init(&tracer->forked);
    nest_list_init(&tracer->began);
    nest_list_init(&tracer->shadow_list);
}

void tracer_clear(Tracer *tracer)
{
    hit_list_clear(&tracer->hits);
    hit_list_clear(&tracer->shadow_hits);
    hit_list_clear(&tracer->beside);
    hit_list_clear(&tracer->along);
    hit_list_clear(&tracer->left);
    hit_list_clear(&tracer->looked);
    hit_list_clear(&tracer->aimed);
    hit_list_clear(&tracer->passed);
    nest_list_clear(&tracer->list);
    nest_list_clear(&tracer->next);
    nest_list_clear(&tracer->before);
    nest_list_clear(&tracer->aside);
    nest_list_clear(&tracer->forked);
    nest_list_clear(&tracer->began);
    nest_list_clear(&tracer->shadow_list);
    free(tracer->parts.items);
    tracer->parts = (FlightParts){0};
    free(tracer->passes);
    tracer->passes = NULL;
    tracers_free(tracer->looker, 1);
    tracers_free(tracer->barer, 1);
    tracer->looker = tracer->barer = NULL;
}

Tracer *tracers_new(const World *world, unsigned n)
{
    Tracer *tracers = memory_apart(n, sizeof *tracers);
    for (unsigned i = 0; tracers && i < n; i++) tracer_init(&tracers[i], world);
    return tracers;
}

void tracers_free(Tracer *tracers, unsigned n)
{
    for (unsigned i = 0; tracers && i < n; i++) tracer_clear(&tracers[i]);
    free(tracers);
}

Tracer *tracer_lend_into(Tracer *tracer, const World *world, Tracer **lent)
{
    if (UNLIKELY(!*lent)) *lent = tracers_new(world, 1);
    if (LIKELY(*lent))
        (*lent)->counters = tracer->counters;
    else
        tracer->out_of_memory = true;
    return *lent;
}

void tracer_take_back_from(Tracer *tracer, const Tracer *lent)
{
    tracer->counters = lent->counters;
    tracer->out_of_memory |= lent->out_of_memory;
}

/* Ends paths that carry little. The decision uses what is the same whichever lane is the hero. Directions that were chosen because a
 * bright light is there carry little, as they are chosen often: left to chance, one in a thousand would be a thousand times too bright. */
static bool survives(Path *path)
{
    if (lanes_zero(path->beta)) return false;
    float carried =
        path->sought * float_max(lanes_max(path->beta) * 0.25f, lanes_mean(path->beta)) / lanes_mean(path->ratio);
    bool long_way = path->n_counted > LONG_WAY && path->tracer->world->max_bounces == SCENE_BOUNCES_BY_CHANCE;
    /* a probe's numbers begin beyond that; it ends where it is scattered */
    bool no_end = path->bounce > NO_END + path->n_counted && !path->probing.is_probe;
    float below = path->tracer->world->trial.roulette_below;
    if (LIKELY(below == 0)) below = ROULETTE_BELOW;
    if (LIKELY(carried >= below && !long_way && !no_end)) return true;
    carried = float_min(carried * (1 / below), 1) * (long_way ? 1 - 1 / (float)path->n_counted : 1) *
              (no_end ? 1 - 3 / (float)path->bounce : 1);
    if (sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_ROULETTE)) >= carried) return false;
    path->beta = lanes_scale(path->beta, 1 / carried);
    return true;
}

/* What an event is at: an object, or those of its parts that have one surface; what scatters in front of all objects is one more,
 * and what does behind boundaries alone more than that, by its medium: wax in a clear oil is seen apart from the oil, though the glass
 * around both is met first. */
static uint32_t scattered_by(const World *world, uint32_t medium, bool first)
{
    return world->scene->n_objects + (first ? 0 : 1 + medium);
}

static uint32_t seen_first(const World *world, const Event *event, bool first)
{
    if (event->kind == EVENT_SCATTER) return scattered_by(world, event->medium, first);
    if (event->kind != EVENT_OPAQUE && event->kind != EVENT_BOUNDARY) return SCENE_NONE;
    const ObjectLook *look = &world->looks[event->hit.object];
    return look->light != SCENE_NONE ? SCENE_NONE : look->thing;
}

/* Whether a surface right behind the first one is a part of the same object with another surface: letters engraved in the back of a
 * sheet are seen apart from its face, else what shines in them would be shared out over the face. */
static bool is_other_part(const World *world, uint32_t seen, const Event *event)
{
    if ((event->kind != EVENT_OPAQUE && event->kind != EVENT_BOUNDARY) || seen >= world->scene->n_objects) return false;
    const ObjectLook *here = &world->looks[event->hit.object], *first = &world->looks[seen];
    return here->whole == first->whole && here->thing != first->thing && here->light == SCENE_NONE;
}

/* What else the path comes to behind the clear faces of what is seen first: by its medium, so that the bubbles in a block of
 * glass are one thing apart from the block, else the glints of those that few paths find would be shared out over all of it.
 * SCENE_NONE: nothing else. */
static uint32_t seen_within(const World *world, uint32_t seen, const Event *event)
{
    const Scene *scene = world->scene;
    if (event->kind != EVENT_BOUNDARY || seen >= scene->n_objects) return SCENE_NONE;
    uint32_t medium = scene->objects[event->hit.object].medium;
    if (medium == SCENE_NONE || world->looks[event->hit.object].whole == world->looks[seen].whole) return SCENE_NONE;
    return scattered_by(world, scene->n_media + medium, false);
}

/* What a path shows behind this event, of which it showed that before, and to which it came through nothing but boundaries. */
static uint32_t seen_behind(const World *world, uint32_t seen, const Event *event, bool first, bool second)
{
    bool part = UNLIKELY(world->has_parts) && second && is_other_part(world, seen, event);
    if (first || event->kind == EVENT_SCATTER || part) return seen_first(world, event, first);
    uint32_t within = seen_within(world, seen, event);
    return within == SCENE_NONE ? seen : within;
}

/* Light that was looked for, and found, on the way to what is met first, was scattered there; so what the path met is not what such a
 * sample shows. */
static void next_event_noting(Path *path, Event *event, bool first)
{
    const World *world = path->tracer->world;
    Lanes before = path->radiance;
    path_next_event(path, event);
    float found = lanes_mean(lanes_sub(path->radiance, before));
    if (!(found > path->in_front)) return;
    path->in_front = found;
    path->scatters_in_front = scattered_by(world, event->medium, first);
}

/* What an event does to a path that does not end there for good. Returns whether it goes on. */
static inline bool pass_event(Path *path, Event *event)
{
    path->n_counted += event->kind != EVENT_SCATTER;
    if (event->kind == EVENT_SCATTER)
        path_scatter_in_medium(path, event);
    else if (!(event->kind == EVENT_BOUNDARY ? path_cross_boundary(path, event) : path_shade_opaque(path, event)))
        return false;
    path->bounce++;
    if (path->tracer->world->scene->n_textures > 0) path_widen(path);
    path_keep_in_range(path);
    return survives(path);
}

static Reflected reflected_of(const Path *path, Lanes before, Lanes after)
{
    Reflected reflected = {.mean = lanes_mean(after) / lanes_mean(before)};
    Lanes each = lanes_div(after, lanes_greater(before, lanes_all(FLT_MIN)));
    color_from_lanes(lanes_mul(each, white_at(path->wavelengths.nm)), &path->wavelengths, reflected.rgb);
    return reflected;
}

/* Whoever shares out single bright samples wants to know where a texture is dark, and of which colour it is. */
static bool pass_noting(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    Lanes before = path_carried(path);
    bool goes_on = pass_event(path, event);
    if (tracer->world->looks[event->hit.object].light == SCENE_NONE && lanes_mean(before) > 0)
        tracer->reflected = goes_on ? reflected_of(path, before, path_carried(path)) : (Reflected){0};
    return goes_on;
}

/* Of light from infinity what is of each group: as it has its part in the radiance there. */
static void add_to_groups(Path *path, const LightRival *rival, bool sight, Lanes radiance, Lanes more)
{
    const World *world = path->tracer->world;
    Lanes all = lanes_greater(radiance, lanes_all(FLT_MIN)), nm = path->wavelengths.nm;
    for (uint32_t i = 0; i < world->scene->light_groups.n; i++) {
        Lanes of_group = light_from_infinity(world, rival, path->ray.direction, sight, i, nm);
        path_add_to_group(path, lanes_mul(more, lanes_div(of_group, all)), i);
    }
}

/* The path leaves the scene. */
static void find_infinity(Path *path)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const Scene *scene = world->scene;
    bool sight = path->ray.sight;
    if (path_is_in_slabs(path)) slab_leave_scene(path);
    if (sight && (!scene->environment || scene->environment_hidden))
        path->open = lanes_mean(path->beta) / lanes_mean(path->ratio);
    const LightRival rival = {path->scatter_lights, path->scatter_point, path->scatter_normal,
                              path->scatter_pdf / (1 + airlight_rival_far(path))};
    Lanes radiance =
        light_from_infinity(world, &rival, path->ray.direction, sight, LIGHT_GROUPS_ALL, path->wavelengths.nm);
    Lanes more = path_add_radiance(path, lanes_all(path_found_part(path, lanes_mean(radiance))),
                                   path_basic_radiance(world, radiance, WORLD_MEDIUM, path->wavelengths.nm));
    if (UNLIKELY(tracer->grouped)) add_to_groups(path, &rival, sight, radiance, more);
    /* out here the ray is in nothing that is bounded, or a surface was lost */
    if (world->compiled->order.policy != NEST_NONE)
        tracer->counters.nesting_faults += compiled_bounded_in(world->compiled, &tracer->list);
}

/* Surfaces alone count for that: where a medium scatters the path, what is behind. */
static void note_sight(const Path *path, const Event *event)
{
    if (event->kind == EVENT_SCATTER)
        sight_look(path, event->t);
    else
        sight_note(path, event, &path->tracer->first_sight);
}

static void follow(Path *path, bool first)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const bool textured = world->scene->n_textures > 0;
    bool clear = first, second = false; /* nothing but boundaries so far; what comes now stands behind one */
    const bool notes_sight = UNLIKELY(tracer->notes_sight) && first;
    const bool looks_ahead = notes_sight && tracer->notes_behind;
    if (UNLIKELY(looks_ahead)) sight_look(path, 0);
    for (;; second = first, first = false) {
        Event event;
        if (UNLIKELY(clear && path->looks))
            next_event_noting(path, &event, first);
        else
            path_next_event(path, &event);
        if (textured) path_reach(path, &event);
        if (clear) tracer->seen = seen_behind(world, tracer->seen, &event, first, second);
        bool notes = textured && clear && event.kind == EVENT_OPAQUE;
        clear = clear && event.kind == EVENT_BOUNDARY;
        if (UNLIKELY(notes_sight && !looks_ahead) && first) note_sight(path, &event);
        if (event.kind == EVENT_LOST) tracer->out_of_memory = true;
        if (event.kind == EVENT_LOST || event.kind == EVENT_GIVE_UP) return;
        if (event.kind == EVENT_ESCAPE) {
            find_infinity(path);
            return;
        }
        if (path->n_counted >= world->max_bounces && event.kind != EVENT_SCATTER) {
            if (event.kind == EVENT_OPAQUE) path_add_emission(path, &event.hit); /* the last surface may still shine */
            return;
        }
        if (event.kind == EVENT_SCATTER && path->probing.is_probe) return;
        if (UNLIKELY(path->catching && event.kind == EVENT_OPAQUE) && path->ray.sight) catcher_meet(path, &event);
        if (UNLIKELY(notes) ? !pass_noting(path, &event) : !pass_event(path, &event)) return;
    }
}

void path_follow(Path *path)
{
    follow(path, false);
}

void path_follow_from_camera(Path *path)
{
    follow(path, true);
    if (UNLIKELY(path->tracer->backdrop)) backdrop_end(path->tracer->backdrop, path);
    if (UNLIKELY(path_shows_front(path))) path->tracer->seen = path->scatters_in_front;
}

void path_follow_from_event(Path *path, Event *event)
{
    if (pass_event(path, event)) follow(path, false);
}
