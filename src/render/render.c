/* render.c - passes over the whole frame, tile by tile.
 * The first passes have one sample per pixel, later ones more, so that a picture is there early and the
 * overhead is small late. With a noise to be reached, pixels stop by themselves, and they may have shares of a number of
 * samples for all (adapt.h). A tile belongs to one thread during a pass, and a sample depends on nothing but its number.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/render.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "render/adapt.h"
#include "render/aov_film.h"
#include "render/caught.h"
#include "render/denoise.h"
#include "render/early.h"
#include "render/film.h"
#include "render/glance.h"
#include "render/light_layers.h"
#include "render/spread.h"
#include "trace/catcher.h"
#include "trace/guide.h"
#include "trace/path.h"

enum { TILE = 8, LARGEST_PASS = 16 };
/* Noise is not judged before this many samples per pixel: fewer say too little about themselves. */
enum { NOISE_FLOOR = 16 };
/* Shares of samples are first given out after this part of them, between these bounds; with fewer than the lower one each pixel
 * gets as many. */
enum { EVEN_PART = 4, EVEN_LEAST = SPREAD_LEAST_SAMPLES, EVEN_MOST = 16 };
/* A picture that is shown begins with every fourth pixel each way. Later ones take this part of the time at most. */
enum { COARSEST = 4 };
static const double picture_interval_s = 1, picture_share = 0.05;
/* What is said of the noise on the way takes this part of the time at most. */
static const double noise_share = 0.02;
static const double save_share = 0.01;
/* Of a time limit, what is left for a picture when photons would take all of it. */
static const double show_share = 0.2;
/* After this part of a time limit it is tried how long it takes to finish the picture. Samples that are still to come may make it take
 * so much longer; and this part of the limit at most is kept for it. */
static const double finish_tried_after = 0.25, finish_longer = 1.25, finish_share = 0.4;

typedef struct Job {
    const RenderSettings *settings;
    const RenderEvents *events;
    const World *world;
    Pool *pool;
    Tracer *tracers; /* one per thread */
    unsigned n_threads;
    uint64_t *saturated; /* samples, by each thread */
    RenderState *state;
    RenderState before; /* its counters before this render */
    uint32_t tiles_x, tiles_y;
    uint32_t wish;                            /* how many samples each pixel is to have in the end, */
    uint32_t n;                               /* how many this pass gives to each, or those that pixels have not yet, */
    uint32_t done;                            /* and how many every pixel has by now */
    uint32_t most;                            /* that a pixel had before this render */
    bool even;                                /* all pixels have as many as every one */
    uint64_t n_pixels, samples, pass_samples; /* of the film; what they have together, and what the pass adds */
    const uint32_t *wanted;                   /* what each pixel is to have; NULL: done + n, all of them */
    uint32_t step;    /* not 0: the first sample of every step-th pixel each way, where it has none */
    bool has_lattice; /* such a pass is done, and its samples stay */
    AdaptPlan plan;
    double planned_at_samples;       /* all pixels' together */
    double adapted_at, adapted_from; /* seconds and samples when the first plan was made */
    double start, last_progress, noise, fraction;
    double sampling_at;              /* when photons were done */
    double finish_s;                 /* kept of a time limit to finish the picture; 0: not yet known; */
    bool finish_spreads;             /* and when that was tried, samples were spread */
    double picture_at, picture_cost; /* when the last one was shown, and how long that took */
    double noise_at, noise_cost;     /* the same of the noise */
    bool *tile_done;                 /* of this pass, */
    atomic_uint n_tiles_done;        /* and how many are */
    atomic_bool pause;               /* the pass waits until the state is saved */
    double saved_at, save_cost;
    uint64_t first_samples; /* that were there before this render */
    bool for_show;          /* these samples are not led by the guide and will be forgotten: no state to be saved */
} Job;

static bool is_stopped(const Job *job)
{
    return job->events && job->events->stop && *job->events->stop;
}

/* A person's wish ends the render at once; a time limit leaves what a whole picture can be made of. */
static bool asked_to_stop(const Job *job)
{
    if (is_stopped(job)) return true;
    double limit = job->settings->time_limit_s;
    return limit > 0 && (job->done > 0 || job->has_lattice) && clock_now_s() - job->start > limit - job->finish_s;
}

static bool asked_to_save(const Job *job)
{
    return job->events && job->events->save && job->events->wish && *job->events->wish && !job->for_show;
}

/* So that saving takes a small part of the time. */
static bool save_is_due(const Job *job)
{
    if (asked_to_save(job)) return true;
    if (job->for_show || !job->events || !job->events->save || !(job->events->save_interval_s > 0)) return false;
    return clock_now_s() - job->saved_at > fmax(job->events->save_interval_s, job->save_cost / save_share);
}

