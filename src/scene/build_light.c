/* build_light.c - lights.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "lang/schema_find.h"
#include "scene/build_parts.h"

static const double usual_spot = 45;     /* degrees */
static const double least_angle = 0.001; /* degrees: the cosine is to tell it from none */

static Vec3 column(const Affine *map, int i)
{
    return vec3(map->m[0][i], map->m[1][i], map->m[2][i]);
}

/* The shapes of the language, which are more than kinds. */
typedef struct LightShape {
    const char *word;
    LightKind kind;
    const char *needs, *takes; /* of the properties that only some shapes have, "|name|name|" */
} LightShape;

static const LightShape shapes[] = {
    {"quad", LIGHT_RECT, "|size|to|", "|size|to|angle|blend|radiance|power|color|light_group|visible|"},
    {"disc", LIGHT_DISC, "|radius|to|", "|radius|to|angle|blend|radiance|power|color|light_group|visible|"},
    {"sphere", LIGHT_SPHERE, "|radius|", "|radius|radiance|power|color|light_group|visible|"},
    {"distant", LIGHT_DISTANT, "|to|", "|to|angle|radiance|power|color|light_group|visible|"},
    {"point", LIGHT_POINT, "|", "|intensity|profile|to|power|color|light_group|"},
    {"spot", LIGHT_POINT, "|to|", "|to|angle|blend|intensity|power|color|light_group|"},
    {"portal", LIGHT_PORTAL, "|size|to|", "|size|to|"},
};

static const LightShape *shape_of(const EvalNode *node)
{
    const char *word = eval_word(node, "shape");
    for (size_t i = 0; i < COUNT_OF(shapes); i++)
        if (strcmp(word, shapes[i].word) == 0) return &shapes[i];
    return &shapes[0];
}

static bool is_named(const char *list, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = list; (at = strstr(at, name)) != NULL; at++)
        if (at[-1] == '|' && at[length] == '|') return true;
    return false;
}

/* What is as bright as a point of an intensity: a sphere to all sides, what is flat along its axis. */
static void hint_at_power(Builder *b, Diagnostic *report, const LightShape *shape, double intensity)
{
    if (shape->kind == LIGHT_DISTANT)
        diag_hint(b->diag, report, "intensity is of lights without a size: give its 'radiance', or its 'power'");
    else
        diag_hint(b->diag, report, "intensity is of lights without a size: as bright %s is power = %g",
                  shape->kind == LIGHT_SPHERE ? "to all sides" : "along its axis, without an angle,",
                  (shape->kind == LIGHT_SPHERE ? 4 * MEN_PI : MEN_PI) * intensity);
}

/* What a light of that shape has in place of a property that it must not have. */
static void hint_at_shape(Builder *b, Diagnostic *report, const LightShape *shape, const EvalProp *prop)
{
    const char *name = prop->type->name;
    if (shape->kind == LIGHT_PORTAL)
        diag_hint(b->diag, report, "it does not shine by itself: the light is the environment's");
    else if (strcmp(name, "visible") == 0)
        diag_hint(b->diag, report, "it has no size, and is not seen");
    else if (strcmp(name, "radiance") == 0)
        diag_hint(b->diag, report, "it has no surface: give its 'intensity', or its 'power'");
    else if (strcmp(name, "intensity") == 0 && is_named(shape->takes, "radiance"))
        hint_at_power(b, report, shape, prop->as.number);
    else if (strcmp(shape->word, "spot") == 0 && strcmp(name, "radius") == 0 && prop->as.number > 0 &&
             prop->as.number < 90)
        diag_hint(
            b->diag, report,
            "its cone is an angle from edge to edge: angle = %g; a light that has a size is shape = disc  radius = ...",
            2 * prop->as.number);
    else if (shape->kind == LIGHT_POINT && strcmp(name, "radius") == 0)
        diag_hint(b->diag, report, "it has no size: sphere and disc are shapes of lights that have one");
    else
        diag_hint(
            b->diag, report, "it takes %s",
            choice_text(b->diag->arena, arena_copy_text(b->diag->arena, shape->takes + 1, strlen(shape->takes) - 2)));
}

