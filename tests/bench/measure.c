/* measure.c - figures, scenes and renders for the benchmarks.
 * SPDX-License-Identifier: Apache-2.0 */
#include "measure.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

void bench_fail(const char *what, const Error *error)
{
    fprintf(stderr, "bench: %s: %s\n", what, error ? error->text : "failed");
    exit(1);
}

static int compare_double(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

Quartiles spread_of(double *values, int n)
{
    qsort(values, (size_t)n, sizeof *values, compare_double);
    int quarter = n < 5 ? 0 : n / 4;
    return (Quartiles){values[n / 2], values[quarter], values[n - 1 - quarter]};
}

void print_figure(const char *what, double *values, int n, const char *unit)
{
    Quartiles spread = spread_of(values, n);
    printf("%-58s %8.3f %-6s (%.3f .. %.3f)\n", what, spread.median, unit, spread.low, spread.high);
}

static Status load_image(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                         uint32_t *height, Error *error)
{
    (void)context;
    (void)space;
    Image image;
    int channels[3];
    TRY(image_read(path, &image, error));
    size_t n = (size_t)image.width * image.height;
    *width = image.width;
    *height = image.height;
    *rgb = malloc(n * 3 * sizeof **rgb);
    bool colored = image_rgb(&image, channels);
    for (size_t i = 0; colored && *rgb && i < 3 * n; i++)
        (*rgb)[i] = image.pixels[i / 3 * image.n_channels + (size_t)channels[i % 3]];
    image_clear(&image);
    if (!*rgb) return fail_memory(error, n * 3 * sizeof **rgb, "an image");
    return colored ? STATUS_OK : fail(error, STATUS_INPUT, "'%s' has no colour", path);
}

static void check_made(Made *made, const char *path, Status status, const Error *error)
{
    if (status == STATUS_OK) return;
    Buf out = {0};
    diag_print(&made->diag, &out, false);
    if (out.text) fputs(out.text, stderr);
    bench_fail(path, error);
}

/* text: NULL for what is in the file. eval: NULL for a scene as it is. */
static Status build(Made *made, const char *path, const char *text, const EvalOptions *eval, Pool *pool, Error *error)
{
    *made = (Made){0};
    arena_init(&made->arena);
    made->sources.arena = &made->arena;
    diag_init(&made->diag, &made->arena, &made->sources);
    SceneOptions options = {.load_image = load_image, .pool = pool};
    if (eval) options.eval = *eval;
    double start = clock_cpu_s();
    Status status = text ? scene_build_text(path, text, &options, &made->diag, &made->scene, NULL, error)
                         : scene_build(path, &options, &made->diag, &made->scene, NULL, error);
    made->build_s = clock_cpu_s() - start;
    return status;
}

void made_begin(Made *made, const char *path, const char *text, Pool *pool)
{
    Error error = {0};
    check_made(made, path, build(made, path, text, NULL, pool, &error), &error);
}

void made_compile(Made *made, const char *path, Pool *pool)
{
    Error error = {0};
    double start = clock_cpu_s();
    Status status = compile_scene(made->scene, made->scene->render.nesting, pool, NULL, &made->compiled, &error);
    if (status == STATUS_OK) status = compiled_share_levels(made->compiled, &error);
    made->compile_s = clock_cpu_s() - start;
    check_made(made, path, status, &error);
}

void made_with_pool(Made *made, const char *text, Pool *pool)
{
    made_begin(made, "bench", text, pool);
    made_compile(made, "bench", pool);
}
void made_from_text(Made *made, const char *text)
{
    made_with_pool(made, text, NULL);
}
void made_with_params(Made *made, const char *path, const char *const *defines, size_t n)
{
    Error error = {0};
    EvalOptions eval = {.defines = defines, .n_defines = n};
    check_made(made, path, build(made, path, NULL, &eval, NULL, &error), &error);
    made_compile(made, path, NULL);
}
void made_from_file(Made *made, const char *path)
{
    made_with_params(made, path, NULL, 0);
}

/* Whether all that is wrong with what was built is that it places nothing, or nothing that looks at it. */
static bool is_only_part(const Made *made)
{
    for (const Diagnostic *report = made->diag.first; report; report = report->next)
        if (report->severity == DIAG_ERROR && report->code != D_NO_CAMERA && report->code != D_NOTHING_TO_RENDER)
            return false;
    return made->diag.n_errors > 0;
}

bool made_from_whole_file(Made *made, const char *path)
{
    Error error = {0};
    Status status = build(made, path, NULL, NULL, NULL, &error);
    if (status == STATUS_SCENE && is_only_part(made)) {
        arena_clear(&made->arena);
        return false;
    }
    check_made(made, path, status, &error);
    made_compile(made, path, NULL);
    return true;
}

void made_clear(Made *made)
{
    compiled_scene_free(made->compiled);
    scene_free(made->scene);
    arena_clear(&made->arena);
}

Pool *pool_of(unsigned threads)
{
    Error error = {0};
    Pool *pool;
    if (pool_new(threads, &pool, &error) != STATUS_OK) bench_fail("threads", &error);
    return pool;
}

RenderStats render_image_at(const CompiledScene *compiled, uint32_t width, uint32_t height, uint32_t samples,
                            uint32_t seed, Pool *pool, Image *image)
{
    Error error = {0};
    RenderStats stats;
    RenderSettings settings = {.width = width,
                               .height = height,
                               .samples = samples,
                               .seed = seed,
                               .bounces = compiled->scene->render.bounces,
                               .caustics = CAUSTICS_OFF};
    if (render_image(compiled, &settings, pool, NULL, image, &stats, &error) != STATUS_OK) bench_fail("render", &error);
    return stats;
}

RenderStats render_at(const CompiledScene *compiled, uint32_t width, uint32_t height, uint32_t samples, Pool *pool)
{
    Image image;
    RenderStats stats = render_image_at(compiled, width, height, samples, 0, pool, &image);
    image_clear(&image);
    return stats;
}
