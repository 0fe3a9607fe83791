/* emitter.c - see emitter.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/emitter.h"

#include <stdlib.h>

#include "base/angle.h"
#include "nest/csg.h"
#include "optics/color.h"
#include "trace/emitter_cells.h"
#include "trace/emitter_cut.h"
#include "trace/world.h"

static double luminance_of(const Spectrum *radiance)
{
    return fmax(spectrum_luminance(radiance), 0);
}

/* Whether a surface that moves keeps facing the same way. */
static bool turns(const Scene *scene, const Affine *keys)
{
    for (uint32_t k = 1; keys && k < scene->n_keys; k++)
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 3; column++)
                if (keys[k].m[row][column] != keys[0].m[row][column]) return true;
    return false;
}

/* Rounded outward. */
static void set_box(LightBounds *bounds, Box3 box)
{
    bounds->low = vec3f(nextafterf((float)box.min.x, -INFINITY), nextafterf((float)box.min.y, -INFINITY),
                        nextafterf((float)box.min.z, -INFINITY));
    bounds->high = vec3f(nextafterf((float)box.max.x, INFINITY), nextafterf((float)box.max.y, INFINITY),
                         nextafterf((float)box.max.z, INFINITY));
}

/* ---- lights ---- */

/* Around a light of these half sizes wherever it moves. */
static Box3 light_box(const Scene *scene, const SceneLight *light)
{
    const Affine *keys = light_keys(scene, light);
    double x = light->half_width, z = light->half_height, y = light->kind == LIGHT_SPHERE ? x : 0;
    Box3 box = box3_empty(), local = {vec3(-x, -y, -z), vec3(x, y, z)};
    if (!keys) return affine_box(&light->to_world, local);
    for (uint32_t k = 0; k < scene->n_keys; k++) box = box3_union(box, affine_box(&keys[k], local));
    return box;
}

static double light_flux(const SceneLight *light)
{
    double luminance = luminance_of(&light->radiance), w = light->half_width;
    switch (light->kind) {
    case LIGHT_RECT: return luminance * light_beam(light) * 4 * w * light->half_height;
    case LIGHT_DISC: return luminance * light_beam(light) * MEN_PI * w * w;
    case LIGHT_SPHERE: return luminance * MEN_PI * 4 * MEN_PI * w * w;
    case LIGHT_POINT: return luminance * light_beam(light);
    case LIGHT_DISTANT:
    case LIGHT_PORTAL: return 0; /* not in the tree */
    }
    return 0;
}

static LightBounds bounds_of_light(const Scene *scene, const SceneLight *light)
{
    LightBounds bounds = {.axis = vec3f_from(affine_vector(&light->to_world, vec3(0, 1, 0))), .cos_o = 1, .cos_e = 0};
    const Affine *keys = light_keys(scene, light);
    if (light->kind == LIGHT_POINT || light_is_focused(light)) { /* within the cone, and not beyond it */
        bounds.cos_o = light->cos_none > -1 ? (float)fmax(light->cos_none, -0.999999) : -1;
        bounds.cos_e = 0.9999f;
    }
    if (light->kind == LIGHT_SPHERE || turns(scene, keys)) bounds.cos_o = -1;
    bounds.power = (float)light_flux(light);
    set_box(&bounds, light_box(scene, light));
    return bounds;
}

/* ---- objects ---- */

typedef struct Finder {
    const CompiledScene *compiled;
    const WorldMedia *media;
    EmitterSet *set;
    LightBounds *bounds;
    float *parts;            /* room for as many numbers as the largest operand has emitters */
    uint32_t points_of_each; /* for finding out what of an operand shows */
    uint32_t *textured;      /* emitters whose emission is a texture, */
    uint32_t *partly;        /* and others, of operands, of which a part shows; */
    float *shown;            /* of them that part */
    uint32_t n_textured, n_partly;
} Finder;

/* For each operand, and for all of a scene's together. */
enum { CUT_POINTS = 512, ALL_CUT_POINTS = 1 << 14 };
/* Of operands of no more parts, those of which less than this shows are looked at closely. */
enum { MOST_PARTS = 64 };
#define PARTLY 0.6f

static void add(Finder *f, Emitter emitter, const LightBounds *bounds)
{
    f->bounds[f->set->n] = *bounds;
    f->set->emitters[f->set->n++] = emitter;
}

/* An object's part, which the object's being an operand makes one that is cut. */
static Emitter part_of(const Finder *f, uint32_t number, uint32_t part, EmitterKind kind)
{
    bool cut = f->compiled->scene->objects[number].part_of != SCENE_NONE;
    return (Emitter){.of = number,
                     .part = part,
                     .kind = kind,
                     .cut = cut,
                     .inward = cut && nest_csg_takes(&f->compiled->csg, f->compiled->hull_of_object[number])};
}

