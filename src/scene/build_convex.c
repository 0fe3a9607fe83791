/* build_convex.c - planes and boxes of an intersection, made one body.
 *
 * Cut gems, prisms and rooms are written as what many planes have in common. As operands of their own each of them meets every
 * ray, and all are asked at each crossing; as a mesh of flat faces they are one. What they look like is the same.
 * They stay as they are where more than their place matters: where one has a surface of its own, where textures or the grain of
 * the surface lie on each of them, where they may move while the shutter is open, and where questions of the scene itself
 * are answered, which knows them exactly.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/hash.h"
#include "mesh/half_spaces.h"
#include "scene/build_parts.h"

enum { PLANES_TO_MERGE = 4 };

/* Equal ones have equal bodies. */
typedef struct BodyKey {
    char kind[8];
    HalfSpace spaces[];
} BodyKey;

typedef struct Merging {
    const EvalNode *node;  /* the combination or part of one */
    uint32_t first;        /* the part of its first child */
    BodyKey *key;          /* half spaces in its frame */
    uint32_t *now;         /* the number that each of its operands has from then on */
    bool *taken, *dropped; /* children; operands */
    uint32_t n_spaces, n_taken, first_taken;
} Merging;

/* The shape of a child that is one operand; NULL: it is none. */
static ShapeFacts *child_facts(const Builder *b, const Merging *merging, uint32_t number)
{
    const NestPart *part = &b->scene->parts[merging->first + number];
    if (part->operation != NEST_OPERAND) return NULL;
    return &b->facts[b->scene->objects[b->scene->operands[part->begin]].shape];
}

/* Room for what is known of n children and n_operands; the same memory each time, as there may be very many instances. */
static void make_room(Builder *b, Merging *merging, size_t n, size_t n_operands)
{
    size_t n_spaces = 0;
    for (uint32_t i = 0; i < n; i++) {
        const ShapeFacts *facts = child_facts(b, merging, i);
        n_spaces += facts && facts->n_spaces ? facts->n_spaces : 6;
    }
    size_t key = sizeof *merging->key + n_spaces * sizeof *merging->key->spaces;
    size_t now = (n_operands + 1) * sizeof *merging->now, bytes = key + now + n + n_operands;
    if (bytes > b->scratch_bytes) {
        b->scratch_bytes = 2 * bytes;
        b->scratch = ARENA_ARRAY(b->arena, double, b->scratch_bytes / sizeof(double) + 1);
    }
    memset(b->scratch, 0, bytes);
    merging->key = b->scratch;
    merging->now = (uint32_t *)((char *)b->scratch + key);
    merging->taken = (bool *)((char *)merging->now + now);
    merging->dropped = merging->taken + n;
}

/* ---- whether they may be one ---- */

static bool has_shutter(const EvalNode *node)
{
    if (strcmp(node->type->name, "camera") == 0 && eval_number(node, "shutter") > 0) return true;
    for (size_t i = 0; i < node->n_children; i++)
        if (has_shutter(node->children[i])) return true;
    return false;
}

/* Whether anything may move while the shutter is open; what is built for a later moment is built as it was at first. */
static bool may_move(Builder *b)
{
    if (b->result.is_still) return false;
    if (build_is_later(b)) return true;
    if (b->shutter_known == SHUTTER_UNKNOWN) {
        b->shutter_known = SHUTTER_NONE;
        for (size_t i = 0; i < b->result.n_nodes; i++)
            if (has_shutter(b->result.nodes[i])) b->shutter_known = SHUTTER_OPENS;
    }
    return b->shutter_known == SHUTTER_OPENS;
}

/* Whether a surface looks the same on a mesh as on a plane or a box. */
static bool is_even(const Scene *scene, uint32_t row)
{
    if (row == SCENE_NONE) return true;
    const SceneSurface *surface = &scene->surfaces[row];
    return !surface->mixed && !surface_has_textures(surface) && surface->emission_texture == SCENE_NONE &&
           surface->spec.specular_roughness_anisotropy == 0 && surface->spec.coat_roughness_anisotropy == 0;
}

