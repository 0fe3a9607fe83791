/* geometry.c - answers about the shape of nodes.
 *
 * A node is built as for the picture, into a scene of its own (a Model) without its own transforms, so that all
 * instances of a prototype share one; what is asked is carried into the Model's frame. Rays are traced by geom/rtc,
 * whose directions are floats, and then met with the surface that was found once more, in double. Of combinations
 * (nest/csg.h) all operands are traced, and the surfaces are where what holds the ray changes.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/geometry.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/hash.h"
#include "nest/csg.h"
#include "scene/build_parts.h"
#include "scene/lines.h"

enum {
    MODELS_MAX = 1000,     /* kept at a time; each has an Embree device of its own */
    ASKED_MAX = 100000,    /* nodes, instances of the models */
    SCATTER_TRIALS = 256,  /* rays that find out how many surfaces a ray can meet */
    SCATTER_RAYS = 100000, /* after which there is no surface to be found */
    VOLUME_LINES = 6000,   /* of each direction, to measure a combination: an error of about 1e-3 of plain ones */
    STEPS_TO_BUILD = 500   /* what a model counts, at least: the time of so many rays */
};
#define MODEL_BYTES_MAX ((size_t)1 << 30)

/* What answers need of an object of the model. */
typedef struct Part {
    Affine to_shape;
    bool closed, plane;
    uint32_t operand; /* of a combination, the number of it; SCENE_NONE */
    int32_t net;      /* how often a ray left it, less how often it entered it: 0 between questions */
} Part;

typedef struct Model {
    const EvalNode *origin; /* the node without its transforms */
    Scene *scene;
    Part *parts;                      /* beside the objects */
    NestCsg csg;                      /* its operands begin with 0; hulls are the rows of combinations */
    NestList held;                    /* operands that hold the ray: empty between questions */
    RtcScene *rtc;                    /* NULL until a ray is asked for */
    Box3 bounds;
    uint32_t first_open, first_unbounded; /* objects; SCENE_NONE */
    bool mistaken;                    /* diag says why */
    bool measured;                    /* volume is known */
    double volume;
    size_t bytes;
} Model;

/* A node that was asked of. */
typedef struct Asked {
    const EvalNode *node;
    Model *model;
    Affine to_model;
    bool flat, has_bounds;
    Box3 bounds;
    size_t most_hits; /* scatter: of the rays that were tried; 0: none were */
} Asked;

typedef struct Table {
    void **items; /* Model or Asked: both begin with the node */
    size_t n, capacity;
} Table;

typedef struct Geometry {
    const SceneOptions *options;
    Diag *diag;
    uint64_t *steps;
    Table models, asked;
    Asked *last;
    size_t bytes;
    HitList hits;
    EvalHit *found;
    size_t found_capacity;
} Geometry;

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

static void *geometry_open(const void *context, Diag *diag, uint64_t *steps)
{
    Geometry *geometry = calloc(1, sizeof *geometry);
    if (!geometry) return NULL;
    geometry->options = context;
    geometry->diag = diag;
    geometry->steps = steps;
    return geometry;
}

static void geometry_close(void *state)
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
        if (object->part_of == SCENE_NONE && box3_is_unbounded(bounds))
            model->first_unbounded = i;
        if (object->part_of == SCENE_NONE && !box3_is_empty(bounds)) model->bounds = box3_union(model->bounds, bounds);
        if (object->shape == SCENE_NONE) continue;
        part->plane = is_plane(&scene->shapes[object->shape]);
        part->closed = facts[object->shape].closed;
        if (!affine_invert(&object->to_world, &part->to_shape))
            return fail(error, STATUS_SCENE, "the transforms of %s squash it flat", object->name);
        if (!part->closed) model->first_open = i;
    }
    model->bytes = sizeof *model + scene->arena.total + scene->n_objects * (sizeof *model->parts + sizeof *scene->objects);
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
                                  .black = SCENE_NONE,
                                  .grey = SCENE_NONE,
                                  .only_shapes = true,
                                  .error = error}};
    task.node.transform = affine_identity();
    uint32_t n_errors = diag->n_errors;
    const DiagChain *chain = diag->chain;
    bool done = arena_guard(&scene->arena, build_node, &task);
    diag->chain = chain;
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

