/* rtc.c - tracing: Embree proposes, double precision decides.
 *
 * Each Embree call runs with a Query behind its context, and hands it every candidate that it finds, in whatever order.
 * For the nearest cluster the search radius shrinks with the nearest candidate, but always stays wider than everything
 * that could stand at the same place as it. Most candidates turn out not to belong to the answer; so the exact part is put
 * off (put_off) until the search is over and few are left, and only what decides about the search is asked at once: is it
 * in front of the start for certain? where it is not, it is computed exactly on the spot (take_exactly). What is then
 * found in double shows whether the search went far enough; where it did not, at grazing rays above all, it is done
 * again with every candidate computed as it comes (search_exactly). What is met near an edge is first looked at closer
 * (rtc_edge.c), and may turn out not to be there. Surfaces that the ray passes by are noted on the way
 * in a list of their own (rtc_passed.c), and end nothing.
 *
 * The ray that Embree sees starts a little behind the true one, so that a triangle right at the start is
 * proposed in spite of float rounding; whether it is in front of the start is then decided in double. One that starts far
 * away from everything is shown from nearer by: in float, coordinates out there are too coarse to aim with.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "geom/rtc_boxes.h"
#include "geom/rtc_query.h"

/* The window for candidates whose cosine is not known yet: most have a larger one. */
#define USUAL_COSINE 0x1p-6

void hit_list_clear(HitList *list)
{
    free(list->items);
    *list = (HitList){0};
}

ATTR_COLD static bool hit_list_grow(HitList *list)
{
    size_t capacity = list->capacity ? list->capacity * 2 : 16;
    Hit *items = realloc(list->items, capacity * sizeof *items);
    if (!items) {
        list->out_of_memory = true;
        return false;
    }
    list->items = items;
    list->capacity = capacity;
    return true;
}

/* The largest number that Embree may round of what it finds at t. grain: of triangles there, as Hit has it. */
static inline double scale_near(const Query *query, double t, float grain)
{
    return (grain > 0 ? double_max(query->start_scale, (double)grain) : query->coarse_scale) + t;
}

/* The same, and *grain by the grid, where that could say much less. own: of what is found itself. */
static inline double scale_at(const Query *query, double t, float own, float *grain)
{
    *grain = 0;
    if (!(t < query->fine_within)) return query->coarse_scale + t;
    Vec3 place = vec3_along(query->origin, t, query->direction);
    *grain = float_max(own, rtc_grain_at(&query->scene->grain, place));
    return double_max(query->start_scale, (double)*grain) + t;
}

/* What that makes of distances, at a usual cosine. */
static inline double doubt_of(double scale)
{
    return (4 * TRUSTED_ULPS * UNIT_ROUNDING + EMBREE_NOISE) / USUAL_COSINE * scale;
}

static inline void reach_no_farther(Query *query, double reach, double doubt)
{
    if (!(reach < query->reach)) return;
    query->reach = reach;
    query->doubt = doubt;
}

/* How far behind a surface at distance t and cosine c another one can be and still be proposed by
 * Embree for a ray that must not lose it. */
static double window_behind(const Query *query, const Hit *hit)
{
    double cosine = double_max(fabs(hit->cos_normal), RTC_LEAST_COSINE);
    double noise = EMBREE_NOISE * scale_near(query, hit->t, hit->grain);
    return double_max(query->least_window, (4 * hit->rounding + noise) / cosine);
}

/* Whether the search went that far. */
static inline bool reaches_behind(const Query *query, const Hit *hit)
{
    double cosine = double_max(fabs(hit->cos_normal), RTC_LEAST_COSINE);
    double noise = EMBREE_NOISE * scale_near(query, hit->t, hit->grain);
    return 4 * hit->rounding + noise <= (query->reach - hit->t) * cosine;
}

/* The upper end of Embree's search, for what the true ray calls t. */
static float embree_t(const Query *query, double t)
{
    double far = t + query->back;
    far += EMBREE_NOISE * far;
    return far < (double)FLT_MAX ? (float)far : INFINITY;
}

static bool is_target(const Ray *ray, uint32_t object, uint32_t primitive)
{
    return object == ray->target && (ray->target_primitive == RTC_NO_OBJECT || primitive == ray->target_primitive);
}

Hit *rtc_hit_place(HitList *list)
{
    if (UNLIKELY(list->n == list->capacity) && !hit_list_grow(list)) return NULL;
    return &list->items[list->n];
}

/* Of a hit that is put off no more than these fields is set, and what its kind of primitive tells at once: a cosine of 0
 * says so. */
static inline void set_hit(Hit *hit, double t, uint32_t object, uint32_t primitive)
{
    hit->t = t;
    hit->grain = 0;
    hit->object = object;
    hit->primitive = primitive;
    hit->cos_normal = 0;
}

/* The place of the next hit of the list, which is of a piece; NULL when memory ends. */
static inline Hit *next_crossing(HitList *list, double t, uint32_t object, uint32_t piece, bool leaving)
{
    Hit *hit = rtc_hit_place(list);
    if (UNLIKELY(!hit)) return NULL;
    set_hit(hit, t, object, piece);
    hit->entering = !leaving;
    return hit;
}