static void add_triangles(Finder *f, uint32_t number, double luminance)
{
    const Scene *scene = f->compiled->scene;
    const SceneObject *object = &scene->objects[number];
    const SceneShape *shape = &scene->shapes[object->shape];
    const Affine *keys = scene_keys(scene, object);
    bool whirls = shape->mesh_end || turns(scene, keys);
    uint32_t n_times = keys ? scene->n_keys : shape->mesh_end ? 2 : 1;
    uint32_t n = rtc_n_primitives(f->compiled->rtc, number);
    Emitter emitter = part_of(f, number, 0, EMITTER_TRIANGLE);
    double side = emitter.inward ? -1 : 1;
    for (uint32_t i = 0; i < n; i++) {
        LightBounds bounds = {.cos_o = whirls ? -1 : 1, .two_sided = !shape->closed};
        Box3 box = box3_empty();
        for (uint32_t k = 0; k < n_times; k++) {
            Vec3 corner[3];
            rtc_triangle(f->compiled->rtc, number, i, n_times > 1 ? (double)k / (n_times - 1) : 0, corner);
            for (int c = 0; c < 3; c++) box = box3_add_point(box, corner[c]);
            Vec3 across = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
            double length = vec3_length(across), power = luminance * MEN_PI * 0.5 * length;
            if (length > 0 && !(bounds.power > 0)) bounds.axis = vec3f_from(vec3_scale(across, side / length));
            if (power > (double)bounds.power) bounds.power = (float)power;
        }
        set_box(&bounds, box);
        emitter.part = i;
        add(f, emitter, &bounds);
    }
}

static void add_pieces(Finder *f, uint32_t number, double luminance)
{
    const Scene *scene = f->compiled->scene;
    const SceneObject *object = &scene->objects[number];
    const Solid *solid = scene->shapes[object->shape].solid;
    const Affine *keys = scene_keys(scene, object);
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        const Piece *piece = &solid->pieces[i];
        Emitter emitter = part_of(f, number, i, EMITTER_PIECE);
        if (piece->kind == PIECE_SPHERE && !keys && affine_even_scale(&object->to_world, 5e-10) > 0 && !emitter.inward)
            emitter.kind = EMITTER_BALL;
        LightBounds bounds = {.axis = {0, 1, 0}, .cos_o = -1};
        Box3 box = box3_empty(), local = piece_bounds(piece);
        for (uint32_t k = 0; k < (keys ? scene->n_keys : 1) && piece->kind != PIECE_PLANE; k++) {
            const Affine *map = keys ? &keys[k] : &object->to_world;
            double stretch = cbrt(fabs(affine_determinant(map)));
            double power = luminance * MEN_PI * piece_area(piece) * stretch * stretch;
            if (power > (double)bounds.power) bounds.power = (float)power;
            box = box3_union(box, affine_box(map, local));
        }
        /* the ends of a cylinder face one way */
        if (piece->kind == PIECE_BAND && piece->y0 == piece->y1 && !turns(scene, keys)) {
            Vec3 facing = affine_area(&object->to_world, vec3(0, piece->r0 > piece->r1 ? 1 : -1, 0));
            if ((affine_determinant(&object->to_world) < 0) != emitter.inward) facing = vec3_scale(facing, -1);
            bounds.axis = vec3f_from(vec3_normalize(facing));
            bounds.cos_o = 1;
        }
        if (bounds.power > 0) set_box(&bounds, box);
        add(f, emitter, &bounds);
    }
}

/* How many parts of an object shine by themselves. */
static uint32_t count_parts(const CompiledScene *compiled, uint32_t number)
{
    const Scene *scene = compiled->scene;
    const SceneObject *object = &scene->objects[number];
    if (object->shape == SCENE_NONE || scene->objects[scene_whole(scene, number)].medium != SCENE_NONE ||
        !scene_surface_shines(scene, number))
        return 0;
    return rtc_n_primitives(compiled->rtc, number);
}

/* No more of it shows than is within the combination's box. */
static void keep_within(LightBounds *bounds, Box3 whole)
{
    Box3 box = box3_intersection((Box3){vec3_from_f(bounds->low), vec3_from_f(bounds->high)}, whole);
    if (box3_is_empty(box))
        bounds->power = 0;
    else
        set_box(bounds, box);
}

