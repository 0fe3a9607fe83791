/* build_implicit.c - solids that a function of space describes: blobs and isosurfaces.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "shape/implicit.h"
#include "scene/build_parts.h"

/* Says when the grid could not be made fine enough; NULL: it could. */
static Diagnostic *check_reached(Builder *b, const EvalNode *node, double reached, double tolerance)
{
    if (reached <= 1.5 * tolerance) return NULL;
    return diag_report(b->diag, D_COARSE_SURFACE, build_span(node, "tolerance"),
                       "parts of this %s are off by up to %.2g; the tolerance is %.2g", node->type->name, reached,
                       tolerance);
}

/* ---- blobs ---- */

/* What belongs to the whole, and not to its components. */
static bool check_component(Builder *b, const EvalNode *component)
{
    static const char *const of_the_whole[] = {"interior", "surface", "priority"};
    for (size_t i = 0; i < COUNT_OF(of_the_whole); i++)
        build_needs(b, component, of_the_whole[i], "within a blob: set it there");
    return build_check_transform(b, component, &component->transform);
}

static bool read_component(Builder *b, const EvalNode *node, BlobComponent *component)
{
    bool ball = strcmp(node->type->name, "sphere") == 0;
    memset(component, 0, sizeof *component); /* its bytes are compared */
    component->to_world = node->transform;
    component->from = eval_vector(node, ball ? "center" : "from");
    component->to = ball ? component->from : eval_vector(node, "to");
    component->radius = eval_number(node, "radius");
    component->strength = eval_number(node, "strength");
    Box3 box = box3_add_point(box3_add_point(box3_empty(), component->from), component->to);
    return check_component(b, node) &&
           build_check_reach(b, node->span, node->type->name, affine_box(&node->transform, box));
}

/* The components of a blob, in the scene's arena; NULL after reporting. */
static const BlobComponent *read_components(Builder *b, const EvalNode *node)
{
    BlobComponent *components = ARENA_ARRAY(b->arena, BlobComponent, node->n_children);
    bool fine = true;
    for (size_t i = 0; i < node->n_children; i++) fine = read_component(b, node->children[i], &components[i]) && fine;
    if (fine && node->n_children) return components;
    if (fine) {
        Diagnostic *report = diag_report(b->diag, D_DEGENERATE_SHAPE, node->span, "this blob has no components");
        diag_hint(b->diag, report, "put spheres and cylinders into it: blob { sphere { radius = 2 } }");
    }
    return NULL;
}

static Status make_blob(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error)
{
    (void)span;
    const EvalProp *tolerance = eval_prop(node, "tolerance");
    double reached = 0;
    const BlobComponent *components = read_components(b, node);
    if (!components) return STATUS_SCENE;
    TRY(mesh_make_blob(components, node->n_children, eval_number(node, "threshold"),
                       tolerance ? tolerance->as.number : 0, b->options->pool, mesh, &reached, error));
    if (tolerance) (void)check_reached(b, node, reached, tolerance->as.number);
    return STATUS_OK;
}

void build_blob(Builder *b, const EvalNode *node, const Affine *to_world)
{
    const BlobComponent *components = read_components(b, node);
    if (components) build_made(b, node, to_world, make_blob, components, node->n_children * sizeof *components);
}

/* ---- isosurfaces ---- */

typedef struct Isosurface {
    SceneField field;
    double threshold;
} Isosurface;

/* Outside is where the function is greater; the mesh wants it the other way round. */
static bool function_value(void *context, Vec3 p, double *value)
{
    const Isosurface *isosurface = context;
    if (!build_field_value(&isosurface->field, p, value)) return false;
    *value = isosurface->threshold - *value;
    return true;
}

static bool function_shared_value(void *context, Vec3 p, double *value)
{
    const Isosurface *isosurface = context;
    if (!build_field_shared_value(&isosurface->field, p, value)) return false;
    *value = isosurface->threshold - *value;
    return true;
}

static Vec3 layer_point(const void *context, uint32_t i, uint32_t j, uint32_t k)
{
    return lattice_point(context, i, j, k);
}

static bool function_bounds(void *context, Box3 box, double *low, double *high)
{
    const Isosurface *isosurface = context;
    double least, most;
    if (!build_field_bounds(&isosurface->field, box, &least, &most)) return false;
    *low = isosurface->threshold - most;
    *high = isosurface->threshold - least;
    return true;
}

static bool function_layer(void *context, const Lattice *lattice, uint32_t k, const uint8_t *wanted, double *values)
{
    const Isosurface *isosurface = context;
    const FieldLayer layer = {lattice, layer_point, {lattice->n[0], lattice->n[1]}, k, wanted};
    if (!build_field_layer(&isosurface->field, &layer, values)) return false;
    for (size_t i = 0; i < (size_t)lattice->n[0] * lattice->n[1]; i++)
        if (!wanted || wanted[i]) values[i] = isosurface->threshold - values[i];
    return true;
}

/* Why no grid is fine enough: the edges of steps are cut off by the grid. */
static void add_jump(Builder *b, Diagnostic *report, const ImplicitFound *found, double threshold)
{
    Vec3 p = found->jump_at;
    diag_hint(b->diag, report,
              "the function jumps at about <%.4g, %.4g, %.4g>, from %.4g to %.4g: the edges of its steps are cut off "
              "by up to a "
              "cell; ask for more 'cells', or a larger tolerance",
              p.x, p.y, p.z, threshold - found->inner_value, threshold - found->outer_value);
}

static Status make_isosurface(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error)
{
    Vec3 from = eval_vector(node, "from"), to = eval_vector(node, "to");
    Box3 bounds = box3_add_point(box3_add_point(box3_empty(), from), to);
    Vec3 size = vec3_sub(bounds.max, bounds.min);
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) {
        *span = build_span(node, "to");
        return fail(error, STATUS_SCENE, "the bounds of this isosurface measure %g x %g x %g", size.x, size.y, size.z);
    }
    if (!build_check_reach(b, node->span, "isosurface", bounds)) return STATUS_SCENE;
    const EvalProp *tolerance = eval_prop(node, "tolerance"), *function = eval_prop(node, "function");
    Isosurface context = {build_field(b, function->as.function), eval_number(node, "threshold")};
    bool (*shared)(void *, Vec3, double *) = context.field.program ? function_shared_value : NULL;
    const ImplicitField field = {&context, function_layer, function_value, shared, NULL, function_bounds};
    const ImplicitOptions options = {.bounds = bounds,
                                     .tolerance = tolerance ? tolerance->as.number : vec3_max_abs(size) / 2000,
                                     .cells = (uint32_t)eval_number(node, "cells"),
                                     .max_points = 16000000,
                                     .pool = b->options->pool};
    ImplicitFound found;
    *span = function->span;
    TRY(mesh_make_implicit(&field, &options, "the isosurface", mesh, &found, error));
    Diagnostic *report = tolerance ? check_reached(b, node, found.reached, options.tolerance) : NULL;
    if (report && found.jumps) add_jump(b, report, &found, context.threshold);
    return STATUS_OK;
}

void build_isosurface(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_made(b, node, to_world, make_isosurface, "", 0);
}
