/* build_meshed.c - solids that are made of triangles from a few numbers: prisms, sweeps, superellipsoids, height
 * fields.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/num.h"
#include "shape/contour.h"
#include "shape/meshed.h"
#include "scene/build_parts.h"

/* ---- shapes by what their nodes say ---- */

static void add_list(Buf *key, const EvalProp *prop, unsigned width)
{
    if (prop->type->kind == PROP_NUMBER_LISTS || prop->type->kind == PROP_VECTOR2_LISTS)
        buf_add_bytes(key, (const char *)prop->as.list.lengths, prop->as.list.n_lists * sizeof *prop->as.list.lengths);
    buf_add_bytes(key, (const char *)prop->as.list.numbers, prop->as.list.n * width * sizeof(double));
}

/* A function by what it computes: the same text in another turn of a loop is another value, with the scene as it is then. */
static void add_function(Builder *b, Buf *key, const EvalFunctionValue *function)
{
    const Program *program = build_field(b, function).program;
    if (!program) { /* instances with properties of their own have their prototype's */
        buf_add_bytes(key, (const char *)&function, sizeof function);
        return;
    }
    const uint32_t sizes[] = {program->n_constants, program->n_steps, program->n_outputs};
    buf_add_bytes(key, (const char *)sizes, sizeof sizes);
    buf_add_bytes(key, (const char *)program->outputs, sizeof program->outputs);
    buf_add_bytes(key, (const char *)program->constants, program->n_constants * sizeof *program->constants);
    for (uint32_t i = 0; i < program->n_steps; i++) {
        const ProgramStep *step = &program->steps[i];
        const uint16_t registers[] = {step->op, step->to, step->a, step->b, step->c};
        buf_add_bytes(key, (const char *)registers, sizeof registers);
        buf_add_bytes(key, (const char *)&step->unary, sizeof step->unary);
    }
}

static void add_value(Builder *b, Buf *key, const EvalProp *prop)
{
    switch (prop->type->kind) {
    case PROP_NUMBER:
    case PROP_INTEGER: buf_add_bytes(key, (const char *)&prop->as.number, sizeof prop->as.number); break;
    case PROP_BOOL: buf_add(key, prop->as.truth ? "1" : "0"); break;
    case PROP_STRING:
    case PROP_CHOICE: buf_add_bytes(key, prop->as.text, strlen(prop->as.text) + 1); break;
    case PROP_VECTOR2: buf_add_bytes(key, (const char *)prop->as.vector, 2 * sizeof(double)); break;
    case PROP_VECTOR3: buf_add_bytes(key, (const char *)prop->as.vector, 3 * sizeof(double)); break;
    case PROP_NUMBERS:
    case PROP_NUMBER_LISTS: add_list(key, prop, 1); break;
    case PROP_VECTORS2:
    case PROP_VECTOR2_LISTS: add_list(key, prop, 2); break;
    case PROP_VECTORS3: add_list(key, prop, 3); break;
    case PROP_FUNCTION: add_function(b, key, prop->as.function); break;
    default: /* another kind is one of a kind */ buf_add_bytes(key, (const char *)&prop, sizeof prop);
    }
}

/* Everything that makes the shape: the same bytes, the same shape. */
static void make_key(Builder *b, Buf *key, const EvalNode *node, const void *more, size_t n_more)
{
    buf_add_bytes(key, node->type->name, strlen(node->type->name) + 1);
    buf_add_bytes(key, (const char *)&n_more, sizeof n_more);
    buf_add_bytes(key, more, n_more);
    for (size_t i = 0; i < node->n_props; i++) {
        const EvalProp *prop = &node->props[i];
        if (!(prop->type->flags & PROP_SHAPE)) continue;
        bool is_list = prop->type->kind >= PROP_NUMBERS && prop->type->kind != PROP_FUNCTION;
        size_t n = is_list ? prop->as.list.n : 0;
        buf_add_bytes(key, prop->type->name, strlen(prop->type->name) + 1);
        buf_add_bytes(key, (const char *)&n, sizeof n);
        add_value(b, key, prop);
    }
}

