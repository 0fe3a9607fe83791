/* build_surface.c - surfaces: what covers opaque objects, and the boundaries of clear ones.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/angle.h"
#include "optics/color.h"
#include "optics/metal.h"
#include "scene/build_parts.h"

/* Properties that are parameters of a BsdfSpec, each on its own: what the property is read as, and where it goes. */
typedef enum ParameterKind {
    PARAMETER_NUMBER,    /* a float */
    PARAMETER_COLOR,     /* a Spectrum of reflectances */
    PARAMETER_INDEX,     /* a Spectrum, the same at all wavelengths */
    PARAMETER_NANOMETRES /* a float, of a length */
} ParameterKind;

typedef struct Parameter {
    const char *property;
    ParameterKind kind;
    size_t offset; /* in BsdfSpec */
} Parameter;

static const Parameter parameters[] = {
    {"albedo", PARAMETER_COLOR, offsetof(BsdfSpec, base_color)},
    {"diffuse_roughness", PARAMETER_NUMBER, offsetof(BsdfSpec, base_diffuse_roughness)},
    {"metalness", PARAMETER_NUMBER, offsetof(BsdfSpec, base_metalness)},
    {"specular", PARAMETER_NUMBER, offsetof(BsdfSpec, specular_weight)},
    {"roughness", PARAMETER_NUMBER, offsetof(BsdfSpec, specular_roughness)},
    {"anisotropy", PARAMETER_NUMBER, offsetof(BsdfSpec, specular_roughness_anisotropy)},
    {"ior", PARAMETER_INDEX, offsetof(BsdfSpec, specular_ior)},
    {"transmission", PARAMETER_NUMBER, offsetof(BsdfSpec, transmission_weight)},
    {"tint", PARAMETER_COLOR, offsetof(BsdfSpec, transmission_color)},
    {"translucency", PARAMETER_NUMBER, offsetof(BsdfSpec, translucency)},
    {"coat", PARAMETER_NUMBER, offsetof(BsdfSpec, coat_weight)},
    {"coat_ior", PARAMETER_INDEX, offsetof(BsdfSpec, coat_ior)},
    {"coat_roughness", PARAMETER_NUMBER, offsetof(BsdfSpec, coat_roughness)},
    {"coat_anisotropy", PARAMETER_NUMBER, offsetof(BsdfSpec, coat_roughness_anisotropy)},
    {"coat_tint", PARAMETER_COLOR, offsetof(BsdfSpec, coat_color)},
    {"film", PARAMETER_NANOMETRES, offsetof(BsdfSpec, film_thickness_nm)},
    {"film_ior", PARAMETER_INDEX, offsetof(BsdfSpec, film_ior)},
    {"weight", PARAMETER_NUMBER, offsetof(BsdfSpec, mix_weight)},
    {"fuzz", PARAMETER_NUMBER, offsetof(BsdfSpec, fuzz_weight)},
    {"fuzz_color", PARAMETER_COLOR, offsetof(BsdfSpec, fuzz_color)},
    {"fuzz_roughness", PARAMETER_NUMBER, offsetof(BsdfSpec, fuzz_roughness)},
};

static double factor_of(const Builder *b, const Parameter *parameter)
{
    return parameter->kind == PARAMETER_NANOMETRES ? b->scene->unit_m * 1e9 : 1;
}

/* The spec gets the largest number that the texture can come to, so that it says what there is at all. */
static void read_texture(Builder *b, const EvalProp *prop, const Parameter *parameter, SceneSurface *surface,
                         SurfaceTexture *texture)
{
    bool color = parameter->kind == PARAMETER_COLOR;
    double least, most;
    if (!build_textures_wanted(b)) return;
    *texture = (SurfaceTexture){
        .texture = build_texture(b, prop, color ? TEXTURE_OF_COLORS : TEXTURE_OF_NUMBERS, &least, &most),
        .color = color,
        .property = parameter->property,
        .offset = parameter->offset,
        .least = (float)prop->type->min,
        .most = (float)prop->type->max,
        .factor = (float)factor_of(b, parameter)};
    if (!color) *(float *)((char *)&surface->spec + parameter->offset) = (float)(most * factor_of(b, parameter));
    build_texture_place(b, texture->texture, surface);
    surface->n_textures++;
}

