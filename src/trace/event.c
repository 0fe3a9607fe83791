/* event.c - from one event of a path to the next: surfaces crossed in silence, media flown through, and the same for
 * straight rays to lights.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/event.h"

#include "base/array.h"
#include "nest/csg.h"
#include "scene/ties.h"
#include "trace/airlight.h"
#include "trace/shade_bsdf.h"

/* A straight line that crosses more surfaces than this without any event is given up, and counted. */
enum { SILENT_LIMIT = 100000 };

/* path_cross for several surfaces. */
ATTR_APART static bool cross_several(Tracer *tracer, NestList *list, const Hit *hits, size_t n, NestCrossing *crossing)
{
    const CompiledScene *compiled = tracer->world->compiled;
    if (UNLIKELY(!array_reserve(&tracer->passes, &tracer->passes_capacity, n, sizeof *tracer->passes))) return false;
    uint32_t n_passes = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t hull = compiled->hull_of_object[hits[i].object];
        if (hull == SCENE_NONE) continue;
        tracer->passes[n_passes++] = (NestPass){hull, hits[i].entering};
    }
    *crossing = (NestCrossing){0};
    return !n_passes || nest_cross(list, &compiled->order, tracer->passes, n_passes, crossing) == STATUS_OK;
}

bool path_cross(Tracer *tracer, NestList *list, const Hit *hits, size_t n, NestCrossing *crossing)
{
    const CompiledScene *compiled = tracer->world->compiled;
    if (UNLIKELY(n != 1)) return cross_several(tracer, list, hits, n, crossing);
    uint32_t hull = compiled->hull_of_object[hits->object];
    if (LIKELY(hull != SCENE_NONE))
        return nest_cross_one(list, &compiled->order, (NestPass){hull, hits->entering}, crossing) == STATUS_OK;
    *crossing = (NestCrossing){0};
    return true;
}

static bool cross_into_next(Tracer *tracer, const Event *event, NestCrossing *crossing)
{
    bool good = nest_list_copy(&tracer->next, &tracer->list) == STATUS_OK &&
                path_cross(tracer, &tracer->next, tracer->hits.items, event->n_cluster, crossing);
    if (UNLIKELY(!good)) tracer->out_of_memory = true;
    return good;
}

bool path_cross_into_next(Tracer *tracer, const Event *event)
{
    NestCrossing crossing;
    return cross_into_next(tracer, event, &crossing);
}

/* Whether a boundary between these media can be seen: their indices differ at some wavelength carried, or one has two. */
static bool media_differ(Path *path, uint32_t a, uint32_t b)
{
    return a != b &&
           (!lanes_equal(path_ior(path, a), path_ior(path, b)) || world_refracts_doubly(path->tracer->world, a, b));
}

bool path_passes_into_boundary(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    NestCrossing crossing;
    if (LIKELY(event->n_cluster == 1) || !cross_into_next(tracer, event, &crossing) || crossing.opaque ||
        !media_differ(path, crossing.medium_from, crossing.medium_to))
        return false;
    event->kind = EVENT_BOUNDARY;
    event->behind = BEHIND_IN_NEXT;
    event->crossing = crossing;
    event->hit = *path_boundary_hit(tracer, &tracer->list, tracer->hits.items, event->n_cluster, &crossing);
    return true;
}

/* The level of the hull whose boundary a surface is; 0: none that owns a point. */
static uint32_t level_of(const CompiledScene *compiled, const Hit *hit)
{
    const NestOrder *order = &compiled->order;
    uint32_t hull = compiled->hull_of_object[hit->object];
    if (hull != SCENE_NONE && hull >= order->n_hulls) hull = order->csg->trees[nest_csg_tree(order->csg, hull)].hull;
    return hull < order->n_hulls ? order->top[hull].level : 0;
}

/* Of the owners on both sides of a boundary the one that would be on top if they overlapped there by a little. */
static uint32_t upper_owner(const CompiledScene *compiled, uint32_t from, uint32_t to)
{
    const NestOrder *order = &compiled->order;
    if (from >= order->n_hulls || to >= order->n_hulls) return from < order->n_hulls ? from : to;
    if (order->policy != NEST_AUTOMATIC) return order->top[from].level > order->top[to].level ? from : to;
    const bool forward = from < to;
    const NestOverlap overlap = {forward ? from : to, forward ? to : from, NEST_PARTIAL};
    return nest_decide(compiled->hulls, &overlap).top;
}

static bool is_operand_of(const CompiledScene *compiled, uint32_t hull, uint32_t tree)
{
    return hull != SCENE_NONE && hull >= compiled->order.n_hulls && nest_csg_tree(&compiled->csg, hull) == tree;
}

/* Whether the operand of a hit alone makes the difference between inside and outside of its combination, at what is in a list; that
 * stays as it is. */