void build_made(Builder *b, const EvalNode *node, const Affine *to_world, BuildMaker *make, const void *more,
                size_t n_more)
{
    Buf key = {0};
    bool found;
    make_key(b, &key, node, more, n_more);
    uint32_t shape = build_shape_of(b, buf_text(&key), key.length, &found);
    buf_clear(&key);
    if (!found) {
        Error error = {.text = ""};
        Span span = node->span;
        Status status = make(b, node, &b->scene->shapes[shape].mesh, &span, &error);
        if (status == STATUS_SCENE && !error.text[0]) return;
        if (!build_succeeded(b, status, &error, span) || !build_finish_mesh(b, node, shape)) return;
    }
    if (b->scene->shapes[shape].mesh) build_object(b, node, shape, to_world); /* a failed one has been reported */
}

/* ---- outlines ---- */

static ContourKind contour_kind(const char *word)
{
    if (strcmp(word, "natural") == 0) return CONTOUR_NATURAL;
    return strcmp(word, "cubic") == 0 ? CONTOUR_CUBIC : strcmp(word, "bezier") == 0 ? CONTOUR_BEZIER : CONTOUR_LINEAR;
}

/* The larger of width and height of all points. */
static double extent_of(const EvalProp *outline)
{
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < 2 * outline->as.list.n; i++) {
        low[i % 2] = fmin(low[i % 2], outline->as.list.numbers[i]);
        high[i % 2] = fmax(high[i % 2], outline->as.list.numbers[i]);
    }
    return fmax(high[0] - low[0], high[1] - low[1]);
}

/* A point of the list as the scene counts it. */
static const char *point_name(Builder *b, const EvalProp *outline, size_t source)
{
    size_t loop = 0;
    while (loop + 1 < outline->as.list.n_lists && source >= outline->as.list.lengths[loop])
        source -= outline->as.list.lengths[loop++];
    if (outline->as.list.n_lists == 1) return arena_format(b->arena, "point %zu", source);
    return arena_format(b->arena, "point %zu of loop %zu", source, loop);
}

static Status draw_loops(const EvalProp *outline, ContourKind kind, Pen *pen, Error *error)
{
    const double *xy = outline->as.list.numbers;
    for (size_t i = 0; i < outline->as.list.n_lists; i++) {
        size_t n = outline->as.list.lengths[i];
        uint32_t first = (uint32_t)(xy - outline->as.list.numbers) / 2;
        pen->source = first;
        TRY(contour_draw(pen, kind, xy, n, error));
        xy += 2 * n;
    }
    return STATUS_OK;
}

/* The loops of a property, drawn and clean. */
static Status read_outline(Builder *b, const EvalProp *prop, ContourKind kind, double tolerance, double smooth_degrees,
                           Outline2 *outline, Error *error)
{
    Pen pen = {.outline = outline, .tolerance = tolerance, .smooth_degrees = smooth_degrees};
    Crossing2 crossing;
    if (prop->as.list.n > POLYGON_MAX_POINTS)
        return fail(error, STATUS_SCENE, "an outline of %zu points is too long; the limit is %d", prop->as.list.n,
                    POLYGON_MAX_POINTS);
    TRY(draw_loops(prop, kind, &pen, error));
    TRY(polygon_find_crossing(outline, &crossing, error));
    if (crossing.found)
        return fail(error, STATUS_SCENE,
                    "the outline crosses or touches itself at <%.6g, %.6g>: behind its %s and behind its %s",
                    crossing.at.x, crossing.at.y, point_name(b, prop, outline->points[crossing.one].source),
                    point_name(b, prop, outline->points[crossing.other].source));
    TRY(polygon_clean(outline, FILL_EVEN_ODD, error));
    if (outline->n_points == 0) return fail(error, STATUS_SCENE, "the outline encloses nothing");
    return STATUS_OK;
}