/* What is known of the node, which is built when it is asked of for the first time. */
static Status ask(Geometry *geometry, const EvalNode *node, Asked **out, Error *error)
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

static Status refuse_unbounded(const Asked *asked, const char *what, Error *error)
{
    const Model *model = asked->model;
    if (model->first_unbounded == SCENE_NONE) return STATUS_OK;
    return fail(error, STATUS_SCENE, "'%s' has no end, and so no %s", model->scene->objects[model->first_unbounded].name,
                what);
}

static Status refuse_open(const Asked *asked, Error *error)
{
    const Model *model = asked->model;
    if (model->first_open == SCENE_NONE) return STATUS_OK;
    return fail(error, STATUS_SCENE, "'%s' is an open mesh: it encloses nothing",
                model->scene->objects[model->first_open].name);
}

/* ---- bounds ---- */

static Status find_bounds(Asked *asked, Error *error)
{
    const Scene *scene = asked->model->scene;
    TRY(refuse_unbounded(asked, "bounds", error));
    if (asked->has_bounds) return STATUS_OK;
    Box3 box = box3_empty();
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        if (scene->objects[i].part_of != SCENE_NONE) continue;
        Box3 bounds = scene_object_bounds(scene, &scene->objects[i], &asked->node->transform);
        if (!box3_is_empty(bounds)) box = box3_union(box, bounds);
    }
    if (box3_is_empty(box)) return fail(error, STATUS_SCENE, "this %s holds no objects", asked->node->type->name);
    if (!vec3_is_finite(box.min) || !vec3_is_finite(box.max) ||
        fmax(vec3_max_abs(box.min), vec3_max_abs(box.max)) > SCENE_REACH)
        return fail(error, STATUS_SCENE, "this %s reaches beyond coordinates of %g", asked->node->type->name,
                    SCENE_REACH);
    asked->bounds = box;
    asked->has_bounds = true;
    return STATUS_OK;
}

static Status geometry_bounds(void *state, const EvalNode *node, Box3 *box, Error *error)
{
    Asked *asked;
    TRY(ask(state, node, &asked, error));
    TRY(find_bounds(asked, error));
    *box = asked->bounds;
    return STATUS_OK;
}

/* ---- rays ---- */

static Status need_rtc(Geometry *geometry, Model *model, Error *error)
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

/* A ray in the frame of the model; t of the true ray is t of rtc's divided by length. */
typedef struct ModelRay {
    Vec3 origin, direction;
    double length;
    Ray ray;
} ModelRay;

static Status model_ray(const Asked *asked, Vec3 from, Vec3 direction, ModelRay *ray, Error *error)
{
    ray->origin = affine_point(&asked->to_model, from);
    ray->direction = affine_vector(&asked->to_model, direction);
    ray->length = vec3_length(ray->direction);
    if (!(vec3_max_abs(ray->origin) <= SCENE_REACH) || !isfinite(ray->length) || !(ray->length > 0))
        return fail(error, STATUS_SCENE, "<%g, %g, %g> is out of reach: coordinates may not exceed %g", from.x, from.y,
                    from.z, SCENE_REACH);
    ray->ray = ray_make(ray->origin, vec3f_from(vec3_scale(ray->direction, 1 / ray->length)));
    return STATUS_OK;
}

/* Where the true ray meets the plane of a triangle that rtc's ray met. false: it is parallel to it. */
static bool meet_triangle(const Mesh *mesh, uint32_t triangle, Vec3 origin, Vec3 direction, double *t, Vec3 *normal)
{
    Vec3 corner[3];
    for (int i = 0; i < 3; i++) corner[i] = vec3_from_f(mesh->positions[mesh->triangles[triangle][i]]);
    *normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    double slope = vec3_dot(*normal, direction);
    if (slope == 0) return false;
    *t = vec3_dot(*normal, vec3_sub(corner[0], origin)) / slope;
    return true;
}

