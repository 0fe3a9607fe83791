/* rtc_query.h - a search along one ray, while it goes on; private to rtc.c and rtc_hit.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RTC_QUERY_H
#define MEN_RTC_QUERY_H

#include "geom/rtc_scene.h"

/* A float has 24 bits. Coordinates are trusted to 4 units in the last place; Embree's distances to 16,
 * divided by the cosine; the start is moved back by 2,048, for surfaces near it that are grazed: what is nearer to the start along
 * its normal than coordinates are trusted stands at one place with it. */
#define UNIT_ROUNDING 0x1p-23
#define TRUSTED_ULPS (RTC_ROUNDING / UNIT_ROUNDING)
#define EMBREE_NOISE 0x1p-20
#define START_BACK 0x1p-12
/* Rays are from afar that start so many times as far away as RtcScene.piece_reach. */
#define RTC_AFAR 2
/* What double precision makes of a point on a surface. */
#define DOUBLE_NOISE 0x1p-42

/* What double makes of a place on an edge, of what float does. */
#define EDGE_ROUNDING 0x1p-18

/* Below this cosine the window for surfaces at one place grows no further. */
#define RTC_LEAST_COSINE 1e-4

/* The ray in the frame of an object with pieces; those of one solid, and of solids in each other, come in a row. */
typedef struct LocalRay {
    uint32_t frame; /* the object's; RTC_NO_OBJECT: none yet */
    PieceLine line;
    const Affine *to_local; /* NULL where the object is only moved and made larger evenly; the object's own, or */
    Affine moved_to_local;
} LocalRay;

/* A ray that leaves a lone object at less than this cosine is searched for as others are. */
#define RTC_LONE_COSINE 0x1p-4

/* How many hollow pieces of one search are met with all their eighths at once. */
enum { RTC_WHOLE = 16 };

typedef struct Query {
    EmbreeContext context; /* first: Embree hands it back by this address */
    const RtcScene *scene;
    const Ray *ray;
    Vec3 origin, direction;
    double back;         /* how far Embree's ray starts behind the true one; from far away < 0: in front of it, */
    const Vec3 *nudge;   /* and how far beside it */
    double unseen;       /* from afar: pieces nearer to the world's origin than this may not be seen; see rtc_afar.c */
    double scale;        /* coordinates of start and scene, for what double rounds */
    double start_scale;  /* and of start and triangles near it, for what float does, */
    double coarse_scale; /* of start and all triangles; */
    double fine_within;  /* so far along the ray it is worth while to ask which triangles are near */
    double t_min;        /* the ray's, or what has been found to be no more than repetitions of the start */
    double pieces_from;  /* the same, or less, where pieces are asked whether the ray starts right behind them */
    double reach;        /* nearest query: candidates beyond do not matter any more, */
    double doubt;        /* and how far what is found there may be off */
    double least_window; /* nearest query, exact: chains are followed at least that far */
    bool all, stop_at_opaque, blocked;
    bool exact; /* nearest query: every candidate is computed exactly as soon as it is found */
    HitList *hits, *passed;
    bool passes;        /* nearest query: the ray passes by some objects */
    bool hides;         /* nearest query: some objects are not there for it */
    bool unsure;        /* the start, or a hit, is within rounding of a triangle's edge */
    uint32_t all_along; /* the object whose triangles along the line have all been taken last; RTC_NO_OBJECT */
    LocalRay local;
    /* by the last digits of a piece's place in RtcScene.pieces: of which piece all crossings have been taken, whichever eighth
     * they are in; RTC_NO_OBJECT: of none */
    uint32_t whole[RTC_WHOLE];
} Query;

/* Whether the ray passes by an object. */
static inline bool rtc_passes(const Query *query, uint32_t object)
{
    if (LIKELY(!query->passes)) return false;
    const RtcPlaced *placed = &query->scene->objects[object];
    if (placed->pass_level <= query->ray->pass_level) return placed->pass_level < query->ray->pass_level;
    return placed->pass_alike == query->ray->pass_alike && placed->pass_alike != RTC_NO_PASS;
}
/* Whether two surfaces, b not in front of a, stand at one place: nearer to each other along the normal than coordinates can
 * tell. Along the steeper normal, so that different surfaces are kept apart; along the flatter one for the two sides of one
 * object's edge, which the ray clips or misses within rounding. Both sides are met in double, and no more than that rounds what is
 * between them: else far from the origin, where floats are coarse, the edges of objects could not be seen. */
static inline bool rtc_together(const Hit *a, const Hit *b)
{
    double flat = double_min(fabs(a->cos_normal), fabs(b->cos_normal)),
           steep = double_max(fabs(a->cos_normal), fabs(b->cos_normal));
    bool edge = a->object == b->object && a->entering != b->entering;
    double rounding = double_max(a->rounding, b->rounding);
    if (UNLIKELY(edge)) {
        steep = double_max(flat, RTC_LEAST_COSINE);
        rounding *= EDGE_ROUNDING;
    }
    return (b->t - a->t) * steep <= rounding;
}
/* By distance, then by number, so that the order does not depend on Embree's. */
void rtc_sort_hits(HitList *hits);
/* A place behind the last hit of a list; NULL when memory ends. The caller counts it. */
Hit *rtc_hit_place(HitList *list);
/* Completes the hits of a list up to there that were put off, leaves out those that are none, and sorts the rest.
 * False when there was one that is none. */
