/* build_environment.c - light from infinitely far: a colour, an image, a sky, or a function of the direction.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/hash.h"
#include "lang/formula.h"
#include "lang/schema_find.h"
#include "optics/sky.h"
#include "scene/build_parts.h"

static const double brightest_sky = 1e20;

/* Radiance must be a number, not negative, and far from the end of float's range. */
static bool check_pixels(Builder *b, Span span, const char *name, const float *rgb, uint32_t width, uint32_t height)
{
    size_t n = (size_t)width * height * 3;
    for (size_t i = 0; i < n; i++) {
        if (rgb[i] >= 0 && rgb[i] <= ENVIRONMENT_BRIGHTEST) continue;
        diag_report(b->diag, D_IMAGE_INVALID, span, "'%s' cannot light a scene: the %s of pixel %zu,%zu is %g", name,
                    i % 3 == 0   ? "red"
                    : i % 3 == 1 ? "green"
                                 : "blue",
                    i / 3 % width, i / 3 / width, (double)rgb[i]);
        return false;
    }
    return true;
}

/* Whether pixels that are fine by themselves are so with the strength, too. */
static bool check_strength(Builder *b, const EvalNode *node, const float *rgb, size_t n, double strength)
{
    float largest = 0;
    for (size_t i = 0; i < n; i++) largest = rgb[i] > largest ? rgb[i] : largest;
    double brightest = strength * (double)largest;
    if (brightest <= (double)ENVIRONMENT_BRIGHTEST) return true;
    diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "strength"),
                "with a strength of %g the brightest place has a radiance of %g, beyond what can be rendered, %g",
                strength, brightest, (double)ENVIRONMENT_BRIGHTEST);
    return false;
}

static void hash_light(Builder *b, const Spectrum *light)
{
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        float value = spectrum_at_one(light, SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM));
        b->environment_hash = hash_bytes(&value, sizeof value, b->environment_hash);
    }
    if (light->kind != SPECTRUM_ROWS) return;
    b->environment_hash = hash_bytes(&light->scale, sizeof light->scale, b->environment_hash);
    b->environment_hash = hash_bytes(light->rows->row, light->rows->n * sizeof *light->rows->row, b->environment_hash);
}

/* false after a report. */
static bool environment_from_pixels(Builder *b, const EvalNode *node, Span span, const float *rgb, uint32_t width,
                                    uint32_t height)
{
    const uint32_t size[2] = {width, height};
    double strength = eval_number(node, "strength");
    if (!check_strength(b, node, rgb, (size_t)width * height * 3, strength)) return false;
    b->environment_hash = hash_bytes(size, sizeof size, b->environment_hash);
    b->environment_hash = hash_bulk(rgb, (size_t)width * height * 3 * sizeof *rgb, b->environment_hash);
    b->environment_hash = hash_bytes(&strength, sizeof strength, b->environment_hash);
    Spectrum light;
    bool colored = eval_prop(node, "color") != NULL;
    if (colored && !build_emission(b, node, "color", 1, &light)) return false;
    if (colored) hash_light(b, &light);
    Error error;
    Status status = environment_new_image(rgb, width, height, strength, colored ? &light : NULL, b->options->pool,
                                          &b->scene->environment, &error);
    if (status != STATUS_INPUT) return build_succeeded(b, status, &error, span);
    diag_report(b->diag, D_IMAGE_INVALID, span, "%s", error.text);
    return false;
}

static void environment_from_image(Builder *b, const EvalNode *node, const EvalProp *image)
{
    const char *path = eval_find_file(&b->eval_options, b->diag, image->span, image->as.text);
    if (!path) return;
    build_note_file(b, path);
    float *rgb = NULL;
    uint32_t width = 0, height = 0;
    Error error;
    Status status = b->options->load_image ? b->options->load_image(b->options->load_image_context, path, NULL, &rgb,
                                                                    &width, &height, &error)
                                           : fail(&error, STATUS_INPUT, "images cannot be read here");
    if (status != STATUS_OK && status != STATUS_NOMEM) {
        diag_report(b->diag, D_IMAGE_INVALID, image->span, "%s", error.text);
    } else if (status == STATUS_OK && (width == 0 || height == 0)) {
        diag_report(b->diag, D_IMAGE_INVALID, image->span, "'%s' has no pixels", path);
    } else if (status == STATUS_OK && check_pixels(b, image->span, path, rgb, width, height)) {
        (void)environment_from_pixels(b, node, image->span, rgb, width, height);
    }
    free(rgb);
    if (status == STATUS_NOMEM) build_succeeded(b, status, &error, image->span);
}