/* The crossing with a piece next to that of rtc's ray, in the same sense. false: the true ray just misses it. */
static bool meet_piece(const Piece *piece, bool entering, Vec3 origin, Vec3 direction, double *t, Vec3 *normal)
{
    double rough = *t, roots[PIECE_MAX_ROOTS], best = HUGE_VAL;
    int n = piece_intersect(piece, origin, direction, 0, HUGE_VAL, roots);
    for (int i = 0; i < n; i++) {
        Vec3 outward = piece_normal(piece, origin, direction, roots[i]);
        if ((vec3_dot(outward, direction) < 0) != entering || fabs(roots[i] - rough) >= best) continue;
        best = fabs(roots[i] - rough);
        *t = roots[i];
        *normal = outward;
    }
    return best < HUGE_VAL;
}

/* What rtc's float ray found, for the true ray. */
static EvalHit true_hit(const Asked *asked, const ModelRay *ray, Vec3 from, Vec3 direction, const Hit *hit)
{
    const Model *model = asked->model;
    const SceneShape *shape = &model->scene->shapes[model->scene->objects[hit->object].shape];
    const Affine *to_shape = &model->parts[hit->object].to_shape;
    Vec3 origin = affine_point(to_shape, ray->origin), along = affine_vector(to_shape, ray->direction);
    Vec3 normal = {0};
    double rough = hit->t / ray->length, t = rough;
    bool met = shape->mesh ? meet_triangle(shape->mesh, hit->primitive, origin, along, &t, &normal)
                           : meet_piece(&shape->solid->pieces[hit->primitive], hit->entering != hit->inside, origin,
                                        along, &t, &normal);
    if (hit->inside) normal = vec3_scale(normal, -1);
    /* at a silhouette the two rays part */
    Vec3 in_model;
    if (met && fabs(t - rough) <= 1e-4 * rough + 1e-6 * vec3_length(from)) {
        in_model = affine_normal(to_shape, normal);
    } else {
        t = rough;
        in_model = vec3_from_f(hit->normal);
    }
    in_model = vec3_normalize(affine_normal(&asked->to_model, in_model));
    return (EvalHit){.point = vec3_along(from, t, direction),
                     .normal = vec3_add(in_model, vec3(0, 0, 0)), /* no -0, which would be printed as such */
                     .distance = t};
}

/* Every surface of every object and operand along the ray; an edge that two faces of an object share is one. */
static Status trace_all(Geometry *geometry, Model *model, const Ray *ray, Error *error)
{
    HitList *hits = &geometry->hits;
    TRY(need_rtc(geometry, model, error));
    rtc_all(model->rtc, ray, false, hits);
    ++*geometry->steps;
    if (hits->out_of_memory) return fail(error, STATUS_NOMEM, "out of memory for the surfaces along a ray");
    size_t kept = 0; /* hit_repeats looks back at what it is shown: the list shrinks behind it */
    for (size_t i = 0; i < hits->n; i++) {
        HitList seen = {.items = hits->items, .n = kept + 1};
        hits->items[kept] = hits->items[i];
        if (!hit_repeats(&seen, kept)) kept++;
    }
    hits->n = kept;
    return STATUS_OK;
}

static bool below_plane(const Model *model, uint32_t object, Vec3 point)
{
    return affine_point(&model->parts[object].to_shape, point).y < 0;
}

/* Puts the operands that hold the start of the ray into model->held: those that it leaves more often than it enters,
 * and halves of space that it starts in. */