/* How much is done, and how long the rest takes, of a render that ends after so many samples of each pixel. */
static void judge_uniform(const Job *job, double done, RenderProgress *progress)
{
    double all = job->wish * (double)job->n_pixels, here = done - (double)job->first_samples;
    progress->fraction = done / all;
    const double seconds = progress->seconds - (job->sampling_at - job->start);
    if (!(here > 0) || seconds <= 0.5) return;
    double left = seconds * (all - done) / here;
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
    bool last = job->done >= job->wish;
    if (!last && now - job->last_progress < 0.1) return;
    job->last_progress = now;
    double done = (double)job->samples + (last ? 0 : fraction_of_pass * (double)job->pass_samples);
    RenderProgress progress = {.samples_done = (uint32_t)(done / (double)job->n_pixels),
                               .samples_total = job->wish,
                               .seconds = now - job->start,
                               .photons = -1,
                               .noise = job->noise,
                               .noise_wanted = settings->noise,
                               .seconds_left_low = -1,
                               .seconds_left_high = -1};
    (settings->noise > 0 && !last ? judge_adaptive : judge_uniform)(job, done, &progress);
    if (limit > 0) {
        double left = fmax(limit - job->finish_s - progress.seconds, 0);
        progress.fraction = fmin(fmax(progress.fraction, progress.seconds / (limit - job->finish_s)), 1);
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
    job->noise = adapt_noise(&job->state->film, NULL, job->settings->exposure, job->pool);
    job->noise_at = clock_now_s();
    job->noise_cost = job->noise_at - now;
}

static bool shows_picture(const Job *job)
{
    return job->events && job->events->picture;
}

/* Shows the picture so far: of every step-th pixel each way, or with what is between filled in. To spread samples and to denoise
 * takes too long for all pictures but the last one. It is not missed when memory ends. */
static void show_picture(Job *job, uint32_t step)
{
    Image image;
    Error unused;
    if (!shows_picture(job)) return;
    double now = clock_now_s();
    if (early_resolve(&job->state->film, step, &image, &unused) != STATUS_OK) return;
    job->events->picture(job->events->context, &image);
    image_clear(&image);
    job->picture_at = clock_now_s();
    job->picture_cost = job->picture_at - now;
}

/* Shows what the render came to. It is not missed when memory ends. */
static void show_last_picture(Job *job, const Image *image)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    Image shown;
    Error unused;
    if (!shows_picture(job) || image_new(image->width, image->height, names, 4, &shown, &unused) != STATUS_OK) return;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++)
        memcpy(shown.pixels + 4 * i, image->pixels + i * image->n_channels, 4 * sizeof(float));
    job->events->picture(job->events->context, &shown);
    image_clear(&shown);
}

/* When it is time for it. */
static void report_picture(Job *job)
{
    if (clock_now_s() - job->picture_at >= fmax(picture_interval_s, job->picture_cost / picture_share))
        show_picture(job, 1);
}

_Static_assert(BRIGHT_NOTHING == SCENE_NONE, "what is seen first");

/* Adds what a sample caught. rgb becomes what is beyond the light that is there in any case: only that may be a single bright
 * sample, which would be taken out of both else, and is spread in one of them. */
static void add_caught(Job *job, const CaughtSample *caught, uint32_t x, uint32_t y, float rgb[3])
{
    if (!(caught->part > 0)) return;
    film_add_caught(&job->state->film, x, y, caught->lit, caught->bare, caught->part);
    for (int i = 0; i < 3; i++) rgb[i] -= fminf(caught->bare[i], caught->lit[i]);
}

/* Returns whether it was brighter than the film can hold. */
static bool render_sample(Job *job, unsigned worker, uint32_t x, uint32_t y, uint32_t index)
{
    Tracer *tracer = &job->tracers[worker];
    const RenderSettings *settings = job->settings;
    PathCounters before = {0};
    float rgb[3], alpha;
    uint64_t rays = tracer->counters.rays;
    if (tracer->notes_sight) before = tracer->counters;
    tracer->notes_behind = aov_film_needs_behind(&job->state->aovs, index);
    const ImagePlace *place = &job->state->place;
    const FilmSample sample = {place->x + x, place->y + y, settings->width, settings->height, settings->seed, index};
    trace_sample(tracer, &sample, rgb, &alpha);
    if (tracer->notes_sight) aov_film_add(&job->state->aovs, x, y, tracer, &before);
    bool saturated = film_add(&job->state->film, x, y, rgb, alpha);
    film_add_rays(&job->state->film, x, y, tracer->counters.rays - rays);
    if (UNLIKELY(job->state->film.caught != NULL)) add_caught(job, &tracer->caught, x, y, rgb);
    if (job->state->bright.pixels) bright_film_add(&job->state->bright, x, y, rgb, tracer->seen, &tracer->reflected);
    return saturated;
}

