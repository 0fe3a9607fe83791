/* between_planes.c - where a combination of planes ends, though none of these does.
 *
 * Planes that became one body (build_convex.c) are no planes any more. Those that stay, as they may move or have surfaces of
 * their own, leave as much of space, and its end is to be the same: an object without end gives way to all others.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/between_planes.h"

#include <stdlib.h>

#include "mesh/half_spaces.h"

static const Box3 everywhere = {{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};

/* Planes move as one where their places as seen from the first stay the same but for this, of their size. */
#define STAYS 1e-9

/* A plane, or what is beyond it. */
typedef struct Side {
    uint32_t object;
    bool beyond;
} Side;

typedef struct Sides {
    const Scene *scene;
    const Affine *after;
    Side *items; /* NULL: they are only counted */
    uint32_t n;
} Sides;

static void add_side(Sides *sides, const NestPart *part, bool beyond)
{
    uint32_t object = sides->scene->operands[part->begin];
    if (!scene_is_plane(sides->scene, object)) return;
    if (sides->items) sides->items[sides->n] = (Side){object, beyond};
    sides->n++;
}

/* Those that all of the part is on one side of; `beyond`: that all but the part is. */
static void list_sides(Sides *sides, uint32_t number, bool beyond)
{
    const NestPart *part = &sides->scene->parts[number];
    const NestOperation all_of = beyond ? NEST_UNION : NEST_INTERSECTION;
    if (part->operation == NEST_OPERAND) {
        add_side(sides, part, beyond);
    } else if (part->operation == all_of || part->n_children == 1) {
        for (uint32_t i = 0; i < part->n_children; i++) list_sides(sides, part->first_child + i, beyond);
    } else if (part->operation == NEST_DIFFERENCE && !beyond) {
        for (uint32_t i = 0; i < part->n_children; i++) list_sides(sides, part->first_child + i, i > 0);
    }
}

static const Affine *place_of(const Sides *sides, uint32_t i, uint32_t key)
{
    const SceneObject *object = &sides->scene->objects[sides->items[i].object];
    const Affine *keys = scene_keys(sides->scene, object);
    return keys ? &keys[key] : &object->to_world;
}

static bool any_moves(const Sides *sides)
{
    for (uint32_t i = 0; i < sides->n; i++)
        if (scene_keys(sides->scene, &sides->scene->objects[sides->items[i].object])) return true;
    return false;
}

static bool is_near(const Affine *a, const Affine *b)
{
    double most = fmax(vec3_max_abs(a->t), 1), apart = vec3_max_abs(vec3_sub(a->t, b->t));
    for (int i = 0; i < 9; i++) {
        most = fmax(most, fabs(a->m[i / 3][i % 3]));
        apart = fmax(apart, fabs(a->m[i / 3][i % 3] - b->m[i / 3][i % 3]));
    }
    return apart <= STAYS * most;
}

/* Whether at this key each is where it was at first, as seen from the first of them: between keys, too, each point of what they
 * leave then goes straight on. */
static bool are_together(const Sides *sides, uint32_t key)
{
    Affine at_first, now;
    if (!affine_invert(place_of(sides, 0, 0), &at_first) || !affine_invert(place_of(sides, 0, key), &now)) return false;
    for (uint32_t i = 1; i < sides->n; i++) {
        Affine was = affine_compose(&at_first, place_of(sides, i, 0)),
               is = affine_compose(&now, place_of(sides, i, key));
        if (!is_near(&was, &is)) return false;
    }
    return true;
}

/* Around what they leave at a key. */
static Box3 box_at(const Sides *sides, HalfSpace *spaces, uint32_t key)
{
    Box3 box;
    for (uint32_t i = 0; i < sides->n; i++) {
        const Affine *place = place_of(sides, i, key);
        Affine map = sides->after ? affine_compose(sides->after, place) : *place;
        spaces[i] = half_space_moved(&map, (HalfSpace){vec3(0, 1, 0), 0});
        if (sides->items[i].beyond) spaces[i] = (HalfSpace){vec3_scale(spaces[i].normal, -1), -spaces[i].distance};
    }
    return half_spaces_box(spaces, sides->n, &box) ? box : everywhere;
}

Box3 between_planes(const Scene *scene, uint32_t part, const Affine *after)
{
    Sides sides = {.scene = scene, .after = after};
    list_sides(&sides, part, false);
    uint32_t n = sides.n;
    if (n < 2 || n > HALF_SPACES_MOST) return everywhere;
    HalfSpace *spaces = malloc(n * sizeof *spaces);
    sides.items = malloc(n * sizeof *sides.items);
    Box3 box = everywhere;
    if (spaces && sides.items) {
        sides.n = 0;
        list_sides(&sides, part, false);
        uint32_t n_keys = any_moves(&sides) ? scene->n_keys : 1;
        box = box_at(&sides, spaces, 0);
        for (uint32_t k = 1; k < n_keys; k++)
            box = are_together(&sides, k) ? box3_union(box, box_at(&sides, spaces, k)) : everywhere;
    }
    free(spaces);
    free(sides.items);
    return box;
}
