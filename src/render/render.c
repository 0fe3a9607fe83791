/* render.c - passes over the whole frame, tile by tile.
 * The first passes have one sample per pixel, later ones more, so that a picture is there early and the
 * overhead is small late. A tile belongs to one thread during a pass, and a sample depends on nothing but its number.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/render.h"

#include <stdlib.h>

#include "base/clock.h"
#include "render/aov_film.h"
#include "render/film.h"
#include "trace/path.h"

enum { TILE = 16, LARGEST_PASS = 16 };
/* Noise is not judged before this many samples per pixel: fewer say too little about themselves. */
enum { NOISE_FLOOR = 16 };

typedef struct Job {
    const RenderSettings *settings;
    const RenderEvents *events;
    const World *world;
    Tracer *tracers; /* one per thread */
    FirstSight *sights; /* one per thread, or NULL */
    unsigned n_threads;
    uint64_t *saturated;
    Film film;
    AovFilm aovs;
    uint32_t crop[4];
    uint32_t tiles_x, tiles_y;
    uint32_t first, n; /* samples of this pass */
    uint32_t done;     /* samples of the passes before */
    double start, last_progress, noise;
    bool *tile_done;   /* of this pass */
} Job;

/* A person's wish ends the render at once; a time limit leaves at least one sample in every pixel. */
static bool asked_to_stop(const Job *job)
{
    if (job->events && job->events->stop && *job->events->stop) return true;
    double limit = job->settings->time_limit_s;
    return limit > 0 && job->done > 0 && clock_now_s() - job->start > limit;
}

static void report_progress(Job *job, double fraction_of_pass)
{
    if (!job->events || !job->events->progress) return;
    double now = clock_now_s();
    bool last = job->done == job->settings->samples;
    if (!last && now - job->last_progress < 0.1) return;
    job->last_progress = now;
    RenderProgress progress = {.samples_done = job->done, .samples_total = job->settings->samples, .seconds = now - job->start,
                               .noise = job->noise, .seconds_left_low = -1, .seconds_left_high = -1};
    double total = job->settings->samples ? job->settings->samples : 1;
    progress.fraction = (job->done + (last ? 0 : fraction_of_pass * job->n)) / total;
    if (progress.fraction > 0 && progress.seconds > 0.5) {
        double left = progress.seconds * (1 - progress.fraction) / progress.fraction;
        double doubt = 0.05 + 0.25 * (1 - progress.fraction); /* early passes say less of the later ones */
        progress.seconds_left_low = left * (1 - doubt);
        progress.seconds_left_high = left * (1 + doubt);
    }
    /* The other threads' counters are in motion: they do about what the calling thread does. */
    progress.paths = job->tracers[0].counters.paths * job->n_threads;
    progress.rays = job->tracers[0].counters.rays * job->n_threads;
    job->events->progress(job->events->context, &progress);
}

static void render_sample(Job *job, unsigned worker, uint32_t x, uint32_t y, uint32_t index)
{
    Tracer *tracer = &job->tracers[worker];
    const RenderSettings *settings = job->settings;
    PathCounters before = {0};
    float rgb[3], alpha;
    if (tracer->first_sight) before = tracer->counters;
    trace_sample(tracer, x, y, settings->width, settings->height, settings->seed, index, rgb, &alpha);
    if (tracer->first_sight) aov_film_add(&job->aovs, x, y, tracer->first_sight, &before, &tracer->counters);
    job->saturated[worker] += film_add(&job->film, x, y, rgb, alpha);
}

static void render_tile(void *context, uint32_t index, unsigned worker)
{
    Job *job = context;
    if (asked_to_stop(job)) return;
    uint32_t x0 = job->crop[0] + index % job->tiles_x * TILE, y0 = job->crop[1] + index / job->tiles_x * TILE;
    uint32_t x1 = x0 + TILE < job->crop[2] ? x0 + TILE : job->crop[2];
    uint32_t y1 = y0 + TILE < job->crop[3] ? y0 + TILE : job->crop[3];
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++)
            for (uint32_t s = 0; s < job->n; s++) render_sample(job, worker, x, y, job->first + s);
    job->tile_done[index] = true;
    if (worker == 0) report_progress(job, (double)index / (job->tiles_x * job->tiles_y));
}

static uint32_t pass_size(uint32_t done)
{
    uint32_t n = done < 4 ? 1 : done / 4;
    return n < LARGEST_PASS ? n : LARGEST_PASS;
}

