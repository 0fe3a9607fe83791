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
/* The gain for which more photons are followed than the first ones, and that for which what has come of them is used; and the
 * promise of the first photons for which more are followed, although as many as there are do not show it yet. */
#define LEAST_GAIN 1.05
#define LEAST_USE 1.02
#define LEAST_PROMISE 10.0
/* How often probes are sent at least: few are enough to keep what was not met on trial from making fireflies. */
#define LEAST_SHARE 0.03f
/* Rays for the guide, as a part of the picture's; and what it may take of the smallest picture. */
#define RAYS_PART 0.06
#define FEWEST_RAYS 200000.0
/* Of that, what is granted on a promise; all of it if the promise is as great as that. */
#define UNSURE_PART 0.2
#define GREAT_PROMISE 1000.0
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
    MOST_LANDED = 1 << 20,
    TRIED_PART = 64, /* of the picture's paths one in so many is followed to try a guide out, which is done twice */
    FEWEST_TRIED = 1 << 12,
    MOST_TRIED = 1 << 15
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
    uint32_t tried; /* how often it was tried out what they are worth */
    double rays_granted, start_s;
    double unforeseen; /* of the last round's flux */
    GuideWorth worth;
    float other;   /* radiance of a white surface by all other light, on the mean of where photons landed */
    Guide *guide;  /* of the rounds so far */
    Guide *survey; /* counts how often paths come to places; NULL: not yet */
    double mean_visits;
} Harvest;

/* Then what the last step has left is not whole, and nothing of it is used. */
static bool is_stopped(const Harvest *harvest)
{
    return harvest->settings->stop && *harvest->settings->stop;
}

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
        uint32_t visits = harvest->survey->visits[guide_leaf(harvest->survey, photon->position)];
        if ((double)visits < 0.05 * harvest->mean_visits) return false;
    }
    uint32_t cell = guide_leaf(harvest->guide, photon->position);
    float mean = harvest->guide->cells[cell].radiance + harvest->other;
    return guide_sample_of(harvest->guide, cell, 0.5f, photon) > FIREFLY * mean;
}

/* Makes lobes of those photons from number `begin` on that are not foreseen, at most so many of them, and the guide anew, but
 * after a stop.
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
    if (is_stopped(harvest)) return STATUS_OK;
    guide_free(harvest->guide);
    harvest->guide = NULL;
    return guide_build(harvest->landed, (uint32_t)harvest->n, harvest->followed, harvest->pool, &harvest->guide, error);
}

/* Tries the guide out on some paths of the camera: one in so many as the picture has. */
static Status try_out(Harvest *harvest, uint64_t one_in, Error *error)
{
    const GuideSettings *settings = harvest->settings;
    uint64_t paths = settings->paths / one_in;
    paths = paths > MOST_TRIED ? MOST_TRIED : paths < FEWEST_TRIED ? FEWEST_TRIED : paths;
    harvest->guide->threshold = harvest->source.threshold;
    TRY(guide_try(harvest->guide, harvest->source.world, settings, (uint32_t)paths, harvest->landed, harvest->followed,
                  harvest->pool, &harvest->worth, error));
    harvest->tried++;
    return STATUS_OK;
}

/* ---- rounds ---- */

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

/* How many rays photons may take: the fewer, the less is gained, or promised. */
static void grant(Harvest *harvest)
{
    const GuideSettings *settings = harvest->settings;
    double hope = harvest->tried > 1 ? 0 : harvest->worth.promise / GREAT_PROMISE;
    double part = fmin(fmax(fmax(harvest->worth.gain - 1, hope), UNSURE_PART), 1);
    harvest->rays_granted =
        part * fmax(RAYS_PART * harvest->worth.rays_per_path * (double)settings->paths, FEWEST_RAYS);
}

/* The first round, and whether it promises anything. */
static Status begin(Harvest *harvest, float flux, bool *worth, Error *error)
{
    double part, mean_visits = 0;
    bool always = harvest->settings->always;
    TRY(follow_round(harvest, FIRST_ROUND, error));
    *worth = harvest->n > 0;
    if (!always) *worth = harvest->flux > (double)(LEAST_PART * flux) * harvest->followed;
    if (!*worth) return STATUS_OK;
    TRY(learn(harvest, 0, FIRST_LOBES, &part, error));
    *worth = !is_stopped(harvest);
    if (!*worth) return STATUS_OK;
    TRY(try_out(harvest, 2 * TRIED_PART, error));
    *worth = always || harvest->worth.gain > LEAST_GAIN || harvest->worth.promise > LEAST_PROMISE;
    if (!*worth) return STATUS_OK;
    grant(harvest);
    for (uint32_t i = 0; i < harvest->guide->n_cells; i++) mean_visits += harvest->guide->visits[i];
    harvest->mean_visits = mean_visits / harvest->guide->n_cells;
    harvest->survey = harvest->guide;
    harvest->guide = NULL;
    look_for_other_light(harvest);
    return guide_build(harvest->landed, (uint32_t)harvest->n, harvest->followed, harvest->pool, &harvest->guide, error);
}

/* More rounds, as far as rays are granted. */
static Status go_on(Harvest *harvest, Error *error)
{
    uint32_t n = FIRST_ROUND;
    double cost = (double)harvest->rays / harvest->followed; /* rays for a photon */
    while (harvest->unforeseen > FORESEEN && harvest->n < MOST_LANDED && harvest->followed < MOST_PHOTONS &&
           !is_over(harvest)) {
        double left = (harvest->rays_granted - (double)harvest->rays) / cost;
        if (left < LEAST_ROUND) break;
        if (n < harvest->followed) n = harvest->followed;
        if (n > left) n = (uint32_t)left;
        if (n > MOST_PHOTONS - harvest->followed) n = MOST_PHOTONS - harvest->followed;
        uint64_t before = harvest->rays;
        size_t begin = harvest->n;
        TRY(follow_round(harvest, n, error));
        TRY(learn(harvest, begin, UINT32_MAX, &harvest->unforeseen, error));
        cost = (double)(harvest->rays - before) / n;
        report(harvest);
    }
    return STATUS_OK;
}

/* All rounds after the first, and whether what has come of them is worth its use. */
static Status finish(Harvest *harvest, bool *worth, Error *error)
{
    bool always = harvest->settings->always;
    for (double granted = 0; harvest->rays_granted > 1.5 * granted; grant(harvest)) {
        granted = harvest->rays_granted;
        TRY(go_on(harvest, error));
        if (is_stopped(harvest)) break;
        TRY(try_out(harvest, TRIED_PART, error));
    }
    *worth = always || harvest->worth.gain > LEAST_USE;
    for (uint32_t i = 0; i < harvest->guide->n_cells; i++) {
        float *share = &harvest->guide->cells[i].share;
        *share = float_max(*share, LEAST_SHARE);
    }
    return STATUS_OK;
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
    if (*worth) TRY(finish(harvest, worth, error));
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
    Harvest harvest = {.settings = settings,
                       .source = {.world = world, .targets = &targets, .seed = settings->seed, .stop = settings->stop},
                       .pool = pool,
                       .start_s = clock_now_s(),
                       .unforeseen = 1};
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
    free(made->visits);
    made->begins = NULL;
    made->visits = NULL;
    stats->landed = harvest.n;
    stats->lobes = made->n_lobes;
    stats->bytes =
        made->n_nodes * sizeof(GuideNode) + made->n_cells * sizeof(GuideCell) + made->n_fours * sizeof(GuideFour);
    return status;
}
