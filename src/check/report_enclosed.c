/* report_enclosed.c - objects and lights that are wholly inside of one opaque object, so that nothing is seen of them.
 * A remark that is wrong costs more than one that is missing. Nothing is tried along lines here, then, but proved: the space
 * that the inner object takes is halved until every cell of it is either clear of the inner object or within the outer one.
 * Where the two touch there is no end to that, and no remark.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "check/report_parts.h"
#include "mesh/box_pairs.h"
#include "shape/ball_side.h"

enum {
    CELLS_OF_PAIR = 20000,
    CELLS_IN_ALL = 200000, /* beside the first of each pair: about half a second */
    CELLS_OF_LAMPS = 20000,
    MOST_LAMPS = 4096, /* that are asked for one by one */
    CELLS_OF_CAMERA = 4000,
    HALVINGS = 48,    /* in all three directions together */
    HALVINGS_OUT = 9, /* after so many, a cell that is outside is not halved to find the inner object in a part of it */
    PAIRS = 50000000  /* of bounds that meet, about two seconds */
};

/* What takes long to make, of a shape that a ball is asked about. */
typedef struct Known {
    bool made, failed;
    BoxTree triangles;
    ProfileTree profile;
} Known;

typedef enum CameraPlace { CAMERA_NOT_ASKED, CAMERA_OUTSIDE, CAMERA_WITHIN } CameraPlace;

/* Things are numbered: the scene's objects, and behind these its lights. */
typedef struct Enclosures {
    const CompiledScene *compiled;
    const Scene *scene;
    bool lamps;   /* is looked for, and not for what does not shine */
    Box3 *bounds; /* of each thing; empty for what neither holds nor is held; may be larger until is_tight */
    bool *is_tight;
    bool *may_hold; /* of each object */
    CameraPlace *cameras;
    uint32_t *holder; /* of each thing: the smallest object that it is inside of, or SCENE_NONE */
    Known *known;     /* of each shape */
    uint32_t cells_left;
    uint64_t pairs_left;
} Enclosures;

/* ---- a ball and an object ---- */

static const Known *know(Enclosures *e, uint32_t number)
{
    Known *known = &e->known[number];
    const SceneShape *shape = &e->scene->shapes[number];
    if (known->made) return known;
    known->made = true;
    Status status = shape->mesh ? mesh_box_tree(shape->mesh, &known->triangles, NULL)
                                : profile_tree_make(shape->solid, &known->profile, NULL);
    known->failed = status != STATUS_OK;
    return known;
}

/* In the world. BALL_NEAR where it is not known, as of what moves. */
static BallSide side_of_shape(Enclosures *e, const SceneObject *object, Ball ball)
{
    const SceneShape *shape = &e->scene->shapes[object->shape];
    Affine inverse;
    if (object->motion != SCENE_NONE || shape->mesh_end || !affine_invert(&object->to_world, &inverse))
        return BALL_NEAR;
    const Known *known = know(e, object->shape);
    if (known->failed) return BALL_NEAR;
    Vec3 centre = affine_point(&inverse, ball.centre);
    double radius = double_max(ball.radius * affine_largest_stretch(&inverse), 4 * rtc_rounding(centre));
    return shape->mesh ? mesh_ball_side(shape->mesh, &known->triangles, centre, radius)
                       : solid_ball_side(shape->solid, &known->profile, centre, radius);
}

/* Of a combination what follows from its operands. */
static BallSide side_of_part(Enclosures *e, uint32_t number, Ball ball)
{
    const NestPart *part = &e->scene->parts[number];
    if (part->operation == NEST_OPERAND)
        return side_of_shape(e, &e->scene->objects[e->scene->operands[part->begin]], ball);
    BallSide decides = part->operation == NEST_UNION ? BALL_INSIDE : BALL_OUTSIDE;
    BallSide side = decides == BALL_INSIDE ? BALL_OUTSIDE : BALL_INSIDE;
    for (uint32_t i = 0; i < part->n_children; i++) {
        BallSide child = side_of_part(e, part->first_child + i, ball);
        if (part->operation == NEST_DIFFERENCE && i > 0 && child != BALL_NEAR)
            child = child == BALL_INSIDE ? BALL_OUTSIDE : BALL_INSIDE;
        if (child == decides) return decides;
        if (child == BALL_NEAR) side = BALL_NEAR;
    }
    return side;
}

