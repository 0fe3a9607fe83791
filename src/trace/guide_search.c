/* guide_search.c - how many photons are followed for a guide, and which of them become lobes.
 *
 * Round by round more photons are followed. Those that the guide of the rounds before did not foresee become lobes of the next
 * one: a photon is foreseen when a path that finds its light by that guide would not be a firefly. So all the lobes stand where
 * they are needed: few where a flat pane sends the sun straight on, many where light is folded again and again, and none
 * where no path of the camera ever comes. All of that is counted in rays, of which the guide gets a part of those that the
 * picture takes, so that it is the same on every machine.
 *
 * It is done by steps that can be left and gone on with (guide_keep.c): what is decided depends on photons and rays that were
 * counted, never on when it was left. Of a round that is left amid its photons, those stay that were followed by whole
 * batches, and of those that become lobes all that are done, as these bear a mark.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/clock.h"
#include "optics/sampling.h"
#include "trace/guide_keep.h"

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
#define LEAST_LOOKS 0.01f
/* Rays for the guide, as a part of the picture's; and what it may take of the smallest picture. */
#define RAYS_PART 0.06
#define FEWEST_RAYS 200000.0
/* Of that, what is granted on a promise; all of it if that is GUIDE_GREAT_PROMISE. */
#define UNSURE_PART 0.2
/* And of a limit of time. */
#define TIME_PART 0.1
/* A sample so many times as bright as the mean is not foreseen. */
#define FIREFLY 6.0f
/* Unforeseen flux, of all, that is no longer worth a round. */
#define FORESEEN 0.002
enum {
    FIRST_ROUND = PHOTON_EXPLORERS,
    FIRST_LOBES = 1 << 10,
    LEAST_ROUND = 1 << 10,
    BATCH = 1 << 14, /* photons between two looks at the clock, */
    LOOKED_BATCH = BATCH / 4 /* and those that are looked around at, which takes longer */,
    TRIED_PART = 64, /* of the picture's paths one in so many is followed to try a guide out, which is done twice */
    FEWEST_TRIED = 1 << 12,
    MOST_TRIED = 1 << 15
};

/* Then what the last step has left is not whole, and nothing of it is used. */
static bool is_stopped(const GuideSearch *search)
{
    return search->settings->stop && *search->settings->stop;
}

/* The search is to be left as it is, and gone on with another time. */
static bool is_to_be_left(const GuideSearch *search)
{
    double end = search->settings->end_s;
    return is_stopped(search) || (end > 0 && clock_now_s() > end);
}

static void report(const GuideSearch *search)
{
    const GuideSettings *settings = search->settings;
    if (settings->progress && search->facts.rays_granted > 0)
        settings->progress(settings->context, fmin((double)search->facts.rays / search->facts.rays_granted, 1));
}

/* Follows n more photons, or none of them where a stop comes between. */
static Status follow(GuideSearch *search, uint32_t n, Error *error)
{
    GuideFacts *facts = &search->facts;
    uint64_t rays = 0;
    if (!array_reserve(&search->landed, &search->capacity, facts->n + n, sizeof *search->landed))
        return fail_memory(error, (facts->n + n) * sizeof *search->landed, "photons");
    Photon *photons = search->landed + facts->n;
    Hopes hopes = {{0}, {0}}, *wanted = facts->followed == 0 ? &hopes : NULL;
    TRY(photons_trace(&search->source, facts->followed, n, search->pool, photons, wanted, &rays, error));
    if (is_stopped(search)) return STATUS_OK;
    if (wanted) facts->hopes = hopes;
    facts->rays += rays;
    facts->followed += n;
    for (uint32_t i = 0; i < n; i++) {
        if (!(photons[i].flux > 0)) continue;
        facts->flux += (double)photons[i].flux;
        search->landed[facts->n++] = photons[i];
    }
    return STATUS_OK;
}

/* Whether the photon's light would come as a surprise to paths that are guided so far. */
static bool is_unforeseen(const GuideSearch *search, const Photon *photon)
{
    if (!search->guide) return true;
    if (search->survey) {
        uint32_t visits = search->survey->visits[guide_leaf(search->survey, photon->position, photon->at_boundary)];
        if ((double)visits < 0.05 * search->facts.mean_visits) return false;
    }
    uint32_t cell = guide_leaf(search->guide, photon->position, photon->at_boundary);
    float mean = search->guide->cells[cell].radiance + search->facts.other;
    return guide_sample_of(search->guide, cell, 0.5f, photon) > FIREFLY * mean;
}

