/* build_media.c - media, and the spectra of colours.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <string.h>

#include "optics/color.h"
#include "scene/build_parts.h"

static bool is_term(const EvalProp *prop, const char *name)
{
    return prop->as.spectrum.form == SPECTRUM_TERM && strcmp(prop->as.spectrum.term->type->name, name) == 0;
}

float *build_new_table(Builder *b)
{
    return ARENA_ARRAY(b->arena, float, SPECTRUM_SAMPLES);
}

/* ---- media ---- */

static bool index_of_refraction(Builder *b, const EvalNode *node, const char *property, Spectrum *out)
{
    const EvalProp *prop = eval_prop(node, property);
    if (!prop) return false;
    const double *args = prop->as.spectrum.form == SPECTRUM_TERM ? prop->as.spectrum.term->args : NULL;
    if (prop->as.spectrum.form == SPECTRUM_NUMBER) {
        *out = spectrum_constant((float)prop->as.spectrum.rgb[0]);
    } else if (is_term(prop, "cauchy")) {
        *out = spectrum_cauchy(args[0], args[1], prop->as.spectrum.term->n_args > 2 ? args[2] : 0);
    } else if (is_term(prop, "sellmeier")) {
        *out = spectrum_sellmeier(args, args + 3);
    } else if (is_term(prop, "spectrum")) {
        if (!build_spectrum(b, prop, 10, out)) return false;
    } else {
        diag_report(b->diag, D_WRONG_TYPE, prop->span,
                    "'%s' is a number, cauchy(a, b), sellmeier(b1, b2, b3, c1, c2, c3) or a spectrum()", property);
        return false;
    }
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        float nm = SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM);
        float ior = spectrum_at_one(out, nm);
        if (ior >= 0.1f && ior <= 10) continue;
        Diagnostic *report =
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span,
                        "the index of refraction is %g at %g nm, outside of 0.1 .. 10", (double)ior, (double)nm);
        diag_hint(b->diag, report, "coefficients are for wavelengths in micrometres");
        return false;
    }
    return true;
}

static bool is_same_index(const Spectrum *a, const Spectrum *b)
{
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        const float nm = SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM);
        if (spectrum_at_one(a, nm) != spectrum_at_one(b, nm)) return false;
    }
    return true;
}

/* Of unit length; false where that has none. */
static bool find_axis(Vec3 along, Vec3 *axis)
{
    const double largest = vec3_max_abs(along);
    if (!(largest > 0)) return false;
    *axis = vec3_normalize(vec3_scale(along, 1 / largest));
    return true;
}

static void optic_axis_of(Builder *b, const EvalNode *node, SceneMedium *medium)
{
    const EvalProp *prop = eval_prop(node, "optic_axis");
    if (!eval_prop(node, "extraordinary_ior")) build_needs(b, node, "optic_axis", "without an 'extraordinary_ior'");
    const Vec3 axis = prop ? vec3(prop->as.vector[0], prop->as.vector[1], prop->as.vector[2]) : vec3(0, 1, 0);
    if (!find_axis(axis, &medium->optic_axis))
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span, "the optic axis is a vector of length 0");
}

static void indices_of(Builder *b, const EvalNode *node, SceneMedium *medium)
{
    bool known = index_of_refraction(b, node, "ior", &medium->ior);
    medium->extraordinary = medium->ior;
    (void)index_of_refraction(b, node, "extraordinary_ior", &medium->extraordinary);
    medium->refracts_doubly = known && !is_same_index(&medium->ior, &medium->extraordinary);
    medium->disperses = !spectrum_is_constant(&medium->ior) || !spectrum_is_constant(&medium->extraordinary);
    optic_axis_of(b, node, medium);
    if (medium->disperses) return;
    /* a formula that comes to a number is that number, which is the quickest to look up */
    medium->ior = spectrum_constant(spectrum_at_one(&medium->ior, SCENE_INDEX_NM));
    medium->extraordinary = spectrum_constant(spectrum_at_one(&medium->extraordinary, SCENE_INDEX_NM));
}