static BallSide side_of(Enclosures *e, uint32_t number, Ball ball)
{
    const SceneObject *object = &e->scene->objects[number];
    return object->tree != SCENE_NONE ? side_of_part(e, e->scene->trees[object->tree].root, ball)
                                      : side_of_shape(e, object, ball);
}

/* ---- cells ---- */

static double rounding_in(Box3 box)
{
    double largest = double_max(vec3_max_abs(box.min), vec3_max_abs(box.max));
    return rtc_rounding(vec3(largest, largest, largest));
}

/* With some room beyond what the coordinates of surfaces can be off by. */
static Ball ball_around(Box3 cell)
{
    return (Ball){box3_centre(cell), vec3_length(vec3_sub(cell.max, cell.min)) / 2 + 16 * rounding_in(cell)};
}

static void halve(Box3 cell, Box3 halves[2])
{
    Vec3 size = vec3_sub(cell.max, cell.min), middle = box3_centre(cell);
    halves[0] = halves[1] = cell;
    if (size.x >= size.y && size.x >= size.z)
        halves[0].max.x = halves[1].min.x = middle.x;
    else if (size.y >= size.z)
        halves[0].max.y = halves[1].min.y = middle.y;
    else
        halves[0].max.z = halves[1].min.z = middle.z;
}

typedef struct Proof {
    uint32_t inner, outer;
    bool hollow; /* of the inner object only the surface counts */
    uint32_t cells_left;
} Proof;

/* Whether all that is in the cell of the inner object is known to be inside of the outer one. */
static bool is_held(Enclosures *e, Proof *proof, Box3 cell, int halvings)
{
    Ball ball = ball_around(cell);
    BallSide outer = side_of(e, proof->outer, ball);
    if (outer == BALL_INSIDE) return true;
    BallSide inner = side_of(e, proof->inner, ball);
    if (inner == BALL_OUTSIDE || (inner == BALL_INSIDE && proof->hollow)) return true;
    if (outer == BALL_OUTSIDE && (inner == BALL_INSIDE || halvings >= HALVINGS_OUT)) return false;
    if (halvings == HALVINGS || proof->cells_left < 2 || e->cells_left < 2) return false;
    proof->cells_left -= 2;
    e->cells_left -= 2;
    Box3 halves[2];
    halve(cell, halves);
    return is_held(e, proof, halves[0], halvings + 1) && is_held(e, proof, halves[1], halvings + 1);
}

static bool is_clear_of(Enclosures *e, uint32_t object, Box3 cell, uint32_t *cells_left)
{
    BallSide side = side_of(e, object, ball_around(cell));
    if (side != BALL_NEAR || *cells_left < 2) return side == BALL_OUTSIDE;
    *cells_left -= 2;
    Box3 halves[2];
    halve(cell, halves);
    return is_clear_of(e, object, halves[0], cells_left) && is_clear_of(e, object, halves[1], cells_left);
}

/* From within one sees what is in there. A camera that is not known to be outside counts as within. */
static bool holds_no_camera(Enclosures *e, uint32_t object)
{
    const Scene *scene = e->scene;
    if (e->cameras[object] != CAMERA_NOT_ASKED) return e->cameras[object] == CAMERA_OUTSIDE;
    e->cameras[object] = CAMERA_WITHIN;
    for (uint32_t i = 0; i < scene->n_cameras; i++) {
        const SceneCamera *camera = &scene->cameras[i];
        Box3 box = scene_camera_bounds(scene, camera);
        for (uint32_t k = 0; camera->keys && k < scene->n_keys; k++)
            box = box3_union(box, scene_camera_bounds(scene, &camera->keys[k]));
        Vec3 lens = vec3(camera->lens_reach, camera->lens_reach, camera->lens_reach);
        uint32_t cells_left = CELLS_OF_CAMERA;
        box = (Box3){vec3_sub(box.min, lens), vec3_add(box.max, lens)};
        if (!is_clear_of(e, object, box, &cells_left)) return false;
    }
    e->cameras[object] = CAMERA_OUTSIDE;
    return true;
}

/* ---- pairs ---- */