/* The samples that a pixel gets in this pass. */
static uint32_t pass_of_pixel(const Job *job, uint32_t x, uint32_t y)
{
    const Film *film = &job->state->film;
    uint32_t n = film_pixel(film, x, y)->n;
    if (job->step) return x % job->step == 0 && y % job->step == 0 && n == 0;
    uint32_t wanted = job->wanted ? job->wanted[(size_t)y * film->width + x] : job->done + job->n;
    uint32_t left = wanted > n ? wanted - n : 0;
    return left < job->n || !job->wanted ? left : job->n;
}

static void render_tile(void *context, uint32_t index, unsigned worker)
{
    Job *job = context;
    const Film *film = &job->state->film;
    if (worker == 0 && save_is_due(job)) atomic_store(&job->pause, true);
    if (asked_to_stop(job)) return;
    uint32_t x0 = index % job->tiles_x * TILE, y0 = index / job->tiles_x * TILE;
    uint32_t x1 = x0 + TILE < film->width ? x0 + TILE : film->width,
             y1 = y0 + TILE < film->height ? y0 + TILE : film->height;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            if (is_stopped(job) || atomic_load_explicit(&job->pause, memory_order_relaxed)) return;
            uint32_t n = pass_of_pixel(job, x, y), first = film->first_sample + film_pixel(film, x, y)->n;
            uint32_t saturated = 0;
            for (uint32_t i = 0; i < n; i++) saturated += render_sample(job, worker, x, y, first + i);
            if (UNLIKELY(saturated)) job->saturated[worker] += saturated;
        }
    job->tile_done[index] = true;
    unsigned n_done = 1 + atomic_fetch_add_explicit(&job->n_tiles_done, 1, memory_order_relaxed);
    if (worker == 0) report_progress(job, (double)n_done / (job->tiles_x * job->tiles_y));
}

static uint32_t pass_size(uint32_t done)
{
    uint32_t n = done < 4 ? 1 : done / 4;
    return n < LARGEST_PASS ? n : LARGEST_PASS;
}

/* What this render counted, and those before it. */
static void sum_counters(const Job *job, RenderState *state)
{
    state->counters = job->before.counters;
    state->saturated_samples = job->before.saturated_samples;
    for (unsigned i = 0; i < job->n_threads; i++) {
        path_counters_add(&state->counters, &job->tracers[i].counters);
        state->saturated_samples += job->saturated[i];
    }
}

static void save(Job *job)
{
    double now = clock_now_s();
    bool asked = asked_to_save(job);
    if (asked) *job->events->wish = 0;
    sum_counters(job, job->state);
    job->events->save(job->events->context, job->state, asked);
    job->saved_at = clock_now_s();
    job->save_cost = job->saved_at - now;
}

/* Goes over all tiles; what is left of them when the state was saved in between, again. */
static void run_tiles(Job *job)
{
    uint32_t n_tiles = job->tiles_x * job->tiles_y;
    bool again = true;
    while (again) {
        for (uint32_t i = 0; i < n_tiles; i++) job->tile_done[i] = false;
        atomic_store(&job->n_tiles_done, 0);
        pool_run(job->pool, n_tiles, render_tile, job);
        again = atomic_exchange(&job->pause, false) && !asked_to_stop(job);
        if (save_is_due(job) && !is_stopped(job)) save(job);
    }
}

/* One pass over all tiles, unless it is stopped. */
static Status run_pass(Job *job, uint32_t n, bool *stopped, Error *error)
{
    const Film *film = &job->state->film;
    uint32_t n_tiles = job->tiles_x * job->tiles_y;
    job->n = n;
    bool same = !job->wanted && !job->step && job->even;
    job->pass_samples = same ? job->n_pixels * n : 0;
    for (uint32_t y = 0; !same && y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++) job->pass_samples += pass_of_pixel(job, x, y);
    run_tiles(job);
    for (unsigned i = 0; i < job->n_threads; i++)
        if (job->tracers[i].out_of_memory) return fail(error, STATUS_NOMEM, "out of memory while rendering");
    for (uint32_t i = 0; i < n_tiles; i++)
        if (!job->tile_done[i]) *stopped = true;
    if (!*stopped) job->samples += job->pass_samples;
    return STATUS_OK;
}