/* Those of the round's photons that are not foreseen and are not looked around at yet, of the first `most` that are not foreseen;
 * returns how many. *flux: of all that are not, as a part of all these photons'. */
static uint32_t choose_unforeseen(const GuideSearch *search, uint32_t most, uint32_t *which, double *flux)
{
    uint32_t n_new = (uint32_t)(search->facts.n - search->facts.round_begin), n = 0, n_left = 0;
    double unforeseen = 0, all = 0;
    for (uint32_t i = 0; i < n_new; i++) {
        const Photon *photon = &search->landed[search->facts.round_begin + i];
        all += (double)photon->flux;
        if (!is_unforeseen(search, photon)) continue;
        unforeseen += (double)photon->flux;
        if (n++ < most && !photon->lobe) which[n_left++] = i;
    }
    *flux = all > 0 ? unforeseen / all : 0;
    return n_left;
}

/* Makes lobes of those photons of the round that are not foreseen, at most so many of them, and the guide anew. *done: it was not
 * left before. */
static Status learn(GuideSearch *search, uint32_t most, bool *done, Error *error)
{
    GuideFacts *facts = &search->facts;
    uint32_t n_new = (uint32_t)(facts->n - facts->round_begin), *which = malloc((n_new + 1) * sizeof *which);
    if (!which) return fail_memory(error, n_new * sizeof *which, "photons");
    uint32_t n = choose_unforeseen(search, most, which, &facts->unforeseen), at = 0;
    Status status = STATUS_OK;
    while (status == STATUS_OK && at < n && (at == 0 || !is_to_be_left(search))) {
        uint32_t batch = n - at < LOOKED_BATCH ? n - at : LOOKED_BATCH;
        status = photons_look_around(&search->source, search->landed + facts->round_begin, which + at, batch,
                                     search->pool, &facts->rays, error);
        at += batch;
        report(search);
    }
    free(which);
    *done = at == n && !is_stopped(search);
    if (status != STATUS_OK || !*done) return status;
    guide_free(search->guide);
    search->guide = NULL;
    return guide_build(search->landed, (uint32_t)facts->n, facts->followed, search->pool, &search->guide, error);
}

/* Tries the guide out on some paths of the camera: one in so many as the picture has. */
static Status try_out(GuideSearch *search, uint64_t one_in, Error *error)
{
    const GuideSettings *settings = search->settings;
    uint64_t paths = settings->paths / one_in;
    paths = paths > MOST_TRIED ? MOST_TRIED : paths < FEWEST_TRIED ? FEWEST_TRIED : paths;
    search->guide->threshold = search->source.threshold;
    search->guide->bright = search->facts.worth.bright;
    const GuideTrial trial = {.world = search->source.world,
                              .settings = settings,
                              .paths = (uint32_t)paths,
                              .photons = search->landed,
                              .followed = search->facts.followed};
    TRY(guide_try(search->guide, &trial, search->pool, &search->facts.worth, error));
    search->guide->bright = search->facts.worth.bright; /* as when it is read from a checkpoint */
    search->facts.tried++;
    return STATUS_OK;
}

/* ---- the first round ---- */

/* What places where photons landed get of other light, on the mean. */
static void look_for_other_light(GuideSearch *search)
{
    enum { LOOKS = 256 };
    Tracer tracer;
    float sum = 0;
    tracer_init(&tracer, search->source.world);
    for (uint32_t i = 0; i < LOOKS; i++) {
        const Photon *photon = &search->landed[search->facts.n * i / LOOKS];
        sum += photon_other_light(&tracer, photon->position, photon->normal, search->source.threshold, i);
    }
    tracer_clear(&tracer);
    search->facts.other = sum / LOOKS / SAMPLING_PI;
}