static void environment_from_color(Builder *b, const EvalNode *node)
{
    Spectrum radiance;
    double strength = eval_number(node, "strength");
    if (!build_emission(b, node, "color", strength, &radiance)) return;
    Error error;
    Status status = environment_new_constant(&radiance, &b->scene->environment, &error);
    if (!build_succeeded(b, status, &error, node->span)) return;
    hash_light(b, &radiance);
}

/* A function's image in the making: row by row, by all threads. */
typedef struct Panorama {
    const Program *program;
    uint32_t width, height;
    float *rgb;
} Panorama;

static void pixel_inputs(const Panorama *panorama, uint32_t x, uint32_t y, double inputs[PROGRAM_INPUTS])
{
    Vec3 d = environment_pixel_direction(panorama->width, panorama->height, x, y);
    const double values[PROGRAM_INPUTS] = {d.x, d.y, d.z, -d.x, -d.y, -d.z, 0, 0, MEN_PI / panorama->height};
    memcpy(inputs, values, sizeof values);
}

static void task_of_row(void *context, uint32_t y, unsigned worker)
{
    const Panorama *panorama = context;
    (void)worker;
    for (uint32_t x = 0; x < panorama->width; x++) {
        double inputs[PROGRAM_INPUTS], outputs[PROGRAM_MOST_OUTPUTS];
        pixel_inputs(panorama, x, y, inputs);
        program_run(panorama->program, inputs, outputs);
        for (uint32_t c = 0; c < 3; c++)
            panorama->rgb[3 * ((size_t)y * panorama->width + x) + c] =
                (float)outputs[panorama->program->n_outputs == 3 ? c : 0];
    }
}

/* Whether it is light everywhere; else what it is not is reported. */
static bool check_panorama(Builder *b, const Panorama *panorama, const EvalProp *function)
{
    size_t n = (size_t)panorama->width * panorama->height * 3;
    for (size_t i = 0; i < n; i++) {
        if (panorama->rgb[i] >= 0 && panorama->rgb[i] <= ENVIRONMENT_BRIGHTEST) continue;
        uint32_t x = (uint32_t)(i / 3 % panorama->width), y = (uint32_t)(i / 3 / panorama->width);
        double inputs[PROGRAM_INPUTS], outputs[PROGRAM_MOST_OUTPUTS];
        size_t n_errors = b->diag->n_errors;
        pixel_inputs(panorama, x, y, inputs);
        if (isnan(panorama->rgb[i])) (void)formula_evaluate(function->as.function, inputs, outputs); /* it says why */
        if (b->diag->n_errors > n_errors) return false;
        Diagnostic *report =
            diag_report(b->diag, D_VALUE_OUT_OF_RANGE, function->span,
                        "this function is %g towards <%.4g, %.4g, %.4g>: an environment's light is 0 or more, and "
                        "finite",
                        (double)panorama->rgb[i], inputs[0], inputs[1], inputs[2]);
        diag_hint(b->diag, report, "max(0, ...) holds it there");
        return false;
    }
    return true;
}

/* Light is looked for where the function is bright, so it is asked all around before anything is rendered. */
static void environment_from_function(Builder *b, const EvalNode *node, const EvalProp *function)
{
    uint32_t width = (uint32_t)eval_number(node, "resolution");
    Panorama panorama = {formula_compile(function->as.function, b->arena), width, (width + 1) / 2, NULL};
    if (!panorama.program) return;
    size_t n = (size_t)panorama.width * panorama.height * 3;
    panorama.rgb = malloc(n * sizeof *panorama.rgb);
    if (!panorama.rgb) {
        Error error;
        Status status = fail_memory(&error, n * sizeof *panorama.rgb, "an environment");
        (void)build_succeeded(b, status, &error, function->span);
        return;
    }
    pool_run(b->options->pool, panorama.height, task_of_row, &panorama);
    if (check_panorama(b, &panorama, function))
        (void)environment_from_pixels(b, node, function->span, panorama.rgb, panorama.width, panorama.height);
    free(panorama.rgb);
}