/* First samples of every step-th pixel each way, and the picture of them. */
static Status run_coarse(Job *job, uint32_t step, bool *stopped, Error *error)
{
    job->step = step;
    Status status = run_pass(job, 1, stopped, error);
    job->step = 0;
    if (status != STATUS_OK || *stopped) return status;
    job->has_lattice = true;
    if (job->pass_samples && step <= COARSEST) show_picture(job, step);
    return STATUS_OK;
}

/* A time limit is to hold for what is made of the samples, too: spreading and denoising. */
static Status foresee_finish(Job *job, Error *error)
{
    const double limit = job->settings->time_limit_s, now = clock_now_s();
    const bool spreads = job->done >= SPREAD_LEAST_SAMPLES, known = job->finish_s > 0 && job->finish_spreads == spreads;
    if (!(limit > 0) || known || now - job->start < finish_tried_after * limit) return STATUS_OK;
    Image image;
    RenderStats stats = {0};
    TRY(render_state_resolve(job->state, job->settings->exposure, job->pool, &image, &stats, error));
    image_clear(&image);
    job->finish_spreads = spreads;
    job->finish_s = fmin(finish_longer * (clock_now_s() - now), finish_share * limit);
    return STATUS_OK;
}

/* Passes that are the same for all pixels. */
static Status run_uniform(Job *job, uint32_t samples, bool *stopped, Error *error)
{
    bool hurries = job->settings->time_limit_s > 0;
    if (job->done == 0 && (shows_picture(job) || hurries)) {
        for (uint32_t step = hurries ? EARLY_COARSEST : COARSEST; step > 0 && !*stopped; step /= 2)
            TRY(run_coarse(job, step, stopped, error));
        if (!*stopped) job->done = 1;
    }
    while (job->done < samples && !*stopped) {
        uint32_t n = pass_size(job->done);
        if (n > samples - job->done) n = samples - job->done;
        TRY(run_pass(job, n, stopped, error));
        if (*stopped) break;
        job->done += n;
        job->even = job->done >= job->most;
        report_picture(job);
        if (job->done >= NOISE_FLOOR) judge_noise(job);
        TRY(foresee_finish(job, error));
        report_progress(job, 0);
        if (job->done < job->wish && asked_to_stop(job)) *stopped = true;
    }
    return STATUS_OK;
}

/* The most samples that a pixel lacks of those it is wanted to have. */
static uint32_t most_wanted(const Job *job, const uint32_t *wanted)
{
    const FilmPixel *pixels = job->state->film.pixels;
    uint32_t most = 0;
    for (uint64_t i = 0; i < job->n_pixels; i++)
        if (wanted[i] > pixels[i].n && wanted[i] - pixels[i].n > most) most = wanted[i] - pixels[i].n;
    return most;
}

static Status plan_samples(Job *job, Adapt *adapt, Error *error)
{
    const Film *film = &job->state->film;
    if (!(job->settings->noise > 0)) return adapt_share(adapt, film, job->wish, job->pool, &job->plan, error);
    return adapt_plan(adapt, film, job->settings->noise, job->wish, job->pool, &job->plan, error);
}

/* Samples where the noise is too large, until it is nowhere so, or until all are given out. A pass is no longer than elsewhere, so
 * that a wish to stop is heard; plans are made when all pixels have what they wanted, of a plan before this render, too. */
static Status run_adaptive(Job *job, Adapt *adapt, bool *stopped, Error *error)
{
    job->adapted_at = clock_now_s() - job->start;
    job->adapted_from = (double)job->samples;
    job->wanted = adapt->wanted;
    uint32_t left = most_wanted(job, adapt->wanted);
    while (!*stopped) {
        if (!left) {
            TRY(plan_samples(job, adapt, error));
            job->planned_at_samples = (double)job->samples;
            judge_noise(job);
            left = job->plan.next;
            if (!left) break;
        }
        while (left && !*stopped) {
            TRY(run_pass(job, left < LARGEST_PASS ? left : LARGEST_PASS, stopped, error));
            report_progress(job, 0);
            report_picture(job);
            TRY(foresee_finish(job, error));
            left = most_wanted(job, adapt->wanted);
            if (asked_to_stop(job)) *stopped = true;
        }
    }
    return STATUS_OK;
}

/* What pixels want is part of the state. */
static Status adapt_pixels(Job *job, bool *stopped, Error *error)
{
    Adapt adapt;
    RenderState *state = job->state;
    TRY(adapt_init(&adapt, &state->film, job->settings->exposure, error));
    if (state->wanted) {
        free(adapt.wanted);
        adapt.wanted = state->wanted;
    }
    state->wanted = adapt.wanted;
    Status status = run_adaptive(job, &adapt, stopped, error);
    job->wanted = NULL;
    if (!*stopped) state->wanted = NULL;
    if (state->wanted) adapt.wanted = NULL;
    adapt_clear(&adapt);
    return status;
}

