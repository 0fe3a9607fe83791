/* render.c - passes over the whole frame, tile by tile.
 * The first passes have one sample per pixel, later ones more, so that a picture is there early and the
 * overhead is small late. With a noise to be reached, pixels stop by themselves (adapt.h). A tile belongs to one thread
 * during a pass, and a sample depends on nothing but its number.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/adapt.h"
#include "render/aov_film.h"
#include "render/early.h"
#include "render/film.h"
#include "render/spread.h"
#include "trace/guide.h"
#include "trace/path.h"

enum { TILE = 16, LARGEST_PASS = 16 };
/* Noise is not judged before this many samples per pixel: fewer say too little about themselves. */
enum { NOISE_FLOOR = 16 };
/* A picture that is shown begins with every fourth pixel each way. Later ones take this part of the time at most. */
enum { COARSEST = 4 };
static const double picture_interval_s = 1, picture_share = 0.05;
/* What is said of the noise on the way takes this part of the time at most. */
static const double noise_share = 0.02;

typedef struct Job {
    const RenderSettings *settings;
    const RenderEvents *events;
    const World *world;
    Tracer *tracers; /* one per thread */
    FirstSight *sights; /* one per thread, or NULL */
    unsigned n_threads;
    uint64_t *saturated;
    Film film;
    BrightFilm bright; /* without pixels: samples stay where they are */
    AovFilm aovs;
    uint32_t crop[4];
    uint32_t tiles_x, tiles_y;
    uint32_t n;             /* samples of this pass, for each pixel that it is about */
    uint32_t done;          /* samples that every pixel has by now, */
    uint64_t n_pixels, samples, pass_samples; /* of the crop; what they have together, and what the pass adds */
    const uint32_t *wanted; /* what each pixel of the crop is to have; NULL: n more, all of them */
    uint32_t step;          /* not 0: the first sample of every step-th pixel each way, where it has none */
    AdaptPlan plan;
    double planned_at_samples;        /* all pixels' together */
    double adapted_at, adapted_from;  /* seconds and samples when the first plan was made */
    double start, last_progress, noise, fraction;
    double picture_at, picture_cost; /* when the last one was shown, and how long that took */
    double noise_at, noise_cost;     /* the same of the noise */
    bool *tile_done;   /* of this pass */
} Job;

/* A person's wish ends the render at once; a time limit leaves at least one sample in every pixel. */
static bool asked_to_stop(const Job *job)
{
    if (job->events && job->events->stop && *job->events->stop) return true;
    double limit = job->settings->time_limit_s;
    return limit > 0 && job->done > 0 && clock_now_s() - job->start > limit;
}

/* How much is done, and how long the rest takes, of a render that ends after so many samples of each pixel. */
static void judge_uniform(const Job *job, double done, RenderProgress *progress)
{
    progress->fraction = done / ((double)job->settings->samples * (double)job->n_pixels);
    if (!(progress->fraction > 0) || progress->seconds <= 0.5) return;
    double left = progress->seconds * (1 - progress->fraction) / progress->fraction;
    double doubt = 0.05 + 0.25 * (1 - progress->fraction); /* early passes say less of the later ones */
    progress->seconds_left_low = left * (1 - doubt);
    progress->seconds_left_high = left * (1 + doubt);
}

/* The same of one that ends with the noise: known once the first plan is there. The pixels that are left take longer than
 * those that are done, so that only the time since then counts; how many samples are missing is known to a factor of
 * two: neighbours will find more to do. */
static void judge_adaptive(const Job *job, double done, RenderProgress *progress)
{
    if (!job->wanted) return;
    double left = (double)job->plan.left, since_plan = done - job->planned_at_samples, since = done - job->adapted_from;
    double all = job->planned_at_samples + left, seconds = progress->seconds - job->adapted_at;
    progress->fraction = all > 0 ? fmin(done / all, 1) : 1;
    if (!(since > 0) || seconds <= 0.5) return;
    double one = seconds / since, most = fmin(2 * left, (double)job->plan.at_most);
    progress->seconds_left_low = one * fmax(0.8 * left - since_plan, 0);
    progress->seconds_left_high = one * fmax(most - since_plan, 0);
}