/* What is neither set nor has a default stays as bsdf_spec_init left it. */
static void read_parameter(const Builder *b, const EvalNode *node, const Parameter *parameter, BsdfSpec *spec)
{
    void *target = (char *)spec + parameter->offset;
    if (!eval_has_value(node, parameter->property)) return;
    if (parameter->kind == PARAMETER_COLOR) {
        Vec3 color = eval_vector(node, parameter->property);
        *(Spectrum *)target = spectrum_from_reflectance((const double[3]){color.x, color.y, color.z});
    } else {
        float number = (float)(eval_number(node, parameter->property) * factor_of(b, parameter));
        if (parameter->kind == PARAMETER_INDEX)
            *(Spectrum *)target = spectrum_constant(number);
        else
            *(float *)target = number;
    }
}

static void read_parameters(Builder *b, const EvalNode *node, SceneSurface *surface)
{
    SurfaceTexture *textures = ARENA_ARRAY(b->arena, SurfaceTexture, COUNT_OF(parameters) + 1);
    surface->textures = textures;
    for (size_t i = 0; i < COUNT_OF(parameters); i++) {
        const EvalProp *prop = eval_prop(node, parameters[i].property);
        if (prop && prop->textured)
            read_texture(b, prop, &parameters[i], surface, &textures[surface->n_textures]);
        else
            read_parameter(b, node, &parameters[i], &surface->spec);
    }
}

/* The checker that a surface has by itself: a texture of squares in the world, whose layers along y are half a square off
 * the origin, so that a ground at y = 0 is in the midst of one. */
static void read_checker(Builder *b, const EvalNode *node, SceneSurface *surface)
{
    const EvalProp *albedo = eval_prop(node, "albedo"), *other = eval_prop(node, "albedo2");
    double size = eval_number(node, "check_size");
    if (albedo && albedo->textured) {
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, build_span(node, "pattern"),
                                         "'pattern' and a texture for 'albedo' exclude each other");
        diag_note(b->diag, report, albedo->span, "the texture is here");
        return;
    }
    if (!(size >= (double)FLT_MIN && size <= SCENE_REACH)) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "check_size"), "squares of %g cannot be drawn",
                    size);
        return;
    }
    Vec3 rgb = eval_vector(node, "albedo"), second = vec3_scale(rgb, 0.25);
    if (other) second = vec3(other->as.vector[0], other->as.vector[1], other->as.vector[2]);
    SurfaceTexture *texture = (SurfaceTexture *)ARENA_ARRAY(b->arena, SurfaceTexture, surface->n_textures + 1);
    if (surface->n_textures) memcpy(texture, surface->textures, surface->n_textures * sizeof *texture);
    surface->textures = texture;
    texture[surface->n_textures++] =
        (SurfaceTexture){.texture = build_world_checker(b, (const double[3]){rgb.x, rgb.y, rgb.z},
                                                        (const double[3]){second.x, second.y, second.z}, size),
                         .property = "albedo",
                         .color = true,
                         .offset = offsetof(BsdfSpec, base_color),
                         .most = 1};
}

/* ---- relief ---- */

static void read_bump(Builder *b, const EvalNode *node, SceneSurface *surface)
{
    const EvalProp *bump = eval_prop(node, "bump"), *height = eval_prop(node, "bump_height");
    double least, most;
    if (!bump) {
        build_needs(b, node, "bump_height", "without a bump");
        return;
    }
    if (!bump->textured) {
        Diagnostic *report =
            diag_report(b->diag, D_WRONG_TYPE, bump->span, "a bump that is the same everywhere is none");
        diag_hint(b->diag, report, "give it a texture, as in: bump = noise { scale(.1) }  bump_height = .01");
        return;
    }
    if (!height) {
        Diagnostic *report = diag_report(b->diag, D_MISSING_PROPERTY, bump->span, "a 'bump' needs a 'bump_height'");
        diag_hint(b->diag, report, "it is how far up the texture's 1 is");
        return;
    }
    if (!build_textures_wanted(b)) return;
    surface->bump = build_texture(b, bump, TEXTURE_OF_NUMBERS, &least, &most);
    surface->bump_height = height->as.number;
    build_texture_place(b, surface->bump, surface);
    surface->textures_use_object = true; /* its slope goes there and back */
}

