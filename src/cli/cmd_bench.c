/* cmd_bench.c - the command bench: how fast this machine renders one small scene, which stays the same.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/clock.h"
#include "cli/commands.h"
#include "render/render.h"
#include "scene/build.h"

/* A glass with a drink that reaches into its wall, two pieces of ice, bubbles, a table, a lamp and a sky. Figures of
 * different versions can be compared as long as not a letter of it is changed. */
static const char scene_text[] =
    "meniscus 1.0 unit mm\n"
    "medium glass { ior = 1.52  tint = rgb(.93, .97, .955)  depth = 80mm  state = solid }\n"
    "medium drink { ior = 1.36  tint = rgb(.96, .74, .17)  depth = 20mm  state = liquid }\n"
    "medium ice { ior = 1.31  state = solid }\n"
    "lathe tumbler { interior = glass  rounding = [0, 2, 2, 1.25, 1.25, 9, 0]  profile = [<0, 2>, <30, 0>, <37.5, 0>, "
    "<41, 88>, <38.4, 88>, <35.2, 12>, <0, 12>] }\n"
    "lathe filling { interior = drink  rounding = [0, 9.1, 0, 0]  "
    "profile = [<0, 11.9>, <35.3, 11.9>, <36.9, 50>, <0, 50>] }\n"
    "for (i in [-1, 1]) { box { interior = ice  size = <18, 18, 18>  bevel = 2.5  rotate(y, 20 + 45 * i)  "
    "rotate(z, 12 * i)  translate(<13 * i, 51, 3 * i>) } }\n"
    "for (i in 1..24) { let a = 360 * rnd(4, i, 0) let d = 24 * sqrt(rnd(4, i, 1)) sphere { interior = air  "
    "radius = .4 + rnd(4, i, 2)  center = <d * cos(a), 16 + 20 * rnd(4, i, 3), d * sin(a)> } }\n"
    "ground { y = -.5  surface = surface { albedo = rgb(.62, .55, .47) } }\n"
    "light { from = <-190, 330, 130>  to = <0, 40, 0>  size = <140, 140>  radiance = 12 }\n"
    "environment { color = rgb(.55, .65, .8) }\n"
    "camera { from = <0, 135, 330>  to = <0, 42, 0>  fov = 18 }\n"
    "render { bounces = 64 }\n";

/* One pass has a sample in each pixel; passes are repeated for about this long. Photons are not sent first: they would be
 * sent anew for each. */
#define MEASURED_SECONDS 2.0
enum { SIDE = 240, MOST_PASSES = 10000 };

typedef struct Speed {
    unsigned threads;
    double paths_per_s, rays_per_s;
} Speed;

static Status measure(const CompiledScene *compiled, unsigned threads, Speed *speed, Error *error)
{
    Pool *pool;
    TRY(pool_new(threads, &pool, error));
    speed->threads = pool_threads(pool);
    uint64_t paths = 0, rays = 0;
    double start = clock_now_s(), seconds = 0;
    Status status = STATUS_OK;
    for (uint32_t pass = 0; status == STATUS_OK && seconds < MEASURED_SECONDS && pass < MOST_PASSES; pass++) {
        RenderSettings settings = {.width = SIDE,
                                   .height = SIDE,
                                   .samples = 1,
                                   .seed = pass,
                                   .bounces = compiled->scene->render.bounces,
                                   .caustics = CAUSTICS_OFF};
        RenderStats stats;
        Image image;
        status = render_image(compiled, &settings, pool, NULL, &image, &stats, error);
        if (status == STATUS_OK) image_clear(&image);
        paths += stats.paths;
        rays += stats.rays;
        seconds = clock_now_s() - start;
    }
    speed->paths_per_s = (double)paths / seconds;
    speed->rays_per_s = (double)rays / seconds;
    pool_free(pool);
    return status;
}

static void print_text(const Speed *one, const Speed *all, Buf *out)
{
    const Speed *speeds[] = {one, all};
    for (int i = 0; i < (all->threads > 1 ? 2 : 1); i++) {
        const Speed *speed = speeds[i];
        buf_format(out, "%3u thread%s %10.3f million paths a second %8.3f million rays a second", speed->threads,
                   speed->threads == 1 ? " " : "s", speed->paths_per_s * 1e-6, speed->rays_per_s * 1e-6);
        if (i > 0) buf_format(out, " %8.2f x", speed->paths_per_s / one->paths_per_s);
        buf_add(out, "\n");
    }
}

static void print_json(const Speed *one, const Speed *all, Buf *out)
{
    const Speed *speeds[] = {one, all};
    JsonWriter json = json_writer(out, true);
    json_begin_object(&json);
    json_add_text(&json, "version", MEN_VERSION);
    json_add_text(&json, "rayTracer", rtc_library_version());
    json_key(&json, "speeds");
    json_begin_array(&json);
    for (int i = 0; i < (all->threads > 1 ? 2 : 1); i++) {
        json_begin_object(&json);
        json_add_whole(&json, "threads", speeds[i]->threads);
        json_add_number(&json, "pathsPerSecond", speeds[i]->paths_per_s);
        json_add_number(&json, "raysPerSecond", speeds[i]->rays_per_s);
        json_end(&json);
    }
    json_end(&json);
    json_end(&json);
    buf_add(out, "\n");
}

static Status measure_both(const Scene *scene, unsigned threads, Speed speeds[2], Error *error)
{
    CompiledScene *compiled;
    TRY(compile_scene(scene, scene->render.nesting, NULL, NULL, &compiled, error));
    Status status = measure(compiled, 1, &speeds[0], error);
    speeds[1] = speeds[0];
    if (status == STATUS_OK && threads != 1) status = measure(compiled, threads, &speeds[1], error);
    compiled_scene_free(compiled);
    return status;
}

Status cmd_bench(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    Arena arena;
    SourceSet sources = {.arena = &arena};
    Diag diag;
    Scene *scene = NULL;
    Speed speeds[2];
    SceneOptions scene_options = {.eval = {.schema = scene_schema()}};
    arena_init(&arena);
    diag_init(&diag, &arena, &sources);
    Status status = scene_build_text("bench", scene_text, &scene_options, &diag, &scene, NULL, error);
    if (status == STATUS_OK) status = measure_both(scene, options->values[OPTION_THREADS].whole[0], speeds, error);
    if (status == STATUS_OK) {
        Buf out = {0};
        (option_given(options, OPTION_JSON) ? print_json : print_text)(&speeds[0], &speeds[1], &out);
        status = print_out(&out, error);
        buf_clear(&out);
    }
    scene_free(scene);
    arena_clear(&arena);
    return status;
}