static void report_progress(Job *job, double fraction_of_pass)
{
    if (!job->events || !job->events->progress) return;
    const RenderSettings *settings = job->settings;
    double now = clock_now_s(), limit = settings->time_limit_s;
    bool last = job->done == settings->samples;
    if (!last && now - job->last_progress < 0.1) return;
    job->last_progress = now;
    double done = (double)job->samples + (last ? 0 : fraction_of_pass * (double)job->pass_samples);
    RenderProgress progress = {.samples_done = (uint32_t)(done / (double)job->n_pixels), .samples_total = settings->samples,
                               .seconds = now - job->start, .photons = -1, .noise = job->noise, .noise_wanted = settings->noise,
                               .seconds_left_low = -1, .seconds_left_high = -1};
    (settings->noise > 0 && !last ? judge_adaptive : judge_uniform)(job, done, &progress);
    if (limit > 0) {
        double left = fmax(limit - progress.seconds, 0);
        progress.fraction = fmin(fmax(progress.fraction, progress.seconds / limit), 1);
        if (progress.seconds_left_low > left) progress.seconds_left_low = left;
        if (progress.seconds_left_high > left || progress.seconds_left_high < 0) progress.seconds_left_high = left;
        if (progress.seconds_left_low < 0) progress.seconds_left_low = 0;
    }
    progress.fraction = job->fraction = fmax(job->fraction, progress.fraction);
    /* The other threads' counters are in motion: they do about what the calling thread does. */
    progress.paths = job->tracers[0].counters.paths * job->n_threads;
    progress.rays = job->tracers[0].counters.rays * job->n_threads;
    job->events->progress(job->events->context, &progress);
}

/* Judges the noise so far, for progress, unless it was just done. */
static void judge_noise(Job *job)
{
    double now = clock_now_s();
    if (!job->events || !job->events->progress || now - job->noise_at < job->noise_cost / noise_share) return;
    job->noise = adapt_noise(&job->film, NULL, job->crop);
    job->noise_at = clock_now_s();
    job->noise_cost = job->noise_at - now;
}

static bool shows_picture(const Job *job)
{
    return job->events && job->events->picture;
}

/* Finds samples that stand alone, and where they go, or leaves it without pixels. */
static Status find_spread(const Job *job, Spread *spread, Error *error)
{
    *spread = (Spread){0};
    return job->bright.pixels ? spread_init(spread, &job->film, &job->bright, job->crop, error) : STATUS_OK;
}

/* Shows the picture so far, when it is time for it. It is not missed when memory ends. To spread samples takes too long for
 * all pictures but the last one. */
static void report_picture(Job *job, uint32_t step, bool due)
{
    Image image;
    Error unused;
    if (!shows_picture(job)) return;
    double now = clock_now_s(), interval = fmax(picture_interval_s, job->picture_cost / picture_share);
    if (!due && now - job->picture_at < interval) return;
    if (early_resolve(&job->film, job->crop, step, &image, &unused) != STATUS_OK) return;
    Spread spread = {0};
    if (due && job->done >= SPREAD_LEAST_SAMPLES && find_spread(job, &spread, &unused) == STATUS_OK && spread.pixels)
        spread_apply(&spread, &image);
    spread_clear(&spread);
    job->events->picture(job->events->context, &image);
    image_clear(&image);
    job->picture_at = clock_now_s();
    job->picture_cost = job->picture_at - now;
}

_Static_assert(BRIGHT_NOTHING == SCENE_NONE, "what is seen first");

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
    if (job->bright.pixels) bright_film_add(&job->bright, x, y, rgb, tracer->seen);
}

/* The samples that a pixel gets in this pass. */
static uint32_t pass_of_pixel(const Job *job, uint32_t x, uint32_t y)
{
    if (job->step)
        return (x - job->crop[0]) % job->step == 0 && (y - job->crop[1]) % job->step == 0 &&
               film_pixel(&job->film, x, y)->n == 0;
    if (!job->wanted) return job->n;
    uint32_t wanted = job->wanted[(size_t)(y - job->crop[1]) * (job->crop[2] - job->crop[0]) + (x - job->crop[0])];
    uint32_t left = wanted - film_pixel(&job->film, x, y)->n;
    return left < job->n ? left : job->n;
}