/* Runs passes until all samples are there, the noise is low enough, or a stop is asked for. */
static Status run_passes(Job *job, Pool *pool, bool *stopped, Error *error)
{
    const RenderSettings *settings = job->settings;
    uint32_t n_tiles = job->tiles_x * job->tiles_y;
    *stopped = false;
    while (job->done < settings->samples && !*stopped) {
        job->n = pass_size(job->done);
        if (job->n > settings->samples - job->done) job->n = settings->samples - job->done;
        job->first = settings->first_sample + job->done;
        for (uint32_t i = 0; i < n_tiles; i++) job->tile_done[i] = false;
        pool_run(pool, n_tiles, render_tile, job);
        for (unsigned i = 0; i < job->n_threads; i++)
            if (job->tracers[i].out_of_memory) return fail(error, STATUS_NOMEM, "out of memory while rendering");
        for (uint32_t i = 0; i < n_tiles; i++)
            if (!job->tile_done[i]) *stopped = true;
        if (*stopped) break;
        job->done += job->n;
        if (settings->noise > 0 || job->done >= NOISE_FLOOR) job->noise = film_noise(&job->film, job->crop);
        report_progress(job, 0);
        if (settings->noise > 0 && job->done >= NOISE_FLOOR && job->noise <= settings->noise) break;
        if (job->done < settings->samples && asked_to_stop(job)) *stopped = true;
    }
    return STATUS_OK;
}

static void sum_counters(const Job *job, RenderStats *stats)
{
    for (unsigned i = 0; i < job->n_threads; i++) {
        const PathCounters *c = &job->tracers[i].counters;
        stats->paths += c->paths;
        stats->rays += c->rays;
        stats->crossings += c->crossings;
        stats->silent_crossings += c->silent_crossings;
        stats->nesting_faults += c->nesting_faults;
        stats->silent_limit += c->silent_limit;
        stats->bad_samples += c->bad_samples;
        stats->saturated_samples += job->saturated[i];
    }
}

static Status job_init(Job *job, Error *error)
{
    const RenderSettings *settings = job->settings;
    bool cropped = settings->crop[0] || settings->crop[1] || settings->crop[2] || settings->crop[3];
    uint32_t frame[4] = {0, 0, settings->width, settings->height};
    for (int i = 0; i < 4; i++) job->crop[i] = cropped ? settings->crop[i] : frame[i];
    if (job->crop[0] >= job->crop[2] || job->crop[1] >= job->crop[3] || job->crop[2] > settings->width ||
        job->crop[3] > settings->height)
        return fail(error, STATUS_USAGE, "the crop %u,%u,%u,%u is not inside the picture of %u x %u", job->crop[0],
                    job->crop[1], job->crop[2], job->crop[3], settings->width, settings->height);
    job->tiles_x = (job->crop[2] - job->crop[0] + TILE - 1) / TILE;
    job->tiles_y = (job->crop[3] - job->crop[1] + TILE - 1) / TILE;
    job->noise = -1;
    job->tracers = calloc(job->n_threads, sizeof *job->tracers);
    job->saturated = calloc(job->n_threads, sizeof *job->saturated);
    job->tile_done = calloc((size_t)job->tiles_x * job->tiles_y, sizeof *job->tile_done);
    if (!job->tracers || !job->saturated || !job->tile_done)
        return fail_memory(error, job->n_threads * sizeof *job->tracers, "threads");
    for (unsigned i = 0; i < job->n_threads; i++) tracer_init(&job->tracers[i], job->world);
    TRY(film_init(&job->film, settings->width, settings->height, error));
    TRY(aov_film_init(&job->aovs, settings->aovs, job->world, settings->width, settings->height, error));
    if (!aov_film_needs_sight(&job->aovs)) return STATUS_OK;
    job->sights = calloc(job->n_threads, sizeof *job->sights);
    if (!job->sights) return fail_memory(error, job->n_threads * sizeof *job->sights, "threads");
    for (unsigned i = 0; i < job->n_threads; i++) job->tracers[i].first_sight = &job->sights[i];
    return STATUS_OK;
}

static void job_clear(Job *job)
{
    for (unsigned i = 0; job->tracers && i < job->n_threads; i++) tracer_clear(&job->tracers[i]);
    free(job->tracers);
    free(job->saturated);
    free(job->tile_done);
    film_clear(&job->film);
    aov_film_clear(&job->aovs);
    free(job->sights);
}

Status render_image(const CompiledScene *compiled, const RenderSettings *settings, Pool *pool, const RenderEvents *events,
                    Image *image, RenderStats *stats, Error *error)
{
    *stats = (RenderStats){0};
    *image = (Image){0};
    World world;
    TRY(world_init(&world, compiled, settings->camera, settings->bounces, settings->no_absorption, error));
    if (settings->by_chance) world_leave_to_chance(&world);
    world.white_noise = settings->white_noise;
    double cpu = clock_cpu_s();
    Job job = {.settings = settings, .events = events, .world = &world, .n_threads = pool_threads(pool), .start = clock_now_s()};
    Status status = job_init(&job, error);
    if (status == STATUS_OK) status = run_passes(&job, pool, &stats->stopped, error);
    if (status == STATUS_OK) {
        sum_counters(&job, stats);
        stats->samples = job.done;
        stats->seconds = clock_now_s() - job.start;
        stats->cpu_seconds = clock_cpu_s() - cpu;
        status = aov_film_resolve(&job.aovs, &job.film, image, error);
    }
    job_clear(&job);
    world_clear(&world);
    return status;
}
