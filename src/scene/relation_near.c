/* relation_near.c - the pairs of hulls whose bounds come near each other; two balls are judged at once.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/angle.h"
#include "base/array.h"
#include "mesh/box_pairs.h"
#include "scene/relation_parts.h"

enum { SIFTED_AT_ONCE = 1 << 16 }; /* candidates: of millions few are left to be judged along lines */

/* A hull that is a ball in the world: its radius, else 0. */
static double sphere_radius(const SceneShape *shape, const Affine *map)
{
    if (!shape->solid || shape->solid->n_pieces != 1 || shape->solid->pieces[0].kind != PIECE_SPHERE) return 0;
    return shape->solid->pieces[0].r0 * affine_even_scale(map, 1e-9);
}

static bool has_room(Box3 box)
{
    return box.min.x < box.max.x && box.min.y < box.max.y && box.min.z < box.max.z;
}

static bool come_near(const Box3 *a, const Box3 *b, double margin)
{
    return a->min.x - b->max.x < margin && b->min.x - a->max.x < margin && a->min.y - b->max.y < margin &&
           b->min.y - a->max.y < margin && a->min.z - b->max.z < margin && b->min.z - a->max.z < margin;
}

/* Of a ball. */
static Vec3 centre_of(const Finder *f, uint32_t hull)
{
    return f->compiled->scene->objects[f->compiled->object_of_hull[hull]].to_world.t;
}

/* Two balls, by formula. */
static HullPair judge_spheres(const Finder *f, uint32_t a, uint32_t b)
{
    HullPair pair = {.a = a, .b = b, .gap = HUGE_VAL};
    double small = fmin(f->radius[a], f->radius[b]), large = fmax(f->radius[a], f->radius[b]);
    Vec3 centre_a = centre_of(f, a), centre_b = centre_of(f, b);
    double d = vec3_length(vec3_sub(centre_a, centre_b));
    double rounding = fmax(rtc_rounding(centre_a), rtc_rounding(centre_b));
    rounding = fmax(rounding, rtc_rounding(vec3(large, large, large)));
    bool a_small = f->radius[a] < f->radius[b];
    pair.touches = fabs(d - (small + large)) <= rounding || fabs(d + small - large) <= rounding;
    pair.overlaps = d < small + large - rounding;
    if (d <= rounding && large - small <= rounding) pair.contact_area = 4 * MEN_PI * small * small;
    if (!pair.overlaps) return pair;
    if (d + small <= large + rounding) {
        pair.relation = small == large ? NEST_PARTIAL : a_small ? NEST_A_IN_B : NEST_B_IN_A;
        pair.overlap_volume = 4 * MEN_PI / 3 * small * small * small;
    } else { /* a lens of two caps */
        double depth = small + large - d;
        pair.overlap_depth = depth;
        pair.overlap_volume = MEN_PI * depth * depth *
                              (d * d + 2 * d * (small + large) - 3 * (large - small) * (large - small)) / (12 * d);
    }
    return pair;
}

Box3 relation_neighbourhood(const void *context, uint32_t hull)
{
    const Finder *f = context;
    Box3 box = f->compiled->hull_bounds[hull];
    return box3_is_empty(box) ? box : widened(box, 1.001 * margin_of(box) + 2 * box_rounding(box));
}

static void note_reach(Finder *f, uint32_t a, uint32_t b)
{
    float length = (float)(1.001 * diagonal(box3_union(relation_neighbourhood(f, a), relation_neighbourhood(f, b))));
    f->reach[a] = fmaxf(f->reach[a], length);
    f->reach[b] = fmaxf(f->reach[b], length);
}

Status relation_add_decided(Finder *f, const HullPair *pair, Error *error)
{
    if (!ARRAY_ROOM(f->decided, f->decided_capacity, f->n_decided))
        return fail_memory(error, f->n_decided * sizeof *f->decided, "pairs of hulls");
    f->decided[f->n_decided++] = *pair;
    return STATUS_OK;
}

Candidate relation_candidate(const Finder *f, uint32_t a, uint32_t b)
{
    Box3 box_a = f->compiled->hull_bounds[a], box_b = f->compiled->hull_bounds[b];
    double rounding = fmax(box_rounding(box_a), box_rounding(box_b));
    Candidate candidate = {.a = a, .b = b, .region = common(widened(box_a, rounding), widened(box_b, rounding))};
    candidate.meet = has_room(candidate.region);
    candidate.region_small =
        candidate.meet && half_area(candidate.region) < 0.6 * fmin(half_area(box_a), half_area(box_b));
    return candidate;
}