/* Coefficients per length: a number, a vector for red, green and blue, or a table. Zero after reporting. */
static Spectrum coefficients_of(Builder *b, const EvalProp *prop)
{
    const double most = (double)FLT_MAX / 16;
    const char *name = prop->type->name;
    Spectrum spectrum = spectrum_constant(0);
    if (is_term(prop, "spectrum")) return build_spectrum(b, prop, most, &spectrum) ? spectrum : spectrum_constant(0);
    if (prop->as.spectrum.form == SPECTRUM_TERM) {
        diag_report(b->diag, D_WRONG_TYPE, prop->span,
                    "'%s' is a number, a vector or a spectrum() per length, not %s()", name,
                    prop->as.spectrum.term->type->name);
        return spectrum;
    }
    const double *rgb = prop->as.spectrum.rgb;
    bool grey = prop->as.spectrum.form == SPECTRUM_NUMBER || (rgb[0] == rgb[1] && rgb[1] == rgb[2]);
    double largest = grey ? rgb[0] : fmax(rgb[0], fmax(rgb[1], rgb[2]));
    if (largest <= most)
        return grey ? spectrum_constant((float)rgb[0]) : spectrum_from_coefficients(rgb, build_new_table(b));
    diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span, "%s %s of %g is too large",
                strcmp(name, "absorption") == 0 ? "an" : "a", name, largest);
    return spectrum;
}

/* Absorption per scene unit, from coefficients or from a tint and its depth. */
static Spectrum absorption_by(Builder *b, const EvalNode *node, const char *coefficients, const char *color)
{
    const EvalProp *absorption = eval_prop(node, coefficients);
    const EvalProp *tint = eval_prop(node, color);
    const EvalProp *depth = eval_prop(node, "depth");
    build_exclude(b, node, coefficients, color);
    if (tint && !depth) {
        Diagnostic *report = diag_report(b->diag, D_MISSING_PROPERTY, tint->span, "'%s' needs a 'depth'", color);
        diag_hint(b->diag, report, "depth is the length of the medium after which white light has this colour");
    } else if (tint) {
        return spectrum_from_tint(tint->as.vector, depth->as.number, build_new_table(b));
    } else if (absorption) {
        return coefficients_of(b, absorption);
    }
    return spectrum_constant(0);
}

/* Of a crystal there may be two, for light that swings across its axis, and along it. */
static void absorption_of(Builder *b, const EvalNode *node, SceneMedium *medium)
{
    static const char *const own[] = {"extraordinary_absorption", "extraordinary_tint"};
    medium->absorption = absorption_by(b, node, "absorption", "tint");
    medium->extraordinary_absorption = medium->absorption;
    for (size_t i = 0; i < COUNT_OF(own); i++) {
        if (!eval_prop(node, own[i])) continue;
        if (!eval_prop(node, "extraordinary_ior")) build_needs(b, node, own[i], "without an 'extraordinary_ior'");
        medium->pleochroic = medium->refracts_doubly;
    }
    if (medium->pleochroic) medium->extraordinary_absorption = absorption_by(b, node, own[0], own[1]);
    if (eval_prop(node, "depth") && !eval_prop(node, "tint") && !eval_prop(node, own[1])) {
        Diagnostic *report = build_needs(b, node, "depth", "without a 'tint'");
        diag_hint(b->diag, report, "tint is the colour of white light after that length: tint = rgb(.8, .9, 1)");
    }
    medium->absorbs = !spectrum_is_zero(&medium->absorption) || !spectrum_is_zero(&medium->extraordinary_absorption);
}

static void scattering_of(Builder *b, const EvalNode *node, SceneMedium *medium)
{
    const EvalProp *scattering = eval_prop(node, "scattering"), *phase = eval_prop(node, "phase");
    medium->scattering = scattering ? coefficients_of(b, scattering) : spectrum_constant(0);
    medium->scatters = !spectrum_is_zero(&medium->scattering);
    medium->phase = phase_isotropic();
    if (phase) build_phase(b, phase, medium);
    Diagnostic *report = scattering ? NULL : build_needs(b, node, "phase", "without 'scattering'");
    if (report) diag_hint(b->diag, report, "how much scatters in a length: scattering = 2 / 1cm");
}

