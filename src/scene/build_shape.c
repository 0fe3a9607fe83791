/* build_shape.c - boxes and the ground; shapes that objects share; objects.
 *
 * What a shape's properties say about its place goes into the object's transform, so that equal shapes are
 * one Solid or Mesh however many objects use it. Boxes keep their coordinates.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/array.h"
#include "scene/build_parts.h"

/* ---- shapes ---- */

Diagnostic *build_report_shape(Builder *b, Span span, const Error *error)
{
    const Diagnostic *last = b->diag->last;
    bool told = last && last->code == D_DEGENERATE_SHAPE && last->has_span && span_equal(last->span, span);
    return told ? NULL : diag_report(b->diag, D_DEGENERATE_SHAPE, span, "%s", error->text);
}

bool build_succeeded(Builder *b, Status status, const Error *error, Span span)
{
    if (status == STATUS_OK) return true;
    if (status == STATUS_SCENE) {
        build_report_shape(b, span, error);
    } else if (b->status == STATUS_OK) {
        b->status = fail(b->error, status, "%s", error->text);
    }
    return false;
}

uint32_t build_new_shape(Builder *b)
{
    Scene *scene = b->scene;
    b->facts = room_for_one(b->arena, b->facts, scene->n_shapes, &b->facts_capacity, sizeof *b->facts);
    scene->shapes = room_for_one(b->arena, scene->shapes, scene->n_shapes, &b->shapes_capacity, sizeof *scene->shapes);
    b->facts[scene->n_shapes] = (ShapeFacts){.bounds = box3_empty()};
    scene->shapes[scene->n_shapes] = (SceneShape){.layer_of = SCENE_NONE};
    return scene->n_shapes++;
}

uint32_t build_shape_of(Builder *b, const void *key, size_t length, bool *found)
{
    const uint32_t *known = map_seek(&b->shapes, key, length);
    *found = known != NULL;
    if (known) return *known;
    map_find(b->arena, &b->shapes, arena_copy_text(b->arena, key, length), length, b->scene->n_shapes);
    return build_new_shape(b);
}

/* Facts of a solid: its volume is known, its bounds are those of its pieces. */
static void finish_solid(Builder *b, uint32_t shape)
{
    const Solid *solid = b->scene->shapes[shape].solid;
    ShapeFacts *facts = &b->facts[shape];
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        if (solid->pieces[i].kind == PIECE_PLANE) {
            facts->bounds = (Box3){{0, 0, 0}, {0, 0, 0}};
            facts->volume = HUGE_VAL;
            facts->closed = true;
            return;
        }
        facts->bounds = box3_union(facts->bounds, piece_bounds(&solid->pieces[i]));
    }
    facts->volume = solid->volume;
    facts->closed = true;
}

bool build_keep_solid(Builder *b, uint32_t shape, Status status, const Error *error, Span span)
{
    if (!build_succeeded(b, status, error, span)) return false;
    finish_solid(b, shape);
    return true;
}

uint32_t build_sphere_shape(Builder *b, double radius)
{
    struct {
        char kind[8];
        double radius;
    } key = {"sphere", radius};
    bool found;
    Error error;
    uint32_t shape = build_shape_of(b, &key, sizeof key, &found);
    if (!found)
        build_keep_solid(b, shape, solid_make_sphere(radius, &b->scene->shapes[shape].solid, &error), &error,
                         (Span){0});
    return shape;
}

uint32_t build_piece_shape(Builder *b, const Piece *piece)
{
    Error error;
    uint32_t shape = build_new_shape(b);
    Solid **solid = &b->scene->shapes[shape].solid;
    Status status = solid_new(1, solid, &error);
    if (status == STATUS_OK) (*solid)->pieces[0] = *piece;
    build_keep_solid(b, shape, status, &error, (Span){0});
    return shape;
}

Affine build_frame(Vec3 origin, Vec3 y)
{
    /* x from the coordinate axis that y has the least of; of equals the first, so that y = +y is the identity */
    double ax = fabs(y.x), ay = fabs(y.y), az = fabs(y.z);
    Vec3 axis = ax <= ay && ax <= az ? vec3(1, 0, 0) : ay <= az ? vec3(0, 1, 0) : vec3(0, 0, 1);
    Vec3 x = vec3_normalize(vec3_along(axis, -vec3_dot(axis, y), y));
    Vec3 z = vec3_cross(x, y);
    return (Affine){{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}, origin};
}

/* ---- objects ---- */

static bool within_reach(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world)
{
    return build_check_reach(b, node->span, node->type->name, affine_box(to_world, b->facts[shape].bounds));
}

uint32_t build_add_object(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world)
{
    return build_add_named(b, node, build_name(b, node, node->type->name), shape, to_world);
}

