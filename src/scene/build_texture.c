/* build_texture.c - textures of surfaces: from their nodes to rows of the scene's table.
 *
 * A node becomes a row for each kind of value that is wanted of it, numbers or colours, however often it is used. What
 * values a texture can take is known before any is looked up, so that a roughness above 1 is an error here and not a
 * surprise in the picture.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "lang/schema_find.h"
#include "optics/color.h"
#include "scene/build_parts.h"

/* Textures within each other, and all that one look-up may come to. */
enum { MOST_DEPTH = 32, MOST_COST = 1000 };

static void no_finite(Builder *b, Span span, const char *what)
{
    diag_report(b->diag, D_VALUE_OUT_OF_RANGE, span, "%s of this texture is beyond what can be computed with", what);
}

/* ---- rows ---- */

static uint32_t add_texture(Builder *b, const Texture *texture, TextureFacts facts)
{
    Scene *scene = b->scene;
    b->texture_facts =
        room_for_one(b->arena, b->texture_facts, scene->n_textures, &b->texture_facts_capacity, sizeof facts);
    scene->textures =
        room_for_one(b->arena, scene->textures, scene->n_textures, &b->textures_capacity, sizeof *texture);
    b->texture_facts[scene->n_textures] = facts;
    scene->textures[scene->n_textures] = *texture;
    return scene->n_textures++;
}

static uint32_t add_constant(Builder *b, Spectrum value, double number)
{
    Texture texture = {.kind = TEXTURE_CONSTANT, .value = value};
    return add_texture(b, &texture, (TextureFacts){.least = number, .most = number, .cost = 1, .depth = 1});
}

static uint32_t add_number(Builder *b, double number)
{
    return add_constant(b, spectrum_constant((float)number), number);
}

static uint32_t add_light(Builder *b, const double rgb[3])
{
    Spectrum light = spectrum_from_light(rgb);
    return add_constant(b, light, spectrum_luminance(&light));
}

/* ---- values ---- */

/* A reflectance of channels that may be anything; false after reporting. While the shutter is open one that is beyond what there is
 * stays at the end of that, as numbers of properties do (EvalOptions.beyond). */
static bool color_of(Builder *b, Span span, const char *name, const double rgb[3], Spectrum *out)
{
    double near[3];
    for (int c = 0; c < 3; c++) near[c] = fmin(fmax(rgb[c], 0), 1);
    for (int c = 0; c < 3 && !build_is_later(b); c++) {
        if (rgb[c] == near[c]) continue;
        Diagnostic *report =
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, span,
                        "'%s' has a channel of %g, and a colour of a surface is in 0..1", name, rgb[c]);
        diag_hint(b->diag, report, "more than 1 would reflect more light than there is");
        return false;
    }
    *out = spectrum_from_reflectance(near);
    return true;
}

static void wants_number(Builder *b, Span span, const char *name)
{
    Diagnostic *report =
        diag_report(b->diag, D_WRONG_TYPE, span, "'%s' is a colour, and this texture stands for a number", name);
    diag_note(b->diag, report, b->texture_user->span, "'%s' takes the texture", b->texture_user->type->name);
}

/* Numbers of light are not below 0; while the shutter is open those that are give none. */
static bool is_light(Builder *b, const EvalProp *prop)
{
    int n = prop->as.spectrum.form == SPECTRUM_TERM ? 0 : prop->as.spectrum.form == SPECTRUM_NUMBER ? 1 : 3;
    for (int c = 0; c < n; c++) {
        if (prop->as.spectrum.rgb[c] >= 0) continue;
        if (!build_is_later(b))
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span,
                        "'%s' has a channel of %g: there is no light below 0", prop->type->name,
                        prop->as.spectrum.rgb[c]);
        return false;
    }
    return true;
}