/* A light without a shape and a size of a quad, but with what another shape has instead: one report, that it is this shape. */
static bool report_other_shape(Builder *b, const EvalNode *node)
{
    if (eval_prop(node, "shape") || eval_prop(node, "size")) return false;
    const EvalProp *intensity = eval_prop(node, "intensity"), *radius = eval_prop(node, "radius"),
                   *of = intensity ? intensity : radius;
    if (!of) return false;
    bool aimed = eval_prop(node, "to") != NULL, cone = eval_prop(node, "angle") || eval_prop(node, "blend");
    bool spot = (aimed || cone) && !eval_prop(node, "profile");
    const char *word = intensity ? (spot ? "spot" : "point") : aimed || cone ? "disc" : "sphere";
    Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, of->span,
                                     "a light without a 'shape' is a quad, which has no '%s'", of->type->name);
    diag_hint(b->diag, report, "write: shape = %s%s%s", word, cone && !aimed ? "  to = <0, 0, 0>" : "",
              intensity && spot && !cone ? ", or shape = point without 'to', for light to all sides" : "");
    return true;
}

uint32_t build_light_group(Builder *b, const EvalNode *node)
{
    const EvalProp *prop = eval_prop(node, "light_group");
    LightGroups *groups = &b->scene->light_groups;
    if (!prop) return 0;
    if (!light_group_can_be(prop->as.text)) {
        Diagnostic *report = diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span,
                                         "'%s' cannot be the name of a group of lights", prop->as.text);
        diag_hint(b->diag, report, "it becomes a part of the names of layers: 1 to %d letters, digits, '_' and '-'",
                  LIGHT_GROUP_NAME_SIZE - 1);
        return 0;
    }
    uint32_t group = light_groups_add(groups, prop->as.text);
    if (group < groups->n) return group;
    Diagnostic *report = diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span,
                                     "there are more than %d groups of lights", LIMIT_LIGHT_GROUPS);
    limit_hint(b->diag, report, OVER_LIGHT_GROUPS);
    return 0;
}

/* Which properties each shape of light needs; the others it must not have. */
static bool check_properties(Builder *b, const EvalNode *node, const LightShape *shape)
{
    static const char *const names[] = {"size",  "radius",   "to",        "angle",   "blend",   "color",
                                        "power", "radiance", "intensity", "profile", "visible", "light_group"};
    if (report_other_shape(b, node)) return false;
    bool fine = build_exclude(b, node, "radiance", "power") && build_exclude(b, node, "intensity", "power");
    for (size_t i = 0; i < COUNT_OF(names); i++) {
        const EvalProp *prop = eval_prop(node, names[i]);
        if (prop && !is_named(shape->takes, names[i])) {
            Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, prop->span,
                                             "a light of shape '%s' has no '%s'", shape->word, names[i]);
            hint_at_shape(b, report, shape, prop);
            fine = false;
        } else if (!prop && is_named(shape->needs, names[i])) {
            Diagnostic *report = diag_report(b->diag, D_MISSING_PROPERTY, node->span,
                                             "a light of shape '%s' needs '%s'", shape->word, names[i]);
            if (shape == &shapes[0] && !eval_prop(node, "shape"))
                diag_hint(b->diag, report,
                          "'quad' is the default; the other shapes are disc, sphere, distant, point, spot and portal");
            else if (strcmp(names[i], "to") == 0)
                diag_hint(b->diag, report, "write: to = <0, 0, 0>, the point that it shines at%s",
                          shape->kind == LIGHT_DISTANT ? "; only the direction counts, from 'from' to there" : "");
            fine = false;
        }
    }
    if (shape->kind == LIGHT_POINT && !is_named(shape->needs, "to") && !eval_prop(node, "profile"))
        build_needs(b, node, "to", "on a point light without a profile");
    return fine;
}