static bool lies_within(Box3 inner, Box3 outer)
{
    double slack = 4 * rounding_in(outer);
    return outer.min.x + slack < inner.min.x && inner.max.x < outer.max.x - slack &&
           outer.min.y + slack < inner.min.y && inner.max.y < outer.max.y - slack &&
           outer.min.z + slack < inner.min.z && inner.max.z < outer.max.z - slack;
}

static double extent_of(Box3 box)
{
    return vec3_length(vec3_sub(box.max, box.min));
}

static bool is_light(const Enclosures *e, uint32_t thing)
{
    return thing >= e->scene->n_objects;
}

/* The row of its light; SCENE_NONE: it does not shine. */
static uint32_t light_of(const Enclosures *e, uint32_t thing)
{
    return is_light(e, thing) ? thing - e->scene->n_objects : e->scene->objects[thing].light;
}

static bool is_asked_for(const Enclosures *e, uint32_t thing)
{
    return e->lamps == (light_of(e, thing) != SCENE_NONE);
}

/* The smallest box, which is worked out only for what is looked at further. */
static Box3 tight_bounds(Enclosures *e, uint32_t thing)
{
    if (!e->is_tight[thing] && !is_light(e, thing))
        e->bounds[thing] = scene_object_bounds(e->scene, &e->scene->objects[thing], NULL);
    e->is_tight[thing] = true;
    return e->bounds[thing];
}

/* Whether one of a few places of the inner object's surface is outside of the outer one: with most that meet it is so. */
static bool stands_out(Enclosures *e, uint32_t inner, uint32_t outer)
{
    enum { PLACES = 8 };
    if (is_light(e, inner)) return false;
    const SceneObject *object = &e->scene->objects[inner];
    const Mesh *mesh = object->shape == SCENE_NONE ? NULL : e->scene->shapes[object->shape].mesh;
    if (!mesh || object->motion != SCENE_NONE) return false;
    for (uint32_t i = 0; i < PLACES; i++) {
        const uint32_t *corners = mesh->triangles[(uint64_t)i * mesh->n_triangles / PLACES];
        Vec3 place = affine_point(&object->to_world, vec3_from_f(mesh->positions[corners[0]]));
        if (!box3_holds_point(e->bounds[outer], place) ||
            side_of(e, outer, ball_around((Box3){place, place})) == BALL_OUTSIDE)
            return true;
    }
    return false;
}

/* Of a round thing that stands still; 0: it is none. */
static double ball_radius(const Enclosures *e, uint32_t thing)
{
    if (is_light(e, thing)) return 0;
    const SceneObject *object = &e->scene->objects[thing];
    const Solid *solid = object->shape == SCENE_NONE ? NULL : e->scene->shapes[object->shape].solid;
    double scale = affine_even_scale(&object->to_world, 5e-10);
    bool round = solid && solid->n_pieces == 1 && solid->pieces[0].kind == PIECE_SPHERE;
    return round && object->motion == SCENE_NONE && scale > 0 ? solid->pieces[0].r0 * scale : 0;
}

/* Whether a round thing that stands still is held whole, as one ball: a lamp that nearly fills its globe would take more cells than
 * there are. */
static bool is_held_as_ball(Enclosures *e, uint32_t inner, uint32_t outer)
{
    double radius = ball_radius(e, inner);
    if (!(radius > 0)) return false;
    Ball ball = {e->scene->objects[inner].to_world.t, radius + 16 * rounding_in(e->bounds[inner])};
    return side_of(e, outer, ball) == BALL_INSIDE;
}

static void look_at(Enclosures *e, uint32_t inner, uint32_t outer)
{
    if (!is_asked_for(e, inner) || is_light(e, outer) || !e->may_hold[outer] || stands_out(e, inner, outer)) return;
    if (!lies_within(tight_bounds(e, inner), tight_bounds(e, outer))) return;
    uint32_t known = e->holder[inner];
    if (known != SCENE_NONE && extent_of(e->bounds[known]) <= extent_of(e->bounds[outer])) return;
    if (!holds_no_camera(e, outer)) return;
    bool held;
    if (is_light(e, inner)) {
        held = side_of(e, outer, ball_around(e->bounds[inner])) == BALL_INSIDE;
    } else {
        Proof proof = {inner, outer, e->compiled->hull_of_object[inner] == SCENE_NONE, CELLS_OF_PAIR};
        held = is_held_as_ball(e, inner, outer) || is_held(e, &proof, e->bounds[inner], 0);
    }
    if (held) e->holder[inner] = outer;
}

