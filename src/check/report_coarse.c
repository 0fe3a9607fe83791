/* report_coarse.c - objects so thin, or so far from the origin, that what float keeps of coordinates there is coarse for them.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "check/report_parts.h"

/* Where two surfaces of an object are taken to be at one place along more than a few rays in a million, these lose count: by how
 * many times what coordinates tell apart it is thicker then. A ball or the like looks the same to 1e-5 where its size is 8 times
 * that (tests/truth/far_test.c, at 4e5), if no other clear object meets it. */
static const double few = 256, few_alone = 8;
/* A fine mesh that is no larger than so many of them loses details of a thousandth of its size. */
static const double few_across = 1000;
enum { FINE = 100 /* triangles */ };

/* What coordinates tell apart at the corner of a box that is farthest out. */
static double rounding_in(const Box3 *box)
{
    return rtc_rounding(
        vec3(fmax(-box->min.x, box->max.x), fmax(-box->min.y, box->max.y), fmax(-box->min.z, box->max.z)));
}

static const SceneShape *shape_of(const Scene *scene, const SceneObject *object)
{
    return object->shape == SCENE_NONE ? NULL : &scene->shapes[object->shape];
}

/* A ball or the like, and no operand. */
static bool is_exact(const Scene *scene, const SceneObject *object)
{
    const SceneShape *shape = shape_of(scene, object);
    return shape && object->part_of == SCENE_NONE && shape->solid;
}

static bool is_fine(const Scene *scene, const SceneObject *object)
{
    const SceneShape *shape = shape_of(scene, object);
    return shape && shape->mesh && shape->mesh->n_triangles >= FINE;
}

/* The objects that others meet; NULL when memory ends. */
static bool *find_meeting(const CompiledScene *compiled)
{
    bool *meets = calloc(compiled->scene->n_objects + (size_t)1, sizeof *meets);
    for (size_t i = 0; meets && i < compiled->n_pairs; i++)
        meets[compiled->pairs[i].a] = meets[compiled->pairs[i].b] = true;
    return meets;
}

static void report_one(const Scene *scene, const SceneObject *object, bool thin, double length, double rounding,
                       Diag *diag)
{
    Buf size = {0}, apart = {0};
    report_add_length(&size, scene, length);
    report_add_length(&apart, scene, rounding);
    Diagnostic *report =
        thin ? diag_report(diag, D_COARSE_PLACE, object->span,
                           "%s is %s thick where coordinates tell surfaces apart only down to %s", object->name,
                           buf_text(&size), buf_text(&apart))
             : diag_report(diag, D_COARSE_PLACE, object->span,
                           "%s is %s across where coordinates tell places apart only down to %s: what is finer is lost",
                           object->name, buf_text(&size), buf_text(&apart));
    diag_hint(diag, report, "%smove the scene, with its cameras, nearer to the origin",
              thin ? "make it thicker, or " : "");
    buf_clear(&size);
    buf_clear(&apart);
}

static bool is_coarse(const Box3 *box)
{
    return vec3_max_abs(vec3_sub(box->max, box->min)) < few_across * rounding_in(box);
}

void report_coarse_places(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    SceneShapeBox known = {0};
    uint32_t n = 0;
    bool *meets = find_meeting(compiled);
    for (uint32_t i = 0; meets && i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        uint32_t hull = compiled->hull_of_object[i];
        bool clear = hull < compiled->n_hulls;
        if (!clear && !is_fine(scene, object)) continue;
        Box3 box = clear ? compiled->hull_bounds[hull] : scene_next_box_around(scene, object, &known);
        if (!clear && is_coarse(&box)) box = scene_next_bounds(scene, object, &known);
        Vec3 sides = vec3_sub(box.max, box.min);
        double thinnest = fmin(sides.x, fmin(sides.y, sides.z)), rounding = rounding_in(&box),
               enough = (is_exact(scene, object) && !meets[i] ? few_alone : few) * rounding;
        if (!(thinnest >= 0) || !isfinite(vec3_max_abs(sides))) continue;
        bool thin = clear && thinnest > 0 && thinnest < enough, coarse = is_fine(scene, object) && is_coarse(&box);
        if ((!thin && !coarse) || ++n > REPORT_MOST) continue;
        report_one(scene, object, thin, thin ? thinnest : vec3_max_abs(sides), rounding, diag);
    }
    free(meets);
    if (n > REPORT_MOST)
        diag_report_nowhere(diag, D_COARSE_PLACE, "%u more of the same kind", (unsigned)(n - REPORT_MOST));
}
