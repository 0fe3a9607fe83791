/* combination_alike.c - combinations that are the same but for an affine map. Instances of one prototype are; so are those
 * that a loop makes anew each time, as equal shapes are one. Operands are compared where they are in the frame of the first
 * one, in steps so coarse that rounding is lost in them, and so fine that nothing else is.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/combination_alike.h"

#include <stdlib.h>
#include <string.h>

#include "mesh/equal.h"

enum { STEP_BITS = 30 }; /* a step is about 1e-9 of the reach */

/* A combination's own frame, that of its first operand when the shutter opens. */
typedef struct Frame {
    Affine from_world;
    double reach; /* of the operands that have an end, from the frame's origin */
    double step;  /* places less than this apart are one */
    bool lone;    /* it is like no other */
} Frame;

typedef struct Alike {
    const Scene *scene;
    const uint32_t *trees;
    Frame *frames; /* of each */
    Box3 *boxes;   /* of the shapes of operands */
} Alike;

/* How an operand lies in the frame; without padding, to be compared whole. */
typedef struct Lie {
    uint64_t shape;
    int64_t turn[3][3], place[3]; /* in steps */
} Lie;

static uint32_t n_keys(const Scene *scene)
{
    return scene->n_keys ? scene->n_keys : 1;
}

static const NestPart *root_of(const Alike *alike, uint32_t tree)
{
    return &alike->scene->parts[alike->scene->trees[tree].root];
}

static const SceneObject *operand_of(const Alike *alike, uint32_t number)
{
    return &alike->scene->objects[alike->scene->operands[number]];
}

/* A power of 2 near x, the same for what differs by rounding: so it must not change at round numbers, which lengths often
 * are. Where it changes after all, two are measured that could have been one. */
static double power_near(double x)
{
    const double off_round = 1.2345;
    return ldexp(1, ilogb(off_round * x));
}

static double reach_of_box(Box3 box)
{
    return double_max(vec3_max_abs(box.min), vec3_max_abs(box.max));
}

/* In steps; false for what has no such number. */
static bool in_steps(double x, double step, int64_t *number)
{
    double steps = floor(x / step + 0.5);
    if (!(fabs(steps) < 1e18)) return false;
    *number = (int64_t)steps;
    return true;
}

/* Turning by a step moves no place of the operand by more than a step: of one without end, no place near the others. */
static bool lie_of(const Alike *alike, const Frame *frame, const Affine *from_world, const SceneObject *operand,
                   uint32_t key, Lie *lie)
{
    Affine map = affine_compose(from_world, combination_place(alike->scene, operand, key));
    Box3 box = alike->boxes[operand->shape];
    double reach = box3_is_unbounded(box) ? frame->reach + vec3_max_abs(map.t) : reach_of_box(box);
    if (!(reach > 0) || !isfinite(reach)) return false;
    double turn = frame->step / power_near(reach);
    lie->shape = operand->shape;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            if (!in_steps(map.m[row][column], turn, &lie->turn[row][column])) return false;
    return in_steps(map.t.x, frame->step, &lie->place[0]) && in_steps(map.t.y, frame->step, &lie->place[1]) &&
           in_steps(map.t.z, frame->step, &lie->place[2]);
}

/* Whether the shutter finds all operands where they are to each other when it opens, and does not see them turned inside
 * out, with which the mean volume would not be as combination_scale says. */
static bool moves_as_one(const Alike *alike, uint32_t tree, const Frame *frame)
{
    const Scene *scene = alike->scene;
    const NestPart *root = root_of(alike, tree);
    const SceneObject *first = combination_first_operand(scene, tree);
    const bool mirrors = affine_determinant(combination_place(scene, first, 0)) < 0;
    for (uint32_t key = 1; key < n_keys(scene); key++) {
        const Affine *place = combination_place(scene, first, key);
        const Affine pair[2] = {*combination_place(scene, first, key - 1), *place};
        const Affine halfway = affine_between(pair, 2, 0.5);
        Affine from_world;
        if ((affine_determinant(place) < 0) != mirrors || (affine_determinant(&halfway) < 0) != mirrors) return false;
        if (!affine_invert(place, &from_world)) return false;
        for (uint32_t i = root->begin; i < root->end; i++) {
            Lie opening, then;
            if (!lie_of(alike, frame, &frame->from_world, operand_of(alike, i), 0, &opening)) return false;
            if (!lie_of(alike, frame, &from_world, operand_of(alike, i), key, &then)) return false;
            if (memcmp(&opening, &then, sizeof opening) != 0) return false;
        }
    }
    return true;
}

/* Whether rounding of places in the world, as lines find them, is not far below the least size of the operands there: what is
 * measured of these is no good for others. */
static bool is_coarse(const Affine *place, double reach)
{
    const double many = 65536;
    double stretch = affine_largest_stretch(place);
    double least_stretch = fabs(affine_determinant(place)) / (stretch * stretch); /* or more */
    return !(vec3_max_abs(place->t) + stretch * reach < many * least_stretch * reach);
}