static uint32_t value_of(Builder *b, const EvalNode *node, const char *name, double unset, TextureUse use)
{
    const EvalProp *prop = eval_prop(node, name);
    if (!prop && use == TEXTURE_OF_LIGHT) return add_light(b, (const double[3]){unset, unset, unset});
    if (!prop) return add_number(b, unset);
    if (prop->textured) return build_texture_row(b, prop->as.node, use);
    if (prop->type->kind == PROP_NUMBER) return add_number(b, prop->as.number);
    if (use == TEXTURE_OF_LIGHT) {
        Spectrum light;
        bool fine = is_light(b, prop) && build_emission(b, node, name, 1, &light);
        /* lines are kept of what shines in them alone, and not of mixtures */
        return add_constant(b, fine ? spectrum_smoothed(&light) : spectrum_constant(0),
                            fine ? spectrum_luminance(&light) : 0);
    }
    const double *rgb = prop->as.spectrum.rgb;
    Spectrum value = spectrum_constant(0);
    switch (prop->as.spectrum.form) {
    case SPECTRUM_NUMBER:
        if (use == TEXTURE_OF_NUMBERS) return add_number(b, rgb[0]);
        color_of(b, prop->span, name, (const double[3]){rgb[0], rgb[0], rgb[0]}, &value);
        break;
    case SPECTRUM_COLOR:
        if (use == TEXTURE_OF_NUMBERS)
            wants_number(b, prop->span, name);
        else
            color_of(b, prop->span, name, rgb, &value);
        break;
    case SPECTRUM_VECTOR: {
        Diagnostic *report = diag_report(b->diag, D_WRONG_TYPE, prop->span, "'%s' is a vector, not a colour", name);
        diag_hint(b->diag, report, "write: rgb(%g, %g, %g)", rgb[0], rgb[1], rgb[2]);
        break;
    }
    case SPECTRUM_TERM:
        if (use == TEXTURE_OF_NUMBERS)
            wants_number(b, prop->span, name);
        else if (strcmp(prop->as.spectrum.term->type->name, "spectrum") != 0)
            diag_report(b->diag, D_WRONG_TYPE, prop->span,
                        "'%s' is a number, a colour, a spectrum() or a texture, not %s()", name,
                        prop->as.spectrum.term->type->name);
        else if (!build_spectrum(b, prop, 1, &value))
            value = spectrum_constant(0);
        break;
    }
    return add_constant(b, value, 0);
}

/* A stop of a ramp of light; its share of the mean goes to the facts. */
static bool light_of(Builder *b, Span span, const double rgb[3], Spectrum *out, TextureFacts *facts, size_t i, size_t n)
{
    for (int c = 0; c < 3; c++) {
        if (rgb[c] >= 0 && build_is_bearable(b, span, rgb[c])) continue;
        if (rgb[c] < 0)
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, span, "'ramp' has a channel of %g: there is no light below 0",
                        rgb[c]);
        return false;
    }
    *out = spectrum_from_light(rgb);
    facts->least = facts->most = (i ? facts->most : 0) + spectrum_luminance(out) / (double)n;
    return true;
}

static void read_ramp(Builder *b, const EvalProp *ramp, TextureUse use, Texture *texture, TextureFacts *facts)
{
    size_t n = ramp->as.list.n;
    if (n > UINT32_MAX / 2) {
        no_finite(b, ramp->span, "the length of the ramp");
        return;
    }
    if (use == TEXTURE_OF_NUMBERS && ramp->as.list.n_lists > 0) wants_number(b, ramp->span, "ramp");
    TextureStop *stops = ARENA_ARRAY(b->arena, TextureStop, n);
    for (size_t i = 0; i < n; i++) {
        const double *stop = ramp->as.list.numbers + 4 * i;
        stops[i] = (TextureStop){(float)stop[0], spectrum_constant((float)stop[1])};
        if (use != TEXTURE_OF_LIGHT) {
            facts->least = i ? fmin(facts->least, stop[1]) : stop[1];
            facts->most = i ? fmax(facts->most, stop[1]) : stop[1];
        }
        if (use == TEXTURE_OF_LIGHT && !light_of(b, ramp->span, stop + 1, &stops[i].value, facts, i, n)) break;
        if (use == TEXTURE_OF_COLORS && !color_of(b, ramp->span, "ramp", stop + 1, &stops[i].value)) break;
    }
    texture->stops = stops;
    texture->n_stops = (uint32_t)n;
}