/* How many samples all pixels have before it is asked where more are needed; as many as there are to be: it never is. */
static uint32_t even_samples(const Job *job)
{
    uint32_t first = NOISE_FLOOR;
    if (!(job->settings->noise > 0)) {
        if (!job->settings->adaptive) return job->wish;
        first = job->wish / EVEN_PART;
        first = first < EVEN_LEAST ? EVEN_LEAST : first < EVEN_MOST ? first : EVEN_MOST;
    }
    return first < job->wish ? first : job->wish;
}

/* Runs passes until all samples are there, the noise is low enough, or a stop is asked for. */
static Status run_passes(Job *job, bool *stopped, Error *error)
{
    uint32_t even = even_samples(job);
    bool adapts = even < job->wish;
    TRY(run_uniform(job, even, stopped, error));
    if (!adapts) { /* others may have been, before */
        free(job->state->wanted);
        job->state->wanted = NULL;
    }
    return adapts && !*stopped ? adapt_pixels(job, stopped, error) : STATUS_OK;
}

/* How many samples the pixels have. */
static void count_samples(const RenderState *state, RenderStats *stats)
{
    const Film *film = &state->film;
    uint64_t sum;
    film_count_samples(film, &stats->samples, &stats->most_samples, &sum);
    stats->mean_samples = (double)sum / ((double)film->width * film->height);
}

/* What was there before this render. */
static void count_before(Job *job)
{
    RenderStats stats;
    count_samples(job->state, &stats);
    job->before.counters = job->state->counters;
    job->before.saturated_samples = job->state->saturated_samples;
    job->done = stats.samples;
    job->most = stats.most_samples;
    job->even = job->most == job->done;
    job->first_samples = job->samples = (uint64_t)(stats.mean_samples * (double)job->n_pixels + 0.5);
}

static void forget_row(void *context, uint32_t y, unsigned worker)
{
    (void)worker;
    RenderState *state = ((Job *)context)->state;
    film_forget_row(&state->film, y);
    bright_film_forget_row(&state->bright, y);
}

static Status aovs_init(RenderState *state, const RenderSettings *settings, const World *world, Error *error)
{
    return aov_film_init(&state->aovs, settings->aovs, &world->scene->light_groups, settings->denoises,
                         aov_film_unit(world), state->film.width, state->film.height, error);
}

static Status choose_crop(const RenderSettings *settings, uint32_t crop[4], Error *error)
{
    bool cropped = settings->crop[0] || settings->crop[1] || settings->crop[2] || settings->crop[3];
    uint32_t frame[4] = {0, 0, settings->width, settings->height};
    memcpy(crop, cropped ? settings->crop : frame, sizeof frame);
    if (crop[0] < crop[2] && crop[1] < crop[3] && crop[2] <= settings->width && crop[3] <= settings->height)
        return STATUS_OK;
    return fail(error, STATUS_USAGE, "the crop %u,%u,%u,%u is not inside the picture of %u x %u", crop[0], crop[1],
                crop[2], crop[3], settings->width, settings->height);
}

/* What this render's samples come to; nothing so far. */
static Status state_init(RenderState *state, const RenderSettings *settings, const World *world, Error *error)
{
    uint32_t crop[4];
    TRY(choose_crop(settings, crop, error));
    const uint32_t width = crop[2] - crop[0], height = crop[3] - crop[1];
    /* memory that is not there is promised all the same */
    double needed = (double)width * height * sizeof(FilmPixel), machine = memory_of_machine();
    state->place = (ImagePlace){.x = crop[0], .y = crop[1], .width = settings->width, .height = settings->height};
    if (machine > 0 && needed > machine) return fail_memory(error, (size_t)needed, "the film");
    TRY(film_init(&state->film, width, height, error));
    state->film.first_sample = settings->first_sample;
    if (world->bare) TRY(film_catch(&state->film, error));
    if (settings->spreads) TRY(bright_film_init(&state->bright, settings->first_sample > 0, width, height, error));
    return aovs_init(state, settings, world, error);
}

void render_state_clear(RenderState *state)
{
    film_clear(&state->film);
    bright_film_clear(&state->bright);
    aov_film_clear(&state->aovs);
    free(state->wanted);
    guide_search_free(state->search);
    *state = (RenderState){0};
}

bool render_state_is_empty(const RenderState *state)
{
    uint32_t least, most;
    uint64_t sum;
    if (!state->film.pixels) return true;
    film_count_samples(&state->film, &least, &most, &sum);
    return most == 0;
}

