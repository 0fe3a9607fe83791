/* guide_new.c - how many photons are followed for a guide, and which of them become lobes.
 *
 * Round by round more photons are followed. Those that the guide of the rounds before did not foresee become lobes of the next
 * one: a photon is foreseen when a path that finds its light by that guide would not be a firefly. So all the lobes stand where
 * they are needed: few where a flat pane sends the sun straight on, many where light is folded again and again, and none
 * where no path of the camera ever comes. All of that is counted in rays, of which the guide gets a part of those that the
 * picture takes, so that it is the same on every machine.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/clock.h"
#include "optics/sampling.h"
#include "trace/guide_parts.h"

/* Lights are small when their radiance is above this many times what an even sky would have that gives the targets as much
 * light as they get; others are found well enough by chance. And less than this part of all light that comes to the
 * targets, landed behind them, is left to chance too. */
#define BRIGHTER 12.0f
#define LEAST_PART 0.002f
/* The expected ratio of variances without and with the guide that is worth its time. */
#define LEAST_GAIN 2.0f
/* Rays for the guide, as a part of the picture's; and what it may take of the smallest picture. */
#define RAYS_PART 0.06
#define FEWEST_RAYS 200000.0
/* And of a limit of time. */
#define TIME_PART 0.1
/* A sample so many times as bright as the mean is not foreseen. */
#define FIREFLY 6.0f
/* Unforeseen flux, of all, that is no longer worth a round. */
#define FORESEEN 0.002
enum {
    FIRST_ROUND = 1 << 12,
    FIRST_LOBES = 1 << 10,
    LEAST_ROUND = 1 << 10,
    MOST_PHOTONS = 1 << 23,
    MOST_LANDED = 1 << 20
};

/* Photons as they are followed, round by round. */
typedef struct Harvest {
    const GuideSettings *settings;
    PhotonSource source;
    Pool *pool;
    Photon *landed;
    size_t n, capacity;
    uint32_t followed;
    double flux; /* of all, times those followed */
    uint64_t rays;
    double rays_granted, start_s;
    float other;   /* radiance of a white surface by all other light, on the mean of where photons landed */
    Guide *guide;  /* of the rounds so far */
    Guide *survey; /* counts how often paths come to places; NULL: not yet */
    double mean_visits;
} Harvest;

static Status follow_round(Harvest *harvest, uint32_t n, Error *error)
{
    if (!array_reserve(&harvest->landed, &harvest->capacity, harvest->n + n, sizeof *harvest->landed))
        return fail_memory(error, (harvest->n + n) * sizeof *harvest->landed, "photons");
    Photon *photons = harvest->landed + harvest->n;
    TRY(photons_trace(&harvest->source, harvest->followed, n, harvest->pool, photons, &harvest->rays, error));
    harvest->followed += n;
    for (uint32_t i = 0; i < n; i++) {
        if (!(photons[i].flux > 0)) continue;
        harvest->flux += (double)photons[i].flux;
        harvest->landed[harvest->n++] = photons[i];
    }
    return STATUS_OK;
}

/* Whether the photon's light would come as a surprise to paths that are guided so far. */
static bool is_unforeseen(const Harvest *harvest, const Photon *photon)
{
    if (!harvest->guide) return true;
    if (harvest->survey) {
        uint32_t visits = atomic_load(&harvest->survey->visits[guide_leaf(harvest->survey, photon->position)]);
        if ((double)visits < 0.05 * harvest->mean_visits) return false;
    }
    uint32_t cell = guide_leaf(harvest->guide, photon->position);
    float mean = harvest->guide->cells[cell].radiance + harvest->other;
    return guide_sample_of(harvest->guide, cell, 0.5f, photon) > FIREFLY * mean;
}

/* Makes lobes of those photons from number `begin` on that are not foreseen, at most so many of them, and the guide anew.
 * *flux: theirs, as a part of all these photons'. */