/* The disc of the sun, of which `sun` is the irradiance. */
static void add_sun(Builder *b, const EvalNode *node, double elevation, const float *sun)
{
    Scene *scene = b->scene;
    double half_angle = 0.5 * BUILD_SUNS_ANGLE * MEN_DEGREE, sine = sin(half_angle);
    SceneLight light = {.kind = LIGHT_DISTANT,
                        .span = build_author_place(b, node),
                        .object = SCENE_NONE,
                        .motion = SCENE_NONE,
                        .group = scene->environment_group,
                        .hidden = scene->environment_hidden,
                        .to_world = affine_identity(),
                        .cos_angle = cos(half_angle)};
    float *table = ARENA_ARRAY(b->arena, float, SPECTRUM_SAMPLES);
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) table[i] = (float)((double)sun[i] / (MEN_PI * sine * sine));
    light.radiance = (Spectrum){.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
    /* the environment's map is a rotation: its transpose turns back */
    light.towards = affine_normal(&scene->world_to_environment, vec3(0, sin(elevation), cos(elevation)));
    light.name = build_name(b, node, "sun");
    build_add_light(b, &light);
}

static void environment_from_sky(Builder *b, const EvalNode *node)
{
    Scene *scene = b->scene;
    Vec3 ground = eval_vector(node, "ground");
    double rgb[3] = {ground.x, ground.y, ground.z}, azimuth = eval_number(node, "azimuth") * MEN_DEGREE;
    Spectrum albedo = spectrum_from_reflectance(rgb);
    SkyModel model = {eval_number(node, "elevation") * MEN_DEGREE, eval_number(node, "turbidity"), &albedo,
                      eval_number(node, "strength"), b->options->pool};
    if (model.strength > brightest_sky) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "strength"),
                    "a sky %g times as bright as day is beyond what can be rendered", model.strength);
        return;
    }
    /* the sky has its sun over +z; turned by the azimuth it is where it should be */
    Affine turn = {{{cos(azimuth), 0, -sin(azimuth)}, {0, 1, 0}, {sin(azimuth), 0, cos(azimuth)}}, {0, 0, 0}};
    scene->world_to_environment = affine_compose(&turn, &scene->world_to_environment);
    float sun[SPECTRUM_SAMPLES] = {0};
    Error error;
    bool overcast = strcmp(eval_word(node, "sky"), "overcast") == 0;
    if (overcast && model.elevation < 0) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "elevation"),
                    "the sun is %g degrees below the horizon: an overcast sky has no twilight",
                    -model.elevation / MEN_DEGREE);
        return;
    }
    Status status = overcast ? sky_new_overcast(&model, &scene->environment, &error)
                             : sky_new(&model, &scene->environment, sun, &error);
    if (!build_succeeded(b, status, &error, node->span)) return;
    double key[] = {overcast, model.elevation, model.turbidity, model.strength, rgb[0], rgb[1], rgb[2]};
    b->environment_hash = hash_bytes(key, sizeof key, b->environment_hash);
    if (!overcast && model.elevation > 0 && model.strength > 0 && eval_truth(node, "disc"))
        add_sun(b, node, model.elevation, sun);
}

void build_environment(Builder *b, const EvalNode *node)
{
    static const char *const of_sky[] = {"elevation", "ground"}, *const of_clear[] = {"azimuth", "turbidity", "disc"};
    const EvalProp *image = eval_prop(node, "image"), *function = eval_prop(node, "function");
    double scale = affine_even_scale(&node->transform, 1e-6);
    static const char *const sources[] = {"image", "function", "sky"};
    bool one = build_exclude(b, node, "color", "sky");
    for (size_t i = 0; i < COUNT_OF(sources); i++)
        for (size_t k = i + 1; k < COUNT_OF(sources) && one; k++) one = build_exclude(b, node, sources[i], sources[k]);
    if (!one) return;
    if (!function) build_needs(b, node, "resolution", "without a function");
    if (fabs(scale - 1) > 1e-6 || affine_determinant(&node->transform) < 0 ||
        !affine_invert(&node->transform, &b->scene->world_to_environment)) {
        diag_report(b->diag, D_SINGULAR_TRANSFORM, node->span, "an environment can only be rotated");
        return;
    }
    b->scene->world_to_environment.t = vec3(0, 0, 0);
    b->scene->environment_hidden = !eval_truth(node, "visible");
    b->scene->environment_group = build_light_group(b, node);
    bool clear = eval_prop(node, "sky") && strcmp(eval_word(node, "sky"), "clear") == 0;
    for (size_t i = 0; i < COUNT_OF(of_sky) && !eval_prop(node, "sky"); i++)
        build_needs(b, node, of_sky[i], "without sky = clear or overcast");
    for (size_t i = 0; i < COUNT_OF(of_clear) && !clear; i++) build_needs(b, node, of_clear[i], "without sky = clear");
    if (eval_prop(node, "sky"))
        environment_from_sky(b, node);
    else if (image)
        environment_from_image(b, node, image);
    else if (function)
        environment_from_function(b, node, function);
    else
        environment_from_color(b, node);
}
