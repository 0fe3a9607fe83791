/* build_csg.c - union, intersection and difference: their operands, and what they are made of.
 *
 * A combination is a row of objects with a medium or a surface but no shape; the rows of its operands follow. How they
 * are combined is a tree of parts (nest/csg.h), whose children stand side by side: room for all children of a node
 * is made before the first of them is built.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/hash.h"
#include "scene/build_parts.h"

/* The combination that is being built. */
struct Combination {
    const EvalNode *node;
    uint32_t object;          /* its row */
    uint32_t medium, surface; /* SCENE_NONE for the one that it has not */
    Span matter_span;         /* where that is said */
    uint32_t part;            /* which part the next object becomes */
    Affine frame;             /* of the node to the world */
};

/* A property that is set, of any type of node: groups know none of these. */
static const EvalProp *find_prop(const EvalNode *node, const char *name)
{
    for (size_t i = 0; i < node->n_props; i++)
        if (strcmp(node->props[i].type->name, name) == 0) return &node->props[i];
    return NULL;
}

/* The first node, the combination itself or one of its operands, that says what it is made of. */
static const EvalNode *find_matter(const EvalNode *node)
{
    if (find_prop(node, "interior") || find_prop(node, "surface")) return node;
    for (size_t i = 0; i < node->n_children; i++) {
        const EvalNode *found = find_matter(node->children[i]);
        if (found) return found;
    }
    return NULL;
}

/* An operand may repeat the combination's interior, and have a surface of its own: where the whole is clear, a rough
 * one. */
static bool operand_matter_fits(Builder *b, const EvalNode *node)
{
    const struct Combination *whole = b->combination;
    const EvalProp *interior = find_prop(node, "interior"), *surface = find_prop(node, "surface"),
                   *priority = find_prop(node, "priority");
    const EvalProp *wrong = NULL;
    if (b->only_shapes) return true;
    if (interior && (whole->medium == SCENE_NONE || build_medium(b, interior->as.node) != whole->medium))
        wrong = interior;
    if (priority) wrong = priority;
    if (!wrong) return !surface || build_surface_fits(b, surface, whole->medium != SCENE_NONE);
    Diagnostic *report = wrong == priority ? diag_report(b->diag, D_CONFLICTING_PROPERTIES, wrong->span,
                                                         "an operand has no priority of its own: that of the %s counts",
                                                         whole->node->type->name)
                                           : diag_report(b->diag, D_CONFLICTING_PROPERTIES, wrong->span,
                                                         "this %s is a part of one %s, which is made of something else",
                                                         node->type->name, whole->node->type->name);
    if (wrong != priority) diag_note(b->diag, report, whole->matter_span, "the whole is made of this");
    diag_hint(b->diag, report,
              wrong == priority ? "move it there"
              : report->in_library /* a gem of std/gems, whose interior is an argument */
                  ? "one combination has one interior: write interior = none in the call, and the part is of what the "
                    "whole is"
                  : "one combination has one interior; what is of several may overlap in a group { ... }");
    return false;
}

/* Room for n parts side by side, which are empty. */
static uint32_t add_parts(Builder *b, size_t n)
{
    Scene *scene = b->scene;
    uint32_t first = scene->n_parts;
    for (size_t i = 0; i < n; i++) {
        scene->parts = room_for_one(b->arena, scene->parts, scene->n_parts, &b->parts_capacity, sizeof *scene->parts);
        scene->parts[scene->n_parts++] = (NestPart){NEST_UNION, scene->n_operands, scene->n_operands, 0, 0};
    }
    return first;
}

/* What all operands of one node share. */
typedef struct OperandKind {
    const EvalNode *node;
    const char *name;
    uint32_t part_of, surface;
    const Affine *frame; /* of the node that the surface was given to */
} OperandKind;

static SceneObject *add_operand(Builder *b, const OperandKind *kind, uint32_t shape, const Affine *to_world,
                                uint32_t part)
{
    Scene *scene = b->scene;
    uint32_t number = build_add_named(b, kind->node, kind->name, shape, to_world);
    SceneObject *object = &scene->objects[number];
    object->part_of = kind->part_of;
    object->surface = kind->surface;
    build_texture_frame(b, number, kind->frame);
    scene->operands =
        room_for_one(b->arena, scene->operands, scene->n_operands, &b->operands_capacity, sizeof *scene->operands);
    scene->operands[scene->n_operands] = number;
    scene->parts[part] = (NestPart){NEST_OPERAND, scene->n_operands, scene->n_operands + 1, 0, 0};
    scene->n_operands++;
    return object;
}

/* A part that is the union of a mesh's layers. */
static void add_layers(Builder *b, const OperandKind *kind, Layers layers, const Affine *to_world, uint32_t part)
{
    Scene *scene = b->scene;
    uint32_t begin = scene->n_operands, first = add_parts(b, layers.n);
    for (uint32_t i = 0; i < layers.n; i++) {
        SceneObject *object = add_operand(b, kind, layers.first + i, to_world, first + i);
        object->identity = hash_u64(b->where + 1 + i); /* the node's own is that of the whole */
    }
    scene->parts[part] = (NestPart){NEST_UNION, begin, scene->n_operands, first, layers.n};
}