static bool decides(const NestCsg *csg, uint32_t tree, NestList *list, NestPass pass)
{
    const bool held = nest_csg_holds(csg, tree, list);
    if (!nest_csg_pass(csg, list, pass.hull, pass.entering)) return false;
    const bool decided = nest_csg_holds(csg, tree, list) != held;
    nest_csg_pass(csg, list, pass.hull, !pass.entering);
    return decided;
}

/* Of operands that decide at that list, in front of all hits or behind them, and of `best`, the one declared last. */
static const Hit *last_deciding(const CompiledScene *compiled, NestList *list, const Hit *hits, size_t n, uint32_t tree,
                                bool behind, const Hit *best)
{
    for (size_t i = 0; i < n; i++) {
        const NestPass pass = {compiled->hull_of_object[hits[i].object], hits[i].entering != behind};
        if (!is_operand_of(compiled, pass.hull, tree) || !decides(&compiled->csg, tree, list, pass)) continue;
        if (!best || hits[i].object > best->object) best = &hits[i];
    }
    return best;
}

/* Of operands the one declared last that decides, in front of all of their surfaces or behind them: so it is the same from either side,
 * and does not hang on rounding; else, where only several together do, the last in turn. NULL: the combination neither begins nor ends.
 * list: that in front, which becomes that behind these operands. */
static const Hit *hit_of_operand(const CompiledScene *compiled, NestList *list, const Hit *hits, size_t n,
                                 uint32_t tree)
{
    const NestCsg *csg = &compiled->csg;
    const Hit *last = NULL;
    if (nest_list_reserve(list, (uint32_t)n) != STATUS_OK) return NULL;
    const bool held = nest_csg_holds(csg, tree, list);
    const Hit *best = last_deciding(compiled, list, hits, n, tree, false, NULL);
    bool inside = held;
    for (size_t i = 0; i < n; i++) {
        const uint32_t operand = compiled->hull_of_object[hits[i].object];
        if (!is_operand_of(compiled, operand, tree)) continue;
        nest_csg_pass(csg, list, operand, hits[i].entering);
        const bool inside_now = nest_csg_holds(csg, tree, list);
        if (inside_now != inside) last = &hits[i];
        inside = inside_now;
    }
    best = last_deciding(compiled, list, hits, n, tree, true, best);
    if (inside == held) return NULL;
    return best ? best : last;
}

/* The hit by which what is of that level begins or ends; NULL: there is none. Of hulls that share it that of the one declared first. */
static const Hit *hit_of_level(Tracer *tracer, const NestList *before, const Hit *hits, size_t n, uint32_t level)
{
    const CompiledScene *compiled = tracer->world->compiled;
    const Hit *best = NULL;
    for (size_t i = 0; i < n; i++) {
        const uint32_t hull = compiled->hull_of_object[hits[i].object];
        if (level_of(compiled, &hits[i]) != level) continue;
        if (hull >= compiled->order.n_hulls) {
            if (nest_list_copy(&tracer->shadow_list, before) != STATUS_OK) return NULL;
            return hit_of_operand(compiled, &tracer->shadow_list, hits, n, nest_csg_tree(&compiled->csg, hull));
        }
        if (!best || hits[i].object < best->object) best = &hits[i];
    }
    return best;
}

/* The operand's hit by which an opaque combination begins; of several combinations that of the operand declared last. NULL: none
 * begins. list: as hit_of_operand has it. */
static const Hit *hit_of_opaque(const CompiledScene *compiled, NestList *list, const Hit *hits, size_t n)
{
    const NestCsg *csg = &compiled->csg;
    const Hit *best = NULL;
    for (size_t i = 0; i < n; i++) {
        const uint32_t operand = compiled->hull_of_object[hits[i].object];
        if (operand == SCENE_NONE || operand < compiled->order.n_hulls) continue;
        const uint32_t tree = nest_csg_tree(csg, operand);
        bool again = csg->trees[tree].hull != NEST_OPAQUE;
        for (size_t k = 0; k < i && !again; k++)
            again = is_operand_of(compiled, compiled->hull_of_object[hits[k].object], tree);
        if (again) continue;
        const Hit *hit = hit_of_operand(compiled, list, hits, n, tree);
        if (hit && (!best || hit->object > best->object)) best = hit;
    }
    return best;
}

/* Crossing the hits of several at one place one after another, the one at which the medium last becomes what it is behind them all. */
static const Hit *last_hit(Tracer *tracer, const NestList *before, const Hit *hits, size_t n,
                           const NestCrossing *crossing)
{
    const CompiledScene *compiled = tracer->world->compiled;
    const Hit *best = &hits[0];
    if (nest_list_copy(&tracer->shadow_list, before) != STATUS_OK) return best;
    for (size_t i = 0; i < n; i++) {
        NestPass pass = {compiled->hull_of_object[hits[i].object], hits[i].entering};
        NestCrossing step;
        if (pass.hull == SCENE_NONE) continue; /* a sheet */
        if (nest_cross_one(&tracer->shadow_list, &compiled->order, pass, &step) != STATUS_OK) return best;
        if (step.medium_from != step.medium_to && step.medium_to == crossing->medium_to) best = &hits[i];
    }
    return best;
}