/* ---- half spaces ---- */

static void add_space(Merging *merging, const EvalNode *child, Vec3 normal, double distance)
{
    merging->key->spaces[merging->n_spaces++] = half_space_moved(&child->transform, (HalfSpace){normal, distance});
}

static void add_box(Merging *merging, const EvalNode *child, Box3 box)
{
    add_space(merging, child, vec3(-1, 0, 0), -box.min.x);
    add_space(merging, child, vec3(1, 0, 0), box.max.x);
    add_space(merging, child, vec3(0, -1, 0), -box.min.y);
    add_space(merging, child, vec3(0, 1, 0), box.max.y);
    add_space(merging, child, vec3(0, 0, -1), -box.min.z);
    add_space(merging, child, vec3(0, 0, 1), box.max.z);
}

/* Those of a child, if it is made of such; `less`: what is beyond it. */
static bool add_child(Builder *b, Merging *merging, uint32_t number, bool less)
{
    const Scene *scene = b->scene;
    const EvalNode *child = merging->node->children[number];
    const ShapeFacts *facts = child_facts(b, merging, number);
    if (!facts || eval_prop(child, "surface")) return false;
    const SceneObject *object = &scene->objects[scene->operands[scene->parts[merging->first + number].begin]];
    const Mesh *mesh = scene->shapes[object->shape].mesh;
    if (object->texture_frame != SCENE_NONE || !is_even(scene, object->surface)) return false;
    if (strcmp(child->type->name, "plane") == 0) {
        Vec3 normal = vec3_normalize(eval_vector(child, "normal"));
        double distance = eval_number(child, "distance");
        add_space(merging, child, less ? vec3_scale(normal, -1) : normal, less ? -distance : distance);
    } else if (strcmp(child->type->name, "box") == 0 && !less && mesh && mesh->n_triangles == 12) {
        add_box(merging, child, facts->bounds);
    } else if (facts->n_spaces && !less) { /* an intersection or a difference in it */
        for (uint32_t i = 0; i < facts->n_spaces; i++)
            add_space(merging, child, facts->spaces[i].normal, facts->spaces[i].distance);
    } else {
        return false;
    }
    if (!merging->n_taken++) merging->first_taken = number;
    merging->taken[number] = true;
    return true;
}

/* False where there are too few of them. */
static bool find_spaces(Builder *b, Merging *merging, NestOperation operation)
{
    size_t n = merging->node->n_children;
    bool less = operation == NEST_DIFFERENCE;
    if (!add_child(b, merging, 0, false) && less) return false;
    for (uint32_t i = 1; i < n; i++) add_child(b, merging, i, less);
    return merging->n_taken >= 2 && merging->n_spaces >= PLANES_TO_MERGE;
}

/* ---- their body ---- */

/* The shape of the body, and where its middle is in the frame of the combination; SCENE_NONE: there is none. Equal ones share
 * it. */
static uint32_t body_shape(Builder *b, const Merging *merging, Vec3 *centre)
{
    BodyKey *key = merging->key;
    bool found;
    Error error;
    memcpy(key->kind, "convex", sizeof "convex");
    uint32_t shape = build_shape_of(b, key, sizeof *key + merging->n_spaces * sizeof *key->spaces, &found);
    if (!found) {
        Status status = half_spaces_mesh(key->spaces, merging->n_spaces, &b->scene->shapes[shape].mesh,
                                         &b->facts[shape].centre, &error);
        if (!build_succeeded(b, status, &error, merging->node->span) || !b->scene->shapes[shape].mesh)
            return SCENE_NONE;
        if (!build_finish_mesh(b, merging->node, shape)) return SCENE_NONE;
        HalfSpace *kept = ARENA_ARRAY(b->arena, HalfSpace, merging->n_spaces);
        memcpy(kept, key->spaces, merging->n_spaces * sizeof *kept);
        b->facts[shape].spaces = kept;
        b->facts[shape].n_spaces = merging->n_spaces;
    }
    const ShapeFacts *facts = &b->facts[shape];
    *centre = facts->centre;
    bool sound = b->scene->shapes[shape].mesh && facts->closed && facts->consistent && !facts->many_parts &&
                 facts->finite && facts->volume > 0;
    return sound ? shape : SCENE_NONE;
}