static NestState state_of(const EvalNode *node)
{
    const char *word = eval_word(node, "state");
    if (!word) return NEST_STATE_UNKNOWN;
    return strcmp(word, "solid") == 0 ? NEST_SOLID : strcmp(word, "gas") == 0 ? NEST_GAS : NEST_LIQUID;
}

/* What it gives off by itself. */
static void glow_of(Builder *b, const EvalNode *node, SceneMedium *medium)
{
    const EvalProp *emission = eval_prop(node, "emission"), *temperature = eval_prop(node, "temperature");
    medium->emission = spectrum_constant(0);
    Diagnostic *report = emission ? NULL : build_needs(b, node, "radiance", "without an 'emission'");
    medium->light_group = build_light_group(b, node);
    if (!emission) build_needs(b, node, "light_group", "without an 'emission'");
    if (report) diag_hint(b->diag, report, "the colour of the light: emission = #fff");
    if (temperature && (!emission || !is_term(emission, "blackbody"))) {
        report = diag_report(b->diag, D_MISSING_PROPERTY, temperature->span,
                             "'temperature' needs emission = blackbody(kelvin)");
        diag_hint(b->diag, report, "'radiance' is that of places which are as hot as that; others follow");
        return;
    }
    if (!emission || !build_emission(b, node, "emission", eval_number(node, "radiance"), &medium->emission)) return;
    medium->emits = !spectrum_is_zero(&medium->emission);
    if (!temperature) return;
    medium->reference_k = emission->as.spectrum.term->args[0];
    medium->temperature = build_volume(b, node, "temperature");
}

/* A medium that mixes is neither on top of anything nor bounded by anything. */
static void mixing_of(Builder *b, const EvalNode *node, SceneMedium *medium)
{
    static const char *const of_owners[] = {"ior", "extraordinary_ior", "priority"};
    static const char *const reasons[] = {"it has the index of what it is in", "it has the index of what it is in",
                                          "it is on top of nothing"};
    medium->mixes = eval_truth(node, "mixes");
    if (!medium->mixes && !eval_prop(node, "ior"))
        diag_hint(b->diag, diag_report(b->diag, D_MISSING_PROPERTY, node->span, "a medium lacks its property 'ior'"),
                  eval_prop(node, "scattering") || eval_prop(node, "density") || eval_prop(node, "emission")
                      ? "write: mixes = true, for what is within something, as smoke is in air, or ior = 1 for the "
                        "world's medium"
                      : "write: ior = 1.5 for glass, 1.33 for water");
    for (size_t i = 0; medium->mixes && i < COUNT_OF(of_owners); i++) {
        const EvalProp *prop = eval_prop(node, of_owners[i]);
        if (!prop) continue;
        Diagnostic *report = diag_report(b->diag, D_CONFLICTING_PROPERTIES, prop->span,
                                         "a medium that mixes can have no '%s': %s", of_owners[i], reasons[i]);
        diag_note(b->diag, report, build_span(node, "mixes"), "'mixes' is set here");
    }
}

static void density_of(Builder *b, const EvalNode *node, SceneMedium *medium)
{
    if (!medium->absorbs && !medium->scatters && !medium->emits)
        build_needs(b, node, "density", "on a medium that neither absorbs, scatters nor shines");
    else
        medium->density = build_volume(b, node, "density");
}

/* Of media without a name, until it is known whose they are. */
static const char nameless[] = "medium";

static void add_value(Buf *key, const void *value, size_t size)
{
    buf_add_bytes(key, value, size);
}

static void add_term(Buf *key, const EvalTerm *term)
{
    add_value(key, &term->type, sizeof term->type);
    add_value(key, term->args, term->n_args * sizeof *term->args);
    add_value(key, &term->scale, sizeof term->scale);
    add_value(key, &term->n_pairs, sizeof term->n_pairs);
    if (term->pairs) add_value(key, term->pairs, 2 * term->n_pairs * sizeof *term->pairs);
    if (term->text) add_value(key, term->text, strlen(term->text) + 1);
}

