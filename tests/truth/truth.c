/* truth.c - see truth.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/luminance.h"
#include "truth.h"

#include "scene/library.h"

enum { SKY_ROWS = 2048, SKY_COLUMNS = 4 };

/* Stands for the reader of image files: the sky, by rows from the zenith down. */
static Status load_sky(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                       uint32_t *height, Error *error)
{
    (void)path;
    (void)space;
    const TruthInput *input = context;
    *width = SKY_COLUMNS;
    *height = SKY_ROWS;
    *rgb = malloc((size_t)SKY_COLUMNS * SKY_ROWS * 3 * sizeof **rgb);
    if (!*rgb) return fail_memory(error, (size_t)SKY_COLUMNS * SKY_ROWS * 3 * sizeof **rgb, "the sky");
    for (uint32_t y = 0; y < SKY_ROWS; y++) {
        double elevation = TRUTH_PI * (0.5 - (y + 0.5) / SKY_ROWS);
        double radiance = input->sky ? input->sky(elevation) : 1;
        for (uint32_t i = 0; i < SKY_COLUMNS * 3; i++) (*rgb)[y * SKY_COLUMNS * 3 + i] = (float)radiance;
    }
    return STATUS_OK;
}

/* The description is immutable to the program; here what is left is a scene that could have been written as it is. */
static void take_away_opaque(Scene *scene)
{
    uint32_t n = 0, *row = calloc(scene->n_objects + 1U, sizeof *row);
    assert_non_null(row);
    for (uint32_t i = 0; i < scene->n_trees; i++) { /* the operands stay: what they make up is then of nothing */
        SceneObject *whole = &scene->objects[scene->trees[i].object];
        if (whole->medium == SCENE_NONE) whole->medium = 0;
    }
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        SceneObject object = scene->objects[i];
        if (object.medium == SCENE_NONE && object.part_of == SCENE_NONE) continue;
        if (object.part_of != SCENE_NONE) object.part_of = row[object.part_of];
        row[i] = n;
        scene->objects[n++] = object;
    }
    for (uint32_t i = 0; i < scene->n_trees; i++) scene->trees[i].object = row[scene->trees[i].object];
    for (uint32_t i = 0; i < scene->n_operands; i++) scene->operands[i] = row[scene->operands[i]];
    for (uint32_t i = 0; i < scene->n_frames; i++) scene->frames[i].object = row[scene->frames[i].object];
    scene->n_objects = n;
    free(row);
}

static void make_furnace(Scene *scene)
{
    scene->environment_hidden = false;
    take_away_opaque(scene);
    scene->n_lights = 0;
    for (uint32_t i = 0; i < scene->n_media; i++) {
        scene->media[i].emits = false;
        scene->media[i].temperature = NULL;
    }
    environment_free(scene->environment);
    scene->environment = NULL;
    const double white[3] = {1, 1, 1};
    Spectrum radiance = spectrum_from_light(white);
    Error error;
    if (environment_new_constant(&radiance, &scene->environment, &error) != STATUS_OK) fail_msg("%s", error.text);
    scene->world_to_environment = affine_identity();
}

static void stop_with_reports(Fixture *scene, const TruthInput *input)
{
    fixture_print(scene);
    fail_msg("%s: %s", input->file ? input->file : input->text, scene->error.text);
}

/* n_threads 0: one per processor */
static Pool *new_pool(unsigned n_threads)
{
    Pool *pool = NULL;
    Error error;
    if (pool_new(n_threads, &pool, &error) != STATUS_OK) fail_msg("%s", error.text);
    return pool;
}

static void build(Fixture *scene, TruthInput *input, Pool *pool)
{
    memset(scene, 0, sizeof *scene);
    arena_init(&scene->arena);
    scene->sources.arena = &scene->arena;
    diag_init(&scene->diag, &scene->arena, &scene->sources);
    size_t n_defines = 0;
    while (input->defines && input->defines[n_defines]) n_defines++;
    SceneOptions options = {
        .eval = {.frames = 1, .frame = 1, .defines = input->defines, .n_defines = n_defines, .library = &std_library},
        .load_image = load_sky,
        .load_image_context = input,
        .pool = pool};
    if (input->file)
        scene->status = scene_build(input->file, &options, &scene->diag, &scene->scene, NULL, &scene->error);
    else
        scene->status =
            scene_build_text("truth.mns", input->text, &options, &scene->diag, &scene->scene, NULL, &scene->error);
}