/* Which hull's surface is there, with its film or its roughness, is the same from either side: that of the upper one of the owners. Where
 * that goes on below the other one it is the other's. */
static const Hit *boundary_hit_of_several(Tracer *tracer, const NestList *before, const Hit *hits, size_t n,
                                          const NestCrossing *crossing)
{
    const CompiledScene *compiled = tracer->world->compiled;
    const NestOrder *order = &compiled->order;
    const uint32_t from = crossing->owner_from, to = crossing->owner_to;
    if (crossing->opaque) {
        const bool copied = nest_list_copy(&tracer->shadow_list, before) == STATUS_OK;
        const Hit *hit = copied ? hit_of_opaque(compiled, &tracer->shadow_list, hits, n) : NULL;
        return hit ? hit : hits;
    }
    if (order->policy == NEST_NONE) return last_hit(tracer, before, hits, n, crossing);
    const uint32_t upper = upper_owner(compiled, from, to), owners[2] = {upper, upper == from ? to : from};
    for (int i = 0; i < 2; i++) {
        if (owners[i] >= order->n_hulls) continue;
        const Hit *hit = hit_of_level(tracer, before, hits, n, order->top[owners[i]].level);
        if (hit) return hit;
    }
    return last_hit(tracer, before, hits, n, crossing);
}

const Hit *path_boundary_hit(Tracer *tracer, const NestList *before, const Hit *hits, size_t n,
                             const NestCrossing *crossing)
{
    return LIKELY(n == 1) ? hits : boundary_hit_of_several(tracer, before, hits, n, crossing);
}

/* Of several the upper owner's, as of boundary_hit_of_several. */
ATTR_APART const Hit *path_painted_hit(const World *world, const Hit *hits, size_t n, uint32_t from, uint32_t to)
{
    const CompiledScene *compiled = world->compiled;
    const NestOrder *order = &compiled->order;
    const bool any = order->policy == NEST_NONE;
    if (from == to && !any) return NULL;
    const uint32_t upper =
        any || n == 1 ? 0 : order->top[upper_owner(compiled, order->hull_at[from], order->hull_at[to])].level;
    const Hit *other = NULL;
    for (size_t i = 0; i < n; i++) {
        if (!scene_is_painted(world->scene, hits[i].object)) continue;
        const uint32_t level = level_of(compiled, &hits[i]);
        if (level && (level == upper || any)) return &hits[i];
        if (level && (level == from || level == to) && !other) other = &hits[i];
    }
    return other;
}

/* Crosses several surfaces at one place into tracer->next; if any is opaque, the one of these that is met is to be shaded. before: the
 * list in front of them. */
static bool cross_cluster(Tracer *tracer, const NestList *before, Event *event)
{
    const Hit *hits = tracer->hits.items;
    const Hit *met = ties_met(tracer->world->compiled, hits, event->n_cluster);
    event->kind = met ? EVENT_OPAQUE : EVENT_BOUNDARY;
    if (met) {
        event->hit = *met;
        return true;
    }
    if (nest_list_copy(&tracer->next, before) != STATUS_OK ||
        !path_cross(tracer, &tracer->next, hits, event->n_cluster, &event->crossing))
        return false;
    event->clear = event->clear && !event->crossing.n_faults;
    return true;
}

/* From where on the list behind the surfaces at one place holds. Several are crossed together, and in between no list does: a ray
 * that grazes a bubble is inside of it there. */
static inline double end_of_place(const Hit *hits, size_t n)
{
    return LIKELY(n == 1) ? hits->t : hits[n - 1].t + hits[n - 1].rounding;
}

/* Crosses what the ray has passed up to *end, place by place; where *end is in the midst of a place, it becomes the end of
 * that. *clear: all of it was silent, and agrees with the list. */
static bool cross_passed(Tracer *tracer, NestList *list, double *end, bool *clear)
{
    const Hit *hits = tracer->passed.items;
    size_t n = tracer->passed.n, cluster;
    for (size_t i = 0; i < n && hits[i].t < *end; i += cluster) {
        NestCrossing crossing;
        cluster = rtc_cluster(hits + i, n - i);
        if (!path_cross(tracer, list, hits + i, cluster, &crossing)) return false;
        *end = double_max(*end, end_of_place(hits + i, cluster));
        *clear = *clear && !crossing.n_faults && crossing.medium_from == crossing.medium_to;
    }
    return true;
}

static bool cross_all_passed(Tracer *tracer, NestList *list, bool *clear)
{
    double end = HUGE_VAL;
    return cross_passed(tracer, list, &end, clear);
}