/* ---- putting it in their place ---- */

/* Takes the operands of children but the first of them out of the tables, whose last entries they are among. */
static void drop_operands(Builder *b, const Merging *merging, uint32_t begin, uint32_t n_objects)
{
    Scene *scene = b->scene;
    uint32_t n = scene->n_operands - begin, kept = 0, *now = merging->now;
    bool *dropped = merging->dropped;
    for (uint32_t i = 0; i < merging->node->n_children; i++)
        if (merging->taken[i] && i != merging->first_taken)
            dropped[scene->parts[merging->first + i].begin - begin] = true;
    for (uint32_t i = 0; i < n; i++) {
        now[i] = begin + kept;
        if (dropped[i]) continue;
        scene->objects[n_objects + kept] = scene->objects[scene->operands[begin + i]];
        scene->operands[begin + kept] = n_objects + kept;
        kept++;
    }
    now[n] = begin + kept;
    scene->n_operands = begin + kept;
    scene->n_objects = n_objects + kept;
    for (uint32_t i = merging->first; i < scene->n_parts; i++) {
        scene->parts[i].begin = now[scene->parts[i].begin - begin];
        scene->parts[i].end = now[scene->parts[i].end - begin];
    }
}

/* The parts of what is left stand side by side; the ones behind are of nothing. */
static uint32_t drop_parts(Builder *b, const Merging *merging)
{
    Scene *scene = b->scene;
    uint32_t n = (uint32_t)merging->node->n_children, kept = 0;
    for (uint32_t i = 0; i < n; i++)
        if (!merging->taken[i] || i == merging->first_taken)
            scene->parts[merging->first + kept++] = scene->parts[merging->first + i];
    for (uint32_t i = kept; i < n; i++)
        scene->parts[merging->first + i] = (NestPart){NEST_UNION, scene->n_operands, scene->n_operands, 0, 0};
    return kept;
}

void build_merge_planes(Builder *b, const EvalNode *node, const Affine *to_world, uint32_t part, uint32_t n_objects)
{
    Scene *scene = b->scene;
    NestPart *whole = &scene->parts[part];
    Merging merging = {.node = node, .first = whole->first_child};
    Vec3 centre;
    if (b->only_shapes || b->status != STATUS_OK || whole->operation == NEST_UNION || may_move(b)) return;
    if (node->n_children < 2 || node->n_children > HALF_SPACES_MOST) return;
    make_room(b, &merging, node->n_children, scene->n_operands - whole->begin);
    if (!find_spaces(b, &merging, whole->operation)) return;
    uint32_t shape = body_shape(b, &merging, &centre);
    if (shape == SCENE_NONE) return;
    Affine place = affine_compose(to_world, &(Affine){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, centre});
    Box3 box = affine_box(&place, b->facts[shape].bounds);
    if (!(fmax(vec3_max_abs(box.min), vec3_max_abs(box.max)) <= SCENE_REACH)) return;
    uint32_t operand = whole->begin;
    for (uint32_t i = 0; i < merging.first_taken; i++) operand = scene->parts[merging.first + i].end;
    drop_operands(b, &merging, whole->begin, n_objects);
    SceneObject *object = &scene->objects[scene->operands[operand]];
    object->shape = shape;
    object->to_world = place;
    object->volume = b->facts[shape].volume * fabs(affine_determinant(&place));
    scene->shapes[shape].closed = true;
    whole->n_children = drop_parts(b, &merging);
    whole->end = scene->n_operands;
    if (whole->n_children == 1) *whole = scene->parts[whole->first_child];
}