bool render_state_is_worth_keeping(const RenderState *state)
{
    return !render_state_is_empty(state) || (state->film.pixels && guide_search_is_begun(state->search));
}

static Status job_init(Job *job, Error *error)
{
    const RenderSettings *settings = job->settings;
    Film *film = &job->state->film;
    const bool is_new = !film->pixels;
    if (is_new) TRY(state_init(job->state, settings, job->world, error));
    job->wish = (settings->end_sample ? settings->end_sample : settings->samples) - settings->first_sample;
    job->tiles_x = (film->width + TILE - 1) / TILE;
    job->tiles_y = (film->height + TILE - 1) / TILE;
    job->n_pixels = (uint64_t)film->width * film->height;
    job->noise = -1;
    job->tracers = tracers_new(job->world, job->n_threads);
    job->saturated = calloc(job->n_threads, sizeof *job->saturated);
    job->tile_done = calloc((size_t)job->tiles_x * job->tiles_y, sizeof *job->tile_done);
    if (!job->tracers || !job->saturated || !job->tile_done)
        return fail_memory(error, job->n_threads * sizeof *job->tracers, "threads");
    /* memory that is read before it is written is mapped twice, and the second time interrupts all threads */
    if (is_new) pool_run(job->pool, film->height, forget_row, job);
    job->state->aovs.world = job->world;
    count_before(job);
    for (unsigned i = 0; i < job->n_threads; i++) {
        job->tracers[i].notes_sight = aov_film_needs_sight(&job->state->aovs);
        job->tracers[i].tells_groups = aov_film_needs_groups(&job->state->aovs);
    }
    return STATUS_OK;
}

/* Samples that were taken without the guide are not those of the render: they were only shown while photons were followed, or
 * written when the time was over. */
static Status forget_samples(Job *job, Error *error)
{
    RenderState *state = job->state;
    pool_run(job->pool, state->film.height, forget_row, job);
    aov_film_clear(&state->aovs);
    free(state->wanted);
    state->wanted = NULL;
    state->counters = job->before.counters;
    state->saturated_samples = job->before.saturated_samples;
    TRY(aovs_init(state, job->settings, job->world, error));
    state->aovs.world = job->world;
    for (unsigned i = 0; i < job->n_threads; i++) {
        job->tracers[i].counters = (PathCounters){0};
        job->saturated[i] = 0;
    }
    job->samples = 0;
    job->has_lattice = false;
    return STATUS_OK;
}

static void job_clear(Job *job)
{
    tracers_free(job->tracers, job->n_threads);
    free(job->saturated);
    free(job->tile_done);
    job->state->aovs.world = NULL;
}

/* While photons are followed, before there are any samples. */
static void report_photons(void *context, double fraction)
{
    Job *job = context;
    const RenderSettings *settings = job->settings;
    double now = clock_now_s();
    if (!job->events || !job->events->progress || now - job->last_progress < 0.1) return;
    job->last_progress = now;
    RenderProgress progress = {.samples_total = job->wish,
                               .seconds = now - job->start,
                               .photons = fraction,
                               .noise = -1,
                               .noise_wanted = settings->noise,
                               .seconds_left_low = -1,
                               .seconds_left_high = -1};
    job->events->progress(job->events->context, &progress);
}

static bool is_slice(const RenderSettings *settings)
{
    return settings->end_sample > 0;
}

/* When a search that a time limit does not shorten is left; 0: when it is done. */
static double end_of_search(const Job *job)
{
    const RenderSettings *settings = job->settings;
    if (!settings->repeatable || !(settings->time_limit_s > 0)) return 0;
    bool shows = job->first_samples == 0 && !is_slice(settings);
    return job->start + (shows ? 1 - show_share : 1) * settings->time_limit_s;
}

/* As adapt_dark has it, by the scene alone: what options say of how the picture is shown changes no sample. */
static Status foresee_dark(const Job *job, double *dark, Error *error)
{
    const SceneFilm *film = &job->world->scene->film;
    Brightness brightness = {0};
    if (film->exposure.automatic)
        TRY(glance(job->world, job->settings->width, job->settings->height, &brightness, error));
    *dark = adapt_dark(&brightness, film->exposure);
    return STATUS_OK;
}