static bool is_stopped_by(const Query *query, uint32_t object)
{
    const RtcPlaced *placed = &query->scene->objects[object];
    return placed->opaque || (UNLIKELY(placed->stops & query->ray->stops) && !rtc_starts_on(query->ray, object));
}

/* A candidate of rtc_all. Returns whether the search may end at once. */
static bool take_any(Query *query, Hit *hit)
{
    const Ray *ray = query->ray;
    bool clear = !query->scene->objects[hit->object].opaque;
    if (!query->stop_at_opaque || !is_stopped_by(query, hit->object)) {
        query->hits->n++;
        return false;
    }
    bool target = is_target(ray, hit->object, hit->primitive);
    if (!target && !rtc_complete_hit(query, hit)) return false;
    query->blocked = !target && hit->clear;
    if (UNLIKELY(!query->blocked && (clear || !target))) query->hits->n++; /* at an edge: to be looked at again */
    return query->blocked;
}

/* However steeply the ray meets this surface, it may graze one in front of it, which Embree then believes to be behind it. */
void rtc_shorten(Query *query, const Hit *hit)
{
    double doubt = doubt_of(scale_near(query, hit->t, hit->grain));
    reach_no_farther(query, hit->t + double_max(window_behind(query, hit), doubt), doubt);
}

/* Whether a candidate is there that is computed exactly at once. In an exact search, where the exact ray misses it, its
 * neighbours are noted that are there instead. */
static bool is_there(Query *query, const HitList *list, Hit *hit)
{
    bool triangle = query->scene->objects[hit->object].is_mesh;
    if (query->exact && triangle && rtc_has_hit(list, hit->object, hit->primitive)) return false;
    if (!rtc_complete_hit(query, hit)) return false;
    if (LIKELY(!query->exact || hit->clear) || rtc_meets(query, hit)) return true;
    rtc_look_at(query, hit);
    return false;
}

/* A candidate of rtc_nearest that is to be computed exactly at once. Returns whether the search may now end at
 * query->reach. */
static bool take_exactly(Query *query, Hit *hit)
{
    double reach = query->reach;
    if (is_there(query, query->hits, hit) && hit->t <= query->reach) {
        query->hits->n++;
        rtc_shorten(query, hit);
    }
    return query->reach < reach;
}

/* A candidate of rtc_nearest that is in front of the start for certain: it is put off. */
static inline bool put_off(Query *query, Hit *hit)
{
    double doubt = doubt_of(scale_at(query, hit->t, 0, &hit->grain));
    query->hits->n++;
    reach_no_farther(query, hit->t + doubt, doubt);
    return true;
}

/* A candidate that the ray passes by, if it is there: it never ends the search. */
static bool note_passed(Query *query, Hit *hit, bool certain)
{
    if (certain || is_there(query, query->passed, hit)) query->passed->n++;
    return false;
}

/* Whether a crossing of a piece that the ray starts on is that start. */
static bool is_start(const Query *query, const Hit *left, double t, bool leaving)
{
    return t <= rtc_start_noise(query->scale, query->ray) && left->inside != leaving;
}

/* The ray starts right behind a surface of a solid. Where it is none that it starts on, it has come there in a corner so narrow
 * that double does not tell the two apart, and what is known of the solid is to be looked at again. */
ATTR_COLD static bool note_behind(Query *query, uint32_t object)
{
    if (!rtc_starts_on(query->ray, object)) query->hits->beside = true;
    return false;
}

static bool take_crossing(Query *query, uint32_t object, uint32_t piece, double t, bool leaving)
{
    if (UNLIKELY(query->hides) && query->scene->objects[object].hidden) return false;
    if (UNLIKELY(t <= query->t_min)) return note_behind(query, object);
    const Hit *left = rtc_find_left(query->ray, object, piece);
    if (left && is_start(query, left, t, leaving)) return false;
    bool passing = rtc_passes(query, object);
    Hit *hit = next_crossing(passing ? query->passed : query->hits, t, object, piece, leaving);
    if (UNLIKELY(!hit)) return false;
    if (query->all) return take_any(query, hit);
    if (passing) return note_passed(query, hit, !query->exact && !left);
    if (query->exact || left) return take_exactly(query, hit);
    return t <= query->reach && put_off(query, hit);
}

/* A ball is met where it is, without a frame. */
static bool consider_ball(Query *query, uint32_t object)
{
    Ball ball = rtc_ball(query->scene, &query->scene->objects[object], query->ray->time);
    PieceCrossings crossings;
    piece_cross_ball(ball.radius, vec3_sub(query->origin, ball.centre), query->direction, query->pieces_from,
                     double_min(query->ray->t_max, query->reach), &crossings);
    bool shrink = false;
    for (int i = 0; i < crossings.n; i++)
        shrink |= take_crossing(query, object, 0, crossings.t[i], crossings.leaving[i]);
    return shrink;
}