/* The same up to the event's surfaces, where lists keep hulls as bits, into event->before. */
static inline bool pass_by(Tracer *tracer, Event *event)
{
    const CompiledScene *compiled = tracer->world->compiled;
    const Hit *hits = tracer->passed.items;
    size_t n = tracer->passed.n;
    event->before = tracer->list.point;
    for (size_t i = 0; i < n; i++) {
        if (UNLIKELY(rtc_cluster(hits + i, n - i) > 1)) {
            tracer->before.point = tracer->list.point;
            bool good = cross_all_passed(tracer, &tracer->before, &event->clear);
            event->before = tracer->before.point;
            return good;
        }
        NestPass pass = {compiled->hull_of_object[hits[i].object], hits[i].entering}; /* what is passed is of hulls */
        event->clear = event->clear && nest_toggle(&event->before, &compiled->order, pass) &&
                       event->before.top.medium == event->medium;
    }
    return true;
}

bool path_turn_aside(Tracer *tracer, double *t)
{
    bool clear = true;
    if (!tracer->passed.n) return true;
    if (nest_list_copy(&tracer->aside, &tracer->list) != STATUS_OK || !cross_passed(tracer, &tracer->aside, t, &clear))
        return false;
    path_turn_back(tracer);
    return true;
}

void path_turn_back(Tracer *tracer)
{
    if (tracer->passed.n) nest_list_swap(&tracer->list, &tracer->aside);
}

/* Crosses the one surface that was found where lists are rows. */
static bool cross_in_row(Tracer *tracer, const NestList *before, NestPass pass, Event *event)
{
    const NestOrder *order = &tracer->world->compiled->order;
    if (!nest_may_look(before, order))
        return nest_list_copy(&tracer->next, before) == STATUS_OK &&
               nest_cross_one(&tracer->next, order, pass, &event->crossing) == STATUS_OK;
    event->behind = BEHIND_BY_STEP;
    nest_look(before, order, pass, &event->step);
    event->crossing.medium_to = event->step.point.top.medium;
    event->crossing.n_faults = event->step.n == before->n;
    return true;
}

/* Whether a ray may go away for ever in front of which there are these hulls: they must be without end. */
static inline bool may_escape(const CompiledScene *compiled, const NestList *list, const NestPoint *point)
{
    if (LIKELY(point->mask == 1 && !list->n)) return true;
    NestList there = *list;
    there.point = *point;
    return compiled->order.policy == NEST_NONE || !compiled_bounded_in(compiled, &there);
}

/* Finds the next surfaces along the path's ray and crosses them into event->behind; the list in front of them is tracer->before, or
 * event->before, where anything was passed on the way. False when memory ends. */
static inline bool read_nearest(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    const CompiledScene *compiled = tracer->world->compiled;
    const NestList *before = &tracer->list;
    const NestPoint *point = &tracer->list.point;
    bool narrow = compiled->order.narrow;
    event->n_cluster = rtc_nearest(compiled->rtc, &path->ray, &tracer->hits, &tracer->passed);
    event->medium = nest_medium(before);
    event->clear = !tracer->hits.beside;
    event->behind = BEHIND_IN_NEXT;
    tracer->counters.rays++;
    if (tracer->hits.out_of_memory || tracer->passed.out_of_memory) return false;
    if (tracer->passed.n) {
        before = &tracer->before;
        point = &event->before;
        if (narrow ? !pass_by(tracer, event)
                   : nest_list_copy(&tracer->before, &tracer->list) != STATUS_OK ||
                         !cross_all_passed(tracer, &tracer->before, &event->clear))
            return false;
        if (!event->clear) return true; /* to be read again, one by one */
    }
    if (event->n_cluster == 0) {
        event->kind = EVENT_ESCAPE;
        event->clear = event->clear && may_escape(compiled, before, narrow ? point : &before->point);
        return true;
    }
    const Hit *hit = tracer->hits.items;
    PREFETCH(&tracer->world->looks[hit->object]); /* for shading */
    if (UNLIKELY(event->n_cluster > 1)) {
        if (narrow && tracer->passed.n) tracer->before.point = event->before;
        return cross_cluster(tracer, before, event);
    }
    uint32_t hull = compiled->hull_of_object[hit->object];
    if (hull == SCENE_NONE) {
        event->kind = EVENT_OPAQUE;
        event->hit = *hit;
        return true;
    }
    event->kind = EVENT_BOUNDARY;
    NestPass pass = {hull, hit->entering};
    event->crossing.medium_from = event->medium;
    event->crossing.n_faults = 0;
    event->crossing.opaque = false;
    if (UNLIKELY(!narrow)) {
        if (!cross_in_row(tracer, before, pass, event)) return false;
        event->clear = event->clear && !event->crossing.n_faults;
        return true;
    }
    event->behind = BEHIND_AT_POINT;
    event->step.point = *point;
    if (UNLIKELY(!nest_toggle(&event->step.point, &compiled->order, pass))) {
        event->crossing.n_faults = 1;
        event->clear = false;
    }
    event->crossing.medium_to = event->step.point.top.medium;
    return true;
}

/* Where a ray starts within rounding of the edges of an object that it does not start on, the exact ray may come just there
 * into a sliver of it that Embree's float ray did not come to before, or out of it: then the ray is in that object from its
 * start on, or no longer in it. Returns whether the list has changed. */