static void add_facts(TextureFacts *facts, const TextureFacts *of)
{
    facts->cost += of->cost;
    facts->uses_uv = facts->uses_uv || of->uses_uv;
    facts->uses_object = facts->uses_object || of->uses_object;
    facts->uses_normal = facts->uses_normal || of->uses_normal;
    facts->formula = facts->formula || of->formula;
    if (of->depth >= facts->depth) facts->depth = of->depth + 1;
}

/* from, to, ramp: what the pattern's 0..1 stands for. */
static void read_values(Builder *b, const EvalNode *node, TextureUse use, Texture *texture, TextureFacts *facts)
{
    static const char *const excluded[] = {"from", "to"};
    const EvalProp *ramp = NULL;
    for (size_t i = 0; i < node->n_props; i++)
        if (strcmp(node->props[i].type->name, "ramp") == 0) ramp = &node->props[i];
    if (ramp) {
        for (size_t i = 0; i < COUNT_OF(excluded); i++) build_exclude(b, node, "ramp", excluded[i]);
        read_ramp(b, ramp, use, texture, facts);
        return;
    }
    texture->low = value_of(b, node, "from", 0, use);
    texture->high = value_of(b, node, "to", 1, use);
    const TextureFacts *low = &b->texture_facts[texture->low], *high = &b->texture_facts[texture->high];
    facts->least = fmin(low->least, high->least);
    facts->most = fmax(low->most, high->most);
    facts->open = low->open || high->open;
    add_facts(facts, low);
    add_facts(facts, high);
}

/* ---- where ---- */

static bool has_row(const EvalNode *node, const char *name)
{
    for (size_t i = 0; i < node->type->n_props; i++)
        if (strcmp(node->type->props[i].name, name) == 0) return true;
    return false;
}

static void read_place(Builder *b, const EvalNode *node, Texture *texture)
{
    if (!build_check_transform(b, node, &node->transform)) return;
    if (!affine_is_identity(&node->transform)) {
        texture->placed = affine_invert(&node->transform, &texture->to_pattern);
        texture->shrink = cbrt(fabs(affine_determinant(&texture->to_pattern)));
        if (!isfinite(texture->shrink)) no_finite(b, node->span, "the place");
    }
    if (has_row(node, "space")) {
        texture->in_world = strcmp(eval_word(node, "space"), "world") == 0;
        texture->vary = eval_number(node, "vary");
    }
    if (has_row(node, "seed")) texture->seed = (uint64_t)eval_number(node, "seed");
    if (!has_row(node, "turbulence")) return;
    texture->turbulence = eval_number(node, "turbulence");
    texture->turbulence_octaves = (unsigned)eval_number(node, "turbulence_octaves");
    build_needs_other(b, node, "turbulence_octaves", "turbulence", "without turbulence");
    if (!(fabs(texture->turbulence) <= SCENE_REACH)) no_finite(b, build_span(node, "turbulence"), "the turbulence");
}

/* ---- patterns ---- */

/* The number of a property's word among those that its row lists. */
static int choice_of(const EvalNode *node, const char *name)
{
    const char *word = eval_word(node, name), *at = NULL;
    for (size_t i = 0; i < node->type->n_props; i++)
        if (strcmp(node->type->props[i].name, name) == 0) at = node->type->props[i].choices;
    size_t length = strlen(word);
    for (int n = 0; at && *at; n++) {
        size_t here = strcspn(at, "|");
        if (here == length && strncmp(at, word, length) == 0) return n;
        at += here + (at[here] == '|');
    }
    return 0;
}

static void brick_of(Builder *b, const EvalNode *node, Pattern *pattern)
{
    pattern->size = eval_vector(node, "size");
    pattern->mortar = eval_number(node, "mortar");
    pattern->bevel = eval_number(node, "bevel");
    pattern->bond = eval_number(node, "bond");
    double least = fmin(pattern->size.x, fmin(pattern->size.y, pattern->size.z));
    if (pattern->mortar >= least)
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "mortar"),
                    "mortar of %g leaves nothing of a brick of %g", pattern->mortar, least);
}

static void gradient_of(Builder *b, const EvalNode *node, Pattern *pattern)
{
    (void)b;
    pattern->shape = (GradientShape)choice_of(node, "shape");
    pattern->wave = (PatternWave)choice_of(node, "wave");
    pattern->frequency = eval_number(node, "frequency");
    pattern->phase = eval_number(node, "phase");
}