/* Which crossings of a hollow piece are taken at one of its eighths. A search comes to several of them, and what it finds
 * of the piece is the same each time: so all are taken with the first, unless another piece has its place in the list. */
typedef enum EighthsTaken { ALL_NOW, ALL_BEFORE, EACH_BY_ITSELF } EighthsTaken;

/* place: the piece's in RtcScene.pieces. */
static inline EighthsTaken take_eighths(Query *query, uint32_t place)
{
    uint32_t *whole = &query->whole[place % RTC_WHOLE];
    if (*whole == place) return ALL_BEFORE;
    if (UNLIKELY(*whole != RTC_NO_OBJECT)) return EACH_BY_ITSELF;
    *whole = place;
    return ALL_NOW;
}

static inline void forget_eighths(Query *query)
{
    memset(query->whole, 0xff, sizeof query->whole);
}

static bool consider_piece(Query *query, const RtcPieceSet *set, uint32_t primitive)
{
    if (primitive < set->n_balls) return consider_ball(query, set->balls[primitive]);
    RtcPart part = rtc_part(set, primitive);
    EighthsTaken taken = ALL_NOW;
    if (part.sector != RTC_ALL_SECTORS) taken = take_eighths(query, set->first + part.number);
    if (taken == ALL_BEFORE) return false;
    const RtcPiece *which = &set->pieces[part.number];
    if (query->local.frame != which->frame) rtc_enter_frame(query, &query->scene->objects[which->object]);
    const PieceLine *line = &query->local.line;
    const Hit *left = rtc_find_left(query->ray, which->object, which->piece);
    PieceStart start = LIKELY(!left) ? PIECE_START_ELSEWHERE : left->inside ? PIECE_START_INSIDE : PIECE_START_OUTSIDE;
    PieceCrossings crossings;
    piece_cross(which->shape, line, query->pieces_from, double_min(query->ray->t_max, query->reach), start, &crossings);
    bool shrink = false;
    for (int i = 0; i < crossings.n; i++) {
        double t = crossings.t[i];
        if (LIKELY(taken == ALL_NOW) ||
            rtc_sector(line->org.x + t * line->dir.x, line->org.z + t * line->dir.z) == part.sector)
            shrink |= take_crossing(query, which->object, which->piece, t, crossings.leaving[i]);
    }
    return shrink;
}

/* Only single rays are traced, so that Embree's arrays of N are these plain structs. */
static struct RTCRay *ray_of(struct RTCRayN *ray)
{
    return (struct RTCRay *)(void *)ray;
}

/* A triangle that Embree has found. On the edge between the two of a quad it may be the other one. */
typedef struct Found {
    uint32_t object, primitive;
    float u, v;
    bool on_diagonal;
} Found;
/* How far Embree's weights of a triangle that it has found are below 0 or above 1 at most; some more. */
#define FOUND_NOISE 0x1p-20f

/* Embree has just written u and v, one after the other: read as one they would have to be waited for. */
static inline float read_apart(const volatile float *number)
{
    return *number;
}

/* Embree's coordinates on a quad are those of its even triangle, and one less those of the odd one. */
static inline Found found_triangle(const struct RTCHitN *of_embree)
{
    const struct RTCHit *hit = (const struct RTCHit *)(const void *)of_embree;
    float u = read_apart(&hit->u), v = read_apart(&hit->v);
    uint32_t odd = u + v > 1;
    float half = (float)odd; /* 0 as often as 1: a branch would not be foreseen */
    return (Found){.object = hit->instID[0] != RTC_INVALID_GEOMETRY_ID ? hit->instID[0] : hit->geomID,
                   .primitive = 2 * hit->primID + odd,
                   .u = fabsf(half - u),
                   .v = fabsf(half - v),
                   .on_diagonal = fabsf(u + v - 1) <= FOUND_NOISE};
}

/* The other of its quad. */
static Found twin_of(const Found *found)
{
    Found twin = *found;
    twin.primitive ^= 1;
    twin.u = 1 - found->u;
    twin.v = 1 - found->v;
    return twin;
}

static inline void set_triangle(Hit *hit, double t, const Found *found)
{
    set_hit(hit, t, found->object, found->primitive);
    hit->u = found->u;
    hit->v = found->v;
}
/* The place of a triangle in a list; NULL where the ray goes away from it, where it is there already, as one that has been found
 * as its twin may be, and when memory ends. */
static Hit *next_triangle(const Query *query, HitList *list, double t, const Found *found)
{
    const Hit *left = rtc_find_left(query->ray, found->object, found->primitive);
    if (left && left->behind) return NULL;
    if (UNLIKELY(found->on_diagonal) && rtc_has_hit(list, found->object, found->primitive)) return NULL;
    Hit *hit = rtc_hit_place(list);
    if (LIKELY(hit)) set_triangle(hit, t, found);
    return hit;
}

/* A triangle that a nearest query finds, and that cannot be put off. Returns whether the search may now end at
 * query->reach. */