static double tolerance_of(const EvalNode *node, double unset)
{
    const EvalProp *tolerance = eval_prop(node, "tolerance");
    return tolerance ? tolerance->as.number : unset;
}

static double smooth_degrees(const EvalNode *node, ContourKind kind)
{
    return node && eval_truth(node, "smooth") ? 40 : kind == CONTOUR_LINEAR ? 0 : 3;
}

/* ---- prism ---- */

static Status make_prism(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error)
{
    const EvalProp *prop = eval_prop(node, "outline");
    ContourKind kind = contour_kind(eval_word(node, "curve"));
    PrismShape shape = {.from = eval_number(node, "from"),
                        .to = eval_number(node, "to"),
                        .scale_from = eval_number(node, "scale_from"),
                        .scale_to = eval_number(node, "scale_to"),
                        .bevel = eval_number(node, "bevel"),
                        .bevel_segments = (unsigned)eval_number(node, "bevel_segments")};
    if (shape.scale_from == 0 && shape.scale_to == 0)
        return fail(error, STATUS_SCENE, "both ends of this prism are scaled to 0");
    if (shape.bevel > 0 && (shape.scale_from != 1 || shape.scale_to != 1)) {
        *span = build_span(node, "bevel");
        return fail(error, STATUS_SCENE,
                    "a prism whose ends are scaled takes no bevel: leave it out, or cut the edges by an intersection");
    }
    Outline2 outline = {0};
    Grower grower = {0};
    *span = prop->span;
    Status status = read_outline(b, prop, kind, tolerance_of(node, extent_of(prop) / 4000), smooth_degrees(node, kind),
                                 &outline, error);
    if (status == STATUS_OK) {
        *span = shape.bevel > 0 ? build_span(node, "bevel") : node->span;
        status = prism_add(&grower, &outline, &shape, error);
    }
    if (status == STATUS_OK) status = grower_finish(&grower, "the prism", mesh, error);
    grower_clear(&grower);
    outline2_clear(&outline);
    const Affine upright = {{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {0, 0, 0}};
    if (status == STATUS_OK) mesh_transform(*mesh, &upright);
    return status;
}

void build_prism(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_needs_other(b, node, "bevel_segments", "bevel", "without a bevel");
    if (strcmp(eval_word(node, "curve"), "linear") == 0) build_needs(b, node, "tolerance", "without curves");
    build_made(b, node, to_world, make_prism, "", 0);
}

/* ---- sweep ---- */

static SweepCurve sweep_curve(const char *word)
{
    if (strcmp(word, "natural") == 0) return SWEEP_NATURAL;
    return strcmp(word, "cubic") == 0 ? SWEEP_CUBIC : SWEEP_LINEAR;
}

static double largest_number(const double *numbers, size_t n)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++) largest = fmax(largest, numbers[i]);
    return largest;
}

/* A 10,000th of how far a path reaches: a tenth of a pixel of a picture of all of it. But what is thick is looked at from near, and
 * a thread is still to be round: a 1000th of its size at least, and a 100th at most. */
static double sweep_tolerance(const Vec3 *path, size_t n, double size)
{
    Box3 box = box3_empty();
    for (size_t i = 0; i < n; i++) box = box3_add_point(box, path[i]);
    double reach = n > 0 ? vec3_max_abs(vec3_sub(box.max, box.min)) : 0;
    return fmin(fmax(reach / 10000, size / 1000), size / 100);
}

static void hint_fit(Builder *b, Diagnostic *report, double fits)
{
    const char *else_what = "sweeps that overlap, in a union";
    if (!(fits > 0) || !isfinite(fits))
        diag_hint(b->diag, report, "a smaller outline or wider bends; or %s", else_what);
    else
        diag_hint(b->diag, report, "%.2g times the size, which fits all along the path, or wider bends; or %s",
                  num_round_down(fits, 2), else_what);
}