static Status search_guide(Job *job, GuideStats *stats, Error *error)
{
    const RenderSettings *settings = job->settings;
    RenderState *state = job->state;
    /* where pixels stop by themselves, or by the clock, it is not known how many there will be */
    const uint32_t uncertain = 256;
    double limit = settings->repeatable ? 0 : settings->time_limit_s;
    bool certain = !(settings->noise > 0) && !(limit > 0);
    uint32_t *samples = &state->guide_samples;
    if (!*samples) *samples = certain || settings->samples < uncertain ? settings->samples : uncertain;
    double start = clock_cpu_s(), dark;
    TRY(foresee_dark(job, &dark, error));
    GuideSettings wish = {.width = settings->width,
                          .height = settings->height,
                          .paths = (uint64_t)settings->width * settings->height * *samples,
                          .seed = settings->seed,
                          .dark = dark,
                          .time_limit_s = limit,
                          .end_s = end_of_search(job),
                          .always = settings->caustics == CAUSTICS_ON,
                          .stop = job->events ? job->events->stop : NULL,
                          .progress = report_photons,
                          .context = job};
    if (!state->search) TRY(guide_search_new(&state->search, error));
    World world = *job->world;
    world.trial.pairs_from_camera = false; /* which is to change paths, and no guide by what it costs these */
    Status status = guide_search_run(state->search, &world, &wish, job->pool, stats, error);
    stats->cpu_seconds = clock_cpu_s() - start;
    return status;
}

/* Counts the samples, and finds those that stand alone, and where they go, or leaves that without pixels. */
static Status find_spread(const RenderState *state, Pool *pool, Spread *spread, RenderStats *stats, Error *error)
{
    *spread = (Spread){0};
    count_samples(state, stats);
    if (state->bright.out_of_memory) return fail(error, STATUS_NOMEM, "out of memory for the brightest samples");
    if (!state->bright.pixels || stats->most_samples < SPREAD_LEAST_SAMPLES) return STATUS_OK;
    return spread_init(spread, &state->film, &state->bright, pool, error);
}

/* With the same means for what catchers caught, the first channels of `carried` if there are any, and for layers of lights. */
static Status denoise_all(const RenderState *state, const LightLayers *layers, Pool *pool, Image *image, Image *caught,
                          Error *error)
{
    const uint32_t n_caught = caught->n_channels, n_layers = 3 * layers->n;
    char names[DENOISE_MOST_CARRIED][16];
    const char *pointers[DENOISE_MOST_CARRIED];
    Image carried;
    if (!layers->n) return denoise(&state->film, &state->aovs, pool, image, n_caught ? caught : NULL, error);
    for (uint32_t i = 0; i < n_caught + n_layers; i++) {
        snprintf(names[i], sizeof names[i], "carried %u", (unsigned)i);
        pointers[i] = names[i];
    }
    TRY(image_new(image->width, image->height, pointers, n_caught + n_layers, &carried, error));
    image_copy_channels(caught, 0, n_caught, &carried, 0);
    image_copy_channels(image, layers->first, n_layers, &carried, n_caught);
    Status status = denoise(&state->film, &state->aovs, pool, image, &carried, error);
    if (n_caught) image_copy_channels(&carried, 0, n_caught, caught, 0);
    image_copy_channels(&carried, n_caught, n_layers, image, layers->first);
    image_clear(&carried);
    return status;
}

/* Fills in what has no samples yet, or averages noise away, and leaves of shadow catchers what they are in the picture. */
static Status finish(const RenderState *state, bool complete, Pool *pool, Image *image, Error *error)
{
    const Film *film = &state->film;
    uint32_t step = complete ? 1 : early_step(film);
    LightLayers layers = light_layers_of(image, &state->aovs.groups);
    Image caught = {0};
    light_layers_follow(&layers, image);
    Status status = film->caught ? caught_means(film, image, &caught, error) : STATUS_OK;
    if (status == STATUS_OK && step <= 1 && state->aovs.guides)
        status = denoise_all(state, &layers, pool, image, &caught, error);
    if (status == STATUS_OK && film->caught) {
        caught_take_all(film, &caught, image);
        light_layers_give_up(&layers, &caught, image);
    }
    image_clear(&caught);
    if (status == STATUS_OK && step > 1) early_fill(film, step, image);
    return status;
}

/* Of samples that are counted. */
static Status resolve(const RenderState *state, const Spread *spread, Exposure exposure, Pool *pool, Image *image,
                      RenderStats *stats, Error *error)
{
    const PathCounters *counters = &state->counters;
    const Spread *moved = spread->pixels ? spread : NULL;
    stats->paths = counters->paths;
    stats->rays = counters->rays;
    stats->crossings = counters->crossings;
    stats->silent_crossings = counters->silent_crossings;
    stats->nesting_faults = counters->nesting_faults;
    stats->silent_limit = counters->silent_limit;
    stats->bad_samples = counters->bad_samples;
    stats->saturated_samples = state->saturated_samples;
    stats->spread_samples = spread->samples;
    stats->spread_light = spread->light;
    stats->spread_one_colored = spread->one_colored;
    stats->noise = adapt_noise(&state->film, moved, exposure, pool);
    TRY(aov_film_resolve(&state->aovs, &state->film, moved, pool, image, error));
    Status status = finish(state, stats->samples > 0, pool, image, error);
    if (status != STATUS_OK) image_clear(image);
    return status;
}

