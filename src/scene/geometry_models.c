/* geometry_models.c - building what answers about the shape of nodes come from, and keeping it for the next questions.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/geometry_models.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "scene/build_parts.h"

enum {
    MODELS_MAX = 1000,   /* kept at a time; each has an Embree device of its own */
    ASKED_MAX = 100000,  /* nodes, instances of the models */
    STEPS_TO_BUILD = 500 /* what a model counts, at least: the time of so many rays */
};
#define MODEL_BYTES_MAX ((size_t)1 << 30)

/* ---- what is remembered ---- */

static const EvalNode *node_of(const void *item)
{
    return *(const EvalNode *const *)item;
}

/* Where the node stands, or a free place. */
static void **table_place(const Table *table, const EvalNode *node)
{
    size_t place = (size_t)hash_u64((uintptr_t)node) & (table->capacity - 1);
    while (table->items[place] && node_of(table->items[place]) != node) place = (place + 1) & (table->capacity - 1);
    return &table->items[place];
}

static void *table_find(const Table *table, const EvalNode *node)
{
    return table->capacity ? *table_place(table, node) : NULL;
}

static bool table_reserve(Table *table)
{
    if (2 * (table->n + 1) <= table->capacity) return true;
    Table grown = {.capacity = table->capacity ? 2 * table->capacity : 64, .n = table->n};
    grown.items = calloc(grown.capacity, sizeof *grown.items);
    if (!grown.items) return false;
    for (size_t i = 0; i < table->capacity; i++)
        if (table->items[i]) *table_place(&grown, node_of(table->items[i])) = table->items[i];
    free(table->items);
    *table = grown;
    return true;
}

/* after table_reserve */
static void table_add(Table *table, void *item)
{
    *table_place(table, node_of(item)) = item;
    table->n++;
}

static void model_free(Model *model)
{
    rtc_scene_free(model->rtc);
    scene_free(model->scene);
    nest_list_clear(&model->held);
    free(model->csg.trees);
    free(model->csg.tree_of_operand);
    free(model->parts);
    free(model);
}

static void forget(Geometry *geometry)
{
    for (size_t i = 0; i < geometry->models.capacity; i++)
        if (geometry->models.items[i]) model_free(geometry->models.items[i]);
    for (size_t i = 0; i < geometry->asked.capacity; i++) free(geometry->asked.items[i]);
    free(geometry->models.items);
    free(geometry->asked.items);
    geometry->models = geometry->asked = (Table){0};
    geometry->last = NULL;
    geometry->bytes = 0;
}

void *geometry_open(const void *context, double unit_m, Diag *diag, uint64_t *steps)
{
    Geometry *geometry = calloc(1, sizeof *geometry);
    if (!geometry) return NULL;
    geometry->options = context;
    geometry->unit_m = unit_m;
    geometry->diag = diag;
    geometry->steps = steps;
    return geometry;
}

void geometry_close(void *state)
{
    Geometry *geometry = state;
    forget(geometry);
    hit_list_clear(&geometry->hits);
    free(geometry->found);
    free(geometry);
}

/* ---- building ---- */

typedef struct BuildTask {
    Builder builder;
    EvalNode node;
} BuildTask;

static void build_node(void *context)
{
    BuildTask *task = context;
    Affine frame = affine_identity();
    build_visit(&task->builder, &task->node, &frame);
}

static size_t mesh_bytes(const Mesh *mesh)
{
    return mesh ? mesh->n_vertices * sizeof(Vec3f) + mesh->n_triangles * sizeof *mesh->triangles : 0;
}

static bool is_plane(const SceneShape *shape)
{
    return shape->solid && shape->solid->n_pieces == 1 && shape->solid->pieces[0].kind == PIECE_PLANE;
}

static Status describe_parts(Model *model, const ShapeFacts *facts, Error *error)
{
    Scene *scene = model->scene;
    model->parts = calloc(scene->n_objects + 1U, sizeof *model->parts);
    if (!model->parts) return fail_memory(error, scene->n_objects * sizeof *model->parts, "the shape of a node");
    model->bounds = box3_empty();
    model->first_open = model->first_unbounded = SCENE_NONE;
    for (uint32_t i = scene->n_objects; i-- > 0;) {
        const SceneObject *object = &scene->objects[i];
        Part *part = &model->parts[i];
        part->operand = SCENE_NONE;
        part->closed = true;
        Box3 bounds = scene_object_bounds(scene, object, NULL);
        if (object->part_of == SCENE_NONE && box3_is_unbounded(bounds)) model->first_unbounded = i;
        if (object->part_of == SCENE_NONE && !box3_is_empty(bounds)) model->bounds = box3_union(model->bounds, bounds);
        if (object->shape == SCENE_NONE) continue;
        part->plane = is_plane(&scene->shapes[object->shape]);
        part->closed = facts[object->shape].closed;
        if (!affine_invert(&object->to_world, &part->to_shape))
            return fail(error, STATUS_SCENE, "the transforms of %s squash it flat", object->name);
        if (!part->closed) model->first_open = i;
    }
    model->bytes =
        sizeof *model + scene->arena.total + scene->n_objects * (sizeof *model->parts + sizeof *scene->objects);
    for (uint32_t i = 0; i < scene->n_shapes; i++) model->bytes += mesh_bytes(scene->shapes[i].mesh);
    return STATUS_OK;
}

