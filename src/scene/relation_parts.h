/* relation_parts.h - what the files that find out how hulls lie share; private to src/scene/relation*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RELATION_PARTS_H
#define MEN_RELATION_PARTS_H

#include "scene/lines.h"
#include "scene/relations.h"
#include "shape/ball_side.h"

/* Of the smaller hull's middle extent: wider is no gap but room. */
#define RELATION_GAP_PART 0.02

/* A quantity summed over evenly spread lines. */
typedef struct Estimate {
    double sum_face, squares_face; /* of the present face */
    double sum, variance;
} Estimate;

/* What is known of one pair. `own` is the hull whose lines or bounds were used. */
typedef struct PairFacts {
    uint32_t own, other;
    bool overlaps, touches, own_out, other_out, seen;
    bool blocked;      /* a gap was not counted, because something else is in it */
    uint32_t n_inside; /* lines that meet own and find it inside of other */
    uint32_t n_gap;
    double gap;                         /* the smallest distance across, */
    double gap_most, gap_sum;           /* the largest, and the sum of all */
    uint32_t n_across;                  /* how many these are */
    double depth;                       /* the thickness of the overlap where it seems to be largest, */
    double depth_time;                  /* when, */
    Vec3 depth_place;                   /* where the middle of the stretch is that says so, */
    Vec3 depth_normal;                  /* and the direction between its faces */
    double offset;                      /* the largest distance between faces that stand at one place */
    Estimate volume, contact, gap_area; /* volume three times over, once for each direction */
    double nearest;                     /* distance along a line between the two, the least so far */
    Vec3 nearest_place;
} PairFacts;

typedef struct FactList {
    PairFacts *items;
    size_t n, capacity;
    uint32_t n_lines; /* that met the hull */
} FactList;

/* The memory of one worker. */
typedef struct Worker {
    Probe probe;
    uint32_t *fact_of; /* of each other hull: 1 + its place in the list of the present hull's facts, or 0 */
} Worker;

/* A pair whose bounds come near each other, but for two balls. */
typedef struct Candidate {
    uint32_t a, b;
    Box3 region;       /* common part of the bounds */
    bool meet;         /* there is one */
    bool region_small; /* and it is much smaller than the smaller hull: worth lines of its own */
    BallSide side;     /* of the smaller hull with the larger: BALL_NEAR for those that lines judge */
    FactList facts;    /* of the second and third stage; at most one */
    double depth;      /* of the fourth */
} Candidate;

/* What is known of a shape that pairs near each other have. */
typedef struct NearShape {
    Box3 box;      /* in its own frame */
    double radius; /* of a ball about the box's middle that holds it */
    ProfileTree profile;
    BoxTree triangles; /* once it is worth making */
    uint64_t n_asked;  /* how often it was the larger one of a pair */
} NearShape;

/* A pair that lies as a candidate does. */
typedef struct AlikePair {
    uint32_t a, b, leader; /* the candidate's place */
} AlikePair;

typedef struct Finder {
    const CompiledScene *compiled;
    Pool *pool;
    Worker *workers;
    double *radius;   /* of spheres; 0: no sphere */
    float *reach;     /* of each hull: no point near it is further from the far end of a hull around that point */
    uint32_t *judges; /* hulls with a pair that is judged along their lines, in rising order */
    uint32_t n_judges;
    uint32_t *judge_of;    /* of each hull: 1 + its place among these, or 0 */
    FactList *judge_facts; /* of each judge */
    NearShape *near_shapes;
    uint32_t n_near_shapes;
    size_t near_shapes_capacity;
    uint32_t *near_shape_of; /* of each shape: 1 + its place among these, or 0 */
    Candidate *candidates;
    size_t n_candidates, candidates_capacity;
    size_t n_sifted; /* of these: the others may still be decided without lines */
    AlikePair *alike;
    size_t n_alike;
    NestMeeting *meetings; /* hulls that are not known to be apart */
    size_t n_meetings, meetings_capacity;
    HullPair *decided; /* that meet: two balls, and pairs where one is well inside of the other, are judged at once */
    size_t n_decided, decided_capacity;
    size_t n_small_regions; /* of all two balls whose bounds come near each other */
    uint32_t lines_of_hull[2],
        lines_of_pair[2]; /* [0] balls and pairs with a ball, [1] others: bubbles are many, glasses few */
    int search_steps;
} Finder;

/* ---- boxes ---- */

/* Half the area of a box. */
static inline double half_area(Box3 box)
{
    Vec3 s = vec3_sub(box.max, box.min);
    return s.x * s.y + s.y * s.z + s.z * s.x;
}

/* The second of the three: the width of a pane, the thickness of a rod. */
static inline double middle_extent(Box3 box)
{
    Vec3 s = vec3_sub(box.max, box.min);
    return fmax(fmin(s.x, s.y), fmin(fmax(s.x, s.y), s.z));
}

/* By a length on all sides. */
static inline Box3 widened(Box3 box, double by)
{
    Vec3 margin = vec3(by, by, by);
    return (Box3){vec3_sub(box.min, margin), vec3_add(box.max, margin)};
}

/* How far off a point in the box may be, by the rounding of its coordinates. */
static inline double box_rounding(Box3 box)
{
    double largest = fmax(vec3_max_abs(box.min), vec3_max_abs(box.max));
    return rtc_rounding(vec3(largest, largest, largest));
}