Status render_state_resolve(const RenderState *state, Exposure exposure, Pool *pool, Image *image, RenderStats *stats,
                            Error *error)
{
    Spread spread;
    TRY(find_spread(state, pool, &spread, stats, error));
    Status status = resolve(state, &spread, exposure, pool, image, stats, error);
    spread_clear(&spread);
    return status;
}

/* Looks for caustics first. What a picture shows meanwhile was not led by the guide: its samples do not stay. */
static Status prepare(Job *job, World *world, RenderStats *stats, Error *error)
{
    bool shows = shows_picture(job) && job->samples == 0;
    if (job->settings->caustics == CAUSTICS_OFF) return STATUS_OK;
    job->for_show = true;
    if (shows) TRY(run_coarse(job, COARSEST, &stats->stopped, error));
    TRY(search_guide(job, &stats->guide, error));
    stats->searching = !guide_search_is_done(job->state->search);
    if (stats->searching) return STATUS_OK;
    job->for_show = false;
    world->guide = guide_search_result(job->state->search);
    return shows && world->guide ? forget_samples(job, error) : STATUS_OK;
}

/* The samples of a render: none where the photons for them are still on their way, but for those that are shown. */
static Status take_samples(Job *job, RenderStats *stats, Error *error)
{
    job->sampling_at = clock_now_s();
    bool searching = stats->searching, shows = job->first_samples == 0 && !is_slice(job->settings);
    Status status = searching && !shows ? STATUS_OK : run_passes(job, &stats->stopped, error);
    if (searching) stats->stopped = true;
    return status;
}

Status render_go_on(const CompiledScene *compiled, const RenderSettings *settings, Pool *pool,
                    const RenderEvents *events, RenderState *state, Image *image, RenderStats *stats, Error *error)
{
    *stats = (RenderStats){0};
    *image = (Image){0};
    World world;
    TRY(world_init(&world, compiled, settings->camera, settings->bounces, settings->no_absorption, pool, error));
    world.trial = settings->trial;
    world.width = settings->width;
    world.height = settings->height;
    double cpu = clock_cpu_s(), now = clock_now_s();
    if (settings->by_chance) world_leave_to_chance(&world);
    if (settings->no_airlight) world.seeks_airlight = false;
    World *bare;
    Status status = catcher_world_new(&world, pool_threads(pool), &bare, error);
    world.bare = bare;
    Job job = {.settings = settings,
               .events = events,
               .state = state,
               .world = &world,
               .pool = pool,
               .n_threads = pool_threads(pool),
               .start = now,
               .sampling_at = now,
               .saved_at = now};
    if (status == STATUS_OK && settings->aovs & ((AovSet)1 << AOV_UV | (AovSet)1 << AOV_BEHIND_UV))
        status = world_find_mesh_boxes(&world, error);
    if (status == STATUS_OK) status = job_init(&job, error);
    if (status == STATUS_OK) status = prepare(&job, &world, stats, error);
    bool too_early = (is_stopped(&job) || stats->searching) && job.first_samples == 0;
    Spread spread = {0};
    if (status == STATUS_OK) status = take_samples(&job, stats, error);
    if (status == STATUS_OK) sum_counters(&job, state);
    if (status == STATUS_OK && stats->stopped && !too_early && events && events->stopped)
        events->stopped(events->context);
    if (status == STATUS_OK) status = find_spread(state, pool, &spread, stats, error);
    if (status == STATUS_OK) {
        stats->noisy_pixels = job.plan.unmet;
        status = resolve(state, &spread, settings->exposure, pool, image, stats, error);
        stats->seconds = clock_now_s() - job.start;
        stats->cpu_seconds = clock_cpu_s() - cpu;
    }
    if (status == STATUS_OK && stats->most_samples > 0) show_last_picture(&job, image);
    if (status == STATUS_OK && too_early) status = forget_samples(&job, error);
    spread_clear(&spread);
    job_clear(&job);
    catcher_world_free(bare);
    world_clear(&world);
    return status;
}

Status render_image(const CompiledScene *compiled, const RenderSettings *settings, Pool *pool,
                    const RenderEvents *events, Image *image, RenderStats *stats, Error *error)
{
    RenderState state = {0};
    Status status = render_go_on(compiled, settings, pool, events, &state, image, stats, error);
    render_state_clear(&state);
    return status;
}