uint32_t build_add_named(Builder *b, const EvalNode *node, const char *name, uint32_t shape, const Affine *to_world)
{
    Scene *scene = b->scene;
    if (shape != SCENE_NONE) scene->shapes[shape].closed = b->facts[shape].closed;
    if (!ARRAY_ROOM(scene->objects, b->objects_capacity, scene->n_objects)) arena_fail(b->arena);
    scene->objects[scene->n_objects] = (SceneObject){
        .name = name,
        .span = build_author_place(b, node),
        .of_library = b->diag->sources->sources[node->span.source].library,
        .shape = shape,
        .to_world = *to_world,
        .medium = SCENE_NONE,
        .surface = SCENE_NONE,
        .light = SCENE_NONE,
        .texture_frame = SCENE_NONE,
        .motion = SCENE_NONE,
        .identity = b->where,
        .tree = SCENE_NONE,
        .part_of = SCENE_NONE,
        .volume = shape == SCENE_NONE ? 0 : b->facts[shape].volume * fabs(affine_determinant(to_world)),
    };
    return scene->n_objects++;
}

/* Defaults above the call of the macro that places the node, or above that of one around it. */
static void note_passed_by(const Builder *b, const EvalNode *node, Diagnostic *report)
{
    for (const DiagChain *call = node->chain; call; call = call->outer)
        for (const EvalPassedBy *passed = b->result.passed_by; passed; passed = passed->next) {
            if (passed->type != node->type || !span_same_place(passed->call, call->span)) continue;
            diag_note(b->diag, report, passed->defaults,
                      "these defaults do not reach into '%s', which is not below them", passed->macro);
            if (node->span.source == passed->defaults.source)
                diag_hint(b->diag, report, "put 'defaults %s' into the def that this %s is in, or above it",
                          node->type->name, node->type->name);
            return;
        }
}

bool build_matter(Builder *b, const EvalNode *node, uint32_t shape, const EvalProp **interior, const EvalProp **surface)
{
    *interior = eval_prop(node, "interior");
    *surface = eval_prop(node, "surface");
    if (!*interior && !*surface) {
        Diagnostic *report = diag_report(b->diag, D_MISSING_PROPERTY, node->span,
                                         "this %s has neither an interior nor a surface", node->type->name);
        diag_hint(b->diag, report, "clear: interior = a medium; opaque: surface = surface { albedo = .5 }");
        note_passed_by(b, node, report);
        const SceneShape *row = shape == SCENE_NONE ? NULL : &b->scene->shapes[shape];
        if (row && row->materials)
            diag_note_nowhere(
                b->diag, report,
                "what '%s' says of its materials, %s, is not taken; 'meniscus import %s' writes a scene that has it",
                row->materials->file, row->materials->names, row->materials->file);
        return false;
    }
    if (*interior && eval_truth((*interior)->as.node, "mixes")) {
        static const char *const of_owners[] = {"surface", "priority"};
        for (size_t i = 0; i < COUNT_OF(of_owners); i++) {
            const EvalProp *prop = eval_prop(node, of_owners[i]);
            if (!prop) continue;
            diag_report(b->diag, D_CONFLICTING_PROPERTIES, prop->span,
                        "a medium that mixes fills this %s: it has no boundary, and no '%s'", node->type->name,
                        of_owners[i]);
            return false;
        }
    }
    return !*surface || build_surface_fits(b, *surface, *interior != NULL);
}

void build_object(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world)
{
    const EvalProp *interior, *surface;
    if (b->status != STATUS_OK || !within_reach(b, node, shape, to_world)) return;
    if (b->combination) {
        build_operand(b, node, shape, to_world);
        return;
    }
    if (b->only_shapes) {
        if (!build_layered(b, node, shape, to_world, SCENE_NONE)) build_add_object(b, node, shape, to_world);
        return;
    }
    if (!build_matter(b, node, shape, &interior, &surface)) return;
    uint32_t before = b->scene->n_objects, cover = surface ? build_surface(b, surface->as.node) : SCENE_NONE;
    bool layered = interior && build_layered(b, node, shape, to_world, cover);
    if (!layered) build_add_object(b, node, shape, to_world);
    SceneObject *object = &b->scene->objects[before];
    const EvalProp *priority = eval_prop(node, "priority");
    object->surface = cover;
    build_texture_frame(b, before, &b->node_to_world);
    if (!interior) {
        build_needs(b, node, "priority", "on an opaque object");
        return;
    }
    build_fill_object(b, interior, before, &b->node_to_world);
    build_note_frame(b, before);
    object->priority = priority ? (int32_t)priority->as.number : b->scene->media[object->medium].priority;
    if (!b->facts[shape].closed)
        build_report_open(b, node->span, object->name, shape);
    else if (layered)
        return; /* what it encloses is measured later, as that of any combination */
    else if (!(object->volume > 0) || (!isfinite(object->volume) && isfinite(b->facts[shape].volume)))
        diag_report(b->diag, D_DEGENERATE_SHAPE, node->span, "%s encloses a volume of %g", object->name,
                    object->volume);
}

/* ---- node types ---- */