/* How far beyond a hull's bounds its gaps are looked for. */
static inline double margin_of(Box3 box)
{
    return RELATION_GAP_PART * middle_extent(box) + 2 * box_rounding(box);
}

/* What is in both; min above max on an axis on which they are apart. */
static inline Box3 common(Box3 a, Box3 b)
{
    return (Box3){vec3(fmax(a.min.x, b.min.x), fmax(a.min.y, b.min.y), fmax(a.min.z, b.min.z)),
                  vec3(fmin(a.max.x, b.max.x), fmin(a.max.y, b.max.y), fmin(a.max.z, b.max.z))};
}

static inline double diagonal(Box3 box)
{
    return vec3_length(vec3_sub(box.max, box.min));
}

/* ---- ends of stretches ---- */

static inline double cosine(const Hit *hit)
{
    return hit ? fabs(hit->cos_normal) : 1;
}

static inline double rounding_of(const Hit *a, const Hit *b)
{
    return fmax(a ? a->rounding : 0, b ? b->rounding : 0);
}

/* Whether a stretch between two surfaces is more than what rounding can make or hide. */
static inline bool is_real(double length, const Hit *a, const Hit *b)
{
    return length > 0 && length * fmin(cosine(a), cosine(b)) > rounding_of(a, b);
}

/* The direction of a hit's normal along the line. */
static inline Vec3 normal_ahead(const Hit *hit)
{
    Vec3 normal = vec3_from_f(hit->normal);
    return hit->cos_normal < 0 ? vec3_scale(normal, -1) : normal;
}

/* The stretch that two intervals share. */
typedef struct Shared {
    double begin, end;
    const Hit *from, *to;
} Shared;

static inline Shared shared_of(const Interval *a, const Interval *b)
{
    bool a_last = a->begin > b->begin, a_first = a->end < b->end;
    return (Shared){a_last ? a->begin : b->begin, a_first ? a->end : b->end, a_last ? a->enter : b->enter,
                    a_first ? a->leave : b->leave};
}

/* ---- relation_line.c ---- */

/* Judges a pair on the line whose intervals are in the probe. */
void relation_judge(const CompiledScene *compiled, const Probe *probe, const Line *line, PairFacts *facts);
/* To be called after the last of n lines over a face. */
void relation_end_face(PairFacts *facts, uint32_t n);
/* The row of a list for another hull, new where there is none; NULL when memory ends, which the probe remembers. */
PairFacts *relation_facts_of(Worker *worker, FactList *list, uint32_t own, uint32_t other);
/* The only row of a list: there may be millions of such lists. NULL when memory ends. */
PairFacts *relation_only_facts(FactList *list, uint32_t own, uint32_t other);
/* Gives back the room for more: lists are as many as hulls, and most of them have one row. */
void relation_fit_facts(FactList *list);
/* For qsort and bsearch: by the other hull. */
int relation_compare_facts(const void *left, const void *right);

/* By which hulls are small or large. */
static inline double relation_extent(const Finder *f, uint32_t hull)
{
    return half_area(f->compiled->hull_bounds[hull]);
}

static inline bool relation_is_smaller(const Finder *f, uint32_t a, uint32_t b)
{
    double extent_a = relation_extent(f, a), extent_b = relation_extent(f, b);
    return extent_a != extent_b ? extent_a < extent_b : a < b;
}

/* The smaller hull of the pair first. */
static inline void relation_by_size(const Finder *f, const Candidate *candidate, uint32_t *own, uint32_t *other)
{
    bool a_first = relation_is_smaller(f, candidate->a, candidate->b);
    *own = a_first ? candidate->a : candidate->b;
    *other = a_first ? candidate->b : candidate->a;
}

/* ---- relations.c ---- */

/* What the lines said of a pair. */
HullPair relation_judge_candidate(const Finder *f, const Candidate *candidate);
/* What the lines through the smaller hull said, and those through what the two share; NULL where there were none. */
void relation_facts_known(const Finder *f, const Candidate *candidate, const PairFacts *facts[2]);

/* ---- relation_near.c ---- */

/* A new one. */
Candidate relation_candidate(const Finder *f, uint32_t a, uint32_t b);
/* Fills in radius, reach, candidates and decided. */
ATTR_NODISCARD Status relation_find_near(Finder *f, Error *error);
ATTR_NODISCARD Status relation_add_decided(Finder *f, const HullPair *pair, Error *error);
/* For qsort: by both hulls. */
int relation_compare_pairs(const void *left, const void *right);
/* The bounds of a hull with a little more than its margin around them: the boxes that lines are started from lie
 * within. */
Box3 relation_neighbourhood(const void *finder, uint32_t hull);

/* ---- relation_apart.c ---- */

/* To be called for each new candidate. */
ATTR_NODISCARD Status relation_remember_shapes(Finder *f, const Candidate *candidate, Error *error);
void relation_forget_shapes(Finder *f);
/* Of the shape of a hull that a candidate has, in its own frame. */
Vec3 relation_shape_size(const Finder *f, uint32_t hull);
/* Decides what can be decided of the candidates from n_sifted on; those left are sifted. */
ATTR_NODISCARD Status relation_sift(Finder *f, Error *error);

/* ---- relation_alike.c ---- */

/* Leaves one candidate of those that lie alike, and moves the others to alike. */
ATTR_NODISCARD Status relation_set_alike_aside(Finder *f, Error *error);
/* Gives these the answers of the candidates, which are judged, where that can be; those left are to be judged themselves. */
ATTR_NODISCARD Status relation_share(Finder *f, Error *error);

#endif