bool rtc_complete_hits(Query *query, HitList *hits, double end);
/* Parts the n hits at the nearest place from what was passed by before it, when those may stand at that place, too; returns
 * how many hits are there then. */
size_t rtc_part_passed(Query *query, size_t n);
/* Takes repetitions of the ray's start (see rtc.c) out of hits in increasing t; returns how many are left. */
size_t rtc_drop_repeats(const Ray *ray, Hit *hits, size_t n);

/* The coordinate that a large triangle's plane is as coarse as, across: a floor of kilometres whose corners are all at one height
 * stands at that height, and what is a millimetre above it is not at one place with it. What a mesh was rounded to before it was
 * placed counts, too. corner: rtc_triangle's; normal: unit. INFINITY: not known. */
double rtc_coordinate_across(const RtcPlaced *object, uint32_t primitive, const Vec3 corner[3], Vec3 normal);
/* The ray in an object's frame, where it is not there yet. */
void rtc_enter_frame(Query *query, const RtcPlaced *object);
static inline void rtc_need_frame(Query *query, const RtcPlaced *object)
{
    if (query->local.frame != object->frame) rtc_enter_frame(query, object);
}
/* RtcMaps.rounding of a frame that moves, whose maps Embree makes for each ray. */
#define RTC_MOVING_ROUNDING 8
/* The coordinates that Embree rounds where a triangle of an object is met at t; largest: its own. */
static inline double rtc_rounded_scale(const Query *query, const RtcPlaced *object, double largest, double t)
{
    double scale = double_max(query->start_scale, largest) + fabs(t);
    if (LIKELY(object->mesh->baked)) return scale;
    /* an instance is traced in its own frame: what goes into it and back is rounded, too */
    double times = object->moves ? RTC_MOVING_ROUNDING : object->mapped ? object->maps->rounding : 1;
    return times * (scale + vec3_max_abs(object->place));
}
/* How far along a ray double may take its start to be off; scale: the largest coordinate of its start and of the scene. */
static inline double rtc_start_noise(double scale, const Ray *ray)
{
    return DOUBLE_NOISE * double_max(scale, ray->start_scale);
}
/* Whether the ray starts on that primitive: NULL, or where it was hit. */
static inline const Hit *rtc_find_left(const Ray *ray, uint32_t object, uint32_t primitive)
{
    const Hit *left = ray->left;
    if (LIKELY(ray->n_left <= 1)) /* nearly always */
        return ray->n_left && left->primitive == primitive && left->object == object ? left : NULL;
    for (size_t i = 0; i < ray->n_left; i++)
        if (left[i].object == object && left[i].primitive == primitive) return &left[i];
    return NULL;
}
static inline bool rtc_starts_on(const Ray *ray, uint32_t object)
{
    for (size_t i = 0; i < ray->n_left; i++)
        if (ray->left[i].object == object) return true;
    return false;
}
/* Computes in double what a candidate is: hit has object and primitive, u and v of a triangle, t of a piece. False when
 * it is not met between t_min and t_max, or is where the ray starts. */
bool rtc_complete_hit(Query *query, Hit *hit);

/* Whether nothing reaches into an object of which that is not known yet. */
bool rtc_find_lone(const RtcScene *scene, uint32_t object);
static inline bool rtc_is_lone(const RtcScene *scene, uint32_t object)
{
    unsigned char lone = atomic_load_explicit(&scene->objects[object].lone, memory_order_acquire);
    return UNLIKELY(lone == RTC_PERHAPS_LONE) ? rtc_find_lone(scene, object) : lone == RTC_LONE;
}

/* A ray from within a lone mesh: its way out becomes the one hit. False where that is not clear. */
bool rtc_cross_lone_mesh(Query *query, uint32_t object);

/* Whether the ray's line goes through a triangle, and the corners' weights there, up to a common factor. One of
 * neighbours that share an edge is met, or both, or none. */
bool rtc_line_meets(const Query *query, const Vec3 corner[3], double weight[3]);
/* How near 0 such a weight is at most where Embree may say that the line passes an edge on the other side. scale: the
 * coordinates that Embree rounds. */
double rtc_edge_noise(const Query *query, Vec3 edge, double scale);
/* Whether it goes through the triangle of a hit, and so far from the edges that Embree's line meets it, too. */
bool rtc_line_is_clear(const Query *query, const Hit *hit, double scale);
/* A ray from afar: where Embree's starts, and what is not seen from there. */
void rtc_start_from_afar(Query *query);
/* The next place from which it is to be shown to Embree, as far as the one after that, at `end`. False where it has been shown
 * from near enough. */
bool rtc_next_start(Query *query, double *end);

/* Where a query is unsure, Embree's float ray may have met other triangles than the exact ray does, or missed some. Looks about
 * the place of a hit, as far as the triangle's edges are that it is near to, and as the hit is outside of them: notes the
 * others that the exact ray meets. */
void rtc_look_at(Query *query, const Hit *hit);
/* The same about the start and all hits; takes out those that the exact ray misses. Their order is lost. */
void rtc_look_closer(Query *query);
/* Whether the exact ray meets the triangle of a hit. */
bool rtc_meets(const Query *query, const Hit *hit);
bool rtc_has_hit(const HitList *list, uint32_t object, uint32_t primitive);
/* Nearest query: no surface matters that is farther behind this one than what stands at one place with it. */
void rtc_shorten(Query *query, const Hit *hit);

#endif