static void compile_built(Fixture *scene, const TruthInput *input, Pool *pool)
{
    /* what a camera is said to be in is so by the scene's own policy */
    for (uint32_t i = 0; i < scene->scene->n_cameras && input->policy != scene->scene->render.nesting; i++)
        scene->scene->cameras[i].expect = NULL;
    scene->status = compile_scene(scene->scene, input->policy, pool, &scene->diag, &scene->compiled, &scene->error);
    if (scene->status != STATUS_OK) stop_with_reports(scene, input);
    scene->status = compile_check_camera(scene->compiled, 0, &scene->diag, &scene->error);
    if (scene->status == STATUS_OK) scene->status = compiled_share_levels(scene->compiled, &scene->error);
    if (scene->status != STATUS_OK) stop_with_reports(scene, input);
}

void truth_open(Fixture *scene, TruthInput input)
{
    Pool *pool = new_pool(0);
    build(scene, &input, pool);
    if (scene->status != STATUS_OK) stop_with_reports(scene, &input);
    if (input.furnace) make_furnace(scene->scene);
    compile_built(scene, &input, pool);
    pool_free(pool);
}

void truth_compile_again(Fixture *scene, const TruthInput *input)
{
    Pool *pool = new_pool(0);
    compiled_scene_free(scene->compiled);
    scene->compiled = NULL;
    compile_built(scene, input, pool);
    pool_free(pool);
}

bool truth_is_library(const char *file)
{
    Fixture scene;
    TruthInput input = {.file = file};
    Pool *pool = new_pool(0);
    build(&scene, &input, pool);
    pool_free(pool);
    bool library = scene.status != STATUS_OK && fixture_find(&scene, D_NO_CAMERA);
    fixture_clear(&scene);
    return library;
}

RenderSettings truth_settings(uint32_t width, uint32_t samples)
{
    return (RenderSettings){.width = width, .height = width, .samples = samples, .bounces = 1000, .seed = 1};
}

void truth_render(const Fixture *scene, const RenderSettings *settings, unsigned threads, Picture *picture)
{
    Pool *pool = new_pool(threads);
    Error error;
    RenderSettings own = *settings;
    own.aovs |= (AovSet)1 << AOV_VARIANCE;
    Status status = render_image(scene->compiled, &own, pool, NULL, &picture->image, &picture->stats, &error);
    pool_free(pool);
    if (status != STATUS_OK) fail_msg("%s", error.text);
    assert_int_equal(picture->stats.samples, settings->samples);
    assert_int_equal(picture->stats.bad_samples, 0);
    assert_int_equal(picture->stats.saturated_samples, 0);
    assert_int_equal(picture->stats.silent_limit, 0);
}

void truth_clear(Picture *picture)
{
    image_clear(&picture->image);
}

static const float *pixel_at(const Picture *picture, uint32_t x, uint32_t y)
{
    return image_at(&picture->image, x, y);
}

double truth_channel(const Picture *picture, uint32_t x, uint32_t y, int channel)
{
    return (double)pixel_at(picture, x, y)[channel];
}

double truth_luminance(const Picture *picture, uint32_t x, uint32_t y)
{
    return (double)color_luminance(pixel_at(picture, x, y));
}

double truth_film_error(const Picture *picture, uint32_t x, uint32_t y)
{
    int channel = image_channel(&picture->image, "variance.Y");
    assert_true(channel >= 0);
    return sqrt(truth_channel(picture, x, y, channel) / picture->stats.samples);
}

double truth_largest_difference(const Picture *a, const Picture *b)
{
    assert_int_equal(a->image.width, b->image.width);
    assert_int_equal(a->image.height, b->image.height);
    double largest = 0;
    for (uint32_t y = 0; y < a->image.height; y++)
        for (uint32_t x = 0; x < a->image.width; x++)
            largest = fmax(largest, fabs(truth_luminance(a, x, y) - truth_luminance(b, x, y)));
    return largest;
}