static void find_held(Model *model, const HitList *hits, Vec3 start)
{
    for (uint32_t i = 0; i < model->scene->n_objects; i++)
        if (model->parts[i].plane && model->parts[i].operand != SCENE_NONE && below_plane(model, i, start))
            nest_csg_pass(&model->csg, &model->held, model->parts[i].operand, true);
    for (size_t i = 0; i < hits->n; i++) model->parts[hits->items[i].object].net += hits->items[i].entering ? -1 : 1;
    for (size_t i = 0; i < hits->n; i++) {
        Part *part = &model->parts[hits->items[i].object];
        if (part->net > 0 && part->operand != SCENE_NONE && !part->plane) nest_csg_pass(&model->csg, &model->held, part->operand, true);
        part->net = 0;
    }
}

/* Whether the hit crosses the surface of the combination that it belongs to; *entering is then said of that. */
static bool crosses_combination(Model *model, const Hit *hit, bool *entering)
{
    uint32_t operand = model->parts[hit->object].operand, tree = nest_csg_tree(&model->csg, operand);
    bool before = nest_csg_holds(&model->csg, tree, &model->held);
    nest_csg_pass(&model->csg, &model->held, operand, hit->entering);
    *entering = nest_csg_holds(&model->csg, tree, &model->held);
    return *entering != before;
}

/* A crossing of a combination at the place of the last one kept, the other way: between them there is nothing. */
static bool cancels(const Model *model, const HitList *hits, size_t kept, const Hit *hit)
{
    if (kept == 0) return false;
    const Hit *last = &hits->items[kept - 1];
    uint32_t a = model->parts[last->object].operand, b = model->parts[hit->object].operand;
    if (a == SCENE_NONE || nest_csg_tree(&model->csg, a) != nest_csg_tree(&model->csg, b)) return false;
    double steep = fmax(fabs(hit->cos_normal), fabs(last->cos_normal));
    return (hit->t - last->t) * steep <= fmax(hit->rounding, last->rounding);
}

/* Of the surfaces of operands those are left that are surfaces of the whole, with normals out of that. Hit.inside is
 * set where that is not the operand's own normal. */
static void combine(Model *model, HitList *hits, Vec3 start)
{
    if (!model->csg.n_trees) return;
    find_held(model, hits, start);
    size_t kept = 0;
    for (size_t i = 0; i < hits->n; i++) {
        Hit hit = hits->items[i];
        bool entering = hit.entering;
        if (model->parts[hit.object].operand != SCENE_NONE) {
            if (!crosses_combination(model, &hit, &entering)) continue;
            if (cancels(model, hits, kept, &hit)) {
                kept--;
                continue;
            }
        }
        hit.inside = entering != hit.entering;
        if (hit.inside) hit.normal = vec3f_negate(hit.normal);
        hit.entering = entering;
        hits->items[kept++] = hit;
    }
    hits->n = kept;
    model->held.n = 0;
}

/* The surfaces along the ray, or the first of them. */
static Status trace(Geometry *geometry, const Asked *asked, const ModelRay *ray, bool all, Error *error)
{
    Model *model = asked->model;
    HitList *hits = &geometry->hits;
    if (all || model->csg.n_trees) {
        TRY(trace_all(geometry, model, &ray->ray, error));
        combine(model, hits, ray->ray.origin);
        if (!all && hits->n > 1) hits->n = 1;
        return STATUS_OK;
    }
    TRY(need_rtc(geometry, model, error));
    if (rtc_nearest(model->rtc, &ray->ray, hits, NULL)) hits->n = 1;
    ++*geometry->steps;
    return hits->out_of_memory ? fail(error, STATUS_NOMEM, "out of memory for the surfaces along a ray") : STATUS_OK;
}

static Status geometry_hits(void *state, const EvalNode *node, Vec3 from, Vec3 direction, bool all,
                            const EvalHit **found, size_t *n, Error *error)
{
    Geometry *geometry = state;
    Asked *asked;
    ModelRay ray;
    *n = 0;
    TRY(ask(geometry, node, &asked, error));
    TRY(model_ray(asked, from, direction, &ray, error));
    TRY(trace(geometry, asked, &ray, all, error));
    for (size_t i = 0; i < geometry->hits.n; i++) {
        if (!ARRAY_ROOM(geometry->found, geometry->found_capacity, *n))
            return fail(error, STATUS_NOMEM, "out of memory for the surfaces along a ray");
        geometry->found[(*n)++] = true_hit(asked, &ray, from, direction, &geometry->hits.items[i]);
    }
    *found = geometry->found;
    return STATUS_OK;
}