ATTR_COLD static bool mend_list(Tracer *tracer, const Ray *ray, NestList *list)
{
    const CompiledScene *compiled = tracer->world->compiled;
    bool mended = false;
    if (ray->t_min > 0 || compiled->order.policy == NEST_NONE) return false;
    size_t n = rtc_beside(compiled->rtc, ray, &tracer->beside, &tracer->along);
    for (size_t i = 0; i < n; i++) {
        Hit *sliver = &tracer->beside.items[i];
        uint32_t hull = compiled->hull_of_object[sliver->object];
        if (hull == SCENE_NONE || nest_has(&compiled->order, list, hull) == sliver->inside) continue;
        NestCrossing crossing;
        sliver->entering = sliver->inside;
        mended |= path_cross(tracer, list, sliver, 1, &crossing);
    }
    return mended;
}

/* Whether a hit contradicts the list in front of it. */
static bool is_wrong(const Tracer *tracer, const NestList *list, const Hit *hit)
{
    const CompiledScene *compiled = tracer->world->compiled;
    uint32_t hull = compiled->hull_of_object[hit->object];
    return hull != SCENE_NONE && nest_has(&compiled->order, list, hull) == hit->entering;
}

/* Asks for a surface of an object in front of `end` that the list says must be there; such a one becomes the only one of
 * `missed`. */
static bool find_missed(const Tracer *tracer, const Ray *ray, const NestList *list, uint32_t object, double end,
                        HitList *missed)
{
    const CompiledScene *compiled = tracer->world->compiled;
    bool inside = nest_has(&compiled->order, list, compiled->hull_of_object[object]);
    return rtc_find_missed(compiled->rtc, ray, object, !inside, end, missed);
}

/* Where what was found contradicts the list although the ray starts well, Embree has missed a surface on the way: an object is
 * left that was not entered, or not left at all. Whether there is one. */
ATTR_COLD static bool find_all_missed(Path *path, size_t n_hits)
{
    Tracer *tracer = path->tracer;
    const CompiledScene *compiled = tracer->world->compiled;
    HitList *hits = &tracer->hits;
    double end = n_hits ? hits->items[0].t : HUGE_VAL;
    bool found = false;
    for (size_t i = 0; i < n_hits; i++) {
        Hit hit = hits->items[i]; /* what is found takes the place of the first, which has been asked about then */
        if (!is_wrong(tracer, &tracer->list, &hit) ||
            !find_missed(tracer, &path->ray, &tracer->list, hit.object, end, hits))
            continue;
        end = hits->items[0].t;
        found = true;
    }
    uint32_t n_hulls = n_hits ? 0 : compiled->n_hulls;
    for (uint32_t hull = 0; hull < n_hulls; hull++) {
        uint32_t object = compiled->object_of_hull[hull];
        if (object == SCENE_NONE || !nest_has(&compiled->order, &tracer->list, hull)) continue;
        if (!find_missed(tracer, &path->ray, &tracer->list, object, end, hits)) continue;
        end = hits->items[0].t;
        found = true;
    }
    return found;
}

/* What was found contradicts the list: place by place, then. */
ATTR_COLD static bool read_again(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    path->ray.pass_level = 0;
    path->ray.pass_alike = RTC_NO_PASS;
    if ((mend_list(tracer, &path->ray, &tracer->list) || tracer->passed.n) && !read_nearest(path, event)) return false;
    bool contradicts =
        event->kind == EVENT_BOUNDARY ? event->crossing.n_faults > 0 : event->kind == EVENT_ESCAPE && !event->clear;
    if (!contradicts || !find_all_missed(path, event->n_cluster)) return true;
    event->n_cluster = 1;
    event->behind = BEHIND_IN_NEXT;
    event->clear = true;
    return cross_cluster(tracer, &tracer->list, event);
}

static inline bool cross_nearest(Path *path, Event *event)
{
    PathCounters *counters = &path->tracer->counters;
    compiled_let_pass(path->tracer->world->compiled, &path->tracer->list, &path->ray);
    if (!read_nearest(path, event)) return false;
    if (UNLIKELY(!event->clear) && !read_again(path, event)) return false;
    counters->crossings += path->tracer->passed.n;
    counters->silent_crossings += path->tracer->passed.n;
    if (event->kind != EVENT_BOUNDARY) return true;
    counters->crossings += event->n_cluster;
    counters->nesting_faults += event->crossing.n_faults;
    return true;
}

/* The path is scattered at t, and does not come to what was counted behind. */
static void discount(Tracer *tracer, const Event *event, double t)
{
    PathCounters *counters = &tracer->counters;
    const Hit *passed = tracer->passed.items;
    size_t n_behind = 0;
    while (n_behind < tracer->passed.n && passed[tracer->passed.n - 1 - n_behind].t >= t) n_behind++;
    counters->crossings -= n_behind;
    counters->silent_crossings -= n_behind;
    if (event->kind != EVENT_BOUNDARY) return;
    counters->crossings -= event->n_cluster;
    counters->nesting_faults -= event->crossing.n_faults;
}