static Box3 bounds_of(const void *context, uint32_t thing)
{
    const Enclosures *e = context;
    return e->bounds[thing];
}

static Status visit(void *context, uint32_t a, uint32_t b, Error *error)
{
    Enclosures *e = context;
    if (e->pairs_left-- == 0) return fail(error, STATUS_NOMEM, "too many objects meet");
    look_at(e, a, b);
    look_at(e, b, a);
    return STATUS_OK;
}

/* Whether a camera is in there with it, as in a room, by a few lines: it takes less than proving that none is. */
static bool shows_a_camera(const Enclosures *e, uint32_t object, HitList *hits)
{
    for (uint32_t i = 0; i < e->scene->n_cameras; i++)
        if (report_is_within(e->compiled, e->scene->cameras[i].from, object, hits)) return true;
    return false;
}

/* Most lamps stand in nothing, which one line tells of each: only where one is, what it may be in is looked for. */
static void look_at_lamps(Enclosures *e, uint32_t n_things)
{
    HitList hits = {0};
    uint32_t n = 0;
    for (uint32_t i = 0; i < n_things; i++) n += !box3_is_empty(e->bounds[i]) && is_asked_for(e, i);
    for (uint32_t i = 0; i < n_things && n <= MOST_LAMPS; i++) {
        if (box3_is_empty(e->bounds[i]) || !is_asked_for(e, i)) continue;
        Vec3 place = box3_centre(tight_bounds(e, i));
        if (report_body_around(e->compiled, place, &hits) == SCENE_NONE) continue;
        for (uint32_t k = 0; k < e->scene->n_objects; k++)
            if (e->may_hold[k] && box3_holds_point(e->bounds[k], place) && !shows_a_camera(e, k, &hits))
                look_at(e, i, k);
    }
    hit_list_clear(&hits);
}

/* ---- the scene ---- */

/* Closed, of a finite size, and nothing of it lets light through. What shines is left out: its inside may be its lamp. */
static bool may_hold(const CompiledScene *compiled, uint32_t number)
{
    const Scene *scene = compiled->scene;
    const SceneObject *object = &scene->objects[number];
    if (object->part_of != SCENE_NONE || object->light != SCENE_NONE ||
        compiled->hull_of_object[number] != SCENE_NONE || scene_is_thin(scene, number))
        return false;
    if (object->tree == SCENE_NONE) return scene->shapes[object->shape].closed && !scene_is_plane(scene, number);
    const NestPart *root = &scene->parts[scene->trees[object->tree].root];
    for (uint32_t i = root->begin; i < root->end; i++) {
        const SceneObject *operand = &scene->objects[scene->operands[i]];
        if (!scene->shapes[operand->shape].closed || scene_is_thin(scene, scene->operands[i])) return false;
    }
    return true;
}

/* An operand has none of its own, nor has a mesh without triangles. */
static bool has_place(const Scene *scene, uint32_t number)
{
    const SceneObject *object = &scene->objects[number];
    const Mesh *mesh = object->shape == SCENE_NONE ? NULL : scene->shapes[object->shape].mesh;
    return object->part_of == SCENE_NONE && !(mesh && mesh->n_triangles == 0);
}

static Box3 bounds_of_light(const SceneLight *light)
{
    bool point = light->kind == LIGHT_POINT && light->motion == SCENE_NONE;
    return point ? (Box3){light->to_world.t, light->to_world.t} : box3_empty();
}

/* false when memory ends */
static bool prepare(Enclosures *e, uint32_t n_things)
{
    const Scene *scene = e->scene;
    SceneShapeBox box = {0};
    e->bounds = malloc((n_things + 1U) * sizeof *e->bounds);
    e->holder = malloc((n_things + 1U) * sizeof *e->holder);
    e->is_tight = calloc(n_things + 1U, sizeof *e->is_tight);
    e->may_hold = calloc(scene->n_objects + 1U, sizeof *e->may_hold);
    e->cameras = calloc(scene->n_objects + 1U, sizeof *e->cameras);
    e->known = calloc(scene->n_shapes + 1U, sizeof *e->known);
    if (!e->bounds || !e->holder || !e->is_tight || !e->may_hold || !e->cameras || !e->known) return false;
    for (uint32_t i = 0; i < n_things; i++) {
        e->holder[i] = SCENE_NONE;
        if (is_light(e, i)) {
            e->bounds[i] = bounds_of_light(&scene->lights[i - scene->n_objects]);
            continue;
        }
        e->bounds[i] = has_place(scene, i) ? scene_next_box_around(scene, &scene->objects[i], &box) : box3_empty();
        if (box3_is_unbounded(e->bounds[i])) e->bounds[i] = box3_empty();
        e->may_hold[i] = !box3_is_empty(e->bounds[i]) && may_hold(e->compiled, i);
    }
    return true;
}