static void render_tile(void *context, uint32_t index, unsigned worker)
{
    Job *job = context;
    if (asked_to_stop(job)) return;
    uint32_t x0 = job->crop[0] + index % job->tiles_x * TILE, y0 = job->crop[1] + index / job->tiles_x * TILE;
    uint32_t x1 = x0 + TILE < job->crop[2] ? x0 + TILE : job->crop[2];
    uint32_t y1 = y0 + TILE < job->crop[3] ? y0 + TILE : job->crop[3];
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            uint32_t n = pass_of_pixel(job, x, y), first = job->settings->first_sample + film_pixel(&job->film, x, y)->n;
            for (uint32_t i = 0; i < n; i++) render_sample(job, worker, x, y, first + i);
        }
    job->tile_done[index] = true;
    if (worker == 0) report_progress(job, (double)index / (job->tiles_x * job->tiles_y));
}

static uint32_t pass_size(uint32_t done)
{
    uint32_t n = done < 4 ? 1 : done / 4;
    return n < LARGEST_PASS ? n : LARGEST_PASS;
}

/* One pass over all tiles, unless it is stopped. */
static Status run_pass(Job *job, Pool *pool, uint32_t n, bool *stopped, Error *error)
{
    uint32_t n_tiles = job->tiles_x * job->tiles_y;
    job->n = n;
    bool same = !job->wanted && !job->step;
    job->pass_samples = same ? job->n_pixels * n : 0;
    for (uint32_t y = job->crop[1]; !same && y < job->crop[3]; y++)
        for (uint32_t x = job->crop[0]; x < job->crop[2]; x++) job->pass_samples += pass_of_pixel(job, x, y);
    for (uint32_t i = 0; i < n_tiles; i++) job->tile_done[i] = false;
    pool_run(pool, n_tiles, render_tile, job);
    for (unsigned i = 0; i < job->n_threads; i++)
        if (job->tracers[i].out_of_memory) return fail(error, STATUS_NOMEM, "out of memory while rendering");
    for (uint32_t i = 0; i < n_tiles; i++)
        if (!job->tile_done[i]) *stopped = true;
    if (!*stopped) job->samples += job->pass_samples;
    return STATUS_OK;
}

/* First samples of every step-th pixel each way, and the picture of them. */
static Status run_coarse(Job *job, Pool *pool, uint32_t step, bool *stopped, Error *error)
{
    job->step = step;
    Status status = run_pass(job, pool, 1, stopped, error);
    job->step = 0;
    if (status == STATUS_OK && !*stopped && job->pass_samples) report_picture(job, step, true);
    return status;
}

/* Passes that are the same for all pixels. */
static Status run_uniform(Job *job, Pool *pool, uint32_t samples, bool *stopped, Error *error)
{
    for (uint32_t step = COARSEST; shows_picture(job) && step > 0 && !*stopped; step /= 2)
        TRY(run_coarse(job, pool, step, stopped, error));
    job->done = shows_picture(job) && !*stopped; /* one sample */
    while (job->done < samples && !*stopped) {
        uint32_t n = pass_size(job->done);
        if (n > samples - job->done) n = samples - job->done;
        TRY(run_pass(job, pool, n, stopped, error));
        if (*stopped) break;
        job->done += n;
        report_picture(job, 1, false);
        if (job->done >= NOISE_FLOOR) judge_noise(job);
        report_progress(job, 0);
        if (job->done < job->settings->samples && asked_to_stop(job)) *stopped = true;
    }
    return STATUS_OK;
}

/* Samples where the noise is too large, until it is nowhere so. A pass is no longer than elsewhere, so that a wish to stop is
 * heard; plans are made when all pixels have what they wanted. */