static void noise_of(Builder *b, const EvalNode *node, Pattern *pattern)
{
    (void)b;
    pattern->style = (NoiseStyle)choice_of(node, "style");
    pattern->octaves = (unsigned)eval_number(node, "octaves");
    pattern->lacunarity = eval_number(node, "lacunarity");
    pattern->gain = eval_number(node, "gain");
}

/* A wave up and down along x, which turbulence makes the veins of. */
static void marble_of(Builder *b, const EvalNode *node, Pattern *pattern)
{
    (void)b;
    (void)node;
    pattern->wave = WAVE_TRIANGLE;
    pattern->frequency = 1;
}

static void wood_of(Builder *b, const EvalNode *node, Pattern *pattern)
{
    (void)b;
    pattern->grain = eval_number(node, "grain");
}

static void crackle_of(Builder *b, const EvalNode *node, Pattern *pattern)
{
    (void)b;
    pattern->value = (CrackleValue)choice_of(node, "value");
}

static void spots_of(Builder *b, const EvalNode *node, Pattern *pattern)
{
    (void)b;
    pattern->radius = eval_number(node, "radius");
    pattern->blur = eval_number(node, "blur");
}

static const struct {
    const char *type;
    PatternKind kind;
    void (*read)(Builder *b, const EvalNode *node, Pattern *pattern);
} patterns[] = {
    {"checker", PATTERN_CHECKER, NULL},       {"brick", PATTERN_BRICK, brick_of},
    {"hexagon", PATTERN_HEXAGON, NULL},       {"gradient", PATTERN_GRADIENT, gradient_of},
    {"noise", PATTERN_NOISE, noise_of},       {"marble", PATTERN_GRADIENT, marble_of},
    {"wood", PATTERN_WOOD, wood_of},          {"granite", PATTERN_GRANITE, NULL},
    {"crackle", PATTERN_CRACKLE, crackle_of}, {"spots", PATTERN_SPOTS, spots_of},
    {"agate", PATTERN_AGATE, NULL},
};

static void read_pattern(Builder *b, const EvalNode *node, Texture *texture, TextureFacts *facts)
{
    for (size_t i = 0; i < COUNT_OF(patterns); i++) {
        if (strcmp(node->type->name, patterns[i].type) != 0) continue;
        texture->kind = TEXTURE_PATTERN;
        texture->pattern.kind = patterns[i].kind;
        texture->pattern.seed = texture->seed;
        if (patterns[i].read) patterns[i].read(b, node, &texture->pattern);
        facts->cost += 1 + texture->pattern.octaves / 4;
    }
}

/* ---- all ---- */

static void check_size(Builder *b, const EvalNode *node, TextureFacts *facts)
{
    if (facts->depth <= MOST_DEPTH && facts->cost <= MOST_COST) return;
    Diagnostic *report = diag_report(b->diag, D_TOO_DEEP, node->span,
                                     "textures within textures: %u levels and %u look-ups, of %d and %d", facts->depth,
                                     facts->cost, MOST_DEPTH, MOST_COST);
    diag_hint(b->diag, report, "look for a texture that takes itself in, turn by turn");
    facts->depth = facts->cost = 1; /* it is said once */
}