void build_operand(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world)
{
    struct Combination *whole = b->combination;
    if (!operand_matter_fits(b, node)) return;
    const EvalProp *surface = find_prop(node, "surface");
    OperandKind kind = {.node = node, .name = build_name(b, node, node->type->name), .part_of = whole->object};
    kind.surface = surface ? build_surface(b, surface->as.node) : whole->surface;
    kind.frame = surface ? &b->node_to_world : &whole->frame;
    if (!b->facts[shape].closed) build_report_open(b, node->span, kind.name, shape);
    Layers layers = build_layers(b, shape);
    if (layers.n > 1)
        add_layers(b, &kind, layers, to_world, whole->part);
    else
        add_operand(b, &kind, shape, to_world, whole->part);
}

static void add_tree(Builder *b, uint32_t object, uint32_t root)
{
    Scene *scene = b->scene;
    scene->objects[object].tree = scene->n_trees;
    scene->trees = room_for_one(b->arena, scene->trees, scene->n_trees, &b->trees_capacity, sizeof *scene->trees);
    scene->trees[scene->n_trees++] = (SceneTree){root, object};
}

bool build_layered(Builder *b, const EvalNode *node, uint32_t shape, const Affine *to_world, uint32_t surface)
{
    Layers layers = build_layers(b, shape);
    if (layers.n == 1) return false;
    uint32_t whole = build_add_object(b, node, SCENE_NONE, to_world), root = add_parts(b, 1);
    OperandKind kind = {node, b->scene->objects[whole].name, whole, surface, &b->node_to_world};
    add_tree(b, whole, root);
    add_layers(b, &kind, layers, to_world, root);
    return true;
}

void build_part(Builder *b, const EvalNode *node, const Affine *to_world, NestOperation operation)
{
    Scene *scene = b->scene;
    struct Combination *whole = b->combination;
    uint32_t part = whole->part, begin = scene->n_operands, n_objects = scene->n_objects;
    uint32_t first = add_parts(b, node->n_children);
    if (!node->n_children)
        diag_report(b->diag, D_EMPTY_COMBINATION, node->span, "this %s has no operands", node->type->name);
    for (size_t i = 0; i < node->n_children; i++) {
        whole->part = first + (uint32_t)i;
        scene->parts[whole->part].begin = scene->parts[whole->part].end = scene->n_operands;
        build_visit(b, node->children[i], to_world);
    }
    scene->parts[part] = (NestPart){operation, begin, scene->n_operands, first, (uint32_t)node->n_children};
    build_merge_planes(b, node, to_world, part, n_objects);
}

/* A combination of which one body between planes is left is that body. */
static void become_body(Builder *b, uint32_t whole, uint32_t root)
{
    Scene *scene = b->scene;
    SceneObject *object = &scene->objects[whole];
    const SceneObject *body = &scene->objects[scene->operands[scene->parts[root].begin]];
    object->shape = body->shape;
    object->to_world = body->to_world;
    object->volume = body->volume;
    object->tree = SCENE_NONE;
    scene->n_objects--;
    scene->n_operands--;
    scene->n_trees--;
    scene->n_parts = root;
}

/* The combination that the node is, or a part of the one around it. */
static void build_combination(Builder *b, const EvalNode *node, const Affine *to_world, NestOperation operation)
{
    Scene *scene = b->scene;
    if (b->combination) {
        if (operand_matter_fits(b, node)) build_part(b, node, to_world, operation);
        return;
    }
    const EvalNode *said = find_matter(node);
    const EvalProp *interior = NULL, *surface = NULL, *priority = find_prop(node, "priority");
    if (!b->only_shapes && !build_matter(b, said ? said : node, SCENE_NONE, &interior, &surface)) return;
    struct Combination whole = {.node = node, .medium = SCENE_NONE, .surface = SCENE_NONE, .frame = *to_world};
    if (interior || surface) whole.matter_span = (interior ? interior : surface)->span;
    if (surface) whole.surface = build_surface(b, surface->as.node);
    if (surface && !interior) build_needs(b, node, "priority", "on an opaque object");
    whole.object = build_add_object(b, node, SCENE_NONE, to_world);
    SceneObject *object = &scene->objects[whole.object];
    object->surface = whole.surface;
    if (interior) build_fill_object(b, interior, whole.object, &b->node_to_world);
    whole.medium = object->medium;
    if (interior) build_note_frame(b, whole.object);
    if (interior) object->priority = priority ? (int32_t)priority->as.number : scene->media[whole.medium].priority;
    whole.part = add_parts(b, 1);
    add_tree(b, whole.object, whole.part);
    b->combination = &whole;
    uint32_t root = whole.part;
    build_part(b, node, to_world, operation);
    b->combination = NULL;
    if (b->scene->parts[root].operation == NEST_OPERAND) become_body(b, whole.object, root);
}

void build_union(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_combination(b, node, to_world, NEST_UNION);
}

void build_intersection(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_combination(b, node, to_world, NEST_INTERSECTION);
}

void build_difference(Builder *b, const EvalNode *node, const Affine *to_world)
{
    build_combination(b, node, to_world, NEST_DIFFERENCE);
}