static bool consider_triangle(Query *query, const Found *found, double t)
{
    bool passing = rtc_passes(query, found->object);
    Hit *hit = next_triangle(query, passing ? query->passed : query->hits, t, found);
    return LIKELY(hit) && (passing ? note_passed(query, hit, false) : take_exactly(query, hit));
}

ATTR_APART static void consider_at_once(const struct RTCFilterFunctionNArguments *arguments, double t)
{
    Query *query = (Query *)(void *)arguments->context;
    Found found = found_triangle(arguments->hit);
    bool shrink = consider_triangle(query, &found, t);
    if (UNLIKELY(found.on_diagonal)) {
        Found twin = twin_of(&found);
        shrink |= consider_triangle(query, &twin, t);
    }
    if (shrink)
        ray_of(arguments->ray)->tfar = embree_t(query, query->reach);
    else
        arguments->valid[0] = 0;
}

/* Most are in front of the start for certain: these are put off without a call, and so without a frame. */
void rtc_filter_nearest(const struct RTCFilterFunctionNArguments *arguments)
{
    Query *query = (Query *)(void *)arguments->context;
    const Ray *ray = query->ray;
    struct RTCRay *embree = ray_of(arguments->ray);
    Found found = found_triangle(arguments->hit);
    const Hit *left = rtc_find_left(ray, found.object, found.primitive);
    if (left && left->behind && LIKELY(!found.on_diagonal)) {
        arguments->valid[0] = 0;
        return;
    }
    double t = (double)embree->tfar - query->back;
    float grain;
    double doubt = doubt_of(scale_at(query, t, query->scene->objects[found.object].grain, &grain));
    if (UNLIKELY(left || query->exact || found.on_diagonal || !(t > query->t_min + doubt && t < ray->t_max - doubt))) {
        consider_at_once(arguments, t);
        return;
    }
    HitList *list = rtc_passes(query, found.object) ? query->passed : query->hits;
    if (UNLIKELY(list->n == list->capacity)) {
        consider_at_once(arguments, t);
        return;
    }
    PREFETCH(&query->scene->objects[found.object].mesh->quads[found.primitive / 2]); /* for when the search is over */
    Hit *hit = &list->items[list->n++];
    set_triangle(hit, t, &found);
    hit->grain = grain;
    if (list != query->hits) {
        arguments->valid[0] = 0;
        return;
    }
    reach_no_farther(query, t + doubt, doubt);
    embree->tfar = embree_t(query, query->reach); /* accepted: the search goes on up to there */
}

/* A triangle that a query for any finds. Returns whether the search may end at once. */
static bool consider_any(Query *query, const Found *found)
{
    Hit *hit = next_triangle(query, query->hits, 0, found);
    return hit && take_any(query, hit);
}

void rtc_filter_any(const struct RTCFilterFunctionNArguments *arguments)
{
    Query *query = (Query *)(void *)arguments->context;
    Found found = found_triangle(arguments->hit);
    bool end = consider_any(query, &found);
    if (UNLIKELY(found.on_diagonal && !end)) {
        Found twin = twin_of(&found);
        end = consider_any(query, &twin);
    }
    if (!end) arguments->valid[0] = 0;
}

/* A ray as Embree reads it: its start and least distance, its direction and time, each as four lanes. */
typedef struct FloatRay {
    Lanes start, direction;
} FloatRay;

static inline FloatRay float_ray(const struct RTCRay *ray)
{
    FloatRay parts;
    memcpy(&parts, ray, sizeof parts);
    return parts;
}

/* Debian's Embree aborts on rays that are not finite or very far away. */
static inline bool is_tame(Lanes part)
{
    return lanes_not_above(lanes_abs(part), lanes_all(1e18f)) == 0xf; /* not of NaN, either */
}

/* False for a ray that Embree cannot be asked about. */
static bool embree_ray(const Query *query, struct RTCRay *ray)
{
    Vec3 origin = vec3_add(query->origin, *query->nudge);
    Vec3f start = vec3f_from(vec3_along(origin, -query->back, query->direction)), direction = query->ray->direction;
    double near = query->t_min;
    if (near > 0) near -= 16 * EMBREE_NOISE * scale_near(query, near, 0);
    near += double_min(query->back, 0); /* from far away */
    FloatRay parts = {lanes(start.x, start.y, start.z, near > 0 ? (float)near : 0),
                      lanes(direction.x, direction.y, direction.z, (float)query->ray->time)};
    memcpy(ray, &parts, sizeof parts); /* as Embree reads it: it need not wait for its parts to come together */
    ray->tfar = embree_t(query, double_min(query->ray->t_max, query->reach));
    ray->mask = 0xffffffffU;
    ray->id = ray->flags = 0;
    return is_tame(parts.start) && is_tame(parts.direction);
}

/* Narrows near .. far to where a ray is between two planes across one axis, of four pairs at once. */
static inline void narrow(Lanes lower, Lanes upper, float start, float inverse, Lanes *near, Lanes *far)
{
    Lanes a = lanes_scale(lanes_sub(lower, lanes_all(start)), inverse),
          b = lanes_scale(lanes_sub(upper, lanes_all(start)), inverse);
    *near = lanes_greater(lanes_lesser(a, b), *near);
    *far = lanes_lesser(lanes_scale(lanes_greater(a, b), 1 + 0x1p-21f), *far);
}