/* tracer->list becomes the one in front of the event's surfaces. */
static inline void take_before(Tracer *tracer, const Event *event)
{
    if (LIKELY(tracer->world->compiled->order.narrow))
        tracer->list.point = event->before;
    else
        nest_list_swap(&tracer->list, &tracer->before);
}

void path_next_event(Path *path, Event *event)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    double t_done = 0; /* the ray's start, not t_min: lengths are measured from the origin */
    bool uneven = false;
    FreeFlight flight;
    flight_begin(path, &flight);
    for (uint32_t silent = 0;; silent++) {
        if (!cross_nearest(path, event)) {
            event->kind = EVENT_LOST;
            return;
        }
        const Hit *hits = tracer->hits.items;
        size_t n = event->n_cluster;
        uint32_t medium = event->medium;
        double t = n ? hits[0].t : HUGE_VAL, length = double_max(t - t_done, 0);
        uneven = flight_is_uneven(world, &tracer->list, medium);
        if (UNLIKELY(path->looks))
            airlight_look(path, &(FlightStretch){&flight, medium, uneven, silent}, t_done, length);
        double flown = LIKELY(!uneven) ? flight_even(path, &flight, medium, length)
                                       : flight_uneven(path, &flight, t_done, length, &medium);
        if (flown < length) {
            discount(tracer, event, t_done + flown);
            *event = (Event){.kind = EVENT_SCATTER, .t = t_done + flown, .medium = medium};
            airlight_note(path, &flight, uneven, event->t);
            bool clear = true;
            if (!cross_passed(tracer, &tracer->list, &event->t, &clear)) event->kind = EVENT_LOST;
            break;
        }
        if (tracer->passed.n) take_before(tracer, event);
        if (event->kind != EVENT_BOUNDARY) break;
        if (event->crossing.opaque) {
            event->kind = EVENT_OPAQUE;
            event->hit = *path_boundary_hit(tracer, &tracer->list, hits, n, &event->crossing);
            break;
        }
        if (media_differ(path, event->crossing.medium_from, event->crossing.medium_to)) {
            event->hit = *path_boundary_hit(tracer, &tracer->list, hits, n, &event->crossing);
            break;
        }
        if (UNLIKELY(world->has_paint)) {
            uint32_t behind =
                event->behind == BEHIND_IN_NEXT ? tracer->next.point.top.level : event->step.point.top.level;
            const Hit *painted = path_painted_hit(world, hits, n, tracer->list.point.top.level, behind);
            if (painted) {
                event->hit = *painted;
                break;
            }
        }
        /* Nothing is there: on along the same ray, with the new list. */
        tracer->counters.silent_crossings++;
        if (silent >= SILENT_LIMIT) {
            tracer->counters.silent_limit++;
            event->kind = EVENT_GIVE_UP;
            return;
        }
        t_done = end_of_place(hits, n);
        path_go_behind(tracer, event);
        rtc_pass_on(&path->ray, hits, n);
    }
    flight_end(path, &flight, event->kind == EVENT_SCATTER && !uneven);
}

bool path_cross_towards(Tracer *tracer, const Ray *ray, NestList *list)
{
    const CompiledScene *compiled = tracer->world->compiled;
    if (nest_list_copy(list, &tracer->list) != STATUS_OK) return false;
    for (size_t i = 0; i < ray->n_left; i++) {
        const Hit *left = &ray->left[i];
        uint32_t hull = compiled->hull_of_object[left->object];
        NestPass pass = {hull, left->inside};
        NestCrossing crossing;
        bool crossed = left->inside == left->entering;
        /* one that is not crossed may have been entered, or left, by another surface there; to pass what the list has is nothing */
        if (hull == SCENE_NONE || (!crossed && compiled->order.policy == NEST_NONE)) continue;
        if (nest_cross_one(list, &compiled->order, pass, &crossing) != STATUS_OK) return false;
    }
    return true;
}

/* tracer->shadow_list becomes the one at a straight ray's start; false when memory ends. mend: what the ray meets contradicts
 * the list, so that the ray's start is looked at more closely. */
static bool begin_straight(Tracer *tracer, const Ray *ray, bool mend)
{
    if (!path_cross_towards(tracer, ray, &tracer->shadow_list)) return false;
    if (UNLIKELY(mend)) mend_list(tracer, ray, &tracer->shadow_list);
    return true;
}

/* What is left of a straight ray as it goes through media and past surfaces. */
typedef struct Straight {
    Lanes depth, panes;
    double t_done;
    uint32_t medium;
    bool uneven; /* some media on its way vary, shine or mix */
    bool mended; /* it has been looked at again */
    size_t n_crossings, n_faults;
    uint32_t n_panes;
} Straight;
typedef enum StraightEnd { STRAIGHT_CLEAR, STRAIGHT_BLOCKED, STRAIGHT_CONTRADICTS, STRAIGHT_LOST } StraightEnd;