static void read_normal_map(Builder *b, const EvalNode *node, SceneSurface *surface)
{
    const EvalProp *map = eval_prop(node, "normal_map");
    if (!map) {
        build_needs(b, node, "normal_strength", "without a normal_map");
        build_needs(b, node, "normal_y", "without a normal_map");
        return;
    }
    static const char *const scalar[] = {"from", "to", "ramp"};
    const EvalNode *image = map->as.node;
    for (size_t i = 0; i < COUNT_OF(scalar); i++) build_needs(b, image, scalar[i], "in a map of normals");
    const EvalProp *projection = eval_prop(image, "projection");
    if (projection && strcmp(projection->as.text, "uv") != 0)
        diag_report(b->diag, D_CONFLICTING_PROPERTIES, projection->span,
                    "a normal map lies on the surface's own coordinates, projection = uv");
    if (!build_textures_wanted(b)) return;
    b->texture_user = map;
    surface->normal_map = build_texture_row(b, image, TEXTURE_OF_VECTORS);
    surface->textures_use_uv = surface->textures_use_object = true;
    surface->normal_x = surface->normal_y = (float)eval_number(node, "normal_strength");
    if (strcmp(eval_word(node, "normal_y"), "down") == 0) surface->normal_y = -surface->normal_y;
}

static uint32_t add_surface(Builder *b, SceneSurface surface)
{
    Scene *scene = b->scene;
    scene->surfaces = room_for_one(b->arena, scene->surfaces, scene->n_surfaces, &b->surfaces_capacity, sizeof surface);
    scene->surfaces[scene->n_surfaces] = surface;
    return scene->n_surfaces++;
}

/* Properties that have no effect without another. */
typedef struct Need {
    const char *property, *other, *words, *hint;
} Need;

#define COAT "without a coat", "a clear coat over all of it: coat = 1"
#define FUZZ "without 'fuzz'", "as on cloth: fuzz = .5"
static const Need needs[] = {
    {"specular", "ior", "without an 'ior'", "as plastic and varnish have it: ior = 1.5"},
    {"coat_ior", "coat", COAT},
    {"coat_roughness", "coat", COAT},
    {"coat_anisotropy", "coat", COAT},
    {"coat_tint", "coat", COAT},
    {"fuzz_color", "fuzz", FUZZ},
    {"fuzz_roughness", "fuzz", FUZZ},
    {"translucency", "thin", "without thin = true", "a leaf: thin = true  albedo = rgb(.2, .4, .1)  translucency = .5"},
    {"film_ior", "film", "without a 'film'", "as on a lens: film = 100nm  film_ior = 1.38"},
    {"weight", "mix", "without a 'mix'", "a mixture of two: mix = [a, b]"},
};

#define TINTS                                                                                                          \
    "what is clear has the tint of its medium, medium glass { ior = 1.5  tint = rgb(.6, .9, .7)  depth = 1cm }"
#define FILM "thin = true  ior = 1.4  transmission = 1  film = 300nm"

static bool has_metal(const EvalNode *node)
{
    return eval_prop(node, "metal") || eval_prop(node, "metalness");
}

/* What only panes have, which are thin and let light through. */
static void check_pane(Builder *b, const EvalNode *node, bool thin, bool pane)
{
    const char *without = thin   ? "without 'transmission'"
                          : pane ? "without thin = true"
                                 : "without thin = true and 'transmission'";
    Diagnostic *report = build_needs(b, node, "tint", without);
    if (report && !thin) diag_hint(b->diag, report, "%s", TINTS ", what is matte an albedo");
}