static Status make_sweep(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error)
{
    const EvalProp *path = eval_prop(node, "path"), *radius = eval_prop(node, "radius"),
                   *prop = eval_prop(node, "outline");
    const EvalProp *segments = eval_prop(node, "segments");
    const double one = 1;
    Outline2 outline = {0};
    SweepShape shape = {.scales = radius ? radius->as.list.numbers : &one,
                        .n_scales = radius ? radius->as.list.n : 1,
                        .up = eval_vector(node, "up"),
                        .curve = sweep_curve(eval_word(node, "curve")),
                        .closed = eval_truth(node, "closed"),
                        .round_ends = strcmp(eval_word(node, "ends"), "round") == 0,
                        .twist = eval_number(node, "twist"),
                        .segments = segments ? (unsigned)segments->as.number : 0};
    double size = largest_number(shape.scales, shape.n_scales);
    if (prop) size *= extent_of(prop);
    if (!(size > 0)) return fail(error, STATUS_SCENE, "a sweep of radius 0 has no volume");
    size_t n = path->as.list.n;
    if (n > 1000000) return fail(error, STATUS_SCENE, "a path of %zu points is too long; the limit is 1000000", n);
    Vec3 *points = ARENA_ARRAY(b->arena, Vec3, n);
    for (size_t i = 0; i < n; i++) {
        const double *p = path->as.list.numbers + 3 * i;
        points[i] = vec3(p[0], p[1], p[2]);
    }
    shape.path = points;
    shape.n_path = n;
    shape.tolerance = tolerance_of(node, sweep_tolerance(points, n, size));
    Status status = STATUS_OK;
    if (prop) {
        ContourKind kind = contour_kind(eval_word(node, "outline_curve"));
        *span = prop->span;
        status = read_outline(b, prop, kind, shape.tolerance / size * extent_of(prop), smooth_degrees(NULL, kind),
                              &outline, error);
        shape.outline = &outline;
    }
    SweepFound found = {0};
    if (status == STATUS_OK) {
        *span = path->span;
        status = mesh_make_sweep(&shape, b->options->pool, mesh, &found, error);
    }
    if (found.folds) {
        Diagnostic *report = build_report_shape(b, path->span, error);
        if (report) hint_fit(b, report, found.fits);
        error->text[0] = 0; /* that is said */
    }
    double enough = eval_prop(node, "tolerance") ? shape.tolerance : fmax(shape.tolerance, size / 50);
    if (status == STATUS_OK) (void)build_check_reached(b, node, found.reached, enough);
    outline2_clear(&outline);
    return status;
}

void build_sweep(Builder *b, const EvalNode *node, const Affine *to_world)
{
    if (eval_prop(node, "outline")) {
        build_needs(b, node, "segments", "with an outline");
        if (strcmp(eval_word(node, "ends"), "round") == 0)
            build_needs(b, node, "ends", "with an outline: only a circle has round ends");
    } else {
        build_needs(b, node, "outline_curve", "without an outline");
        build_needs(b, node, "twist", "without an outline");
        build_needs(b, node, "up", "without an outline");
    }
    Diagnostic *report = eval_truth(node, "closed") ? build_needs(b, node, "ends", "on a closed path") : NULL;
    if (report)
        diag_hint(b->diag, report, "leave it out; where 'closed' is computed: ends = closed ? none : \"%s\"",
                  eval_prop(node, "ends")->as.text);
    build_made(b, node, to_world, make_sweep, "", 0);
}

/* ---- superellipsoid ---- */

static Status make_superellipsoid(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error)
{
    (void)b;
    (void)span;
    Vec3 exponents = eval_vector(node, "exponents"), radii = eval_vector(node, "radius");
    return mesh_make_superellipsoid(exponents.x, exponents.y, radii, tolerance_of(node, vec3_max_abs(radii) / 4000),
                                    mesh, error);
}