/* The light's frame in its node's space, y towards where it shines, x level. */
static bool local_frame(Builder *b, const EvalNode *node, Affine *frame, bool *hangs)
{
    Vec3 from = eval_vector(node, "from");
    *frame = affine_identity();
    frame->t = from;
    bool aimed = eval_prop(node, "to") != NULL;
    if (!aimed && !eval_prop(node, "profile")) return true; /* the same to all sides */
    Vec3 along = aimed ? vec3_sub(eval_vector(node, "to"), from) : vec3(0, -1, 0);
    double length = vec3_length(along);
    if (!(length > 0) || !isfinite(length)) {
        diag_report(b->diag, D_DEGENERATE_SHAPE, build_span(node, "to"),
                    "'from' and 'to' of this light are the same point");
        return false;
    }
    Vec3 y = vec3_scale(along, 1 / length);
    Vec3 level = vec3_cross(vec3(0, 1, 0), y);
    *hangs = !(vec3_length(level) > 1e-9);
    Vec3 x = *hangs ? vec3(1, 0, 0) : vec3_normalize(level);
    Vec3 z = vec3_cross(x, y);
    *frame = (Affine){{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}, from};
    return true;
}

/* The frame in the world, made rigid and right-handed; all lights but those of a profile are symmetric, so that a mirrored z axis
 * is the same light, and of a profile 'mirrored' says it. */
static Affine rigid_frame(const Affine *to_world, const Affine *local)
{
    Affine map = affine_compose(to_world, local);
    Vec3 y = vec3_normalize(column(&map, 1));
    Vec3 x = vec3_normalize(vec3_along(column(&map, 0), -vec3_dot(column(&map, 0), y), y));
    Vec3 z = vec3_cross(x, y);
    return (Affine){{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}, map.t};
}

static double area_of(const SceneLight *light)
{
    double w = light->half_width;
    if (light->kind == LIGHT_RECT || light->kind == LIGHT_PORTAL) return 4 * w * light->half_height;
    return light->kind == LIGHT_DISC ? MEN_PI * w * w : 4 * MEN_PI * w * w;
}

/* Radiance per unit of colour. Power is in watts and lengths in metres, so that a light is as bright in
 * whatever unit the scene is written. */
static double radiance_factor(const Builder *b, const EvalNode *node, const SceneLight *light, double half_angle)
{
    const EvalProp *power = eval_prop(node, "power");
    const EvalProp *radiance = eval_prop(node, "radiance");
    if (light->kind == LIGHT_DISTANT) {
        /* the irradiance of a cone of constant radiance L is pi L sin^2; white under an irradiance of pi looks like 1
         */
        double sine = sin(half_angle);
        return radiance ? radiance->as.number : (power ? power->as.number : MEN_PI) / (MEN_PI * sine * sine);
    }
    if (light->kind == LIGHT_POINT) {
        const EvalProp *intensity = eval_prop(node, "intensity");
        double unit2 = b->scene->unit_m * b->scene->unit_m, beam = light_beam(light);
        return (power ? power->as.number / beam : intensity ? intensity->as.number : 1) / unit2;
    }
    double area_m2 = area_of(light) * b->scene->unit_m * b->scene->unit_m;
    double steradians = light->kind == LIGHT_SPHERE ? MEN_PI : light_beam(light);
    return power ? power->as.number / (steradians * area_m2) : radiance ? radiance->as.number : 1;
}

static bool check_area(Builder *b, const EvalNode *node, const SceneLight *light, double scale)
{
    double reach = hypot(light->half_width, light->half_height);
    Box3 bounds = {vec3_sub(light->to_world.t, vec3(reach, reach, reach)),
                   vec3_add(light->to_world.t, vec3(reach, reach, reach))};
    if (!build_check_reach(b, node->span, "this light", bounds)) return false;
    if (!(light->half_width > 0) || !(light->half_height > 0) || !isfinite(1 / area_of(light))) {
        Diagnostic *report = diag_report(b->diag, D_DEGENERATE_SHAPE, node->span, "this light has no area");
        if (scale != 1) diag_hint(b->diag, report, "its transforms scale it by %g", scale);
        return false;
    }
    return true;
}

static bool place_area_light(Builder *b, const EvalNode *node, SceneLight *light, double scale)
{
    if (!check_area(b, node, light, scale)) return false;
    Piece piece = {.kind = PIECE_RECT, .r0 = light->half_width, .r1 = light->half_height};
    if (light->kind == LIGHT_DISC) piece = piece_make_band(light->half_width, 0, 0, 0); /* inwards: facing +y */
    uint32_t shape =
        light->kind == LIGHT_SPHERE ? build_sphere_shape(b, light->half_width) : build_piece_shape(b, &piece);
    if (b->status != STATUS_OK) return false;
    light->object = build_add_object(b, node, shape, &light->to_world);
    SceneObject *object = &b->scene->objects[light->object];
    object->surface = build_black_surface(b);
    object->light = b->scene->n_lights;
    object->volume = 0;
    light->name = object->name;
    return true;
}