static Status learn(Harvest *harvest, size_t begin, uint32_t most, double *flux, Error *error)
{
    uint32_t n_new = (uint32_t)(harvest->n - begin), n = 0, *which = malloc((n_new + 1) * sizeof *which);
    if (!which) return fail_memory(error, n_new * sizeof *which, "photons");
    double unforeseen = 0, all = 0;
    for (uint32_t i = 0; i < n_new; i++) {
        const Photon *photon = &harvest->landed[begin + i];
        all += (double)photon->flux;
        if (!is_unforeseen(harvest, photon)) continue;
        unforeseen += (double)photon->flux;
        if (n < most) which[n++] = i;
    }
    *flux = all > 0 ? unforeseen / all : 0;
    Status status =
        photons_look_around(&harvest->source, harvest->landed + begin, which, n, harvest->pool, &harvest->rays, error);
    free(which);
    TRY(status);
    guide_free(harvest->guide);
    harvest->guide = NULL;
    return guide_build(harvest->landed, (uint32_t)harvest->n, harvest->followed, harvest->pool, &harvest->guide, error);
}

/* ---- what paths of the camera do ---- */

typedef struct Survey {
    World world;
    const GuideSettings *settings;
    uint32_t n;
    Tracer *tracers;
} Survey;

static void survey_path(void *context, uint32_t i, unsigned worker)
{
    const Survey *survey = context;
    const GuideSettings *settings = survey->settings;
    uint64_t pixels = (uint64_t)settings->width * settings->height,
             pixel = ((uint64_t)i * pixels + pixels / 2) / survey->n;
    float rgb[3], alpha;
    uint32_t x = (uint32_t)(pixel % settings->width), y = (uint32_t)(pixel / settings->width);
    trace_sample(&survey->tracers[worker], x, y, settings->width, settings->height, ~settings->seed, i, rgb, &alpha);
}

/* Follows some of the camera's paths: how many rays they take, and where they come to. */
static Status look_where_paths_go(Harvest *harvest, Error *error)
{
    const GuideSettings *settings = harvest->settings;
    uint64_t pixels = (uint64_t)settings->width * settings->height, wish = settings->paths / 64;
    unsigned n_threads = pool_threads(harvest->pool);
    wish = wish > 16384 ? 16384 : wish < 256 ? 256 : wish;
    Survey survey = {.world = *harvest->source.world,
                     .settings = settings,
                     .n = (uint32_t)(wish < pixels ? wish : pixels),
                     .tracers = calloc(n_threads, sizeof *survey.tracers)};
    Guide *guide = harvest->guide;
    guide->visits = calloc(guide->n_cells, sizeof *guide->visits);
    Status status = STATUS_OK;
    if (survey.tracers && guide->visits) {
        uint64_t rays = 0, visits = 0;
        survey.world.guide = guide;
        guide->threshold = harvest->source.threshold;
        for (unsigned i = 0; i < n_threads; i++) tracer_init(&survey.tracers[i], &survey.world);
        pool_run(harvest->pool, survey.n, survey_path, &survey);
        for (unsigned i = 0; i < n_threads; i++) {
            rays += survey.tracers[i].counters.rays;
            tracer_clear(&survey.tracers[i]);
        }
        for (uint32_t i = 0; i < guide->n_cells; i++) visits += atomic_load(&guide->visits[i]);
        harvest->mean_visits = (double)visits / guide->n_cells;
        harvest->rays += rays;
        harvest->rays_granted = fmax(RAYS_PART * (double)rays / survey.n * (double)settings->paths, FEWEST_RAYS);
        harvest->survey = guide;
        harvest->guide = NULL;
    } else {
        status = fail_memory(error, guide->n_cells * sizeof *guide->visits, "caustics");
    }
    free(survey.tracers);
    return status;
}

/* ---- rounds ---- */

static bool is_stopped(const Harvest *harvest)
{
    return harvest->settings->stop && *harvest->settings->stop;
}

/* No more rounds. What is there is used. */
static bool is_over(const Harvest *harvest)
{
    double limit = harvest->settings->time_limit_s;
    return is_stopped(harvest) || (limit > 0 && clock_now_s() - harvest->start_s > TIME_PART * limit);
}

static void report(const Harvest *harvest)
{
    const GuideSettings *settings = harvest->settings;
    if (settings->progress && harvest->rays_granted > 0)
        settings->progress(settings->context, fmin((double)harvest->rays / harvest->rays_granted, 1));
}

/* What places where photons landed get of other light, on the mean. */
static void look_for_other_light(Harvest *harvest)
{
    enum { LOOKS = 256 };
    Tracer tracer;
    float sum = 0;
    tracer_init(&tracer, harvest->source.world);
    for (uint32_t i = 0; i < LOOKS; i++) {
        const Photon *photon = &harvest->landed[harvest->n * i / LOOKS];
        sum += photon_other_light(&tracer, photon->position, photon->normal, harvest->source.threshold, i);
    }
    tracer_clear(&tracer);
    harvest->other = sum / LOOKS / SAMPLING_PI;
}