/* The emitters from `first` on are of one operand: what of it is buried in others, or taken away, gives no light. */
static Status weigh_operand(Finder *f, uint32_t first, Error *error)
{
    uint32_t n = f->set->n - first;
    TRY(emitter_cut_parts(f->compiled, &f->set->emitters[first], n, f->points_of_each, f->parts, error));
    const Scene *scene = f->compiled->scene;
    const SceneObject *object = &scene->objects[f->set->emitters[first].of];
    Box3 whole = scene_object_bounds(scene, &scene->objects[object->part_of], NULL);
    bool closely = n <= MOST_PARTS && scene->surfaces[object->surface].emission_texture == SCENE_NONE;
    for (uint32_t i = 0; i < n; i++) {
        LightBounds *bounds = &f->bounds[first + i];
        bounds->power *= f->parts[i];
        if (bounds->power > 0) keep_within(bounds, whole);
        if (!closely || !(bounds->power > 0) || f->parts[i] >= PARTLY) continue;
        f->shown[f->n_partly] = f->parts[i];
        f->partly[f->n_partly++] = first + i;
    }
    return STATUS_OK;
}

/* What shows of operands in small places: where that is, and how much. */
static Status weigh_partly(Finder *f, const World *world, Pool *pool, Error *error)
{
    const float least = 1e-5f; /* of what was not seen anywhere */
    for (uint32_t i = 0; i < f->n_partly; i++) f->bounds[f->partly[i]].power /= f->shown[i];
    TRY(emitter_cells_find_cut(world, f->set, f->partly, f->n_partly, pool, f->shown, error));
    for (uint32_t i = 0; i < f->n_partly; i++) f->bounds[f->partly[i]].power *= float_max(f->shown[i], least);
    return STATUS_OK;
}

static Status add_objects(Finder *f, Error *error)
{
    const Scene *scene = f->compiled->scene;
    uint32_t last_whole = SCENE_NONE;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        if (!count_parts(f->compiled, i)) continue;
        double luminance = luminance_of(&scene->surfaces[object->surface].emission);
        uint32_t first = f->set->n, whole = scene_whole(scene, i);
        f->set->first_of_object[i] = first;
        f->set->n_sources += whole != last_whole; /* operands of one combination stand side by side */
        last_whole = whole;
        if (scene->shapes[object->shape].mesh)
            add_triangles(f, i, luminance);
        else
            add_pieces(f, i, luminance);
        bool textured = scene->surfaces[object->surface].emission_texture != SCENE_NONE;
        for (uint32_t k = first; textured && k < f->set->n; k++)
            if (f->bounds[k].power > 0) f->textured[f->n_textured++] = k;
        if (object->part_of != SCENE_NONE) TRY(weigh_operand(f, first, error));
    }
    return STATUS_OK;
}

/* The emitters f->textured[begin .. end) are of one object. Their powers are as if all of it were as bright as its surface's mean. */
static void weigh_brightness(Finder *f, uint32_t begin, uint32_t end, const float *means)
{
    const double least = 1e-3, of_all = 0.35; /* what places that were not looked at may be */
    const Scene *scene = f->compiled->scene;
    uint32_t object = f->set->emitters[f->textured[begin]].of;
    double taken = luminance_of(&scene->surfaces[scene->objects[object].surface].emission), all = 0;
    for (uint32_t i = begin; i < end; i++) all += (double)means[i] / (end - begin);
    for (uint32_t i = begin; i < end; i++) {
        double mean = (1 - of_all) * (double)means[i] + of_all * all;
        f->bounds[f->textured[i]].power *= (float)fmax(mean / taken, least);
    }
}

static Status weigh_textured(Finder *f, const World *world, Pool *pool, Error *error)
{
    const Emitter *emitters = f->set->emitters;
    float *means = malloc((f->n_textured + (size_t)1) * sizeof *means);
    if (!means) return fail_memory(error, f->n_textured * sizeof *means, "textures that shine");
    for (uint32_t i = 0; i < f->n_textured; i++) means[i] = f->bounds[f->textured[i]].power;
    Status status = emitter_cells_find(world, f->set, f->textured, f->n_textured, pool, means, error);
    for (uint32_t begin = 0, end; status == STATUS_OK && begin < f->n_textured; begin = end) {
        for (end = begin + 1; end < f->n_textured; end++)
            if (emitters[f->textured[end]].of != emitters[f->textured[begin]].of) break;
        weigh_brightness(f, begin, end, means);
    }
    free(means);
    return status;
}

/* ---- media ---- */

static void add_glows(Finder *f)
{
    const Scene *scene = f->compiled->scene;
    f->set->first_glow = f->set->n;
    for (uint32_t i = 0; i < f->media->n_glows; i++) {
        const Glow *glow = &f->media->glows[i];
        LightBounds bounds = {.axis = {0, 1, 0}, .cos_o = -1, .power = (float)glow->power};
        Box3 box = box3_empty();
        uint32_t n_times = glow->place->moves ? scene->n_keys : 1;
        for (uint32_t k = 0; k < n_times; k++)
            box = box3_union(box, glow_box(scene, glow, n_times > 1 ? (double)k / (n_times - 1) : 0));
        set_box(&bounds, box);
        add(f, (Emitter){.of = i, .kind = EMITTER_GLOW}, &bounds);
        f->set->n_sources++;
    }
}