/* One over the direction. */
static inline Lanes inverse_of(Lanes direction)
{
    const Lanes least = lanes_all(1e-18f); /* as Embree does it, so that infinity and NaN do not come up */
    return lanes_div(lanes_all(1), lanes_select_less(lanes_abs(direction), least, least, direction));
}

/* Which of four bounds Embree's float ray meets, as bits. */
static inline unsigned meets_bounds(const RtcFour *four, const struct RTCRay *ray)
{
    FloatRay parts = float_ray(ray);
    Lanes inverse = inverse_of(parts.direction), near = lanes_all(ray->tnear), far = lanes_all(ray->tfar);
    for (int axis = 0; axis < 3; axis++)
        narrow(four->lower[axis], four->upper[axis], lanes_get(parts.start, axis), lanes_get(inverse, axis), &near,
               &far);
    return lanes_not_above(near, far);
}

/* Whether it meets one. */
static inline bool meets_one(const RtcOne *one, const struct RTCRay *ray)
{
    FloatRay parts = float_ray(ray);
    Lanes inverse = inverse_of(parts.direction), a = lanes_mul(lanes_sub(one->lower, parts.start), inverse),
          b = lanes_mul(lanes_sub(one->upper, parts.start), inverse);
    float near = lanes_max(lanes_lesser(a, b)), far = lanes_min(lanes_greater(a, b)) * (1 + 0x1p-21f);
    return float_max(near, ray->tnear) <= float_min(far, ray->tfar);
}

/* Primitives that Embree does not know, those whose bits are set; shortens Embree's ray where the search may end sooner
 * then. */
static void consider_own(Query *query, uint32_t first, uint32_t n, unsigned met, struct RTCRay *ray)
{
    bool shrink = false;
    for (uint32_t i = 0; i < n && !query->blocked; i++, met >>= 1)
        if (met & 1) shrink |= consider_piece(query, &query->scene->still, first + i);
    if (shrink) ray->tfar = embree_t(query, double_min(query->ray->t_max, query->reach));
}

static void consider_plane(Query *query, const RtcPlane *plane, struct RTCRay *ray)
{
    double height = vec3_dot(plane->up, vec3_sub(query->origin, plane->place)),
           slope = vec3_dot(plane->up, query->direction);
    if (UNLIKELY(plane->moves)) {
        Affine to_local = rtc_to_local(query->scene, &query->scene->objects[plane->object], query->ray->time);
        height = affine_point(&to_local, query->origin).y;
        slope = affine_vector(&to_local, query->direction).y;
    }
    if (slope == 0) return;
    double t = -height / slope;
    if (!(t > query->pieces_from && t <= double_min(query->ray->t_max, query->reach))) return;
    if (take_crossing(query, plane->object, 0, t, slope > 0))
        ray->tfar = embree_t(query, double_min(query->ray->t_max, query->reach));
}

/* All such, and planes, which have no bounds. */
static inline void consider_all_own(Query *query, struct RTCRay *ray)
{
    const RtcScene *scene = query->scene;
    for (uint32_t i = 0; i < scene->n_planes && !query->blocked; i++) consider_plane(query, &scene->planes[i], ray);
    if (LIKELY(scene->n_few <= RTC_ALONE)) {
        for (uint32_t i = 0; i < scene->n_few; i++)
            if (meets_one(&scene->alone[i], ray)) consider_own(query, i, 1, 1, ray);
        return;
    }
    for (uint32_t i = 0; i < scene->n_few; i += LANES) {
        unsigned met = meets_bounds(&scene->few[i / LANES], ray);
        if (met) consider_own(query, i, scene->n_few - i, met, ray);
    }
}

void rtc_piece_intersect(const struct RTCIntersectFunctionNArguments *arguments)
{
    Query *query = (Query *)(void *)arguments->context;
    if (!arguments->valid[0]) return;
    if (consider_piece(query, arguments->geometryUserPtr, arguments->primID)) {
        struct RTCRay *ray = &((struct RTCRayHit *)(void *)arguments->rayhit)->ray;
        float tfar = embree_t(query, query->reach);
        ray->tfar = tfar < ray->tfar ? tfar : ray->tfar;
    } else {
        arguments->valid[0] = 0;
    }
}

void rtc_piece_occluded(const struct RTCOccludedFunctionNArguments *arguments)
{
    Query *query = (Query *)(void *)arguments->context;
    if (!arguments->valid[0]) return;
    if (consider_piece(query, arguments->geometryUserPtr, arguments->primID))
        ray_of(arguments->ray)->tfar = -INFINITY;
    else
        arguments->valid[0] = 0;
}