static Status run_adaptive(Job *job, Pool *pool, Adapt *adapt, bool *stopped, Error *error)
{
    job->adapted_at = clock_now_s() - job->start;
    job->adapted_from = (double)job->samples;
    job->wanted = adapt->wanted;
    while (!*stopped) {
        TRY(adapt_plan(adapt, &job->film, job->settings->noise, job->settings->samples, &job->plan, error));
        job->planned_at_samples = (double)job->samples;
        judge_noise(job);
        uint32_t left = job->plan.next;
        if (!left) break;
        while (left && !*stopped) {
            uint32_t n = left < LARGEST_PASS ? left : LARGEST_PASS;
            TRY(run_pass(job, pool, n, stopped, error));
            report_progress(job, 0);
            report_picture(job, 1, false);
            if (asked_to_stop(job)) *stopped = true;
            left -= n;
        }
    }
    return STATUS_OK;
}

/* Runs passes until all samples are there, the noise is low enough, or a stop is asked for. */
static Status run_passes(Job *job, Pool *pool, bool *stopped, Error *error)
{
    const RenderSettings *settings = job->settings;
    bool adapts = settings->noise > 0 && settings->samples > NOISE_FLOOR;
    TRY(run_uniform(job, pool, adapts ? NOISE_FLOOR : settings->samples, stopped, error));
    if (!adapts || *stopped) return STATUS_OK;
    Adapt adapt;
    TRY(adapt_init(&adapt, job->crop, error));
    Status status = run_adaptive(job, pool, &adapt, stopped, error);
    job->wanted = NULL;
    adapt_clear(&adapt);
    return status;
}

/* How many samples the pixels have. */
static void count_samples(const Job *job, RenderStats *stats)
{
    double sum = 0;
    stats->samples = UINT32_MAX;
    for (uint32_t y = job->crop[1]; y < job->crop[3]; y++)
        for (uint32_t x = job->crop[0]; x < job->crop[2]; x++) {
            uint32_t n = film_pixel(&job->film, x, y)->n;
            if (n < stats->samples) stats->samples = n;
            if (n > stats->most_samples) stats->most_samples = n;
            sum += n;
        }
    stats->mean_samples = sum / (double)job->n_pixels;
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
    job->n_pixels = (uint64_t)(job->crop[2] - job->crop[0]) * (job->crop[3] - job->crop[1]);
    job->noise = -1;
    job->tracers = calloc(job->n_threads, sizeof *job->tracers);
    job->saturated = calloc(job->n_threads, sizeof *job->saturated);
    job->tile_done = calloc((size_t)job->tiles_x * job->tiles_y, sizeof *job->tile_done);
    if (!job->tracers || !job->saturated || !job->tile_done)
        return fail_memory(error, job->n_threads * sizeof *job->tracers, "threads");
    for (unsigned i = 0; i < job->n_threads; i++) tracer_init(&job->tracers[i], job->world);
    TRY(film_init(&job->film, settings->width, settings->height, error));
    if (settings->spreads) TRY(bright_film_init(&job->bright, settings->width, settings->height, error));
    TRY(aov_film_init(&job->aovs, settings->aovs, job->world, settings->width, settings->height, error));
    if (!aov_film_needs_sight(&job->aovs)) return STATUS_OK;
    job->sights = calloc(job->n_threads, sizeof *job->sights);
    if (!job->sights) return fail_memory(error, job->n_threads * sizeof *job->sights, "threads");
    for (unsigned i = 0; i < job->n_threads; i++) job->tracers[i].first_sight = &job->sights[i];
    return STATUS_OK;
}

/* Samples that were taken without the guide are not those of the picture: they were only shown while photons were followed. */
static Status forget_samples(Job *job, Error *error)
{
    const RenderSettings *settings = job->settings;
    memset(job->film.pixels, 0, (size_t)settings->width * settings->height * sizeof *job->film.pixels);
    bright_film_forget(&job->bright);
    aov_film_clear(&job->aovs);
    TRY(aov_film_init(&job->aovs, settings->aovs, job->world, settings->width, settings->height, error));
    for (unsigned i = 0; i < job->n_threads; i++) {
        job->tracers[i].counters = (PathCounters){0};
        job->saturated[i] = 0;
    }
    job->samples = 0;
    return STATUS_OK;
}