static Texture make_texture(Builder *b, const EvalNode *node, TextureUse use, TextureFacts *facts)
{
    Texture texture = {.low = TEXTURE_NONE, .high = TEXTURE_NONE, .blend = TEXTURE_NONE, .shrink = 1};
    const char *type = node->type->name;
    read_place(b, node, &texture);
    if (strcmp(type, "image") == 0) {
        texture.kind = TEXTURE_IMAGE;
        texture.projection = (TextureProjection)choice_of(node, "projection");
        facts->uses_uv = texture.projection == PROJECTION_UV;
        facts->uses_normal = texture.projection == PROJECTION_BOX;
        texture.wrap = (TextureWrap)choice_of(node, "wrap");
        texture.turns = eval_number(node, "turns");
        if (texture.projection != PROJECTION_CYLINDRICAL && texture.projection != PROJECTION_SPHERICAL)
            build_needs(b, node, "turns", "with a projection that does not go around");
        texture.is_value = use == TEXTURE_OF_VECTORS ||
                           (!eval_prop(node, "from") && !eval_prop(node, "to") && !eval_prop(node, "ramp"));
        TextureUse of_image = texture.is_value ? use : TEXTURE_OF_NUMBERS;
        texture.image = build_texture_image(b, node, of_image, &texture.source);
        if (texture.is_value) {
            float least = 0, most = 0;
            facts->open = build_is_later(b) && use == TEXTURE_OF_NUMBERS;
            if (texture.image && use == TEXTURE_OF_NUMBERS) texture_image_range(texture.image, 0, &least, &most);
            if (texture.image && texture.wrap == WRAP_ONCE) least = float_min(least, 0), most = float_max(most, 0);
            if (texture.image && use == TEXTURE_OF_LIGHT) least = most = texture_image_luminance(texture.image);
            facts->least = (double)least;
            facts->most = (double)most;
            return texture;
        }
    } else if (strcmp(type, "mix") == 0) {
        texture.kind = TEXTURE_MIX;
        texture.blend = value_of(b, node, "blend", eval_number(node, "blend"), TEXTURE_OF_NUMBERS);
        add_facts(facts, &b->texture_facts[texture.blend]);
    } else if (strcmp(type, "variation") == 0) {
        texture.kind = TEXTURE_VARIATION;
    } else if (strcmp(type, "formula") == 0) {
        build_formula(b, node, use, &texture, facts);
        facts->formula = true;
        if (texture.is_value) return texture;
    } else {
        read_pattern(b, node, &texture, facts);
    }
    read_values(b, node, use, &texture, facts);
    return texture;
}

uint32_t build_texture_row(Builder *b, const EvalNode *node, TextureUse use)
{
    struct {
        const EvalNode *node;
        uint64_t use;
    } key = {node, use};
    const uint32_t *known = map_seek(&b->textures, &key, sizeof key);
    if (known) return *known;
    TextureFacts facts = {.cost = 1, .depth = 1};
    Texture texture = make_texture(b, node, use, &facts);
    bool has_place =
        texture.kind == TEXTURE_PATTERN || texture.kind == TEXTURE_IMAGE || texture.kind == TEXTURE_FORMULA;
    facts.uses_object = facts.uses_object || facts.uses_uv || (has_place && !texture.in_world);
    check_size(b, node, &facts);
    if ((texture.kind == TEXTURE_IMAGE && !texture.image) || (texture.kind == TEXTURE_FORMULA && !texture.program)) {
        /* reported */
        texture = (Texture){.kind = TEXTURE_CONSTANT, .value = spectrum_constant(0)};
        facts = (TextureFacts){.cost = 1, .depth = 1};
    }
    uint32_t row = add_texture(b, &texture, facts);
    return *map_find(b->arena, &b->textures, arena_copy_text(b->arena, (const char *)&key, sizeof key), sizeof key,
                     row);
}

uint32_t build_world_checker(Builder *b, const double rgb[3], const double other[3], double size)
{
    Texture texture = {
        .kind = TEXTURE_PATTERN, .in_world = true, .placed = true, .shrink = 1 / size, .blend = TEXTURE_NONE};
    texture.pattern.kind = PATTERN_CHECKER;
    texture.to_pattern = affine_identity();
    for (int i = 0; i < 3; i++) texture.to_pattern.m[i][i] = 1 / size;
    texture.to_pattern.t.y = 0.5;
    texture.low = add_constant(b, spectrum_from_reflectance(rgb), 0);
    texture.high = add_constant(b, spectrum_from_reflectance(other), 0);
    return add_texture(b, &texture, (TextureFacts){.cost = 3, .depth = 2});
}

void build_texture_place(const Builder *b, uint32_t row, SceneSurface *surface)
{
    const TextureFacts *facts = &b->texture_facts[row];
    surface->textures_use_uv = surface->textures_use_uv || facts->uses_uv;
    surface->textures_use_object = surface->textures_use_object || facts->uses_object;
    surface->textures_use_normal = surface->textures_use_normal || facts->uses_normal;
}