static void clear(Enclosures *e)
{
    for (uint32_t i = 0; e->known && i < e->scene->n_shapes; i++) {
        box_tree_clear(&e->known[i].triangles);
        profile_tree_clear(&e->known[i].profile);
    }
    free(e->bounds);
    free(e->holder);
    free(e->is_tight);
    free(e->may_hold);
    free(e->cameras);
    free(e->known);
}

/* ---- chance ---- */

typedef struct Made {
    Span span;
    uint32_t thing;
} Made;

static int compare_made(const void *left, const void *right)
{
    const Made *a = left, *b = right;
    int order = span_compare(a->span, b->span);
    return order ? order : a->thing < b->thing ? -1 : a->thing > b->thing;
}

/* Of many things that one statement strews, as leaves, some are hidden by chance, and nobody wants to know: forgotten
 * unless all of them are. */
static void forget_chance(Enclosures *e, uint32_t n_things)
{
    const Scene *scene = e->scene;
    Made *made = malloc((n_things + 1U) * sizeof *made);
    uint32_t n = 0;
    for (uint32_t i = 0; i < n_things; i++) {
        e->holder[i] = made ? e->holder[i] : SCENE_NONE;
        if (!made || box3_is_empty(e->bounds[i]) || !is_asked_for(e, i)) continue;
        made[n++] = (Made){is_light(e, i) ? scene->lights[i - scene->n_objects].span : scene->objects[i].span, i};
    }
    if (n) qsort(made, n, sizeof *made, compare_made);
    for (uint32_t first = 0, end; first < n; first = end) {
        uint32_t n_held = 0;
        for (end = first; end < n && span_same_place(made[end].span, made[first].span); end++)
            n_held += e->holder[made[end].thing] != SCENE_NONE;
        for (uint32_t i = first; end - first > REPORT_FEW && n_held < end - first && i < end; i++)
            e->holder[made[i].thing] = SCENE_NONE;
    }
    free(made);
}

/* ---- what is said of them ---- */

static void hint_for_lamp(const Enclosures *e, uint32_t light, uint32_t holder, Diag *diag, Diagnostic *report)
{
    const SceneObject *outer = &e->scene->objects[holder];
    double radius = ball_radius(e, holder);
    if (e->scene->lights[light].kind == LIGHT_POINT && radius > 0) /* POV-Ray's looks_like */
        diag_hint(diag, report,
                  "let the light be that ball, which is seen then, and remove %s: shape = sphere  radius = %.6g",
                  outer->name, radius);
    else
        diag_hint(diag, report, "move it out of %s, or give that an 'interior' that light goes through, and no surface",
                  outer->name);
}

/* n: how many things the same place in the text is of, this one the first, that are within what another one is of. */
static void report_one_held(const Enclosures *e, uint32_t thing, uint32_t n, Diag *diag)
{
    const Scene *scene = e->scene;
    const SceneObject *outer = &scene->objects[e->holder[thing]];
    Diagnostic *report;
    if (e->lamps) {
        const SceneLight *light = &scene->lights[light_of(e, thing)];
        report = diag_report(diag, D_ENCLOSED_LIGHT, light->span,
                             "%s is wholly inside of %s, which is opaque: none of its light comes out", light->name,
                             outer->name);
    } else {
        report = diag_report(diag, D_ENCLOSED_OBJECT, scene->objects[thing].span,
                             "%s is wholly inside of %s, which is opaque: nothing of it is seen",
                             scene->objects[thing].name, outer->name);
    }
    if (n > 1)
        diag_note_nowhere(diag, report, "and so %s %u more that this line places", n == 2 ? "is" : "are",
                          (unsigned)(n - 1));
    diag_note(diag, report, outer->span, "%s is here", outer->name);
    if (e->lamps)
        hint_for_lamp(e, light_of(e, thing), e->holder[thing], diag, report);
    else
        diag_hint(diag, report, "let it come through the surface of %s, or remove it", outer->name);
}