/* What the media that vary, shine or mix leave of a straight ray that nothing blocks. */
static Lanes transmit_uneven(Path *path, const Ray *ray, bool mended)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const Hit *hits = tracer->shadow_hits.items;
    size_t n = tracer->shadow_hits.n, end = 0;
    NestList *list = &tracer->shadow_list;
    Lanes left = lanes_all(1);
    uint32_t n_drawn = 0;
    double t_done = 0;
    if (!begin_straight(tracer, ray, mended)) tracer->out_of_memory = true;
    for (size_t begin = 0; !lanes_zero(left) && !tracer->out_of_memory; begin = end) {
        double t = begin < n ? hits[begin].t : ray->t_max;
        if (flight_is_uneven(world, list, nest_medium(list)))
            left = lanes_mul(left, flight_transmit(path, ray, list, t_done, t, &n_drawn, NULL));
        if (begin == n) break;
        NestCrossing crossing;
        end = begin + rtc_cluster(hits + begin, n - begin);
        if (!path_cross(tracer, list, hits + begin, end - begin, &crossing)) tracer->out_of_memory = true;
        t_done = t;
    }
    return left;
}

/* A place that a straight ray comes to. */
static inline StraightEnd cross_straight(Path *path, const Ray *ray, const Hit *hits, size_t n, Straight *straight)
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    NestCrossing crossing;
    bool uneven_here = flight_is_uneven(world, &tracer->shadow_list, straight->medium);
    uint32_t level = tracer->shadow_list.point.top.level;
    if (!path_cross(tracer, &tracer->shadow_list, hits, n, &crossing)) return STRAIGHT_LOST;
    if (UNLIKELY(crossing.n_faults) && !straight->mended) return STRAIGHT_CONTRADICTS;
    straight->n_crossings += n;
    straight->n_faults += crossing.n_faults;
    if (UNLIKELY(world->has_panes)) {
        size_t n_hulls = 0;
        for (size_t i = 0; i < n; i++) n_hulls += world->compiled->hull_of_object[hits[i].object] != SCENE_NONE;
        const bool combined = crossing.opaque && n == 1 && path_is_pane(world, hits->object, n);
        if (n_hulls < n || combined) {
            /* a path that goes this way counts each of them, too */
            if (path->n_counted + ++straight->n_panes > world->max_bounces) return STRAIGHT_BLOCKED;
            straight->panes = lanes_mul(straight->panes, path_pass_panes(path, ray, hits, n, straight->medium));
        }
        if (combined) crossing.opaque = false;
        if (!n_hulls) crossing.medium_from = crossing.medium_to = straight->medium;
        if (lanes_zero(straight->panes)) return STRAIGHT_BLOCKED;
    }
    if (crossing.opaque || media_differ(path, crossing.medium_from, crossing.medium_to)) return STRAIGHT_BLOCKED;
    if (UNLIKELY(world->has_paint) && path_painted_hit(world, hits, n, level, tracer->shadow_list.point.top.level))
        return STRAIGHT_BLOCKED;
    straight->uneven = straight->uneven || uneven_here;
    if (LIKELY(!uneven_here))
        straight->depth = lanes_add(straight->depth, flight_depth(path, straight->medium, hits->t - straight->t_done));
    straight->t_done = hits->t;
    straight->medium = crossing.medium_to;
    return STRAIGHT_CLEAR;
}

/* From the list at its start to its end, past tracer->shadow_hits. */
static inline StraightEnd follow_straight(Path *path, const Ray *ray, bool mended, Straight *straight)
{
    Tracer *tracer = path->tracer;
    const Hit *hits = tracer->shadow_hits.items;
    size_t n_hits = tracer->shadow_hits.n, n;
    *straight = (Straight){
        .depth = lanes_all(0), .panes = lanes_all(1), .medium = nest_medium(&tracer->shadow_list), .mended = mended};
    for (size_t begin = 0; begin < n_hits; begin += n) {
        n = rtc_cluster(hits + begin, n_hits - begin);
        StraightEnd end = cross_straight(path, ray, hits + begin, n, straight);
        if (end != STRAIGHT_CLEAR) return end;
    }
    if (LIKELY(!flight_is_uneven(tracer->world, &tracer->shadow_list, straight->medium)))
        straight->depth =
            lanes_add(straight->depth, flight_depth(path, straight->medium, ray->t_max - straight->t_done));
    else
        straight->uneven = true;
    return STRAIGHT_CLEAR;
}

