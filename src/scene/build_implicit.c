/* build_implicit.c - solids that a function of space describes: blobs and isosurfaces.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "shape/implicit.h"
#include "scene/build_parts.h"

Diagnostic *build_check_reached(Builder *b, const EvalNode *node, double reached, double tolerance)
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
    const BlobShape shape = {.components = read_components(b, node),
                             .n = node->n_children,
                             .threshold = eval_number(node, "threshold"),
                             .tolerance = tolerance ? tolerance->as.number : 0};
    if (!shape.components) return STATUS_SCENE;
    TRY(mesh_make_blob(&shape, b->options->pool, mesh, &reached, error));
    if (tolerance) (void)build_check_reached(b, node, reached, tolerance->as.number);
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

/* ---- bounds that hold no body, or only body ---- */

/* Of an isosurface's bounds, as its node has them or by default. */
typedef struct Bounds {
    Box3 box;
    bool given; /* both corners are written */
} Bounds;

static void add_corners(Buf *out, const char *first, Box3 box, const char *second)
{
    buf_format(out, "%s<%.4g, %.4g, %.4g>%s<%.4g, %.4g, %.4g>", first, box.min.x, box.min.y, box.min.z, second,
               box.max.x, box.max.y, box.max.z);
}

/* Points of a coarse grid that fills a box; the values of those where the function has none are not asked for, as that would
 * be reported. */
enum { FEW_POINTS = 17 };

static bool value_at(const Isosurface *isosurface, const Lattice *few, const uint32_t *at, double *value)
{
    return build_field_shared_value(&isosurface->field, lattice_point(few, at[0], at[1], at[2]), value);
}

/* What the function is between there, and whether there is something inside, and nothing at the faces: a body that the box holds.
 * false: at no point is a value known. */
static bool look_within(const Isosurface *isosurface, Box3 box, double *least, double *most, bool *holds)
{
    Vec3 size = vec3_sub(box.max, box.min);
    const Lattice few = {box.min, vec3_scale(size, 1.0 / (FEW_POINTS - 1)), {FEW_POINTS, FEW_POINTS, FEW_POINTS}};
    bool some_inside = false, face_inside = false;
    uint32_t at[3];
    *least = HUGE_VAL;
    *most = -HUGE_VAL;
    for (uint32_t i = 0; i < FEW_POINTS * FEW_POINTS * FEW_POINTS; i++) {
        double value;
        at[0] = i % FEW_POINTS, at[1] = i / FEW_POINTS % FEW_POINTS, at[2] = i / FEW_POINTS / FEW_POINTS;
        if (!value_at(isosurface, &few, at, &value)) continue;
        *least = fmin(*least, value);
        *most = fmax(*most, value);
        if (value >= isosurface->threshold) continue;
        some_inside = true;
        for (int axis = 0; axis < 3; axis++) face_inside = face_inside || at[axis] == 0 || at[axis] == FEW_POINTS - 1;
    }
    *holds = some_inside && !face_inside;
    return *least <= *most;
}

/* Larger bounds around the same middle that hold a body whole. */
static bool find_holding(const Isosurface *isosurface, Box3 bounds, Box3 *holding)
{
    enum { DOUBLINGS = 12 };
    Vec3 middle = vec3_scale(vec3_add(bounds.min, bounds.max), 0.5);
    Vec3 half = vec3_scale(vec3_sub(bounds.max, bounds.min), 0.5);
    for (int i = 0; i < DOUBLINGS; i++) {
        double least, most;
        bool holds;
        half = vec3_scale(half, 2);
        *holding = (Box3){vec3_sub(middle, half), vec3_add(middle, half)};
        if (look_within(isosurface, *holding, &least, &most, &holds) && holds) return true;
    }
    return false;
}

static void add_bounds_hint(Builder *b, Diagnostic *report, const Isosurface *isosurface, const Bounds *bounds,
                            const char *otherwise)
{
    Box3 holding;
    Buf hint = {0};
    if (find_holding(isosurface, bounds->box, &holding)) {
        add_corners(&hint, "these bounds hold a body whole: from = ", holding, "  to = ");
        if (!bounds->given) buf_add(&hint, "; unset, they are <-1, -1, -1> and <1, 1, 1>");
    } else {
        buf_format(&hint, "inside is where the function is less than the threshold: %s", otherwise);
    }
    diag_hint(b->diag, report, "%s", buf_text(&hint));
    buf_clear(&hint);
}