void build_superellipsoid(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_made(b, node, to_world, make_superellipsoid, "", 0);
}

/* ---- height field ---- */

static Status list_heights(const EvalProp *rows, float **heights, uint32_t *n_x, uint32_t *n_z, Error *error)
{
    size_t n = rows->as.list.n, length = rows->as.list.n_lists ? rows->as.list.lengths[0] : 0;
    for (size_t i = 1; i < rows->as.list.n_lists; i++)
        if (rows->as.list.lengths[i] != length)
            return fail(error, STATUS_SCENE, "row %zu has %zu heights, and row 0 has %zu", i, rows->as.list.lengths[i],
                        length);
    if (n >= UINT32_MAX) return fail(error, STATUS_SCENE, "%zu heights are too many", n);
    *heights = malloc((n + 1) * sizeof **heights);
    if (!*heights) return fail_memory(error, n * sizeof **heights, "a height field");
    for (size_t i = 0; i < n; i++) (*heights)[i] = (float)rows->as.list.numbers[i];
    *n_x = (uint32_t)length;
    *n_z = (uint32_t)rows->as.list.n_lists;
    return STATUS_OK;
}

/* Means of the three channels, in place; values that are none are mistakes. */
static Status image_heights(Builder *b, const char *path, float **heights, uint32_t *n_x, uint32_t *n_z, Error *error)
{
    if (!b->options->load_image) return fail(error, STATUS_SCENE, "images cannot be read here");
    Status status =
        b->options->load_image(b->options->load_image_context, path, SCENE_SPACE_DATA, heights, n_x, n_z, error);
    if (status != STATUS_OK) return status == STATUS_NOMEM ? status : STATUS_SCENE;
    size_t n = (size_t)*n_x * *n_z;
    for (size_t i = 0; i < n; i++) {
        const float *rgb = *heights + 3 * i;
        float mean = rgb[0] == rgb[1] && rgb[1] == rgb[2] ? rgb[0] : (rgb[0] + rgb[1] + rgb[2]) / 3;
        if (!isfinite(mean))
            return fail(error, STATUS_SCENE, "'%s' has no finite height in row %zu, column %zu", path, i / *n_x,
                        i % *n_x);
        (*heights)[i] = mean;
    }
    return STATUS_OK;
}

static Status make_height_field(Builder *b, const EvalNode *node, Mesh **mesh, Span *span, Error *error)
{
    const EvalProp *image = eval_prop(node, "image"), *rows = eval_prop(node, "heights");
    float *heights = NULL;
    HeightField field = {
        .size = eval_vector(node, "size"), .base = eval_number(node, "base"), .smooth = eval_truth(node, "smooth")};
    *span = image ? image->span : rows->span;
    const char *path = image ? eval_find_file(&b->eval_options, b->diag, image->span, image->as.text) : NULL;
    if (image && !path) return STATUS_SCENE; /* reported */
    Status status = image ? image_heights(b, path, &heights, &field.n_x, &field.n_z, error)
                          : list_heights(rows, &heights, &field.n_x, &field.n_z, error);
    field.heights = heights;
    if (status == STATUS_OK) status = mesh_make_height_field(&field, mesh, error);
    free(heights);
    return status;
}

void build_height_field(Builder *b, const EvalNode *node, const Affine *to_world)
{
    const EvalProp *image = eval_prop(node, "image");
    if (!build_exclude(b, node, "image", "heights")) return;
    if (!image && !eval_prop(node, "heights")) {
        Diagnostic *report = diag_report(b->diag, D_MISSING_PROPERTY, node->span, "this height_field has no heights");
        diag_hint(b->diag, report, "give an image, or heights = [[...], [...]]");
        return;
    }
    const char *path = image ? eval_find_file(&b->eval_options, b->diag, image->span, image->as.text) : "";
    if (!path) return;
    if (image) build_note_file(b, path);
    build_made(b, node, to_world, make_height_field, path, strlen(path));
}