/* What float rounds about the ray's start, and so how far before it Embree's begins. */
static inline void find_scales(Query *query)
{
    const RtcGrain *grains = &query->scene->grain;
    const Ray *ray = query->ray;
    double far = vec3_max_abs(ray->origin);
    float grain = ray->grain;
    query->scale = double_max(far, query->scene->reach);
    query->coarse_scale = double_max(far, (double)grains->most);
    if (!(grain > 0) && far < (double)grains->matters) grain = rtc_grain_at(grains, ray->origin);
    query->start_scale = grain > 0 ? double_max(far, (double)grain) : query->coarse_scale;
    query->fine_within = (double)grains->matters - query->start_scale;
    query->back = START_BACK * query->start_scale;
    query->nudge = &ray->nudge;
    query->unseen = 0;
    if (UNLIKELY(far > RTC_AFAR * query->scene->piece_reach)) rtc_start_from_afar(query);
}

static void query_init(Query *query, const RtcScene *scene, const Ray *ray, HitList *hits, HitList *passed)
{
    embree_init_context(&query->context);
    query->scene = scene;
    query->ray = ray;
    query->origin = ray->origin;
    query->direction = vec3_from_f(ray->direction);
    find_scales(query);
    query->t_min = query->pieces_from = ray->t_min;
    query->reach = HUGE_VAL;
    query->least_window = 0;
    query->all = query->stop_at_opaque = query->blocked = query->exact = false;
    query->unsure = ray->at_edge;
    query->hides = ray->sight && scene->has_hidden;
    query->hits = hits;
    query->passed = passed;
    query->passes = passed && (ray->pass_level || ray->pass_alike != RTC_NO_PASS);
    query->local.frame = query->all_along = RTC_NO_OBJECT;
    hits->n = 0;
    if (passed) passed->n = 0;
}

static int compare_hits(const void *left, const void *right)
{
    const Hit *a = left, *b = right;
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    if (a->object != b->object) return a->object < b->object ? -1 : 1;
    return a->primitive < b->primitive ? -1 : a->primitive > b->primitive;
}

void rtc_sort_hits(HitList *hits)
{
    enum { FEW = 48 };
    if (hits->n > FEW) {
        qsort(hits->items, hits->n, sizeof *hits->items, compare_hits);
        return;
    }
    for (size_t i = 1; i < hits->n; i++) {
        Hit hit = hits->items[i];
        size_t place = i;
        while (place > 0 && compare_hits(&hits->items[place - 1], &hit) > 0) {
            hits->items[place] = hits->items[place - 1];
            place--;
        }
        hits->items[place] = hit;
    }
}

/* Sorts what a search has found. What it was shown more than once is there as often: one of each is kept. */
static void sort_found(const Query *query, HitList *hits)
{
    rtc_sort_hits(hits);
    if (LIKELY(query->unseen == 0)) return;
    size_t n = 0;
    for (size_t i = 0; i < hits->n; i++) {
        const Hit *hit = &hits->items[i];
        size_t k = n;
        while (k > 0 && compare_hits(&hits->items[k - 1], hit) == 0 && hits->items[k - 1].entering != hit->entering)
            k--;
        if (k == 0 || compare_hits(&hits->items[k - 1], hit) != 0) hits->items[n++] = *hit;
    }
    hits->n = n;
}

bool hit_list_copy(HitList *list, const Hit *hits, size_t n)
{
    list->n = 0;
    for (size_t i = 0; i < n; i++) {
        Hit *place = rtc_hit_place(list);
        if (!place) return false;
        *place = hits[i];
        list->n++;
    }
    return true;
}

bool rtc_add_hit(HitList *hits, const Hit *more)
{
    Hit *place = rtc_hit_place(hits);
    if (!place) return false;
    *place = *more;
    hits->n++;
    rtc_sort_hits(hits);
    return true;
}

size_t rtc_cluster(const Hit *hits, size_t n_hits)
{
    size_t n = n_hits ? 1 : 0;
    while (n < n_hits && rtc_together(&hits[n - 1], &hits[n])) n++;
    return n;
}

/* Whether a hit goes the way that the ray went through a surface that it starts on, as one does that repeats it. */
static inline bool may_repeat(const Hit *left, const Hit *hit)
{
    return left->object == hit->object && left->inside == hit->entering;
}

/* Whether a hit is the crossing that the ray has just made, reported again by a neighbouring triangle: Embree's
 * float ray may pass on the other side of an edge than the exact one. It is within rounding of the plane that the ray
 * starts on, or the start is within rounding of its plane, and it enters (leaves) an object that the ray is already
 * inside (outside) of. To be asked of an object's first hit only: the next crossing goes the other way. */
static bool repeats_start(const Ray *ray, const Hit *hit)
{
    for (size_t i = 0; i < ray->n_left; i++) {
        const Hit *left = &ray->left[i];
        if (!may_repeat(left, hit)) continue;
        double slope = vec3_dot(vec3_from_f(left->normal), vec3_from_f(ray->direction));
        if (hit->t * double_min(fabs(slope), fabs(hit->cos_normal)) <= 2 * hit->rounding) return true;
    }
    return false;
}