static void job_clear(Job *job)
{
    for (unsigned i = 0; job->tracers && i < job->n_threads; i++) tracer_clear(&job->tracers[i]);
    free(job->tracers);
    free(job->saturated);
    free(job->tile_done);
    film_clear(&job->film);
    bright_film_clear(&job->bright);
    aov_film_clear(&job->aovs);
    free(job->sights);
}

/* While photons are followed, before there are any samples. */
static void report_photons(void *context, double fraction)
{
    Job *job = context;
    const RenderSettings *settings = job->settings;
    double now = clock_now_s();
    if (!job->events || !job->events->progress || now - job->last_progress < 0.1) return;
    job->last_progress = now;
    RenderProgress progress = {.samples_total = settings->samples,
                               .seconds = now - job->start,
                               .photons = fraction,
                               .noise = -1,
                               .noise_wanted = settings->noise,
                               .seconds_left_low = -1,
                               .seconds_left_high = -1};
    job->events->progress(job->events->context, &progress);
}

static Status make_guide(Job *job, Pool *pool, Guide **guide, GuideStats *stats, Error *error)
{
    const RenderSettings *settings = job->settings;
    /* where pixels stop by themselves, or by the clock, it is not known how many there will be */
    const uint32_t uncertain = 256;
    bool certain = !(settings->noise > 0) && !(settings->time_limit_s > 0);
    uint32_t samples = certain || settings->samples < uncertain ? settings->samples : uncertain;
    GuideSettings wish = {.width = settings->width,
                          .height = settings->height,
                          .paths = (uint64_t)settings->width * settings->height * samples,
                          .seed = settings->seed,
                          .time_limit_s = settings->time_limit_s,
                          .always = settings->caustics == CAUSTICS_ON,
                          .stop = job->events ? job->events->stop : NULL,
                          .progress = report_photons,
                          .context = job};
    double start = clock_cpu_s();
    Status status = guide_new(job->world, &wish, pool, guide, stats, error);
    stats->cpu_seconds = clock_cpu_s() - start;
    return status;
}

static Status make_picture(const Job *job, Image *image, RenderStats *stats, Error *error)
{
    Spread spread;
    TRY(find_spread(job, &spread, error));
    stats->spread_samples = spread.samples;
    stats->spread_light = spread.light;
    stats->noise = adapt_noise(&job->film, spread.pixels ? &spread : NULL, job->crop);
    Status status = aov_film_resolve(&job->aovs, &job->film, spread.pixels ? &spread : NULL, image, error);
    spread_clear(&spread);
    return status;
}

Status render_image(const CompiledScene *compiled, const RenderSettings *settings, Pool *pool, const RenderEvents *events,
                    Image *image, RenderStats *stats, Error *error)
{
    *stats = (RenderStats){0};
    *image = (Image){0};
    World world;
    TRY(world_init(&world, compiled, settings->camera, settings->bounces, settings->no_absorption, pool, error));
    world.trial = settings->trial;
    double cpu = clock_cpu_s();
    if (settings->by_chance) world_leave_to_chance(&world);
    if (settings->no_airlight) world.seeks_airlight = false;
    Job job = {.settings = settings, .events = events, .world = &world, .n_threads = pool_threads(pool), .start = clock_now_s()};
    Guide *guide = NULL;
    Status status = job_init(&job, error);
    if (status == STATUS_OK && settings->caustics != CAUSTICS_OFF) {
        if (shows_picture(&job)) status = run_coarse(&job, pool, COARSEST, &stats->stopped, error);
        if (status == STATUS_OK) status = make_guide(&job, pool, &guide, &stats->guide, error);
        world.guide = guide;
        if (status == STATUS_OK && guide && shows_picture(&job)) status = forget_samples(&job, error);
    }
    if (status == STATUS_OK) status = run_passes(&job, pool, &stats->stopped, error);
    if (status == STATUS_OK) {
        report_picture(&job, COARSEST, true);
        sum_counters(&job, stats);
        count_samples(&job, stats);
        stats->noisy_pixels = job.plan.unmet;
        stats->seconds = clock_now_s() - job.start;
        stats->cpu_seconds = clock_cpu_s() - cpu;
        status = make_picture(&job, image, stats, error);
    }
    job_clear(&job);
    world_clear(&world);
    guide_free(guide);
    return status;
}