static void report_held(const Enclosures *e, uint32_t n_things, Diag *diag)
{
    const Scene *scene = e->scene;
    ReportLikes likes = {.n = 0};
    for (uint32_t i = 0; i < n_things; i++) {
        if (e->holder[i] == SCENE_NONE) continue;
        Span span = e->lamps ? scene->lights[light_of(e, i)].span : scene->objects[i].span;
        (void)report_count_places(&likes, span, scene->objects[e->holder[i]].span, i);
    }
    for (uint32_t i = 0; i < likes.n; i++) report_one_held(e, (uint32_t)likes.first[i], likes.counts[i], diag);
    report_others(diag, e->lamps ? D_ENCLOSED_LIGHT : D_ENCLOSED_OBJECT, likes.n_others);
}

/* The opaque object in whose face a flat light lies, at its middle and halfway to two corners, and that it shines into; SCENE_NONE:
 * none. */
static uint32_t shines_into(Enclosures *e, const SceneLight *light)
{
    Vec3 places[LIGHT_PLACES], up[LIGHT_PLACES];
    light_some_places(light, places, up);
    uint32_t object = SCENE_NONE;
    for (int i = 0; i < 3; i++) {
        SurfacesHere here;
        uint32_t k = 0;
        compiled_surfaces_at(e->compiled, places[i], 0, &here);
        while (k < here.n && (!e->may_hold[here.items[k].object] || (i && here.items[k].object != object) ||
                              vec3_dot(vec3_from_f(here.items[k].normal), up[i]) > -(1 - 1e-6)))
            k++;
        if (k == here.n) return SCENE_NONE;
        object = here.items[k].object;
    }
    return holds_no_camera(e, object) ? object : SCENE_NONE;
}

static void report_inward(Enclosures *e, Diag *diag)
{
    const Scene *scene = e->scene;
    uint32_t n = 0;
    for (uint32_t i = 0; i < scene->n_lights && n < REPORT_MOST; i++) {
        const SceneLight *light = &scene->lights[i];
        if (!light_is_flat(light) || scene->objects[light->object].motion != SCENE_NONE) continue;
        uint32_t object = shines_into(e, light);
        if (object == SCENE_NONE) continue;
        const SceneObject *outer = &scene->objects[object];
        n++;
        Diagnostic *report =
            diag_report(diag, D_ENCLOSED_LIGHT, light->span,
                        "%s lies in a face of %s, which is opaque, and shines into it: none of its light comes out",
                        light->name, outer->name);
        diag_note(diag, report, outer->span, "%s is here", outer->name);
        diag_hint(diag, report, "turn it round, to where its light is meant to go");
    }
}

/* Where memory ends, or objects meet too often, less is said. */
static void report_either(Enclosures *e, Diag *diag)
{
    const Scene *scene = e->scene;
    uint32_t n_things = scene->n_objects + scene->n_lights;
    if (prepare(e, n_things)) {
        bool any = false;
        for (uint32_t i = 0; i < scene->n_objects && !any; i++) any = e->may_hold[i];
        if (any && e->lamps)
            look_at_lamps(e, n_things);
        else if (any && box_pairs_visit(n_things, bounds_of, visit, e, NULL) != STATUS_OK)
            e->pairs_left = 0;
        if (any) forget_chance(e, n_things);
        report_held(e, n_things, diag);
        if (any && e->lamps) report_inward(e, diag);
    }
    clear(e);
}

void report_enclosed(const CompiledScene *compiled, Diag *diag)
{
    report_either(
        &(Enclosures){.compiled = compiled, .scene = compiled->scene, .cells_left = CELLS_IN_ALL, .pairs_left = PAIRS},
        diag);
}

void report_enclosed_lights(const CompiledScene *compiled, Diag *diag)
{
    if (compiled->scene->n_lights == 0) return;
    report_either(
        &(Enclosures){.compiled = compiled, .scene = compiled->scene, .lamps = true, .cells_left = CELLS_OF_LAMPS},
        diag);
}