/* What tells media apart that have no name. */
static void add_values(Buf *key, const EvalNode *node)
{
    for (size_t i = 0; i < node->n_props; i++) {
        const EvalProp *prop = &node->props[i];
        bool is_spectrum = prop->type->kind == PROP_SPECTRUM || prop->type->kind == PROP_NUMBER_OR_TERM ||
                           prop->type->kind == PROP_TERM;
        add_value(key, &prop->type, sizeof prop->type);
        if (is_spectrum) add_value(key, &prop->as.spectrum.form, sizeof prop->as.spectrum.form);
        if (is_spectrum && prop->as.spectrum.form == SPECTRUM_TERM)
            add_term(key, prop->as.spectrum.term);
        else if (is_spectrum)
            add_value(key, prop->as.spectrum.rgb, (prop->as.spectrum.form == SPECTRUM_NUMBER ? 1 : 3) * sizeof(double));
        else if (prop->type->kind == PROP_COLOR || prop->type->kind == PROP_VECTOR3)
            add_value(key, prop->as.vector, sizeof prop->as.vector);
        else if (prop->type->kind == PROP_CHOICE)
            add_value(key, prop->as.text, strlen(prop->as.text) + 1);
        else if (prop->type->kind == PROP_BOOL)
            add_value(key, &prop->as.truth, sizeof prop->as.truth);
        else if (prop->type->kind == PROP_NODE)
            add_value(key, &prop->as.node, sizeof prop->as.node);
        else
            add_value(key, &prop->as.number, sizeof prop->as.number);
    }
}

/* A macro or a loop makes the medium in its block anew each time: without a name, those of the same values are one. */
static uint32_t row_of_values(Builder *b, const EvalNode *node, uint32_t row_if_new)
{
    Buf key = {0};
    add_values(&key, node);
    const char *text = buf_text(&key);
    const uint32_t *known = map_seek(&b->nameless_media, text, key.length);
    uint32_t row = known ? *known : row_if_new;
    if (!known) map_find(b->arena, &b->nameless_media, arena_copy_text(b->arena, text, key.length), key.length, row);
    buf_clear(&key);
    return row;
}

uint32_t build_medium(Builder *b, const EvalNode *node)
{
    Scene *scene = b->scene;
    bool found;
    uint32_t *row = build_row_of(b, &b->media, node, scene->n_media, &found);
    if (found) return *row;
    if (!build_word(b, node)) *row = row_of_values(b, node, scene->n_media);
    if (*row != scene->n_media) return *row;
    SceneMedium medium = {.span = build_author_place(b, node),
                          .ior = spectrum_constant(1),
                          .turned_from = SCENE_NONE,
                          .state = state_of(node)};
    medium.name = build_word(b, node);
    if (!medium.name) medium.name = nameless;
    indices_of(b, node, &medium);
    mixing_of(b, node, &medium);
    absorption_of(b, node, &medium);
    scattering_of(b, node, &medium);
    glow_of(b, node, &medium);
    density_of(b, node, &medium);
    const EvalProp *priority = eval_prop(node, "priority");
    if (priority) {
        medium.has_priority = true;
        medium.priority = (int32_t)priority->as.number;
    }
    scene->media = room_for_one(b->arena, scene->media, scene->n_media, &b->media_capacity, sizeof medium);
    scene->media[scene->n_media] = medium;
    for (const EvalNode *model = node->prototype; model; model = model->prototype) {
        const uint32_t *its = map_seek(&b->media, &model, sizeof model);
        if (its) scene->media[*its].models = true;
    }
    return scene->n_media++;
}

uint32_t build_medium_of(Builder *b, const EvalNode *node, const char *owner)
{
    uint32_t number = build_medium(b, node);
    SceneMedium *medium = &b->scene->media[number];
    if (medium->name == nameless) medium->name = arena_format(b->arena, "medium of %s", owner);
    return number;
}