/* What is thin is a film itself, of its own index. */
static void check_thin_film(Builder *b, const EvalNode *node)
{
    if (!has_metal(node) && !eval_prop(node, "transmission")) build_needs(b, node, "film", "without 'transmission'");
    Diagnostic *report = has_metal(node) ? NULL : build_needs(b, node, "film_ior", "of what is thin");
    if (report) diag_hint(b->diag, report, "it is a film as a whole: its index is its ior");
}

static bool is_whole(const EvalNode *node, const char *property)
{
    const EvalProp *part = eval_prop(node, property);
    return part && !part->textured && part->as.number == 1;
}

/* A coat lies over what is opaque of a thin surface. */
static void check_coat_of_thin(Builder *b, const EvalNode *node)
{
    if (!eval_truth(node, "thin") || has_metal(node)) return;
    const bool clear = is_whole(node, "transmission"), translucent = !clear && is_whole(node, "translucency");
    Diagnostic *report = clear         ? build_needs(b, node, "coat", "on a pane, all of which is clear")
                         : translucent ? build_needs(b, node, "coat", "on what is translucent as a whole")
                                       : NULL;
    if (report)
        diag_hint(b->diag, report,
                  clear ? "what light loses in a pane is its tint, what it mirrors its ior; part of it is opaque with "
                          "transmission = .5"
                        : "what light loses in it is its albedo; half of it is under the coat with translucency = .5");
}

static void check_needs(Builder *b, const EvalNode *node)
{
    static const char *const of_metal[] = {"albedo", "ior", "diffuse_roughness", "pattern"};
    bool thin = eval_truth(node, "thin"), pane = eval_prop(node, "transmission");
    for (size_t i = 0; i < COUNT_OF(needs); i++) {
        const Need *need = &needs[i];
        Diagnostic *report = build_needs_other(b, node, need->property, need->other, need->words);
        if (report) diag_hint(b->diag, report, "%s", need->hint);
    }
    if (!thin || !pane) check_pane(b, node, thin, pane);
    if (thin) check_thin_film(b, node);
    check_coat_of_thin(b, node);
    bool all_metal = eval_prop(node, "metal") && !eval_prop(node, "metalness");
    for (size_t i = 0; all_metal && i < COUNT_OF(of_metal); i++) build_exclude(b, node, "metal", of_metal[i]);
    static const char *const of_grain[] = {"grain", "grain_angle"};
    bool grained = eval_prop(node, "anisotropy") || eval_prop(node, "coat_anisotropy");
    for (size_t i = 0; !grained && i < COUNT_OF(of_grain); i++)
        build_needs(b, node, of_grain[i], "without 'anisotropy'");
    if (!thin || pane || eval_prop(node, "translucency")) return;
    Diagnostic *report =
        diag_report(b->diag, D_MISSING_PROPERTY, build_span(node, "thin"), "nothing goes through this thin surface");
    diag_hint(b->diag, report,
              "a pane: ior = 1.5  transmission = 1; a leaf: albedo = rgb(.2, .4, .1)  translucency = .5");
}

/* What is meant in nanometres is most often too much in the scene's unit. */
static void check_film(Builder *b, const EvalNode *node, double nanometres)
{
    const double thickest = 50e3;
    const EvalProp *film = eval_prop(node, "film");
    if (!film || film->textured || nanometres <= thickest) return;
    Diagnostic *report =
        diag_report(b->diag, D_THICK_FILM, film->span, "a film of %g mm: light interferes in films of less than %g um",
                    nanometres * 1e-6, thickest * 1e-3);
    diag_hint(b->diag, report, "a soap film: film = 500nm");
}

static SceneGrain grain_of(const EvalNode *node)
{
    const char *word = eval_word(node, "grain");
    return strcmp(word, "around") == 0 ? GRAIN_AROUND : (SceneGrain)(GRAIN_X + (word[0] - 'x'));
}