double truth_difference_from_empty(const RenderSettings *settings, const Picture *picture)
{
    static const char *const text = "meniscus 1.0 unit mm camera { from = <0, 0, 9> }" TRUTH_WHITE_SKY;
    Fixture scene;
    Picture empty;
    truth_open(&scene, (TruthInput){.text = text, .furnace = true});
    truth_render(&scene, settings, 0, &empty);
    fixture_clear(&scene);
    double difference = truth_largest_difference(picture, &empty);
    truth_clear(&empty);
    return difference;
}

Estimate truth_estimate(const double *values, size_t n)
{
    double sum = 0, squares = 0;
    for (size_t i = 0; i < n; i++) sum += values[i];
    double mean = sum / (double)n;
    for (size_t i = 0; i < n; i++) squares += (values[i] - mean) * (values[i] - mean);
    return (Estimate){mean, n > 1 ? sqrt(squares / ((double)n - 1) / (double)n) : HUGE_VAL};
}

Estimate truth_mean(const Picture *picture, int channel)
{
    const Image *image = &picture->image;
    size_t n = (size_t)image->width * image->height;
    double *values = malloc(n * sizeof *values);
    assert_non_null(values);
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++)
            values[(size_t)y * image->width + x] =
                channel < 0 ? truth_luminance(picture, x, y) : truth_channel(picture, x, y, channel);
    Estimate estimate = truth_estimate(values, n);
    free(values);
    return estimate;
}

Estimate truth_total(const Picture *picture)
{
    double sum = 0, variance = 0;
    for (uint32_t y = 0; y < picture->image.height; y++)
        for (uint32_t x = 0; x < picture->image.width; x++) {
            double error = truth_film_error(picture, x, y);
            sum += truth_luminance(picture, x, y);
            variance += error * error;
        }
    return (Estimate){sum, sqrt(variance)};
}

void truth_figure(const char *what, double expected, double measured, double error)
{
    printf("  %-58s expected %-11.7g measured %-11.7g", what, expected, measured);
    if (error > 0)
        printf(" error %-9.3g sigmas %+.2f\n", error, (measured - expected) / error);
    else
        printf(" difference %+.3g\n", measured - expected);
    fflush(stdout);
}

void truth_check(const char *what, double expected, Estimate measured, double sigmas, double resolution)
{
    if (!(measured.error <= resolution * fabs(expected)))
        fail_msg("%s: a standard error of %g says too little about %g", what, measured.error, expected);
    if (!(fabs(measured.mean - expected) <= sigmas * measured.error + 1e-6 * fabs(expected)))
        fail_msg("%s: %.9g is %.2f standard errors from %.9g", what, measured.mean,
                 (measured.mean - expected) / measured.error, expected);
}

void truth_expect(const char *what, double expected, Estimate measured, double sigmas, double resolution)
{
    truth_figure(what, expected, measured.mean, measured.error);
    truth_check(what, expected, measured, sigmas, resolution);
}

void truth_alike(const char *what, Estimate expected, Estimate measured, double sigmas, double resolution)
{
    measured.error = hypot(measured.error, expected.error);
    truth_expect(what, expected.mean, measured, sigmas, resolution);
}

void truth_found_alike(const char *what, const char *text, uint32_t chance, double resolution)
{
    /* without photons: what is tested is that the lamp is found by looking */
    RenderSettings looking = truth_small(512);
    looking.caustics = CAUSTICS_OFF;
    Estimate sampled = truth_measure_as(text, NULL, &looking), by_chance = truth_measure(text, NULL, chance, true);
    truth_alike(what, by_chance, sampled, 4, resolution);
}

Estimate truth_ratio(Estimate a, Estimate b)
{
    double ratio = a.mean / b.mean;
    return (Estimate){ratio, fabs(ratio) * hypot(a.error / a.mean, b.error / b.mean)};
}