/* Where the hits of a straight ray contradict the list, those that Embree has missed are put among them. */
ATTR_COLD static void add_missed(Tracer *tracer, const Ray *ray)
{
    HitList *hits = &tracer->shadow_hits, *missed = &tracer->along;
    NestList *list = &tracer->shadow_list;
    for (size_t i = 0; i < hits->n; i++) {
        const Hit hit = hits->items[i];
        NestCrossing crossing;
        Ray from = *ray; /* behind the surface of that object that was found before this one */
        for (size_t k = 0; k < i; k++)
            if (hits->items[k].object == hit.object) from.t_min = hits->items[k].t;
        if (is_wrong(tracer, list, &hit) && find_missed(tracer, &from, list, hit.object, hit.t, missed) &&
            rtc_add_hit(hits, missed->items)) {
            if (!path_cross(tracer, list, missed->items, 1, &crossing)) return;
            i++;
        }
        if (!path_cross(tracer, list, &hit, 1, &crossing)) return;
    }
}

/* What a straight ray meets contradicts the list: as path_next_event's read_again. */
ATTR_COLD static StraightEnd follow_again(Path *path, const Ray *ray, Straight *straight)
{
    Tracer *tracer = path->tracer;
    if (!begin_straight(tracer, ray, true)) return STRAIGHT_LOST;
    add_missed(tracer, ray);
    if (!begin_straight(tracer, ray, true)) return STRAIGHT_LOST;
    return follow_straight(path, ray, true, straight);
}

/* Follows a straight ray past tracer->shadow_hits, from the list at its start, which is there already. */
static inline bool arrive_straight(Path *path, const Ray *ray, Straight *straight)
{
    Tracer *tracer = path->tracer;
    const CrystalWave wave = path->wave;
    path->wave = CRYSTAL_UNPOLARIZED; /* whatever the path is that has come to where light is looked for from */
    StraightEnd end = follow_straight(path, ray, false, straight);
    if (UNLIKELY(end == STRAIGHT_CONTRADICTS)) end = follow_again(path, ray, straight);
    path->wave = wave;
    tracer->counters.crossings += straight->n_crossings;
    tracer->counters.nesting_faults += straight->n_faults;
    if (UNLIKELY(end == STRAIGHT_LOST)) tracer->out_of_memory = true;
    return end == STRAIGHT_CLEAR;
}

static inline void leave_of_straight(Path *path, const Ray *ray, const Straight *straight, Lanes *transmittance,
                                     uint32_t *medium_at_light)
{
    *transmittance = lanes_mul(flight_attenuation(straight->depth), straight->panes);
    *medium_at_light = straight->medium;
    if (UNLIKELY(straight->uneven))
        *transmittance = lanes_mul(*transmittance, transmit_uneven(path, ray, straight->mended));
}

/* tracer->shadow_list and tracer->shadow_hits become what a straight ray begins in, and meets. */
static inline bool look_straight(Path *path, Ray *ray)
{
    Tracer *tracer = path->tracer;
    tracer->counters.rays++;
    if (!begin_straight(tracer, ray, false)) {
        tracer->out_of_memory = true;
        return false;
    }
    ray->stops = compiled_stop_class(nest_medium(&tracer->shadow_list));
    return rtc_all(tracer->world->compiled->rtc, ray, true, &tracer->shadow_hits);
}

bool path_shadow(Path *path, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light)
{
    Straight straight;
    if (!look_straight(path, ray) || !arrive_straight(path, ray, &straight)) return false;
    leave_of_straight(path, ray, &straight, transmittance, medium_at_light);
    return true;
}

/* Parts the surfaces that a straight ray meets: those in front of the light's place, where the ray comes to its operand on the side
 * that shines, stay in tracer->shadow_hits, those at that place go to tracer->aimed, and what is behind is forgotten. False: it does
 * not come there. */
static bool part_hits(Tracer *tracer, const LightSample *light)
{
    HitList *hits = &tracer->shadow_hits;
    size_t wanted = 0, begin = 0, n;
    while (wanted < hits->n && !light_is_met(tracer->world, light, &hits->items[wanted])) wanted++;
    if (wanted == hits->n) return false;
    while (n = rtc_cluster(hits->items + begin, hits->n - begin), begin + n <= wanted) begin += n;
    if (!hit_list_copy(&tracer->aimed, hits->items + begin, n)) {
        tracer->out_of_memory = true;
        return false;
    }
    hits->n = begin;
    return true;
}

/* Whether the operand's surface among tracer->aimed is the one by which a path that came there would find the combination opaque.
 * tracer->shadow_list is that in front of them. */
static bool is_opaque_there(Tracer *tracer, uint32_t object)
{
    const Hit *hit = hit_of_opaque(tracer->world->compiled, &tracer->shadow_list, tracer->aimed.items, tracer->aimed.n);
    return hit && hit->object == object;
}

bool path_meets(Path *path, const LightSample *light, Ray *ray, Lanes *transmittance, uint32_t *medium_at_light)
{
    Tracer *tracer = path->tracer;
    Straight straight;
    ray->t_max = light->distance * (1 + (double)light->slack);
    if (!look_straight(path, ray) || !part_hits(tracer, light)) return false;
    ray->t_max = tracer->aimed.items[0].t;
    if (!arrive_straight(path, ray, &straight) || !is_opaque_there(tracer, light->object)) return false;
    leave_of_straight(path, ray, &straight, transmittance, medium_at_light);
    return true;
}