/* What makes a surface more than matte. */
static void finish_of(Builder *b, const EvalNode *node, SceneSurface *surface)
{
    const EvalProp *ior = eval_prop(node, "ior");
    const char *metal = eval_word(node, "metal");
    BsdfSpec *spec = &surface->spec;
    bsdf_spec_init(spec);
    read_parameters(b, node, surface);
    check_film(b, node, (double)spec->film_thickness_nm);
    surface->albedo = spec->base_color;
    if (strcmp(eval_word(node, "pattern"), "checker") == 0) {
        read_checker(b, node, surface);
    } else {
        build_needs(b, node, "albedo2", "without pattern = checker");
        build_needs(b, node, "check_size", "without pattern = checker");
    }
    read_bump(b, node, surface);
    read_normal_map(b, node, surface);
    surface->roughness = spec->specular_roughness;
    if (!ior) spec->specular_weight = 0;
    if (metal) {
        if (!eval_prop(node, "metalness")) spec->base_metalness = 1;
        spec->measured_metal =
            metal_index(metal, &spec->metal_n, &spec->metal_k, build_new_table(b), build_new_table(b));
    }
    spec->thin_walled = surface->thin = eval_truth(node, "thin");
    surface->grain = grain_of(node);
    surface->grain_angle = eval_number(node, "grain_angle") * MEN_DEGREE;
    const bool filmed = eval_prop(node, "film") && !has_metal(node), parted = eval_prop(node, "transmission");
    if (filmed && !spec->thin_walled && !parted) spec->transmission_weight = 1;
    surface->painted = (parted || filmed) && !spec->thin_walled;
    surface->finished = ior || spec->base_metalness > 0 || spec->coat_weight > 0 || spec->base_diffuse_roughness > 0 ||
                        spec->thin_walled || spec->fuzz_weight > 0;
}

/* A picture that lies behind has no light of its own to add to, and is not seen through what stands before it. */
static void check_catcher(Builder *b, const EvalNode *node, const SceneSurface *surface)
{
    const EvalProp *emission = eval_prop(node, "emission");
    Span where = build_span(node, "shadow_catcher");
    if (emission) {
        Diagnostic *report =
            diag_report(b->diag, D_CONFLICTING_PROPERTIES, where,
                        "a shadow catcher cannot shine: it holds only what other things change of its light");
        diag_note(b->diag, report, emission->span, "'emission' is set here");
        diag_hint(b->diag, report, "put a light { } in its place, which shines on what is there all the same");
    }
    if (surface->thin || surface->painted) {
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, where,
                                         "a shadow catcher is opaque, and this surface lets light through");
        diag_hint(b->diag, report,
                  "leave 'thin' and 'transmission' out: a picture behind what is clear is seen through it as it is");
    }
}

/* ---- what suits an object ---- */

/* Whether a clear object's surface can have that. */
static bool clear_has(const char *property)
{
    static const char *const properties[] = {"roughness", "anisotropy",  "grain",      "grain_angle",
                                             "bump",      "bump_height", "normal_map", "normal_strength",
                                             "normal_y",  "film",        "film_ior"};
    for (size_t i = 0; i < COUNT_OF(properties); i++)
        if (strcmp(property, properties[i]) == 0) return true;
    return false;
}