void truth_count(FaultCount *count, const RenderStats *stats)
{
    count->crossings += stats->crossings;
    count->silent += stats->silent_crossings;
    count->faults += stats->nesting_faults;
}

void truth_add(FaultCount *sum, const FaultCount *more)
{
    sum->crossings += more->crossings;
    sum->silent += more->silent;
    sum->faults += more->faults;
}

void truth_print_faults(const char *what, const FaultCount *count)
{
    printf("  %-58s %llu faults in %.3f million crossings (%.3f million silent): %.3g per million\n", what,
           (unsigned long long)count->faults, (double)count->crossings * 1e-6, (double)count->silent * 1e-6,
           count->crossings ? (double)count->faults / ((double)count->crossings * 1e-6) : 0);
    fflush(stdout);
}

double truth_fresnel(double cosine, double ior_from, double ior_to)
{
    double sine = ior_from / ior_to * sqrt(fmax(1 - cosine * cosine, 0));
    if (sine >= 1) return 1;
    double cosine_to = sqrt(1 - sine * sine);
    double s = (ior_from * cosine - ior_to * cosine_to) / (ior_from * cosine + ior_to * cosine_to);
    double p = (ior_to * cosine - ior_from * cosine_to) / (ior_to * cosine + ior_from * cosine_to);
    return (s * s + p * p) / 2;
}

double truth_pane(double cosine, double ior)
{
    double inside = sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    double s = (cosine - ior * inside) / (cosine + ior * inside), p = (ior * cosine - inside) / (ior * cosine + inside);
    return 0.5 * (1 - s * s) / (1 + s * s) + 0.5 * (1 - p * p) / (1 + p * p);
}

double truth_two_skies(double elevation)
{
    return elevation > 0.4 ? 3 : 0.2;
}

Picture truth_render_text(const char *text, uint32_t width, uint32_t samples)
{
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text, .sky = truth_two_skies});
    RenderSettings settings = truth_settings(width, samples);
    settings.bounces = 1000000;
    truth_render(&scene, &settings, 0, &picture);
    if (picture.stats.nesting_faults) fail_msg("%s: nesting faults", text);
    fixture_clear(&scene);
    return picture;
}

RenderSettings truth_small(uint32_t samples)
{
    enum { PICTURE = 16 };
    return truth_settings(PICTURE, samples);
}

Estimate truth_measure_as(const char *text, double (*sky)(double), const RenderSettings *settings)
{
    return truth_measure_input((TruthInput){.text = text, .sky = sky, .policy = NEST_AUTOMATIC}, settings);
}

Estimate truth_measure_input(TruthInput input, const RenderSettings *settings)
{
    Fixture scene;
    Picture picture;
    truth_open(&scene, input);
    truth_render(&scene, settings, 0, &picture);
    if (input.policy != NEST_NONE) assert_int_equal(picture.stats.nesting_faults, 0);
    Estimate mean = truth_mean(&picture, -1);
    truth_clear(&picture);
    fixture_clear(&scene);
    return mean;
}

double truth_white(const char *what, const char *text, uint32_t width, uint32_t samples, double tolerance)
{
    Picture picture = truth_render_text(text, width, samples);
    Estimate mean = truth_mean(&picture, -1);
    truth_figure(what, 1, mean.mean, mean.error);
    if (!(fabs(mean.mean - 1) <= tolerance + 3 * mean.error)) fail_msg("%s: %.5f +- %.5f", what, mean.mean, mean.error);
    assert_true(mean.error < 0.01);
    truth_clear(&picture);
    return mean.mean;
}

void truth_fill(char *text, size_t size, const char *pattern, const char *value)
{
    const char *hole = strstr(pattern, "%s");
    assert_non_null(hole);
    assert_in_range(snprintf(text, size, "%.*s%s%s", (int)(hole - pattern), pattern, value, hole + 2), 1, size - 1);
}

Estimate truth_measure(const char *text, double (*sky)(double), uint32_t samples, bool by_chance)
{
    RenderSettings settings = truth_small(samples);
    settings.by_chance = by_chance;
    return truth_measure_as(text, sky, &settings);
}