/* Where EmitterSet.powers has an emitter's. */
static size_t place_of_power(const Finder *f, const Emitter *emitter)
{
    const Scene *scene = f->compiled->scene;
    if (emitter->kind == EMITTER_LIGHT) return emitter->of;
    if (emitter->kind != EMITTER_GLOW) return (size_t)scene->n_lights + scene->objects[emitter->of].surface;
    return (size_t)scene->n_lights + scene->n_surfaces + f->media->glows[emitter->of].place->medium;
}

static void sum_powers(Finder *f)
{
    for (uint32_t i = 0; i < f->set->n; i++)
        f->set->powers[place_of_power(f, &f->set->emitters[i])] += (double)f->bounds[i].power;
}

static void add_lights(Finder *f)
{
    const Scene *scene = f->compiled->scene;
    EmitterSet *set = f->set;
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        const SceneLight *light = &scene->lights[i];
        if (light->object != SCENE_NONE) set->first_of_object[light->object] = i;
        LightBounds bounds = bounds_of_light(scene, light);
        set->n_sources += bounds.power > 0;
        add(f, (Emitter){.of = i, .kind = EMITTER_LIGHT}, &bounds);
    }
}

/* How many emitters there are, of the largest operand, and with textures. */
static uint64_t count_all(Finder *f, uint32_t *n_of_operand, uint64_t *n_textured, uint64_t *n_partly)
{
    const Scene *scene = f->compiled->scene;
    uint64_t n = (uint64_t)scene->n_lights + f->media->n_glows;
    uint32_t n_operands = 0;
    *n_of_operand = 0;
    *n_textured = *n_partly = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        uint32_t more = count_parts(f->compiled, i);
        n += more;
        if (more && scene->surfaces[scene->objects[i].surface].emission_texture != SCENE_NONE) *n_textured += more;
        if (!more || scene->objects[i].part_of == SCENE_NONE) continue;
        n_operands++;
        if (more <= MOST_PARTS) *n_partly += more;
        if (more > *n_of_operand) *n_of_operand = more;
    }
    f->points_of_each = CUT_POINTS;
    if (n_operands > ALL_CUT_POINTS / CUT_POINTS) f->points_of_each = ALL_CUT_POINTS / n_operands;
    return n;
}

Status emitters_find(const World *world, Pool *pool, EmitterSet *set, Error *error)
{
    const Scene *scene = world->scene;
    uint32_t n_of_operand;
    uint64_t n_textured, n_partly;
    *set = (EmitterSet){0};
    Finder f = {.compiled = world->compiled, .media = &world->media, .set = set};
    uint64_t n = count_all(&f, &n_of_operand, &n_textured, &n_partly);
    if (n > LIGHT_TREE_MOST)
        return fail(error, STATUS_RENDER, "%llu triangles shine, more than can be chosen from", (unsigned long long)n);
    f.bounds = malloc((n + 1) * sizeof *f.bounds);
    f.parts = malloc((n_of_operand + (size_t)1) * sizeof *f.parts);
    f.textured = malloc((n_textured + 1) * sizeof *f.textured);
    f.partly = malloc((n_partly + 1) * sizeof *f.partly);
    f.shown = malloc((n_partly + 1) * sizeof *f.shown);
    set->emitters = malloc((n + 1) * sizeof *set->emitters);
    set->first_of_object = malloc((scene->n_objects + 1U) * sizeof *set->first_of_object);
    size_t n_powers = (size_t)scene->n_lights + scene->n_surfaces + scene->n_media;
    set->powers = calloc(n_powers + 1, sizeof *set->powers);
    Status status = STATUS_OK;
    if (!f.bounds || !f.parts || !f.textured || !f.partly || !f.shown || !set->emitters || !set->first_of_object ||
        !set->powers) {
        status = fail_memory(error, n * sizeof *f.bounds, "lights");
    } else {
        for (uint32_t i = 0; i < scene->n_objects; i++) set->first_of_object[i] = EMITTER_NONE;
        add_lights(&f);
        status = add_objects(&f, error);
        if (status == STATUS_OK) status = weigh_textured(&f, world, pool, error);
        if (status == STATUS_OK) status = weigh_partly(&f, world, pool, error);
        add_glows(&f);
        sum_powers(&f);
        if (status == STATUS_OK) status = light_tree_new(f.bounds, set->n, pool, &set->tree, error);
    }
    free(f.bounds);
    free(f.parts);
    free(f.textured);
    free(f.partly);
    free(f.shown);
    if (status != STATUS_OK) emitters_clear(set);
    return status;
}

void emitters_clear(EmitterSet *set)
{
    light_tree_free(set->tree);
    emitter_cells_clear(set);
    free(set->emitters);
    free(set->first_of_object);
    free(set->powers);
    *set = (EmitterSet){0};
}