size_t rtc_drop_repeats(const Ray *ray, Hit *hits, size_t n)
{
    if (ray->t_min > 0) return n;
    for (size_t k = 0; k < ray->n_left; k++) {
        size_t first = 0;
        while (first < n && hits[first].object != ray->left[k].object) first++;
        if (first == n || !repeats_start(ray, &hits[first])) continue;
        n--;
        for (size_t i = first; i < n; i++) hits[i] = hits[i + 1];
    }
    return n;
}

/* How far a surface that stands at one place with this one may be. */
static double chain_end(const Hit *last)
{
    return last->t + 2 * last->rounding / double_max(fabs(last->cos_normal), RTC_LEAST_COSINE);
}

/* Shows Embree a ray from afar again, from nearer by. What it finds once more is the same, and is dropped later. */
ATTR_COLD static void search_from_nearer(Query *query)
{
    const RtcScene *scene = query->scene;
    const double back = query->back, unseen = query->unseen;
    const Vec3 *nudge = query->nudge;
    struct RTCRayHit embree;
    double end;
    while (!query->blocked && rtc_next_start(query, &end) && embree_ray(query, &embree.ray)) {
        consider_own(query, 0, scene->n_few, UINT_MAX, &embree.ray);
        embree.ray.tfar = float_min(embree.ray.tfar, embree_t(query, end));
        embree.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        embree.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        if (query->all)
            embree_occluded(scene->world, &query->context, &embree.ray);
        else
            embree_intersect(scene->world, &query->context, &embree);
    }
    query->back = back;
    query->nudge = nudge;
    query->unseen = unseen;
}

/* False where nothing can be searched. */
static bool search_nearest(Query *query)
{
    query->reach = HUGE_VAL;
    query->doubt = 0;
    query->hits->n = 0;
    query->all_along = RTC_NO_OBJECT;
    if (query->passes) query->passed->n = 0;
    forget_eighths(query);
    struct RTCRayHit embree;
    if (UNLIKELY(!embree_ray(query, &embree.ray))) return false;
    consider_all_own(query, &embree.ray);
    embree.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    embree.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect(query->scene->world, &query->context, &embree);
    if (UNLIKELY(query->unseen > 0)) search_from_nearer(query);
    return true;
}

bool rtc_complete_hits(Query *query, HitList *hits, double end)
{
    size_t n = 0, n_elsewhere = 0;
    for (size_t i = 0; i < hits->n; i++) {
        Hit *hit = &hits->items[i];
        if (hit->t > end) continue;
        bool complete = hit->cos_normal != 0; /* at once, near the start */
        if (!complete && !rtc_complete_hit(query, hit)) {
            n_elsewhere++;
            continue;
        }
        if (n != i) hits->items[n] = *hit;
        n++;
    }
    hits->n = n;
    if (n > 1) sort_found(query, hits);
    return n_elsewhere == 0;
}

/* Completes the hits that were put off, as far as the search went on. False when that shows that it
 * may have ended too early: it went by what Embree said of a triangle that is elsewhere or nowhere, or past one that
 * the ray grazes. */
static bool complete_nearest(Query *query)
{
    HitList *hits = query->hits;
    double end = query->reach + query->doubt;
    if (!rtc_complete_hits(query, hits, end)) return false;
    if (query->passes && query->passed->n) rtc_complete_hits(query, query->passed, end);
    return hits->n == 0 || reaches_behind(query, &hits->items[0]);
}

/* How many hits stand at the nearest place; what is passed by there is among them. */
static size_t nearest_place(Query *query)
{
    size_t n = rtc_cluster(query->hits->items, query->hits->n);
    return query->passes && query->passed->n ? rtc_part_passed(query, n) : n;
}

/* The same with every candidate computed exactly as it comes; a chain of surfaces at one place may come near the end of
 * the window, and is then followed further. Returns how many there are. */
ATTR_COLD static size_t search_exactly(Query *query)
{
    HitList *hits = query->hits;
    query->exact = true;
    query->least_window = 0;
    if (query->ray->at_edge && query->t_min == 0) query->pieces_from = -rtc_start_noise(query->scale, query->ray);
    for (;;) {
        if (!search_nearest(query)) return 0;
        if (query->unsure) rtc_look_closer(query);
        sort_found(query, hits);
        if (query->passes) rtc_complete_hits(query, query->passed, query->reach);
        size_t n = nearest_place(query);
        if (n <= 1) return n;
        double end = chain_end(&hits->items[n - 1]);
        if (end <= query->reach) return n;
        query->least_window = (end - hits->items[0].t) + 0x1p-48 * end; /* so that their sum comes to the end */
    }
}

/* What has been found near edges is looked at closer. False where nothing is left as far as the search went: it may have ended
 * at a triangle that the exact ray misses. */
ATTR_COLD static bool settle(Query *query)
{
    rtc_look_closer(query);
    sort_found(query, query->hits);
    if (query->passes) rtc_complete_hits(query, query->passed, query->reach);
    return query->hits->n > 0 && reaches_behind(query, &query->hits->items[0]);
}