/* How many rays photons may take: the fewer, the less is gained, or promised. */
static void grant(GuideSearch *search)
{
    const GuideSettings *settings = search->settings;
    GuideFacts *facts = &search->facts;
    double hope = facts->tried > 1 ? 0 : facts->worth.promise / GUIDE_GREAT_PROMISE;
    double part = fmin(fmax(fmax(facts->worth.gain - 1, hope), UNSURE_PART), 1);
    facts->rays_granted = part * fmax(RAYS_PART * facts->worth.rays_per_path * (double)settings->paths, FEWEST_RAYS);
}

/* Rounds begin with few photons again: more rays are granted than before. */
static void begin_rounds(GuideSearch *search)
{
    GuideFacts *facts = &search->facts;
    facts->granted = facts->rays_granted;
    facts->round_photons = FIRST_ROUND;
    facts->cost = (double)facts->rays / facts->followed;
    facts->step = GUIDE_STEP_PLAN;
}

/* The first round, and whether it promises anything; short, and done anew if it is stopped. */
static Status begin(GuideSearch *search, float flux, bool *worth, Error *error)
{
    GuideFacts *facts = &search->facts;
    double mean_visits = 0;
    bool always = search->settings->always, whole;
    TRY(follow(search, FIRST_ROUND, error));
    *worth = facts->n > 0;
    if (!always) *worth = facts->flux > (double)(LEAST_PART * flux) * facts->followed;
    if (!*worth) return STATUS_OK;
    TRY(learn(search, FIRST_LOBES, &whole, error));
    facts->unforeseen = 1;
    *worth = whole;
    if (!*worth) return STATUS_OK;
    TRY(try_out(search, 2 * TRIED_PART, error));
    *worth = always || facts->worth.gain > LEAST_GAIN || facts->worth.promise > LEAST_PROMISE;
    if (!*worth) return STATUS_OK;
    grant(search);
    for (uint32_t i = 0; i < search->guide->n_cells; i++) mean_visits += search->guide->visits[i];
    facts->mean_visits = mean_visits / search->guide->n_cells;
    search->survey = search->guide;
    search->guide = NULL;
    look_for_other_light(search);
    begin_rounds(search);
    return guide_build(search->landed, (uint32_t)facts->n, facts->followed, search->pool, &search->guide, error);
}

/* ---- further rounds ---- */

/* No more rounds: what is there is used, where a limit of time decides that, and not only when it is done. */
static bool is_over(const GuideSearch *search)
{
    double limit = search->settings->time_limit_s;
    return limit > 0 && clock_now_s() - search->start_s > TIME_PART * limit;
}

/* One more round, as far as rays are granted, or else the trial. */
static void plan_round(GuideSearch *search)
{
    GuideFacts *facts = &search->facts;
    double left = (facts->rays_granted - (double)facts->rays) / facts->cost;
    facts->step = GUIDE_STEP_TRY;
    if (!(facts->unforeseen > FORESEEN) || facts->n >= GUIDE_MOST_LANDED || facts->followed >= GUIDE_MOST_PHOTONS ||
        is_over(search) || left < LEAST_ROUND)
        return;
    uint32_t n = facts->round_photons;
    if (n < facts->followed) n = facts->followed;
    if (n > left) n = (uint32_t)left;
    if (n > GUIDE_MOST_PHOTONS - facts->followed) n = GUIDE_MOST_PHOTONS - facts->followed;
    facts->round_photons = n;
    facts->round_end = facts->followed + n;
    facts->round_begin = facts->n;
    facts->round_rays = facts->rays;
    facts->step = GUIDE_STEP_FOLLOW;
}

static Status follow_round(GuideSearch *search, Error *error)
{
    GuideFacts *facts = &search->facts;
    do {
        uint32_t left = facts->round_end - facts->followed;
        TRY(follow(search, left < BATCH ? left : BATCH, error));
        report(search);
    } while (facts->followed < facts->round_end && !is_to_be_left(search));
    if (facts->followed == facts->round_end) facts->step = GUIDE_STEP_LEARN;
    return STATUS_OK;
}

static Status learn_round(GuideSearch *search, Error *error)
{
    GuideFacts *facts = &search->facts;
    bool done;
    TRY(learn(search, UINT32_MAX, &done, error));
    if (!done) return STATUS_OK;
    facts->cost = (double)(facts->rays - facts->round_rays) / facts->round_photons;
    facts->step = GUIDE_STEP_PLAN;
    return STATUS_OK;
}