void build_add_light(Builder *b, const SceneLight *light)
{
    Scene *scene = b->scene;
    scene->lights = room_for_one(b->arena, scene->lights, scene->n_lights, &b->lights_capacity, sizeof *light);
    scene->lights[scene->n_lights++] = *light;
}

/* Of a spot, of a quad or a disc: it shines into a cone of so many degrees, from edge to edge. */
static void set_cone(const EvalNode *node, SceneLight *light, double angle)
{
    double half_angle = angle / 2 * MEN_DEGREE;
    light->cos_none = fmax(cos(half_angle), 0);
    light->cos_full = cos(half_angle * (1 - eval_number(node, "blend")));
}

void build_light(Builder *b, const EvalNode *node, const Affine *to_world)
{
    if (b->only_shapes) return;
    const LightShape *shape = shape_of(node);
    SceneLight light = {.kind = shape->kind,
                        .span = build_author_place(b, node),
                        .object = SCENE_NONE,
                        .motion = SCENE_NONE,
                        .identity = b->where,
                        .hidden = !eval_truth(node, "visible")};
    /* to float: what turns does not change its size by a last bit, which motion.c would tell */
    double scale = light.kind == LIGHT_DISTANT ? 1 : (double)(float)affine_even_scale(to_world, 1e-6);
    Affine frame;
    if (!check_properties(b, node, shape) || !local_frame(b, node, &frame, &light.hangs)) return;
    if (!(scale > 0)) {
        diag_report(b->diag, D_SINGULAR_TRANSFORM, node->span,
                    "a light can be turned, moved and scaled evenly, but not stretched or sheared");
        return;
    }
    const EvalProp *angle = eval_prop(node, "angle");
    if (light_is_flat(&light)) build_needs_other(b, node, "blend", "angle", "without an angle, into which it shines");
    if (angle && !(angle->as.number >= least_angle)) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, angle->span, "an angle of %g degrees is too small: %g is the least",
                    angle->as.number, least_angle);
        return;
    }
    double half_angle = (angle ? angle->as.number : BUILD_SUNS_ANGLE) / 2 * MEN_DEGREE;
    if (angle && light.kind != LIGHT_DISTANT) set_cone(node, &light, angle->as.number);
    light.to_world = rigid_frame(to_world, &frame);
    light.mirrored = affine_determinant(to_world) < 0;
    light.towards = vec3_scale(column(&light.to_world, 1), -1);
    light.cos_angle = cos(half_angle);
    if (light.kind == LIGHT_RECT || light.kind == LIGHT_PORTAL) {
        const EvalProp *size = eval_prop(node, "size");
        light.half_width = size->as.vector[0] / 2 * scale;
        light.half_height = size->as.vector[1] / 2 * scale;
    } else if (light.kind == LIGHT_DISC || light.kind == LIGHT_SPHERE) {
        light.half_width = light.half_height = eval_number(node, "radius") * scale;
    } else if (light.kind == LIGHT_POINT) {
        if (!is_named(shape->takes, "angle"))
            light.cos_full = light.cos_none = -1; /* to all sides */
        else if (!angle)
            set_cone(node, &light, usual_spot);
        if (eval_prop(node, "profile") && !build_profile(b, eval_prop(node, "profile"), &light)) return;
        Box3 bounds = {light.to_world.t, light.to_world.t};
        if (!build_check_reach(b, node->span, "this light", bounds)) return;
    }
    if (light.kind == LIGHT_DISTANT || light.kind == LIGHT_POINT || light.kind == LIGHT_PORTAL)
        light.name = build_name(b, node, node->type->name);
    if (light.kind == LIGHT_PORTAL ? !check_area(b, node, &light, scale)
                                   : !light.name && !place_area_light(b, node, &light, scale))
        return;
    if (light.kind == LIGHT_PORTAL)
        light.radiance = spectrum_constant(0);
    else if (!build_emission(b, node, "color", radiance_factor(b, node, &light, half_angle), &light.radiance))
        return;
    light.group = build_light_group(b, node);
    build_add_light(b, &light);
}