static Frame frame_of(const Alike *alike, uint32_t tree)
{
    const Scene *scene = alike->scene;
    const NestPart *root = root_of(alike, tree);
    Frame frame = {.lone = true};
    if (root->begin == root->end ||
        !affine_invert(combination_place(scene, combination_first_operand(scene, tree), 0), &frame.from_world))
        return frame;
    bool moves = false;
    for (uint32_t i = root->begin; i < root->end; i++) {
        const SceneObject *operand = operand_of(alike, i);
        if (operand->shape == SCENE_NONE || scene->shapes[operand->shape].mesh_end) return frame;
        moves = moves || operand->motion != SCENE_NONE;
        Box3 box = alike->boxes[operand->shape];
        if (box3_is_empty(box) || box3_is_unbounded(box)) continue;
        Affine map = affine_compose(&frame.from_world, combination_place(scene, operand, 0));
        frame.reach = double_max(frame.reach, reach_of_box(affine_box(&map, box)));
    }
    if (!(frame.reach > 0) || !isfinite(frame.reach)) return frame;
    if (is_coarse(combination_place(scene, combination_first_operand(scene, tree), 0), frame.reach)) return frame;
    frame.step = ldexp(power_near(frame.reach), -STEP_BITS);
    bool has_place = true;
    Lie lie;
    for (uint32_t i = root->begin; has_place && i < root->end; i++)
        has_place = lie_of(alike, &frame, &frame.from_world, operand_of(alike, i), 0, &lie);
    frame.lone = !has_place || (moves && !moves_as_one(alike, tree, &frame));
    return frame;
}

static uint64_t hash_part(const Alike *alike, const Frame *frame, const NestPart *part, uint64_t hash)
{
    hash = hash_u64(hash ^ ((uint64_t)part->n_children << 32 | (uint64_t)part->operation));
    Lie lie;
    if (part->operation == NEST_OPERAND &&
        lie_of(alike, frame, &frame->from_world, operand_of(alike, part->begin), 0, &lie))
        hash = hash_bytes(&lie, sizeof lie, hash);
    for (uint32_t i = 0; i < part->n_children; i++)
        hash = hash_part(alike, frame, &alike->scene->parts[part->first_child + i], hash);
    return hash;
}

static uint32_t hash_tree(const void *context, uint32_t i)
{
    const Alike *alike = context;
    const Frame *frame = &alike->frames[i];
    uint64_t hash = frame->lone ? hash_u64(i) : hash_part(alike, frame, root_of(alike, alike->trees[i]), 0);
    return (uint32_t)(hash ^ hash >> 32);
}

static bool same_part(const Alike *alike, const Frame *const frames[2], const NestPart *a, const NestPart *b)
{
    const NestPart *parts = alike->scene->parts;
    if (a->operation != b->operation || a->n_children != b->n_children || a->end - a->begin != b->end - b->begin)
        return false;
    if (a->operation == NEST_OPERAND) {
        Lie lies[2];
        return lie_of(alike, frames[0], &frames[0]->from_world, operand_of(alike, a->begin), 0, &lies[0]) &&
               lie_of(alike, frames[1], &frames[1]->from_world, operand_of(alike, b->begin), 0, &lies[1]) &&
               memcmp(&lies[0], &lies[1], sizeof lies[0]) == 0;
    }
    for (uint32_t i = 0; i < a->n_children; i++)
        if (!same_part(alike, frames, &parts[a->first_child + i], &parts[b->first_child + i])) return false;
    return true;
}

static bool same_tree(const void *context, uint32_t i, uint32_t k)
{
    const Alike *alike = context;
    const Frame *const frames[2] = {&alike->frames[i], &alike->frames[k]};
    if (i == k) return true;
    return !frames[0]->lone && !frames[1]->lone &&
           same_part(alike, frames, root_of(alike, alike->trees[i]), root_of(alike, alike->trees[k]));
}

/* The boxes of the shapes that the trees use: of a mesh, each is a look at all its vertices. */
static void find_boxes(const Alike *alike, uint32_t n)
{
    const Scene *scene = alike->scene;
    for (uint32_t i = 0; i < scene->n_shapes; i++) alike->boxes[i] = box3_empty();
    for (uint32_t t = 0; t < n; t++) {
        const NestPart *root = root_of(alike, alike->trees[t]);
        for (uint32_t i = root->begin; i < root->end; i++) {
            uint32_t shape = operand_of(alike, i)->shape;
            if (shape != SCENE_NONE && box3_is_empty(alike->boxes[shape]))
                alike->boxes[shape] = scene_shape_bounds(&scene->shapes[shape]);
        }
    }
}

Status combination_find_alike(const Scene *scene, const uint32_t *trees, uint32_t n, Pool *pool, uint32_t **first,
                              Error *error)
{
    static const char what[] = "the volumes of combinations";
    Alike alike = {.scene = scene,
                   .trees = trees,
                   .frames = malloc((n + (size_t)1) * sizeof *alike.frames),
                   .boxes = malloc((scene->n_shapes + (size_t)1) * sizeof *alike.boxes)};
    *first = NULL;
    Status status = STATUS_OK;
    if (alike.frames && alike.boxes) {
        find_boxes(&alike, n);
        for (uint32_t i = 0; i < n; i++) alike.frames[i] = frame_of(&alike, trees[i]);
        const EqualItems items = {&alike, hash_tree, same_tree};
        status = equal_find(&items, n, what, pool, first, error);
    } else {
        status = fail_memory(error, n * sizeof *alike.frames + scene->n_shapes * sizeof *alike.boxes, what);
    }
    free(alike.frames);
    free(alike.boxes);
    return status;
}

/* Between two keys a map's numbers change evenly, and the determinant is a cubic: Simpson's rule has its mean. */
double combination_scale(const Scene *scene, uint32_t tree)
{
    const SceneObject *first = combination_first_operand(scene, tree);
    const Affine *keys = scene_keys(scene, first);
    if (!keys) return fabs(affine_determinant(&first->to_world));
    double sum = 0;
    for (uint32_t k = 0; k + 1 < scene->n_keys; k++) {
        const Affine halfway = affine_between(&keys[k], 2, 0.5);
        sum += affine_determinant(&keys[k]) + 4 * affine_determinant(&halfway) + affine_determinant(&keys[k + 1]);
    }
    return fabs(sum) / (6.0 * (scene->n_keys - 1));
}