bool build_textures_wanted(const Builder *b)
{
    return !b->only_shapes;
}

uint32_t build_texture(Builder *b, const EvalProp *prop, TextureUse use, double *least, double *most)
{
    const EvalProp *outer = b->texture_user;
    b->texture_user = prop;
    uint32_t row = build_texture_row(b, prop->as.node, use);
    b->texture_user = outer;
    const TextureFacts *facts = &b->texture_facts[row];
    const PropType *type = prop->type;
    *least = facts->least;
    *most = facts->most;
    if (facts->formula) {
        b->open_textures = room_for_one(b->arena, b->open_textures, b->n_open_textures, &b->open_textures_capacity,
                                        sizeof *b->open_textures);
        b->open_textures[b->n_open_textures++] = (OpenTexture){.row = row, .user = prop};
    }
    if (facts->open) { /* known when it is asked where the surface is */
        *least = fmax(type->min, 0);
        *most = isfinite(type->max) ? type->max : fmax(type->min, 1);
        return row;
    }
    if (use != TEXTURE_OF_NUMBERS || (facts->least >= type->min && facts->most <= type->max)) return row;
    bool low = facts->least < type->min;
    Diagnostic *report =
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, prop->span, "%s reaches %g by this texture, which %s", type->name,
                    low ? facts->least : facts->most, schema_bounds_text(b->diag->arena, type));
    diag_hint(b->diag, report, "its values are those of from and to, of the ramp, or of the picture");
    return row;
}

static bool any_textures(const Scene *scene, const SceneSurface *surface)
{
    return surface_has_textures(surface) || surface->emission_texture != SCENE_NONE ||
           (surface->mixed && (any_textures(scene, &scene->surfaces[surface->mix[0]]) ||
                               any_textures(scene, &scene->surfaces[surface->mix[1]])));
}

static bool surface_has(const SceneSurface *surface, uint32_t row)
{
    if (surface->bump == row || surface->emission_texture == row) return true;
    for (uint32_t i = 0; i < surface->n_textures; i++)
        if (surface->textures[i].texture == row) return true;
    return false;
}

bool build_surface_includes(const Scene *scene, uint32_t surface, uint32_t row, unsigned depth)
{
    if (surface == SCENE_NONE || depth > MOST_DEPTH) return false;
    const SceneSurface *at = &scene->surfaces[surface];
    return surface_has(at, row) || (at->mixed && (build_surface_includes(scene, at->mix[0], row, depth + 1) ||
                                                  build_surface_includes(scene, at->mix[1], row, depth + 1)));
}

void build_texture_frame(Builder *b, uint32_t object_row, const Affine *node_to_world)
{
    Scene *scene = b->scene;
    SceneObject *object = &scene->objects[object_row];
    if (object->shape == SCENE_NONE || object->surface == SCENE_NONE || !build_textures_wanted(b)) return;
    if (!any_textures(scene, &scene->surfaces[object->surface])) return;
    Affine to_node;
    if (!affine_invert(node_to_world, &to_node)) return; /* reported */
    SceneTextureFrame frame;
    memset(&frame, 0, sizeof frame); /* it is compared as bytes */
    frame.from_shape = affine_compose(&to_node, &object->to_world);
    frame.moved = !affine_is_identity(&frame.from_shape);
    frame.motion = SCENE_NONE;
    frame.inverse = 1 / affine_determinant(&frame.from_shape);
    frame.box = b->facts[object->shape].bounds;
    /* instances of one prototype share theirs, but for rounding */
    SceneTextureFrame *last = scene->n_texture_frames ? &scene->texture_frames[scene->n_texture_frames - 1] : NULL;
    if (!last || memcmp(last, &frame, sizeof frame) != 0) {
        scene->texture_frames = room_for_one(b->arena, scene->texture_frames, scene->n_texture_frames,
                                             &b->texture_frames_capacity, sizeof frame);
        scene->texture_frames[scene->n_texture_frames++] = frame;
    }
    object->texture_frame = scene->n_texture_frames - 1;
    if (b->n_open_textures) build_check_formulas(b, object_row);
}