static bool moves(const Finder *f, uint32_t hull)
{
    return f->compiled->scene->objects[f->compiled->object_of_hull[hull]].motion != SCENE_NONE;
}

static Status add_meeting(Finder *f, uint32_t a, uint32_t b, Error *error)
{
    if (!ARRAY_ROOM(f->meetings, f->meetings_capacity, f->n_meetings))
        return fail_memory(error, f->n_meetings * sizeof *f->meetings, "pairs of hulls");
    f->meetings[f->n_meetings++] = (NestMeeting){a, b};
    return STATUS_OK;
}

/* Of all but two balls: those that no plane or ball has kept apart. */
static Status add_meetings(Finder *f, Error *error)
{
    for (size_t i = 0; i < f->n_decided; i++) {
        const HullPair *pair = &f->decided[i];
        if (!(f->radius[pair->a] > 0 && f->radius[pair->b] > 0)) TRY(add_meeting(f, pair->a, pair->b, error));
    }
    for (size_t i = 0; i < f->n_candidates; i++)
        if (f->candidates[i].meet) TRY(add_meeting(f, f->candidates[i].a, f->candidates[i].b, error));
    return STATUS_OK;
}

/* Pairs whose bounds come near enough for a gap; only where the bounds meet can there be more than that. */
static Status add_candidate(void *context, uint32_t a, uint32_t b, Error *error)
{
    Finder *f = context;
    Box3 box_a = f->compiled->hull_bounds[a], box_b = f->compiled->hull_bounds[b];
    note_reach(f, a, b);
    if (!come_near(&box_a, &box_b, 2 * fmin(margin_of(box_a), margin_of(box_b)))) return STATUS_OK;
    Candidate candidate = relation_candidate(f, a, b);
    if (f->radius[a] > 0 && f->radius[b] > 0) {
        HullPair pair = judge_spheres(f, a, b);
        f->n_small_regions += candidate.region_small;
        /* where balls that move are at first says nothing of where they come */
        if (candidate.meet && (pair.overlaps || pair.touches || moves(f, a) || moves(f, b)))
            TRY(add_meeting(f, a, b, error));
        return pair.overlaps || pair.touches ? relation_add_decided(f, &pair, error) : STATUS_OK;
    }
    if (!ARRAY_ROOM(f->candidates, f->candidates_capacity, f->n_candidates))
        return fail_memory(error, f->n_candidates * sizeof *f->candidates, "pairs of hulls");
    f->candidates[f->n_candidates++] = candidate;
    TRY(relation_remember_shapes(f, &candidate, error));
    return f->n_candidates - f->n_sifted < SIFTED_AT_ONCE ? STATUS_OK : relation_sift(f, error);
}

static int compare_numbers(uint32_t a, uint32_t b, uint32_t other_a, uint32_t other_b)
{
    if (a != other_a) return a < other_a ? -1 : 1;
    return b < other_b ? -1 : b > other_b;
}

static int compare_candidates(const void *left, const void *right)
{
    const Candidate *a = left, *b = right;
    return compare_numbers(a->a, a->b, b->a, b->b);
}

int relation_compare_pairs(const void *left, const void *right)
{
    const HullPair *a = left, *b = right;
    return compare_numbers(a->a, a->b, b->a, b->b);
}

Status relation_find_near(Finder *f, Error *error)
{
    const CompiledScene *compiled = f->compiled;
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        const SceneObject *object = &compiled->scene->objects[compiled->object_of_hull[h]];
        if (object->shape == SCENE_NONE) continue; /* a combination */
        f->radius[h] = sphere_radius(&compiled->scene->shapes[object->shape], &object->to_world);
    }
    TRY(box_pairs_visit(f->compiled->n_hulls, relation_neighbourhood, add_candidate, f, error));
    TRY(relation_sift(f, error));
    TRY(add_meetings(f, error));
    if (f->n_candidates) qsort(f->candidates, f->n_candidates, sizeof *f->candidates, compare_candidates);
    if (f->n_candidates > UINT32_MAX) return fail(error, STATUS_NOMEM, "too many pairs of hulls");
    return STATUS_OK;
}