/* The surface of a boundary says how rough it is, or, with 'transmission', what part of it is clear at all. */
static void check_boundary(Builder *b, const EvalNode *node, Span where)
{
    const EvalProp *transmission = eval_prop(node, "transmission");
    bool all_opaque = transmission && !transmission->textured && transmission->as.number == 0;
    for (size_t i = 0; i < node->n_props; i++) {
        const EvalProp *prop = &node->props[i];
        const char *name = prop->type->name;
        bool coat = strcmp(name, "coat") == 0 && !all_opaque, thin = strcmp(name, "thin") == 0;
        bool shines = strcmp(name, "emission") == 0, catches = strcmp(name, "shadow_catcher") == 0;
        if (catches && !prop->as.truth) continue;
        if (clear_has(name) || (transmission && !coat && !thin && !shines && !catches)) continue;
        Diagnostic *report = diag_report(
            b->diag, D_CONFLICTING_PROPERTIES, where,
            "an object with an interior is clear: its surface can be rough and have relief, but has no '%s'", name);
        diag_note(b->diag, report, prop->span, "'%s' is set here", name);
        if (coat)
            diag_hint(b->diag, report,
                      "a coat on glass is a medium of its own: put a slightly larger object around this one");
        else if (strcmp(name, "tint") == 0)
            diag_hint(b->diag, report, TINTS);
        else if (strcmp(name, "ior") == 0)
            diag_hint(b->diag, report, "the index is that of its medium, the interior");
        else if (thin)
            diag_hint(b->diag, report, "leave 'interior' out: on both sides of what is thin is what it stands in");
        else if (catches)
            diag_hint(b->diag, report, "leave 'interior' out: a shadow catcher is opaque");
        else if (!shines)
            diag_hint(
                b->diag, report,
                "transmission = 0 beside '%s' paints or gilds what is clear, .5 half of it; what is opaque through "
                "and through has no interior: interior = none, where a prototype has one",
                name);
        break;
    }
    const EvalProp *rough = eval_prop(node, "roughness");
    if (rough && eval_prop(node, "film") && (rough->textured || rough->as.number > 0)) {
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, rough->span,
                                         "a film lies on what is smooth of a clear object, and this is rough");
        diag_hint(b->diag, report,
                  "leave one of both out; bumps can be under a film: bump = noise { }  bump_height = .01mm");
    }
    if (node->n_props > 0) return;
    Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, where,
                                     "an object with an interior is clear: this surface says nothing of it");
    diag_hint(b->diag, report, "a rough one is surface { roughness = .3 }");
}

static void check_opaque(Builder *b, const EvalNode *node)
{
    bool thin = eval_truth(node, "thin"), facets = eval_prop(node, "ior") || has_metal(node);
    const EvalProp *transmission = eval_prop(node, "transmission");
    bool lets_through = transmission && (transmission->textured || transmission->as.number > 0);
    if (lets_through && !thin) {
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, build_span(node, "transmission"),
                                         "this object has no interior for light to go through");
        diag_hint(b->diag, report, "name one, interior = a medium, or make the surface thin = true");
    } else if (lets_through && !eval_prop(node, "ior")) {
        Diagnostic *report = build_needs(b, node, "transmission", "without an 'ior'");
        if (report)
            diag_hint(b->diag, report, "a pane of glass: ior = 1.5; where a sheet has holes: ior = 1  specular = 0");
    }
    Diagnostic *filmed =
        thin || has_metal(node) ? NULL : build_needs(b, node, "film", "on what is opaque and no metal");
    if (filmed)
        diag_hint(b->diag, filmed,
                  "it lies on a metal, metal = titanium  film = 60nm  film_ior = 2.4, or on what has an interior; or "
                  "it is a thin "
                  "surface: " FILM);
    static const struct {
        const char *property;
        double none; /* what says of a matte surface that it is one */
    } of_facets[] = {{"roughness", 1}, {"anisotropy", 0}};
    for (size_t i = 0; !facets && i < COUNT_OF(of_facets); i++) {
        const EvalProp *prop = eval_prop(node, of_facets[i].property);
        if (!prop || (!prop->textured && prop->as.number == of_facets[i].none)) continue;
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, prop->span,
                                         "'%s' has no effect on a matte surface", of_facets[i].property);
        diag_hint(b->diag, report, "give it a skin, ior = 1.5, or make it a metal");
        break;
    }
}

static void check_fits(Builder *b, const EvalNode *node, Span where, bool clear)
{
    const EvalProp *mix = eval_prop(node, "mix");
    for (size_t i = 0; mix && i < mix->as.list.n; i++) check_fits(b, mix->as.list.nodes[i], where, clear);
    if (mix && clear && eval_truth(node, "shadow_catcher"))
        diag_report(b->diag, D_CONFLICTING_PROPERTIES, build_span(node, "shadow_catcher"),
                    "an object with an interior is clear, and no shadow catcher");
    if (mix) return;
    if (clear)
        check_boundary(b, node, where);
    else
        check_opaque(b, node);
}

bool build_surface_fits(Builder *b, const EvalProp *surface, bool clear)
{
    size_t n_errors = b->diag->n_errors;
    check_fits(b, surface->as.node, surface->span, clear);
    return b->diag->n_errors == n_errors;
}

