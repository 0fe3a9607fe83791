/* ties.c - see ties.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/ties.h"

#include <stdlib.h>

#include "mesh/box_pairs.h"

/* The later wins. */
typedef enum Rank { RANK_SHEET, RANK_LAMP_FROM_BEHIND, RANK_DARK, RANK_SHINING, RANK_LAMP } Rank;

static Rank rank_of(const Scene *scene, uint32_t object, bool faces)
{
    if (scene->objects[object].light != SCENE_NONE) return faces ? RANK_LAMP : RANK_LAMP_FROM_BEHIND;
    if (scene_is_thin(scene, object)) return RANK_SHEET;
    return scene_shines(scene, object) ? RANK_SHINING : RANK_DARK;
}

bool ties_wins(const Scene *scene, uint32_t a, bool faces_a, uint32_t b, bool faces_b)
{
    Rank rank_a = rank_of(scene, a, faces_a), rank_b = rank_of(scene, b, faces_b);
    if (rank_a != rank_b) return rank_b > rank_a;
    bool plane_a = scene_is_plane(scene, a), plane_b = scene_is_plane(scene, b);
    return plane_a != plane_b ? plane_a : b > a;
}

const Hit *ties_met(const CompiledScene *compiled, const Hit *hits, size_t n)
{
    const Hit *met = NULL;
    for (size_t i = 0; i < n; i++) {
        const Hit *hit = &hits[i];
        if (compiled->hull_of_object[hit->object] != SCENE_NONE) continue;
        if (!met || ties_wins(compiled->scene, met->object, met->entering, hit->object, hit->entering)) met = hit;
    }
    return met;
}

/* ---- lamps that yield to others ---- */

typedef struct Shining {
    const Scene *scene;
    uint32_t *objects;
    Box3 *boxes; /* with what coordinates are rounded by */
    uint32_t n;
    bool *yields, any;
} Shining;

static double rounding_of(Vec3 a, Vec3 b)
{
    return rtc_rounding(a) + rtc_rounding(b);
}

/* Whether two lights that stand still may have more than a line in common, by which they face alike. */
static bool may_coincide(const SceneLight *a, const SceneLight *b)
{
    Vec3 apart = vec3_sub(a->to_world.t, b->to_world.t), up = affine_vector(&a->to_world, vec3(0, 1, 0));
    double rounding = 4 * rounding_of(a->to_world.t, b->to_world.t) + 1e-6 * (a->half_width + b->half_width);
    if (a->kind == LIGHT_SPHERE && b->kind == LIGHT_SPHERE)
        return fabs(a->half_width - b->half_width) + vec3_length(apart) <= rounding;
    if (!light_is_flat(a) || !light_is_flat(b)) return false;
    return vec3_dot(up, affine_vector(&b->to_world, vec3(0, 1, 0))) > 1 - 1e-6 &&
           fabs(vec3_dot(apart, up)) <= rounding + 2e-3 * (a->half_width + a->half_height);
}

static Status note_pair(void *context, uint32_t i, uint32_t k, Error *error)
{
    Shining *shining = context;
    const Scene *scene = shining->scene;
    uint32_t a = shining->objects[i], b = shining->objects[k];
    const SceneObject *of_a = &scene->objects[a], *of_b = &scene->objects[b];
    (void)error;
    if (of_a->light != SCENE_NONE && of_b->light != SCENE_NONE && of_a->motion == SCENE_NONE &&
        of_b->motion == SCENE_NONE && !may_coincide(&scene->lights[of_a->light], &scene->lights[of_b->light]))
        return STATUS_OK;
    shining->yields[ties_wins(scene, a, true, b, true) ? a : b] = shining->any = true;
    return STATUS_OK;
}

static Box3 box_at(const void *context, uint32_t i)
{
    return ((const Shining *)context)->boxes[i];
}

static Box3 rounded_box(Box3 box)
{
    double by = rounding_of(box.min, box.max);
    Vec3 more = vec3(by, by, by);
    return (Box3){vec3_sub(box.min, more), vec3_add(box.max, more)};
}

/* Planes are found by chance only: nobody looks for them. Looks at operands of combinations are blocked by any lamp that is there. */
static void find_shining(Shining *shining)
{
    const Scene *scene = shining->scene;
    SceneShapeBox known = {0};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        bool shines = object->light != SCENE_NONE || scene_surface_shines(scene, i);
        if (!shines || object->shape == SCENE_NONE || object->part_of != SCENE_NONE || scene_is_plane(scene, i))
            continue;
        Box3 box = scene_next_box_around(scene, object, &known);
        if (box3_is_empty(box) || box3_is_unbounded(box)) continue;
        shining->objects[shining->n] = i;
        shining->boxes[shining->n++] = rounded_box(box);
    }
}

Status ties_find_yielding(const Scene *scene, bool **yields, Error *error)
{
    size_t n = (size_t)scene->n_objects + 1;
    Shining shining = {.scene = scene,
                       .objects = malloc(n * sizeof *shining.objects),
                       .boxes = malloc(n * sizeof *shining.boxes),
                       .yields = calloc(n, sizeof *shining.yields)};
    Status status = STATUS_OK;
    if (shining.objects && shining.boxes && shining.yields) {
        find_shining(&shining);
        status = box_pairs_visit(shining.n, box_at, note_pair, &shining, error);
    } else {
        status = fail_memory(error, n * sizeof *shining.boxes, "the places of lamps");
    }
    free(shining.objects);
    free(shining.boxes);
    *yields = NULL;
    if (status == STATUS_OK && shining.any)
        *yields = shining.yields;
    else
        free(shining.yields);
    return status;
}