/* ---- inside and outside ---- */

/* Whether any object is left more often than it is entered by a ray from the point, or a combination is made up of such
 * ones. */
static Status inside_along(Geometry *geometry, Model *model, Vec3 point, int direction, bool *inside, Error *error)
{
    Ray ray = ray_make(point, vec3f_from(line_direction(direction)));
    HitList *hits = &geometry->hits;
    TRY(trace_all(geometry, model, &ray, error));
    *inside = false;
    for (uint32_t i = 0; i < model->scene->n_objects; i++)
        if (model->parts[i].plane && model->parts[i].operand == SCENE_NONE) *inside = *inside || below_plane(model, i, point);
    for (size_t i = 0; i < hits->n; i++) model->parts[hits->items[i].object].net += hits->items[i].entering ? -1 : 1;
    for (size_t i = 0; i < hits->n; i++) {
        const Part *part = &model->parts[hits->items[i].object];
        if (part->net > 0 && !part->plane && part->operand == SCENE_NONE) *inside = true;
    }
    for (size_t i = 0; i < hits->n; i++) model->parts[hits->items[i].object].net = 0;
    if (!model->csg.n_trees) return STATUS_OK;
    find_held(model, hits, point);
    for (uint32_t i = 0; i < model->held.n; i++)
        if (nest_csg_holds(&model->csg, nest_csg_tree(&model->csg, nest_list_items(&model->held)[i]), &model->held))
            *inside = true;
    model->held.n = 0;
    return STATUS_OK;
}

/* Two directions must agree; else a third decides. */
static Status geometry_inside(void *state, const EvalNode *node, Vec3 point, bool *inside, Error *error)
{
    Geometry *geometry = state;
    Asked *asked;
    TRY(ask(geometry, node, &asked, error));
    TRY(refuse_open(asked, error));
    Model *model = asked->model;
    Vec3 p = affine_point(&asked->to_model, point);
    *inside = false;
    if (!box3_holds_point(model->bounds, p)) return STATUS_OK;
    bool first, second;
    TRY(inside_along(geometry, model, p, 0, &first, error));
    TRY(inside_along(geometry, model, p, 1, &second, error));
    *inside = first;
    return first == second ? STATUS_OK : inside_along(geometry, model, p, 2, inside, error);
}

/* ---- volume ---- */

/* What a combination encloses has no closed form: it is measured along evenly spread lines. */
static Status measure_combination(Geometry *geometry, Model *model, uint32_t object, double *volume, Error *error)
{
    Box3 box = scene_object_bounds(model->scene, &model->scene->objects[object], NULL);
    for (int direction = 0; direction < LINE_DIRECTIONS && !box3_is_empty(box); direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, box, direction, VOLUME_LINES, 0);
        while (line_set_next(&set, &line)) {
            Ray ray = ray_make(line.start, line.direction);
            TRY(trace_all(geometry, model, &ray, error));
            combine(model, &geometry->hits, ray.origin);
            for (size_t i = 0; i < geometry->hits.n; i++) {
                const Hit *hit = &geometry->hits.items[i];
                if (model->scene->objects[hit->object].part_of != object) continue;
                *volume += (hit->entering ? -hit->t : hit->t) * line.area / LINE_DIRECTIONS;
            }
        }
    }
    return STATUS_OK;
}