/* ---- making ---- */

/* The mix's own row comes before those of its surfaces. */
static void mix_of(Builder *b, const EvalNode *node, const EvalProp *mix, uint32_t row)
{
    static const char *const own[] = {"mix", "weight", "emission", "radiance", "light_group", "shadow_catcher"};
    for (size_t i = 0; i < node->n_props; i++) {
        const char *name = node->props[i].type->name;
        size_t k = 0;
        while (k < COUNT_OF(own) && strcmp(name, own[k]) != 0) k++;
        if (k < COUNT_OF(own)) continue;
        diag_report(b->diag, D_CONFLICTING_PROPERTIES, node->props[i].span,
                    "'%s' belongs in one of the two surfaces of the mix", name);
    }
    if (mix->as.list.n != 2) {
        diag_report(b->diag, D_WRONG_TYPE, mix->span, "a mix is of two surfaces, not %zu", mix->as.list.n);
        return;
    }
    uint32_t parts[2];
    for (int i = 0; i < 2; i++) {
        const EvalNode *part = mix->as.list.nodes[i];
        const EvalProp *emission = eval_prop(part, "emission");
        if (emission) {
            Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, emission->span,
                                             "a surface within a mix cannot have an 'emission' of its own");
            diag_hint(b->diag, report, "give it to the mix");
        }
        const EvalProp *catcher = eval_prop(part, "shadow_catcher");
        if (catcher && catcher->as.truth) {
            Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, catcher->span,
                                             "a surface within a mix cannot be a shadow catcher by itself");
            diag_hint(b->diag, report, "make the mix one");
        }
        parts[i] = build_surface(b, part);
    }
    SceneSurface *surface = &b->scene->surfaces[row];
    surface->mixed = true;
    for (int i = 0; i < 2; i++) {
        surface->mix[i] = parts[i];
        if (b->scene->surfaces[parts[i]].thin) surface->thin = true;
        if (b->scene->surfaces[parts[i]].painted) surface->painted = true;
    }
}

static SceneSurface plain_surface(const char *name, float albedo)
{
    return (SceneSurface){.name = name,
                          .albedo = spectrum_constant(albedo),
                          .bump = SCENE_NONE,
                          .normal_map = SCENE_NONE,
                          .emission_texture = SCENE_NONE};
}

static void shine_by_texture(Builder *b, const EvalNode *node, SceneSurface *surface)
{
    double factor = eval_number(node, "radiance"), least, most;
    if (!build_textures_wanted(b)) return;
    surface->emission_texture = build_texture(b, eval_prop(node, "emission"), TEXTURE_OF_LIGHT, &least, &most);
    surface->emission_factor = (float)factor;
    build_texture_place(b, surface->emission_texture, surface);
    double mean = 0.5 * (least + most) * factor;
    build_is_bearable(b, build_span(node, "radiance"), fmax(mean, factor));
    surface->emission = spectrum_from_light((const double[3]){mean, mean, mean});
    surface->emits = mean > 0;
}

uint32_t build_surface(Builder *b, const EvalNode *node)
{
    bool found;
    uint32_t known = *build_row_of(b, &b->surfaces, node, b->scene->n_surfaces, &found);
    if (found) return known;
    const char *name = build_word(b, node);
    SceneSurface surface = plain_surface(name ? name : "surface", 0);
    surface.light_group = build_light_group(b, node);
    if (!eval_prop(node, "emission")) {
        build_needs(b, node, "radiance", "without an 'emission'");
        build_needs(b, node, "light_group", "without an 'emission'");
    } else if (eval_prop(node, "emission")->textured)
        shine_by_texture(b, node, &surface);
    else if (build_emission(b, node, "emission", eval_number(node, "radiance"), &surface.emission))
        surface.emits = !spectrum_is_zero(&surface.emission);
    check_needs(b, node);
    finish_of(b, node, &surface);
    uint32_t row = add_surface(b, surface);
    const EvalProp *mix = eval_prop(node, "mix");
    if (mix) mix_of(b, node, mix, row);
    b->scene->surfaces[row].catches = eval_truth(node, "shadow_catcher");
    if (b->scene->surfaces[row].catches) check_catcher(b, node, &b->scene->surfaces[row]);
    return row;
}