/* The corners of a box, sorted; false after reporting. */
static bool box_corners(Builder *b, const EvalNode *node, Vec3 *low, Vec3 *high)
{
    const EvalProp *from = eval_prop(node, "from"), *to = eval_prop(node, "to"), *size = eval_prop(node, "size");
    if (!build_exclude(b, node, "size", "from") || !build_exclude(b, node, "size", "to")) return false;
    if (!size && (!from || !to)) {
        Diagnostic *report = diag_report(b->diag, D_MISSING_PROPERTY, node->span, "this box has no %s",
                                         from ? "'to'"
                                         : to ? "'from'"
                                              : "size");
        diag_hint(b->diag, report, "give two corners, from and to, or a size about the origin");
        return false;
    }
    Vec3 corners[2];
    if (size) {
        corners[1] = vec3_scale(vec3(size->as.vector[0], size->as.vector[1], size->as.vector[2]), 0.5);
        corners[0] = vec3_scale(corners[1], -1);
    } else {
        corners[0] = eval_vector(node, "from");
        corners[1] = eval_vector(node, "to");
    }
    Box3 box = box3_add_point(box3_add_point(box3_empty(), corners[0]), corners[1]);
    *low = box.min;
    *high = box.max;
    if (!build_check_reach(b, node->span, "box", box)) return false;
    /* the corners are stored as floats */
    if ((float)low->x < (float)high->x && (float)low->y < (float)high->y && (float)low->z < (float)high->z) return true;
    diag_hint(b->diag,
              diag_report(b->diag, D_DEGENERATE_SHAPE, node->span, "this box is flat: it measures %g x %g x %g",
                          high->x - low->x, high->y - low->y, high->z - low->z),
              "give it a thickness, which for a label or a sheet can be as little as .1mm");
    return false;
}

void build_box(Builder *b, const EvalNode *node, const Affine *to_world)
{
    Vec3 low, high;
    if (!box_corners(b, node, &low, &high)) return;
    double bevel = eval_number(node, "bevel");
    double shortest = fmin(high.x - low.x, fmin(high.y - low.y, high.z - low.z));
    build_needs_other(b, node, "bevel_segments", "bevel", "without a bevel");
    if (bevel > 0 && !(2 * bevel < shortest)) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "bevel"),
                    "a bevel of %g does not fit a box whose shortest edge is %g", bevel, shortest);
        return;
    }
    unsigned segments = bevel > 0 ? (unsigned)eval_number(node, "bevel_segments") : 1;
    struct {
        char kind[8];
        Vec3 low, high;
        double bevel, segments;
    } key = {"box", low, high, bevel, segments};
    bool found;
    uint32_t shape = build_shape_of(b, &key, sizeof key, &found);
    if (!found) {
        Error error;
        Status status = mesh_make_box(low, high, bevel, segments, &b->scene->shapes[shape].mesh, &error);
        if (!build_succeeded(b, status, &error, node->span) || !build_finish_mesh(b, node, shape)) return;
    }
    build_object(b, node, shape, to_world);
}

/* Shared by all that has no end: the plane y = 0; SCENE_NONE after reporting. */
static uint32_t plane_shape(Builder *b, Span span)
{
    bool found;
    uint32_t shape = build_shape_of(b, "plane", 6, &found);
    if (found) return shape;
    Error error;
    Status status = solid_new(1, &b->scene->shapes[shape].solid, &error);
    if (status == STATUS_OK) b->scene->shapes[shape].solid->pieces[0] = (Piece){.kind = PIECE_PLANE};
    return build_keep_solid(b, shape, status, &error, span) ? shape : SCENE_NONE;
}

void build_ground(Builder *b, const EvalNode *node, const Affine *to_world)
{
    const EvalProp *surface = eval_prop(node, "surface");
    uint32_t shape = plane_shape(b, node->span);
    Affine place = affine_identity();
    place.t.y = eval_number(node, "y");
    place = affine_compose(to_world, &place);
    if (b->status != STATUS_OK || shape == SCENE_NONE || !within_reach(b, node, shape, &place)) return;
    uint32_t number = build_add_object(b, node, shape, &place);
    if (b->only_shapes) return;
    b->scene->objects[number].surface = surface ? build_surface(b, surface->as.node) : build_grey_surface(b);
    build_texture_frame(b, number, to_world);
}

void build_plane(Builder *b, const EvalNode *node, const Affine *to_world)
{
    Vec3 normal = eval_vector(node, "normal");
    double length = vec3_length(normal);
    uint32_t shape = plane_shape(b, node->span);
    if (!(length > 0) || !isfinite(length)) {
        diag_report(b->diag, D_DEGENERATE_SHAPE, build_span(node, "normal"),
                    "the normal of this plane has no direction");
        return;
    }
    if (shape == SCENE_NONE) return;
    normal = vec3_scale(normal, 1 / length);
    Affine frame = build_frame(vec3_scale(normal, eval_number(node, "distance")), normal);
    Affine place = affine_compose(to_world, &frame);
    build_object(b, node, shape, &place);
}