/* Nothing but the guide is needed any more, if it is. */
static void end_search(GuideSearch *search, bool worth)
{
    free(search->landed);
    guide_free(search->survey);
    search->landed = NULL;
    search->capacity = 0;
    search->survey = NULL;
    if (!worth) {
        guide_free(search->guide);
        search->guide = NULL;
    } else {
        free(search->guide->begins);
        free(search->guide->visits);
        search->guide->begins = NULL;
        search->guide->visits = NULL;
    }
    search->facts.step = GUIDE_STEP_DONE;
}

/* Whether what has come of the rounds is worth its use; or more of them, where it is worth more than was thought. */
static Status try_rounds(GuideSearch *search, Error *error)
{
    GuideFacts *facts = &search->facts;
    TRY(try_out(search, TRIED_PART, error));
    grant(search);
    if (facts->rays_granted > 1.5 * facts->granted) {
        begin_rounds(search);
        return STATUS_OK;
    }
    bool looks = guide_most_looks(search->guide) > 0;
    for (uint32_t i = 0; i < search->guide->n_cells; i++) {
        GuideCell *cell = &search->guide->cells[i];
        cell->share = float_max(cell->share, LEAST_SHARE);
        if (looks) cell->looks = float_max(cell->looks, LEAST_LOOKS);
    }
    guide_shares_are_set(search->guide);
    end_search(search, search->settings->always || facts->worth.gain > LEAST_USE);
    return STATUS_OK;
}

/* ---- all of it ---- */

static Status take_step(GuideSearch *search, float flux, Error *error)
{
    bool worth;
    switch (search->facts.step) {
    case GUIDE_STEP_BEGIN:
        TRY(begin(search, flux, &worth, error));
        if (is_stopped(search))
            guide_search_clear(search);
        else if (!worth)
            end_search(search, false);
        return STATUS_OK;
    case GUIDE_STEP_PLAN: plan_round(search); return STATUS_OK;
    case GUIDE_STEP_FOLLOW: return follow_round(search, error);
    case GUIDE_STEP_LEARN: return learn_round(search, error);
    case GUIDE_STEP_TRY: return try_rounds(search, error);
    default: return STATUS_OK;
    }
}

static Status take_steps(GuideSearch *search, const PhotonTargets *targets, Error *error)
{
    const World *world = search->source.world;
    bool some = targets->n > 0 && world_lights(world)->n > 0;
    float flux = some ? photon_flux(world, targets) : 0, area = some ? (float)targets->cumulative[targets->n - 1] : 0;
    if (!(flux > 0) || !(area > 0)) {
        end_search(search, false);
        return STATUS_OK;
    }
    search->source.threshold = (search->settings->always ? 1 : BRIGHTER) * flux / (area * SAMPLING_PI);
    do {
        TRY(take_step(search, flux, error));
    } while (search->facts.step != GUIDE_STEP_DONE && !is_to_be_left(search));
    return STATUS_OK;
}

Status guide_search_run(GuideSearch *search, const World *world, const GuideSettings *settings, Pool *pool,
                        GuideStats *stats, Error *error)
{
    Status status = STATUS_OK;
    if (search->facts.step != GUIDE_STEP_DONE) {
        PhotonTargets targets;
        TRY(photon_targets(world, &targets, error));
        search->settings = settings;
        search->pool = pool;
        search->start_s = clock_now_s();
        search->source = (PhotonSource){.world = world,
                                        .targets = &targets,
                                        .seed = settings->seed,
                                        .stop = settings->stop,
                                        .hopes = &search->facts.hopes};
        status = take_steps(search, &targets, error);
        search->settings = NULL;
        search->pool = NULL;
        search->source = (PhotonSource){0};
        photon_targets_clear(&targets);
    }
    const Guide *guide = guide_search_result(search);
    *stats = (GuideStats){.followed = search->facts.followed};
    if (!guide) return status;
    stats->landed = search->facts.n;
    stats->lobes = guide->n_lobes;
    stats->bytes = guide->n_nodes * (sizeof(GuideNode) + sizeof(GuideBox)) + guide->n_cells * sizeof(GuideCell) +
                   guide->n_fours * sizeof(GuideFour);
    return status;
}
