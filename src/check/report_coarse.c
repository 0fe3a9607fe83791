/* report_coarse.c - objects so thin, or so far from the origin, that what float keeps of coordinates there is coarse for them.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "check/report_parts.h"

/* By how many times what coordinates tell apart something is to be thicker. Stacks of sheets and water, 8 times as thick as that, lose
 * count once in ten million crossings, and what no other clear object meets does not then; thinner, two of its surfaces are taken to
 * be at one place. A ball of that size looks the same to 1e-5 (tests/truth/far_test.c, at 4e5). */
static const double few = 32, few_alone = 8;
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

typedef struct CoarseObject {
    bool thin; /* else it is a mesh whose details are lost */
    double length, rounding;
    uint32_t n; /* how many of one place of the scene's text are */
} CoarseObject;

static void report_one(const Scene *scene, const SceneObject *object, const CoarseObject *coarse, Diag *diag)
{
    Buf size = {0}, apart = {0}, what = {0};
    report_add_length(&size, scene, coarse->length);
    report_add_length(&apart, scene, coarse->rounding);
    buf_add(&what, object->name);
    if (coarse->n > 1) buf_format(&what, ", like %u more,", (unsigned)coarse->n - 1);
    Diagnostic *report =
        coarse->thin
            ? diag_report(diag, D_COARSE_PLACE, object->span,
                          "%s is %s thick where coordinates tell surfaces apart only down to %s", buf_text(&what),
                          buf_text(&size), buf_text(&apart))
            : diag_report(diag, D_COARSE_PLACE, object->span,
                          "%s is %s across where coordinates tell places apart only down to %s: what is finer is lost",
                          buf_text(&what), buf_text(&size), buf_text(&apart));
    diag_hint(diag, report, "%smove the scene, with its cameras, nearer to the origin",
              coarse->thin ? "make it thicker, or " : "");
    buf_clear(&size);
    buf_clear(&apart);
    buf_clear(&what);
}

static bool is_coarse(const Box3 *box)
{
    return vec3_max_abs(vec3_sub(box->max, box->min)) < few_across * rounding_in(box);
}

static bool judge(const CompiledScene *compiled, uint32_t number, bool meets, SceneShapeBox *known, CoarseObject *found)
{
    const Scene *scene = compiled->scene;
    const SceneObject *object = &scene->objects[number];
    uint32_t hull = compiled->hull_of_object[number];
    bool clear = hull < compiled->n_hulls;
    if (!clear && !is_fine(scene, object)) return false;
    Box3 box = clear ? compiled->hull_bounds[hull] : scene_next_box_around(scene, object, known);
    if (!clear && is_coarse(&box)) box = scene_next_bounds(scene, object, known);
    Vec3 sides = vec3_sub(box.max, box.min);
    double thinnest = fmin(sides.x, fmin(sides.y, sides.z)), rounding = rounding_in(&box);
    if (!(thinnest >= 0) || !isfinite(vec3_max_abs(sides))) return false;
    bool thin = clear && thinnest > 0 && thinnest < (meets ? few : few_alone) * rounding;
    *found = (CoarseObject){thin, thin ? thinnest : vec3_max_abs(sides), rounding, 1};
    return thin || (is_fine(scene, object) && is_coarse(&box));
}

void report_coarse_places(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    SceneShapeBox known = {0};
    CoarseObject first = {.n = 0}, more;
    uint32_t n = 0, of = 0;
    bool *meets = find_meeting(compiled);
    for (uint32_t i = 0; meets && i < scene->n_objects; i++) {
        if (!judge(compiled, i, meets[i], &known, &more)) continue;
        if (first.n && span_same_place(scene->objects[of].span, scene->objects[i].span) && more.thin == first.thin) {
            first.n++;
            continue;
        }
        if (first.n && ++n <= REPORT_MOST) report_one(scene, &scene->objects[of], &first, diag);
        first = more;
        of = i;
    }
    if (first.n && ++n <= REPORT_MOST) report_one(scene, &scene->objects[of], &first, diag);
    free(meets);
    report_rest(diag, D_COARSE_PLACE, n);
}