static void report_nothing(Builder *b, const EvalProp *function, const Isosurface *isosurface, const Bounds *bounds)
{
    double least, most;
    bool holds;
    Buf asked = {0};
    if (look_within(isosurface, bounds->box, &least, &most, &holds)) {
        add_corners(&asked, ": within its bounds, ", bounds->box, " to ");
        buf_format(&asked, ", the function is between %.4g and %.4g, and the threshold is %.4g", least, most,
                   isosurface->threshold);
    }
    Diagnostic *report = diag_report(b->diag, D_DEGENERATE_SHAPE, function->span, "the isosurface has nothing inside%s",
                                     buf_text(&asked));
    if (least < isosurface->threshold)
        diag_hint(b->diag, report, "what is inside is smaller than a cell of the grid: ask for more 'cells'");
    else
        add_bounds_hint(b, report, isosurface, bounds,
                        "where it is greater inside, as densities are, turn its sign and that of the threshold round; "
                        "what is smaller than a cell of the grid may be missed: ask for more 'cells'");
    buf_clear(&asked);
}

/* The part of its area that the bounds cut off, and of the area of the bounds that it covers. */
static void measure_cut(const Mesh *mesh, Box3 box, double *of_mesh, double *of_bounds)
{
    Vec3 size = vec3_sub(box.max, box.min);
    double near = 1e-5 * vec3_max_abs(size), all = 0, cut = 0;
    const double low[3] = {box.min.x, box.min.y, box.min.z}, high[3] = {box.max.x, box.max.y, box.max.z};
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        Vec3 at[3];
        for (int k = 0; k < 3; k++) at[k] = vec3_from_f(mesh->positions[mesh->triangles[i][k]]);
        double area = vec3_length(vec3_cross(vec3_sub(at[1], at[0]), vec3_sub(at[2], at[0]))) / 2;
        bool flat = false;
        for (int axis = 0; axis < 3; axis++) {
            bool at_low = true, at_high = true;
            for (int k = 0; k < 3; k++) {
                const double place[3] = {at[k].x, at[k].y, at[k].z};
                at_low = at_low && fabs(place[axis] - low[axis]) <= near;
                at_high = at_high && fabs(place[axis] - high[axis]) <= near;
            }
            flat = flat || at_low || at_high;
        }
        all += area;
        if (flat) cut += area;
    }
    *of_mesh = cut / all;
    *of_bounds = cut / (2 * (size.x * size.y + size.y * size.z + size.z * size.x));
}

/* A landscape in a box of its own has five flat sides of six, and one in a tall box more; all six show no shape of the
 * function. */
static void check_cut(Builder *b, const EvalNode *node, const Isosurface *isosurface, const Bounds *bounds,
                      const Mesh *mesh)
{
    const double nearly_all = bounds->given ? 0.995 : 0.9, whole = 0.999;
    double of_mesh, of_bounds;
    measure_cut(mesh, bounds->box, &of_mesh, &of_bounds);
    if (!(of_mesh >= nearly_all || of_bounds >= whole)) return;
    Buf box = {0};
    add_corners(&box, "", bounds->box, " to ");
    const char *why = of_bounds < whole ? "hardly more than a box: nearly all of its surface is where these cut it off"
                      : of_mesh >= nearly_all ? "a box: all within these is inside"
                                              : "a box from outside: it is cut off everywhere along these";
    Diagnostic *report = diag_report(b->diag, D_FULL_BOUNDS, node->span, "with the bounds %s this isosurface is %s",
                                     buf_text(&box), why);
    buf_clear(&box);
    add_bounds_hint(b, report, isosurface, bounds,
                    "where that is to be outside, turn its sign and that of the threshold round");
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
    const Bounds limits = {bounds, eval_prop(node, "from") && eval_prop(node, "to")};
    *span = function->span;
    Status status = mesh_make_implicit(&field, &options, "the isosurface", mesh, &found, error);
    if (status == STATUS_SCENE && error->text[0]) {
        report_nothing(b, function, &context, &limits);
        error->text[0] = 0;
    }
    TRY(status);
    check_cut(b, node, &context, &limits, *mesh);
    Diagnostic *report = tolerance ? build_check_reached(b, node, found.reached, options.tolerance) : NULL;
    if (report && found.jumps) add_jump(b, report, &found, context.threshold);
    return STATUS_OK;
}

void build_isosurface(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_made(b, node, to_world, make_isosurface, "", 0);
}