/* The nearest place as the usual search finds it; false where an exact one is needed. n: of hits there. */
static bool find_nearest(Query *query, size_t *n)
{
    if (UNLIKELY(!complete_nearest(query)) || (UNLIKELY(query->unsure) && !settle(query))) return false;
    *n = nearest_place(query);
    return LIKELY(*n <= 1) || chain_end(&query->hits->items[*n - 1]) <= query->reach;
}

/* Whether a ray goes into an object that nothing else reaches into: it then meets the other side of its surface, and that
 * alone. */
static bool cross_lone(Query *query)
{
    const Ray *ray = query->ray;
    uint32_t object = ray->left->object;
    if (!rtc_is_lone(query->scene, object) || ray->t_min > 0 || rtc_passes(query, object)) return false;
    const RtcPlaced *placed = &query->scene->objects[object];
    if (placed->ball)
        consider_ball(query, object);
    else
        rtc_cross_lone_mesh(query, object);
    return query->hits->n == 1 && query->hits->items[0].cos_normal >= RTC_LONE_COSINE;
}

size_t rtc_nearest(const RtcScene *scene, const Ray *ray, HitList *hits, HitList *passed)
{
    Query query;
    query_init(&query, scene, ray, hits, passed);
    hits->beside = false;
    if (ray->n_left == 1 && ray->left->inside && cross_lone(&query)) return 1;
    for (;;) {
        size_t n = 0;
        bool at_edge = query.unsure;
        if (LIKELY(!at_edge) && UNLIKELY(!search_nearest(&query))) return 0;
        if (UNLIKELY(at_edge) || UNLIKELY(!find_nearest(&query, &n))) n = search_exactly(&query);
        if (query.passes && passed->n) passed->n = rtc_drop_repeats(ray, passed->items, passed->n);
        if (n == 0) return 0;
        if (LIKELY(n == 1 && (ray->n_left == 0 || (ray->n_left == 1 && !may_repeat(ray->left, hits->items)))))
            return hits->n = 1;
        double behind = hits->items[n - 1].t;
        hits->n = rtc_drop_repeats(ray, hits->items, n);
        if (LIKELY(hits->n)) return hits->n;
        /* nothing but repetitions: look behind them; what was passed by before them is found again, one by one */
        query.exact = false;
        if (UNLIKELY(query.passes && passed->n)) {
            query.passes = false;
            passed->n = 0;
        } else {
            query.t_min = query.pieces_from = behind;
        }
    }
}

/* Whether one of the hits stops the ray. */
ATTR_COLD static bool is_blocked(const Query *query)
{
    const HitList *hits = query->hits;
    size_t i = 0;
    while (i < hits->n && (!is_stopped_by(query, hits->items[i].object) ||
                           is_target(query->ray, hits->items[i].object, hits->items[i].primitive)))
        i++;
    return i < hits->n;
}

bool rtc_all(const RtcScene *scene, const Ray *ray, bool stop_at_opaque, HitList *hits)
{
    Query query;
    query_init(&query, scene, ray, hits, NULL);
    query.all = true;
    query.stop_at_opaque = stop_at_opaque;
    forget_eighths(&query);
    struct RTCRay embree;
    if (UNLIKELY(!embree_ray(&query, &embree))) return true;
    consider_all_own(&query, &embree);
    if (query.blocked) return false;
    embree_occluded(scene->world, &query.context, &embree);
    if (UNLIKELY(query.unseen > 0)) search_from_nearer(&query);
    if (query.blocked) return false;
    rtc_complete_hits(&query, hits, HUGE_VAL);
    if (UNLIKELY(query.unsure)) {
        rtc_look_closer(&query);
        rtc_sort_hits(hits);
        if (stop_at_opaque && is_blocked(&query)) return false;
    }
    hits->n = rtc_drop_repeats(ray, hits->items, hits->n);
    return true;
}

typedef struct Missed {
    Query query;
    uint32_t object;
    bool entering;
    Hit first; /* so far */
} Missed;

static void look_for_missed(void *context, uint32_t begin, uint32_t end)
{
    Missed *missed = context;
    for (uint32_t i = begin; i < end; i++) {
        Hit hit = {.object = missed->object, .primitive = i};
        if (rtc_meets(&missed->query, &hit) && rtc_complete_hit(&missed->query, &hit) &&
            hit.entering == missed->entering && hit.t < missed->first.t)
            missed->first = hit;
    }
}

bool rtc_find_missed(const RtcScene *scene, const Ray *ray, uint32_t object, bool entering, double end, HitList *found)
{
    HitList none = {0};
    if (!scene->objects[object].is_mesh) return false;
    Missed missed = {.object = object, .entering = entering, .first = {.t = end}};
    query_init(&missed.query, scene, ray, &none, NULL);
    rtc_along(scene, object, missed.query.origin, missed.query.direction, ray->time, look_for_missed, &missed);
    if (!(missed.first.t < end) || (!found->capacity && !hit_list_grow(found))) return false;
    found->items[0] = missed.first;
    found->n = 1;
    return true;
}
