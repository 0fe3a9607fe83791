/* build_surface.c - surfaces: what covers opaque objects, and how rough clear ones are.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <string.h>

#include "optics/color.h"
#include "optics/metal.h"
#include "scene/build_parts.h"

/* Properties that are parameters of a BsdfSpec, each on its own: what the property is read as, and where it goes. */
typedef enum ParameterKind {
    PARAMETER_NUMBER, /* a float */
    PARAMETER_COLOR,  /* a Spectrum of reflectances */
    PARAMETER_INDEX   /* a Spectrum, the same at all wavelengths */
} ParameterKind;

typedef struct Parameter {
    const char *property;
    ParameterKind kind;
    size_t offset; /* in BsdfSpec */
} Parameter;

static const Parameter parameters[] = {
    {"albedo", PARAMETER_COLOR, offsetof(BsdfSpec, base_color)},
    {"diffuse_roughness", PARAMETER_NUMBER, offsetof(BsdfSpec, base_diffuse_roughness)},
    {"roughness", PARAMETER_NUMBER, offsetof(BsdfSpec, specular_roughness)},
    {"ior", PARAMETER_INDEX, offsetof(BsdfSpec, specular_ior)},
    {"coat", PARAMETER_NUMBER, offsetof(BsdfSpec, coat_weight)},
    {"coat_ior", PARAMETER_INDEX, offsetof(BsdfSpec, coat_ior)},
    {"coat_roughness", PARAMETER_NUMBER, offsetof(BsdfSpec, coat_roughness)},
    {"coat_tint", PARAMETER_COLOR, offsetof(BsdfSpec, coat_color)},
};

/* What is neither set nor has a default stays as bsdf_spec_init left it. */
static void read_parameter(const EvalNode *node, const Parameter *parameter, BsdfSpec *spec)
{
    void *target = (char *)spec + parameter->offset;
    if (!eval_has_value(node, parameter->property)) return;
    if (parameter->kind == PARAMETER_COLOR) {
        Vec3 color = eval_vector(node, parameter->property);
        *(Spectrum *)target = spectrum_from_reflectance((const double[3]){color.x, color.y, color.z});
    } else {
        float number = (float)eval_number(node, parameter->property);
        if (parameter->kind == PARAMETER_INDEX)
            *(Spectrum *)target = spectrum_constant(number);
        else
            *(float *)target = number;
    }
}

static uint32_t add_surface(Builder *b, SceneSurface surface)
{
    Scene *scene = b->scene;
    scene->surfaces = room_for_one(b->arena, scene->surfaces, scene->n_surfaces, &b->surfaces_capacity, sizeof surface);
    scene->surfaces[scene->n_surfaces] = surface;
    return scene->n_surfaces++;
}

/* Skin, metal, coat: what makes a surface more than matte. */
static void finish_of(Builder *b, const EvalNode *node, SceneSurface *surface)
{
    const EvalProp *ior = eval_prop(node, "ior");
    const char *metal = eval_word(node, "metal");
    BsdfSpec *spec = &surface->spec[0];
    bsdf_spec_init(spec);
    for (size_t i = 0; i < COUNT_OF(parameters); i++) read_parameter(node, &parameters[i], spec);
    surface->roughness = spec->specular_roughness;
    spec->specular_weight = ior ? 1 : 0;
    if (metal) {
        spec->base_metalness = 1;
        spec->measured_metal =
            metal_index(metal, &spec->metal_n, &spec->metal_k, build_new_table(b), build_new_table(b));
    }
    surface->spec[1] = *spec;
    surface->spec[1].base_color = surface->albedo2;
    surface->finished = ior || metal || spec->coat_weight > 0 || spec->base_diffuse_roughness > 0;
    static const char *const of_metal[] = {"albedo", "ior", "diffuse_roughness", "pattern"};
    for (size_t i = 0; metal && i < COUNT_OF(of_metal); i++) build_exclude(b, node, "metal", of_metal[i]);
    static const char *const of_coat[] = {"coat_ior", "coat_roughness", "coat_tint"};
    for (size_t i = 0; spec->coat_weight == 0 && i < COUNT_OF(of_coat); i++)
        build_needs(b, node, of_coat[i], "without a coat");
}

