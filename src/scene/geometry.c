/* geometry.c - answers about the shape of nodes.
 *
 * A node is built as for the picture, into a scene of its own (a Model, scene/geometry_models.h) without its own transforms,
 * so that all instances of a prototype share one; what is asked is carried into the Model's frame. Rays are traced by
 * geom/rtc, whose directions are floats, and then met with the surface that was found once more, in double. Of
 * combinations (nest/csg.h) all operands are traced, and the surfaces are where what holds the ray changes.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/geometry.h"

#include "base/angle.h"
#include "base/array.h"
#include "base/hash.h"
#include "scene/build_parts.h"
#include "scene/geometry_models.h"
#include "scene/lines.h"

enum {
    SCATTER_TRIALS = 256,  /* rays that find out how many surfaces a ray can meet */
    SCATTER_RAYS = 100000, /* after which there is no surface to be found */
    VOLUME_LINES = 6000    /* of each direction, to measure a combination: an error of about 1e-3 of plain ones */
};

/* ---- what has no answer ---- */

static Status refuse_unbounded(const Asked *asked, const char *what, Error *error)
{
    const Model *model = asked->model;
    if (model->first_unbounded == SCENE_NONE) return STATUS_OK;
    return fail(error, STATUS_SCENE, "'%s' has no end, and so no %s",
                model->scene->objects[model->first_unbounded].name, what);
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
    TRY(geometry_ask(state, node, &asked, error));
    TRY(find_bounds(asked, error));
    *box = asked->bounds;
    return STATUS_OK;
}

/* ---- rays ---- */

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

/* Where the true ray meets the plane of a triangle that rtc's ray met, whose corners only rtc knows: it has them in an
 * order of its own. false: it is parallel to it. */
static bool meet_triangle(const RtcScene *rtc, const Hit *hit, const ModelRay *ray, double *t, Vec3 *normal)
{
    Vec3 corner[3];
    rtc_triangle(rtc, hit->object, hit->primitive, ray->ray.time, corner);
    *normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    double slope = vec3_dot(*normal, ray->direction);
    if (slope == 0) return false;
    *t = vec3_dot(*normal, vec3_sub(corner[0], ray->origin)) / slope;
    return true;
}

/* The crossing with a piece next to that of rtc's ray, in the same sense. false: the true ray just misses it. */
static bool meet_piece(const Model *model, const Solid *solid, const Hit *hit, const ModelRay *ray, double *t,
                       Vec3 *normal)
{
    const Affine *to_shape = &model->parts[hit->object].to_shape;
    const Piece *piece = &solid->pieces[hit->primitive];
    bool entering = hit->entering != hit->inside;
    Vec3 origin = affine_point(to_shape, ray->origin), direction = affine_vector(to_shape, ray->direction);
    double rough = *t, roots[PIECE_MAX_ROOTS], best = HUGE_VAL;
    int n = piece_intersect(piece, origin, direction, 0, HUGE_VAL, roots);
    for (int i = 0; i < n; i++) {
        Vec3 outward = piece_normal(piece, origin, direction, roots[i]);
        if ((vec3_dot(outward, direction) < 0) != entering || fabs(roots[i] - rough) >= best) continue;
        best = fabs(roots[i] - rough);
        *t = roots[i];
        *normal = affine_normal(to_shape, outward);
    }
    return best < HUGE_VAL;
}

/* What rtc's float ray found, for the true ray. */
static EvalHit true_hit(const Asked *asked, const ModelRay *ray, Vec3 from, Vec3 direction, const Hit *hit)
{
    const Model *model = asked->model;
    const SceneShape *shape = &model->scene->shapes[model->scene->objects[hit->object].shape];
    Vec3 normal = {0};
    double rough = hit->t / ray->length, t = rough;
    bool met = shape->mesh ? meet_triangle(model->rtc, hit, ray, &t, &normal)
                           : meet_piece(model, shape->solid, hit, ray, &t, &normal);
    if (hit->inside) normal = vec3_scale(normal, -1);
    /* at a silhouette the two rays part */
    if (!met || !(fabs(t - rough) <= 1e-4 * rough + 1e-6 * vec3_length(from))) {
        t = rough;
        normal = vec3_from_f(hit->normal);
    }
    normal = vec3_normalize(affine_normal(&asked->to_model, normal));
    return (EvalHit){.point = vec3_along(from, t, direction),
                     .normal = vec3_add(normal, vec3(0, 0, 0)), /* no -0, which would be printed as such */
                     .distance = t};
}

/* Every surface of every object and operand along the ray; an edge that two faces of an object share is one. */
static Status trace_all(Geometry *geometry, Model *model, const Ray *ray, Error *error)
{
    HitList *hits = &geometry->hits;
    TRY(geometry_need_rtc(geometry, model, error));
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
        if (part->net > 0 && part->operand != SCENE_NONE && !part->plane)
            nest_csg_pass(&model->csg, &model->held, part->operand, true);
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
    TRY(geometry_need_rtc(geometry, model, error));
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
    TRY(geometry_ask(geometry, node, &asked, error));
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
        if (model->parts[i].plane && model->parts[i].operand == SCENE_NONE)
            *inside = *inside || below_plane(model, i, point);
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
    TRY(geometry_ask(geometry, node, &asked, error));
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
    TRY(geometry_ask(state, node, &asked, error));
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
    double y = 2 * next_unit(h) - 1, turn = 2 * MEN_PI * next_unit(h), ring = sqrt(fmax(0, 1 - y * y));
    double off = radius * sqrt(next_unit(h)), at = 2 * MEN_PI * next_unit(h);
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
    TRY(geometry_ask(geometry, node, &asked, error));
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