uint32_t build_black_surface(Builder *b)
{
    if (b->black == SCENE_NONE) b->black = add_surface(b, plain_surface("light", 0));
    return b->black;
}

uint32_t build_grey_surface(Builder *b)
{
    if (b->grey == SCENE_NONE) b->grey = add_surface(b, plain_surface("grey", 0.5f));
    return b->grey;
}

/* ---- while the shutter is open ---- */

const SurfaceTexture *build_texture_of(const SceneSurface *surface, const char *property)
{
    for (uint32_t i = 0; i < surface->n_textures; i++)
        if (strcmp(surface->textures[i].property, property) == 0) return &surface->textures[i];
    return NULL;
}

static bool same_parameter(const Parameter *parameter, const SceneSurface *a, const SceneSurface *b)
{
    const char *first = (const char *)&a->spec + parameter->offset,
               *second = (const char *)&b->spec + parameter->offset;
    bool textured = build_texture_of(a, parameter->property) != NULL;
    if (textured != (build_texture_of(b, parameter->property) != NULL)) return false;
    if (textured) return true;
    if (parameter->kind == PARAMETER_NUMBER || parameter->kind == PARAMETER_NANOMETRES)
        return *(const float *)first == *(const float *)second;
    return spectrum_same((const Spectrum *)first, (const Spectrum *)second);
}

static bool same_emission(const SceneSurface *a, const SceneSurface *b)
{
    bool textured = a->emission_texture != SCENE_NONE;
    if (textured != (b->emission_texture != SCENE_NONE)) return false;
    if (textured) return a->emission_factor == b->emission_factor;
    return a->emits == b->emits && (!a->emits || spectrum_same(&a->emission, &b->emission));
}

static bool same_metal(const SceneSurface *a, const SceneSurface *b)
{
    return a->spec.measured_metal == b->spec.measured_metal &&
           (!a->spec.measured_metal || spectrum_same(&a->spec.metal_n, &b->spec.metal_n));
}

const char *build_next_change(const SceneSurface *a, const SceneSurface *b, unsigned *n)
{
    while (*n < COUNT_OF(parameters)) {
        const Parameter *parameter = &parameters[(*n)++];
        if (!same_parameter(parameter, a, b)) return parameter->property;
    }
    const struct {
        const char *property;
        bool same;
    } rest[] = {
        {"emission", same_emission(a, b)},
        {"metal", same_metal(a, b)},
        {"mix", a->mixed == b->mixed},
        {"thin", a->thin == b->thin},
        {"shadow_catcher", a->catches == b->catches},
        {"bump", (a->bump == SCENE_NONE) == (b->bump == SCENE_NONE)},
        {"bump_height", a->bump_height == b->bump_height},
        {"normal_map", (a->normal_map == SCENE_NONE) == (b->normal_map == SCENE_NONE)},
        {"normal_strength", a->normal_x == b->normal_x && a->normal_y == b->normal_y},
        {"grain", a->grain == b->grain},
        {"grain_angle", a->grain_angle == b->grain_angle},
    };
    while (*n < COUNT_OF(parameters) + COUNT_OF(rest)) {
        size_t i = (*n)++ - COUNT_OF(parameters);
        if (!rest[i].same) return rest[i].property;
    }
    return NULL;
}

void build_widen_surface(SceneSurface *surface, const SceneSurface *later)
{
    for (uint32_t i = 0; i < surface->n_textures; i++) {
        const SurfaceTexture *texture = &surface->textures[i];
        if (texture->color) continue;
        float *most = (float *)((char *)&surface->spec + texture->offset);
        *most = fmaxf(*most, *(const float *)((const char *)&later->spec + texture->offset));
    }
    surface->roughness = surface->spec.specular_roughness;
    surface->finished = surface->finished || later->finished;
    if (surface->emission_texture == SCENE_NONE || surface->emits || !later->emits) return;
    surface->emits = true; /* it was dark at first */
    surface->emission = later->emission;
}