/* A crystal whose axis lies in another direction is another medium. */
static uint32_t turned(Builder *b, uint32_t number, const Affine *to_world)
{
    const double same = 1 - 1e-12;
    Scene *scene = b->scene;
    SceneMedium medium = scene->media[number];
    if (!find_axis(affine_vector(to_world, medium.optic_axis), &medium.optic_axis))
        return number; /* the map is reported */
    for (uint32_t i = number; i < scene->n_media; i++) {
        const SceneMedium *other = &scene->media[i];
        const bool alike = i == number || other->turned_from == number;
        if (alike && fabs(vec3_dot(other->optic_axis, medium.optic_axis)) >= same) return i;
    }
    medium.turned_from = number;
    scene->media = room_for_one(b->arena, scene->media, scene->n_media, &b->media_capacity, sizeof medium);
    scene->media[scene->n_media] = medium;
    return scene->n_media++;
}

void build_fill_object(Builder *b, const EvalProp *interior, uint32_t number, const Affine *frame)
{
    SceneObject *object = &b->scene->objects[number];
    object->medium = build_medium_of(b, interior->as.node, object->name);
    const SceneMedium *medium = &b->scene->media[object->medium];
    if (!medium->refracts_doubly) return;
    if (object->surface != SCENE_NONE && !surface_is_clear(&b->scene->surfaces[object->surface]))
        diag_report(
            b->diag, D_ONE_IMAGE, interior->span,
            "the surface of %s is not smooth and clear: light is bent there by the ordinary index of '%s' alone",
            object->name, medium->name);
    object->medium = turned(b, object->medium, frame);
}

/* ---- light ---- */

/* beyond this the products along a path could leave the range of float */
static const double brightest = 1e30;

bool build_is_bearable(Builder *b, Span span, double radiance)
{
    if (radiance <= brightest) return true;
    diag_report(b->diag, D_VALUE_OUT_OF_RANGE, span, "a radiance of %g is beyond what can be rendered, %g", radiance,
                brightest);
    return false;
}

/* The shape of a table is the light's, and `factor` its luminance. */
static bool emission_of_table(Builder *b, const EvalProp *prop, double factor, Spectrum *out)
{
    const EvalTerm *term = prop->as.spectrum.term;
    factor *= term->scale;
    if (factor < 0) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span, "a light cannot be %g times a spectrum", term->scale);
        return false;
    }
    float *table = build_new_table(b);
    if (is_term(prop, "blackbody")) {
        double kelvin = term->args[0];
        if (!(kelvin >= 500 && kelvin <= 1e6)) {
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span, "a black body of %g K is outside of 500 K .. 1e6 K",
                        kelvin);
            return false;
        }
        *out = spectrum_blackbody(kelvin, table);
    } else {
        EvalTerm unscaled = *term;
        EvalProp shape = *prop;
        unscaled.scale = 1;
        shape.as.spectrum.term = &unscaled;
        if (!build_light_spectrum(b, &shape, brightest, out)) return false;
        double luminance = spectrum_luminance(out);
        factor /= luminance > 0 ? luminance : 1;
    }
    if (!build_is_bearable(b, prop->span, factor * (double)spectrum_max(out))) return false;
    if (out->kind == SPECTRUM_ROWS) {
        out->scale = (float)factor;
        return true;
    }
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) table[i] = (float)((double)out->table[i] * factor);
    out->table = table;
    return true;
}

bool build_emission(Builder *b, const EvalNode *node, const char *property, double factor, Spectrum *out)
{
    const EvalProp *prop = eval_prop(node, property);
    double rgb[3] = {1, 1, 1};
    *out = spectrum_constant(0);
    if (prop && (is_term(prop, "blackbody") || is_term(prop, "spectrum")))
        return emission_of_table(b, prop, factor, out);
    if (prop && prop->as.spectrum.form == SPECTRUM_TERM) {
        diag_report(b->diag, D_WRONG_TYPE, prop->span, "'%s' is a colour, blackbody(kelvin) or a spectrum(), not %s()",
                    property, prop->as.spectrum.term->type->name);
        return false;
    }
    if (prop)
        for (int i = 0; i < 3; i++) rgb[i] = prop->as.spectrum.rgb[prop->as.spectrum.form == SPECTRUM_NUMBER ? 0 : i];
    if (!build_is_bearable(b, prop ? prop->span : node->span, factor * fmax(rgb[0], fmax(rgb[1], rgb[2]))))
        return false;
    for (int i = 0; i < 3; i++) rgb[i] *= factor;
    *out = spectrum_from_light(rgb);
    return true;
}