static Status geometry_volume(void *state, const EvalNode *node, double *volume, Error *error)
{
    Asked *asked;
    TRY(ask(state, node, &asked, error));
    TRY(refuse_unbounded(asked, "volume", error));
    TRY(refuse_open(asked, error));
    Model *model = asked->model;
    for (uint32_t i = 0; i < model->scene->n_objects && !model->measured; i++) {
        const SceneObject *object = &model->scene->objects[i];
        if (object->tree != SCENE_NONE)
            TRY(measure_combination(state, model, i, &model->volume, error));
        else if (object->part_of == SCENE_NONE)
            model->volume += object->volume;
    }
    model->measured = true;
    *volume = model->volume * fabs(affine_determinant(&node->transform));
    return STATUS_OK;
}

/* ---- places on the surface ---- */

static double next_unit(uint64_t *h)
{
    *h = hash_u64(*h);
    return hash_to_unit(*h);
}

/* The surfaces along a random line through the ball around the node. Lines that are spread evenly over all
 * directions and over the ball's disc across each meet every piece of surface as often as it is large (Cauchy and
 * Crofton). */
static Status random_line(Geometry *geometry, const Asked *asked, uint64_t *h, Vec3 *start, Vec3 *direction,
                          ModelRay *ray, Error *error)
{
    Vec3 half = vec3_scale(vec3_sub(asked->bounds.max, asked->bounds.min), 0.5);
    double radius = vec3_length(half) * (1 + 1e-6);
    double y = 2 * next_unit(h) - 1, turn = 6.283185307179586 * next_unit(h), ring = sqrt(fmax(0, 1 - y * y));
    double off = radius * sqrt(next_unit(h)), at = 6.283185307179586 * next_unit(h);
    *direction = vec3(ring * cos(turn), y, ring * sin(turn));
    Affine frame = build_frame(vec3_add(asked->bounds.min, half), *direction);
    *start = affine_point(&frame, vec3(off * cos(at), -2 * radius, off * sin(at)));
    TRY(model_ray(asked, *start, *direction, ray, error));
    return trace(geometry, asked, ray, true, error);
}

static Status find_most_hits(Geometry *geometry, Asked *asked, Error *error)
{
    Vec3 start, direction;
    ModelRay ray;
    uint64_t h = 1;
    TRY(find_bounds(asked, error));
    if (asked->most_hits) return STATUS_OK;
    asked->most_hits = 1;
    for (int i = 0; i < SCATTER_TRIALS; i++) {
        TRY(random_line(geometry, asked, &h, &start, &direction, &ray, error));
        if (geometry->hits.n > asked->most_hits) asked->most_hits = geometry->hits.n;
    }
    return STATUS_OK;
}

/* A line counts as often as it has hits: it is taken with the chance that it has of the most, and then one of them.
 * A line with more hits than any of the trials counts as one of those. */
static Status geometry_scatter(void *state, const EvalNode *node, uint64_t seed, EvalHit *place, Error *error)
{
    Geometry *geometry = state;
    Asked *asked;
    Vec3 start, direction;
    ModelRay ray;
    TRY(ask(geometry, node, &asked, error));
    TRY(refuse_unbounded(asked, "evenly distributed places", error));
    TRY(find_most_hits(geometry, asked, error));
    for (int i = 0; i < SCATTER_RAYS; i++) {
        TRY(random_line(geometry, asked, &seed, &start, &direction, &ray, error));
        double chosen = next_unit(&seed) * (double)asked->most_hits;
        size_t n = geometry->hits.n;
        if (n >= asked->most_hits) chosen *= (double)n / (double)asked->most_hits;
        if (!(chosen < (double)n)) continue;
        *place = true_hit(asked, &ray, start, direction, &geometry->hits.items[(size_t)chosen]);
        return STATUS_OK;
    }
    return fail(error, STATUS_SCENE, "no ray out of %d met a surface of this %s", SCATTER_RAYS, node->type->name);
}

const EvalGeometry scene_geometry = {
    .open = geometry_open,
    .close = geometry_close,
    .bounds = geometry_bounds,
    .volume = geometry_volume,
    .inside = geometry_inside,
    .hits = geometry_hits,
    .scatter = geometry_scatter,
};