bool build_surface_fits(Builder *b, const EvalProp *surface, bool clear)
{
    const EvalNode *node = surface->as.node;
    size_t n_errors = b->diag->n_errors;
    for (size_t i = 0; clear && i < node->n_props; i++) {
        if (strcmp(node->props[i].type->name, "roughness") == 0) continue;
        Diagnostic *report =
            diag_report(b->diag, D_CONFLICTING_PROPERTIES, surface->span,
                        "an object with an interior is clear: its surface can be rough, but has no '%s'",
                        node->props[i].type->name);
        diag_note(b->diag, report, node->props[i].span, "'%s' is set here", node->props[i].type->name);
        break;
    }
    if (clear && node->n_props == 0) {
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, surface->span,
                                         "an object with an interior is clear: this surface says nothing of it");
        diag_hint(b->diag, report, "a rough one is surface { roughness = .3 }");
    }
    if (!clear && !eval_prop(node, "ior") && !eval_prop(node, "metal") && eval_prop(node, "roughness")) {
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, build_span(node, "roughness"),
                                         "'roughness' has no effect on a matte surface");
        diag_hint(b->diag, report, "give it a skin, ior = 1.5, or make it a metal");
    }
    return b->diag->n_errors == n_errors;
}

uint32_t build_surface(Builder *b, const EvalNode *node)
{
    bool found;
    uint32_t known = *build_row_of(b, &b->surfaces, node, b->scene->n_surfaces, &found);
    if (found) return known;
    const char *name = node->name ? node->name : "surface";
    Vec3 albedo = eval_vector(node, "albedo");
    double rgb[3] = {albedo.x, albedo.y, albedo.z};
    SceneSurface surface = {.name = arena_copy_text(b->arena, name, strlen(name)),
                            .albedo = spectrum_from_reflectance(rgb)};
    surface.albedo2 = surface.albedo;
    if (!eval_prop(node, "emission"))
        build_needs(b, node, "radiance", "without an 'emission'");
    else if (build_emission(b, node, "emission", eval_number(node, "radiance"), &surface.emission))
        surface.emits = !spectrum_is_zero(&surface.emission);
    surface.check_size = (float)eval_number(node, "check_size");
    if (strcmp(eval_word(node, "pattern"), "checker") == 0) {
        const EvalProp *albedo2 = eval_prop(node, "albedo2");
        double other[3];
        for (int i = 0; i < 3; i++) other[i] = albedo2 ? albedo2->as.vector[i] : rgb[i] / 4;
        surface.checkered = true;
        surface.albedo2 = spectrum_from_reflectance(other);
        if (!(surface.check_size >= FLT_MIN && surface.check_size <= (float)SCENE_REACH))
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "check_size"), "squares of %g cannot be drawn",
                        eval_number(node, "check_size"));
    } else {
        build_needs(b, node, "albedo2", "without pattern = checker");
        build_needs(b, node, "check_size", "without pattern = checker");
    }
    finish_of(b, node, &surface);
    return add_surface(b, surface);
}

uint32_t build_black_surface(Builder *b)
{
    if (b->black == SCENE_NONE)
        b->black = add_surface(
            b, (SceneSurface){
                   .name = "light", .albedo = spectrum_constant(0), .albedo2 = spectrum_constant(0), .check_size = 1});
    return b->black;
}

uint32_t build_grey_surface(Builder *b)
{
    if (b->grey == SCENE_NONE)
        b->grey = add_surface(b, (SceneSurface){.name = "grey",
                                                .albedo = spectrum_constant(0.5f),
                                                .albedo2 = spectrum_constant(0.5f),
                                                .check_size = 1});
    return b->grey;
}
