/* relation_alike.c - pairs of hulls that lie to each other as another pair does: the bricks of a wall, the cubes of a grid.
 * One of them is judged along lines, and the others have its answer, unless others around it had a part in that.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/equal.h"
#include "scene/relation_parts.h"

/* How the second hull of a pair lies to the first, but for where the two are; without padding, to be compared whole. */
typedef struct Pose {
    uint32_t shapes[2];
    double turns[2][3][3];
    int64_t between[3]; /* in parts of the first one's size, far below what lines can tell */
    int64_t rounding;   /* of their places, as a power of 2 */
} Pose;

static const SceneObject *object_of(const Finder *f, uint32_t hull)
{
    return &f->compiled->scene->objects[f->compiled->object_of_hull[hull]];
}

static bool has_pose(const Finder *f, uint32_t hull)
{
    const SceneObject *object = object_of(f, hull);
    return object->shape != SCENE_NONE && object->motion == SCENE_NONE &&
           !f->compiled->scene->shapes[object->shape].mesh_end && !f->compiled->unbounded[hull];
}

static double rounding_of_pair(const Finder *f, const Candidate *candidate)
{
    const Box3 *bounds = f->compiled->hull_bounds;
    return double_max(box_rounding(bounds[candidate->a]), box_rounding(bounds[candidate->b]));
}

/* False for a pair that is like no other. */
static bool pose_of(const Finder *f, const Candidate *candidate, Pose *pose)
{
    if (!has_pose(f, candidate->a) || !has_pose(f, candidate->b)) return false;
    const SceneObject *objects[2] = {object_of(f, candidate->a), object_of(f, candidate->b)};
    memset(pose, 0, sizeof *pose);
    double size = 0;
    for (int i = 0; i < 2; i++) {
        pose->shapes[i] = objects[i]->shape;
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 3; column++) {
                pose->turns[i][row][column] = objects[i]->to_world.m[row][column] + 0.0; /* -0 is 0 */
                if (i == 0) size += fabs(objects[i]->to_world.m[row][column]);
            }
    }
    Vec3 between = vec3_sub(objects[1]->to_world.t, objects[0]->to_world.t);
    double part = 1e-9 * size * vec3_max_abs(relation_shape_size(f, candidate->a));
    const double parts[3] = {between.x / part, between.y / part, between.z / part};
    for (int axis = 0; axis < 3; axis++) {
        if (!(fabs(parts[axis]) < 1e18)) return false;
        pose->between[axis] = (int64_t)floor(parts[axis] + 0.5);
    }
    double rounding = rounding_of_pair(f, candidate);
    pose->rounding = rounding > 0 ? ilogb(rounding) : INT32_MIN;
    return true;
}

static uint32_t pose_hash(const void *context, uint32_t i)
{
    const Finder *f = context;
    Pose pose;
    uint64_t hash = pose_of(f, &f->candidates[i], &pose) ? hash_bytes(&pose, sizeof pose, 0) : hash_u64(i);
    return (uint32_t)(hash ^ hash >> 32);
}

static bool same_pose(const void *context, uint32_t i, uint32_t k)
{
    const Finder *f = context;
    Pose a, b;
    return i == k ||
           (pose_of(f, &f->candidates[i], &a) && pose_of(f, &f->candidates[k], &b) && memcmp(&a, &b, sizeof a) == 0);
}

Status relation_set_alike_aside(Finder *f, Error *error)
{
    const EqualItems items = {f, pose_hash, same_pose};
    uint32_t *first, n = (uint32_t)f->n_candidates, n_left = 0;
    free(f->alike);
    f->alike = NULL;
    f->n_alike = 0;
    if (n < 2) return STATUS_OK;
    TRY(equal_find(&items, n, "how the hulls lie", f->pool, &first, error));
    for (uint32_t i = 0; i < n; i++) f->n_alike += first[i] != i;
    f->alike = malloc((f->n_alike + 1) * sizeof *f->alike);
    size_t at = 0;
    for (uint32_t i = 0; i < n && f->alike; i++) {
        Candidate candidate = f->candidates[i];
        if (first[i] == i) {
            first[i] = n_left; /* where it goes: none asks for its first again */
            f->candidates[n_left++] = candidate;
        } else {
            first[i] = first[first[i]];
            f->alike[at++] = (AlikePair){candidate.a, candidate.b, first[i]};
        }
    }
    free(first);
    if (!f->alike) return fail_memory(error, f->n_alike * sizeof *f->alike, "how the hulls lie");
    f->n_candidates = n_left;
    return STATUS_OK;
}

/* Whether nothing but the two hulls made the answer, and nothing that rounding elsewhere could turn round. */
static bool can_be_shared(const Finder *f, const Candidate *candidate, const HullPair *pair)
{
    const PairFacts *facts[2];
    relation_facts_known(f, candidate, facts);
    for (int i = 0; i < 2; i++)
        if (facts[i] && (facts[i]->blocked || facts[i]->n_gap)) return false;
    double rounding = rounding_of_pair(f, candidate);
    if (pair->overlaps && pair->relation == NEST_PARTIAL && pair->overlap_depth < 8 * rounding) return false;
    return pair->contact_offset <= 0.25 * rounding;
}

Status relation_share(Finder *f, Error *error)
{
    size_t n_left = 0;
    for (size_t i = 0; i < f->n_alike; i++) {
        AlikePair alike = f->alike[i];
        const Candidate *leader = &f->candidates[alike.leader];
        HullPair pair = relation_judge_candidate(f, leader);
        if (!can_be_shared(f, leader, &pair)) {
            f->alike[n_left++] = alike;
        } else if (pair.overlaps || pair.touches) {
            pair.a = alike.a;
            pair.b = alike.b;
            TRY(relation_add_decided(f, &pair, error));
        }
    }
    f->n_alike = n_left;
    return STATUS_OK;
}