/* The first round, and whether it promises anything. */
static Status begin(Harvest *harvest, float flux, bool *worth, Error *error)
{
    double part;
    TRY(follow_round(harvest, FIRST_ROUND, error));
    *worth = harvest->n > 0;
    if (!harvest->settings->always) *worth = harvest->flux > (double)(LEAST_PART * flux) * harvest->followed;
    if (!*worth) return STATUS_OK;
    TRY(learn(harvest, 0, FIRST_LOBES, &part, error));
    if (harvest->settings->always) return STATUS_OK;
    TRY(guide_choose_shares(harvest->guide, harvest->source.world, harvest->source.threshold, harvest->landed,
                            harvest->followed, harvest->pool, error));
    *worth = harvest->guide->gain > LEAST_GAIN;
    return STATUS_OK;
}

static Status go_on(Harvest *harvest, Error *error)
{
    look_for_other_light(harvest);
    uint32_t n = FIRST_ROUND;
    double unforeseen = 1, cost = (double)harvest->rays / harvest->followed; /* rays for a photon */
    TRY(look_where_paths_go(harvest, error));
    TRY(guide_build(harvest->landed, (uint32_t)harvest->n, harvest->followed, harvest->pool, &harvest->guide, error));
    while (unforeseen > FORESEEN && harvest->n < MOST_LANDED && harvest->followed < MOST_PHOTONS && !is_over(harvest)) {
        double left = (harvest->rays_granted - (double)harvest->rays) / cost;
        if (left < LEAST_ROUND) break;
        if (n < harvest->followed) n = harvest->followed;
        if (n > left) n = (uint32_t)left;
        if (n > MOST_PHOTONS - harvest->followed) n = MOST_PHOTONS - harvest->followed;
        uint64_t before = harvest->rays;
        size_t begin = harvest->n;
        TRY(follow_round(harvest, n, error));
        TRY(learn(harvest, begin, UINT32_MAX, &unforeseen, error));
        cost = (double)(harvest->rays - before) / n;
        report(harvest);
    }
    return guide_choose_shares(harvest->guide, harvest->source.world, harvest->source.threshold, harvest->landed,
                               harvest->followed, harvest->pool, error);
}

static Status gather(Harvest *harvest, bool *worth, Error *error)
{
    const World *world = harvest->source.world;
    const PhotonTargets *targets = harvest->source.targets;
    *worth = false;
    if (targets->n == 0 || world_lights(world)->n == 0) return STATUS_OK;
    float flux = photon_flux(world, targets), area = (float)targets->cumulative[targets->n - 1];
    if (!(flux > 0) || !(area > 0)) return STATUS_OK;
    harvest->source.threshold = (harvest->settings->always ? 1 : BRIGHTER) * flux / (area * SAMPLING_PI);
    TRY(begin(harvest, flux, worth, error));
    if (*worth) TRY(go_on(harvest, error));
    if (is_stopped(harvest)) *worth = false;
    return STATUS_OK;
}

Status guide_new(const World *world, const GuideSettings *settings, Pool *pool, Guide **guide, GuideStats *stats,
                 Error *error)
{
    *guide = NULL;
    *stats = (GuideStats){0};
    PhotonTargets targets;
    photon_targets(world, &targets);
    Harvest harvest = {
        .settings = settings, .source = {world, &targets, 0, settings->seed}, .pool = pool, .start_s = clock_now_s()};
    bool worth = false;
    Status status = gather(&harvest, &worth, error);
    free(harvest.landed);
    guide_free(harvest.survey);
    stats->followed = harvest.followed;
    if (status != STATUS_OK || !worth) {
        guide_free(harvest.guide);
        return status;
    }
    Guide *made = *guide = harvest.guide;
    free(made->begins);
    made->begins = NULL;
    made->threshold = harvest.source.threshold;
    stats->landed = harvest.n;
    stats->lobes = made->n_lobes;
    stats->bytes =
        made->n_nodes * sizeof(GuideNode) + made->n_cells * sizeof(GuideCell) + made->n_lobes * sizeof(GuideLobe);
    return status;
}