/* Which operand is what, and of which combination. */
static Status describe_combinations(Model *model, Error *error)
{
    const Scene *scene = model->scene;
    NestCsg *csg = &model->csg;
    *csg = (NestCsg){0, scene->n_operands, scene->n_trees, scene->n_parts, scene->parts, NULL, NULL};
    csg->trees = malloc((scene->n_trees + 1U) * sizeof *csg->trees);
    csg->tree_of_operand = malloc((scene->n_operands + 1U) * sizeof *csg->tree_of_operand);
    if (!csg->trees || !csg->tree_of_operand || nest_list_reserve(&model->held, scene->n_operands) != STATUS_OK)
        return fail_memory(error, scene->n_operands * sizeof *csg->trees, "a combination of objects");
    for (uint32_t i = 0; i < scene->n_trees; i++)
        csg->trees[i] = (NestTree){scene->trees[i].root, scene->trees[i].object};
    for (uint32_t i = 0; i < scene->n_operands; i++) {
        const SceneObject *object = &scene->objects[scene->operands[i]];
        model->parts[scene->operands[i]].operand = i;
        csg->tree_of_operand[i] = scene->objects[object->part_of].tree;
    }
    return STATUS_OK;
}

static Status build_model(Geometry *geometry, Model *model, Error *error)
{
    Scene *scene = model->scene = calloc(1, sizeof *scene);
    if (!scene) return fail_memory(error, sizeof *scene, "the shape of a node");
    arena_init(&scene->arena);
    Diag *diag = geometry->diag;
    BuildTask task = {.node = *model->origin,
                      .builder = {.scene = scene,
                                  .arena = &scene->arena,
                                  .diag = diag,
                                  .options = geometry->options,
                                  .eval_options = scene_eval_options(geometry->options),
                                  .result = {.unit_m = geometry->unit_m},
                                  .black = SCENE_NONE,
                                  .grey = SCENE_NONE,
                                  .only_shapes = true,
                                  .error = error}};
    task.node.transform = affine_identity();
    task.builder.eval_options.arena = &scene->arena; /* for what functions are compiled to */
    uint32_t n_errors = diag->n_errors;
    const DiagChain *chain = diag->chain;
    bool done = arena_guard(&scene->arena, build_node, &task);
    diag->chain = chain;
    mesh_kept_clear(&task.builder.kept_mesh);
    if (!done) return fail(error, STATUS_NOMEM, "out of memory for the shape of a node");
    TRY(task.builder.status);
    model->mistaken = diag->n_errors != n_errors;
    if (model->mistaken) return STATUS_OK;
    TRY(describe_parts(model, task.builder.facts, error));
    return describe_combinations(model, error);
}

static Status find_model(Geometry *geometry, const EvalNode *origin, Model **out, Error *error)
{
    *out = table_find(&geometry->models, origin);
    if (*out) return STATUS_OK;
    Model *model = calloc(1, sizeof *model);
    if (!model || !table_reserve(&geometry->models)) {
        free(model);
        return fail_memory(error, sizeof(Model), "the shape of a node");
    }
    model->origin = origin;
    nest_list_init(&model->held);
    Status status = build_model(geometry, model, error);
    if (status != STATUS_OK) {
        model_free(model);
        return status;
    }
    table_add(&geometry->models, model);
    geometry->bytes += model->bytes;
    *geometry->steps += STEPS_TO_BUILD + model->bytes / 64;
    *out = model;
    return STATUS_OK;
}

static Status ask_first(Geometry *geometry, const EvalNode *node, Asked **out, Error *error)
{
    if (geometry->bytes > MODEL_BYTES_MAX || geometry->models.n >= MODELS_MAX || geometry->asked.n >= ASKED_MAX)
        forget(geometry);
    const EvalNode *origin = node;
    while (origin->prototype) origin = origin->prototype;
    Model *model;
    TRY(find_model(geometry, origin, &model, error));
    Asked *asked = calloc(1, sizeof *asked);
    if (!asked || !table_reserve(&geometry->asked)) {
        free(asked);
        return fail_memory(error, sizeof(Asked), "the shape of a node");
    }
    *asked = (Asked){.node = node, .model = model};
    asked->flat = !affine_invert(&node->transform, &asked->to_model);
    table_add(&geometry->asked, asked);
    *out = asked;
    return STATUS_OK;
}

Status geometry_ask(Geometry *geometry, const EvalNode *node, Asked **out, Error *error)
{
    Asked *asked = geometry->last;
    if (!asked || asked->node != node) asked = table_find(&geometry->asked, node);
    if (!asked) TRY(ask_first(geometry, node, &asked, error));
    geometry->last = asked;
    *out = asked;
    const Scene *scene = asked->model->scene;
    if (asked->model->mistaken) return fail(error, STATUS_SCENE, "%s", "");
    if (asked->flat) return fail(error, STATUS_SCENE, "the transforms of this %s squash it flat", node->type->name);
    if (scene->n_objects == 0 && !(node->type->flags & NODE_CHILDREN))
        return fail(error, STATUS_SCENE, "a %s has no shape: ask of an object, or of a group of them",
                    node->type->name);
    return STATUS_OK;
}

Status geometry_need_rtc(Geometry *geometry, Model *model, Error *error)
{
    if (model->rtc) return STATUS_OK;
    const Scene *scene = model->scene;
    RtcObject *objects = malloc((scene->n_objects + 1U) * sizeof *objects);
    if (!objects) return fail_memory(error, scene->n_objects * sizeof *objects, "the shape of a node");
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        objects[i] = (RtcObject){.to_world = scene->objects[i].to_world};
        if (scene->objects[i].shape == SCENE_NONE) continue; /* a combination: its operands have the geometry */
        objects[i].mesh = scene->shapes[scene->objects[i].shape].mesh;
        objects[i].solid = scene->shapes[scene->objects[i].shape].solid;
    }
    Status status = rtc_scene_new(objects, scene->n_objects, 0, 1, &model->rtc, error);
    free(objects);
    TRY(status);
    size_t bytes = rtc_scene_bytes(model->rtc);
    model->bytes += bytes;
    geometry->bytes += bytes;
    return STATUS_OK;
}
