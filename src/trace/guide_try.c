/* guide_try.c - what a guide is worth, and where: some of the camera's paths are followed with it, and thrown away.
 *
 * Where light is found that probes look for, the path's own direction and the probe's may both find it, and each counts as
 * f / (p + s g): f what is sent on, p the density of the path's own directions, g the guide's, s how often probes are sent.
 * The expected sum of these squares, each times (p + s g) / (p + t g), is what the squares would be if probes were sent t
 * times; for t = 0 it is the square that the path has without probes. So paths with probes tell what all is like
 * without, with little noise where the guide knows better: no firefly has to be met to be counted. That difference, of
 * the relative variance of pixels, is held against the work of the probes.
 *
 * That is not much in most scenes, whatever the photons say of the places where they land: the camera sees few of these, or they are
 * bright by other light, or the pixels are noisy for other reasons. (An estimate from photons alone, cell by cell, was
 * wrong by factors of 1.5 to 6: light-bulb 5.4, measured 0.85; surfaces 3.1, 0.75; peers' glass 2.0, 1.2.)
 *
 * All is summed up in the order of the paths: the choice is the same for any number of threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/luminance.h"
#include "optics/color.h"
#include "optics/sampling.h"
#include "trace/guide_parts.h"

enum { SPOT_PATHS = 16, HALVES = 2 };
/* One spot in so many is where photons land. */
enum { LED_PART = 4 };
/* How often probes are sent by paths that are scattered in a cell, and for each of these how often by looks along paths, over that. */
enum { N_SHARES = 7, N_LOOKS = 4, N_CHOICES = N_SHARES * N_LOOKS };
static const float shares[N_SHARES] = {0, 0.03f, 0.06f, 0.12f, 0.25f, 0.5f, 1}, looks[N_LOOKS] = {0, 0.25f, 1, 4};
/* Of these choices, in all cells: what is judged for all, without looks and with, and what is tried out. */
enum { EVEN = 4 * N_LOOKS, EVEN_LOOKS = EVEN + 2, TRIED = 5 * N_LOOKS + 2 };

/* What a probe takes besides its rays, a look to find its place, and looking up a place: in rays. */
#define PROBE_COST 1.0
#define LOOK_COST 1.0
#define VISIT_COST 0.05
/* Where less is known of a part of the guide, it does as the larger one that it lies in. */
#define LEAST_FOUND 24
/* A single path's relative square is not counted higher: lone bright samples are spread in the picture. */
#define MOST_SQUARE 1e4
/* What is left of the variance of the tried paths, if all of it is that of probes, and these are sent as often as can be. */
#define LEAST_LEFT 0.5
/* Lines are bright on which cells scatter this much of what they do on lines in the mean, weighted by itself; or so much that the
 * line is not dark. */
#define BRIGHT_PART 0.25
#define NOT_DARK (4 * (double)SAMPLING_PI)
/* The part that is trusted of what one share for all cells gains. */
#define EVEN_TRUST 0.5

typedef struct Record {
    uint32_t path, cell;
    GuideRecordKind kind;
    float amount, ratio;
    float of_looks; /* the part of the ratio that is that of looks */
} Record;

/* What paths do in a part of the guide. */
typedef struct Tally {
    uint32_t cell, n_found, visits;
    double weight,
        look_weight;   /* how many probes there would be if all shares were 1: by what is scattered, by looks; */
    double sent, rays; /* those sent, and their rays */
    double lines, lines_squared; /* what all cells scatter on the lines of the looks */
    double carried;              /* squares of what the paths carried there */
    double returned;         /* and of what part of the light of a white surface went back along them, of those sent */
    double saved[N_CHOICES]; /* of the squares, over having no guide */
} Tally;

struct GuideLedger {
    Record *records; /* of the present spot */
    size_t n, capacity;
    Tally *tallies; /* of all spots, each with the cells that it has met */
    size_t n_tallies, tallies_capacity;
    uint32_t path, *last; /* of each cell, its tally */
    bool out_of_memory;
};

/* A pixel that is tried. */
typedef struct Spot {
    uint32_t x, y, first_sample;
    double weight; /* over that of one of as many spots that are spread evenly */
    unsigned worker;
    size_t first, end; /* of the worker's tallies */
    double variance;   /* relative, the sum of that of its paths */
    double rays;
} Spot;

typedef struct Tryout {
    World world;
    const GuideSettings *settings;
    Guide *guide;
    uint32_t n_spots;
    Spot *spots;
    Tracer *tracers;
    GuideLedger *ledgers;
    Tally *cells[HALVES]; /* sums of the spots of even numbers, and of odd ones */
    Tally *nodes;         /* sums, for each of the tree's */
    int *chosen;          /* number of each cell's share */
    double paths, variance, rays;
} Tryout;

void guide_note(GuideLedger *ledger, const GuideAt *at, GuideRecordKind kind, float amount, float ratio)
{
    if (!array_reserve(&ledger->records, &ledger->capacity, ledger->n + 1, sizeof *ledger->records)) {
        ledger->out_of_memory = true;
        return;
    }
    float of_looks = at->share > 0 ? float_max(1 - at->sent / at->share, 0) : 0;
    ledger->records[ledger->n++] =
        (Record){ledger->path, (uint32_t)(at->cell - at->guide->cells), kind, amount, ratio, of_looks};
}

static double share_of(int choice)
{
    return (double)shares[choice / N_LOOKS];
}

static double looks_of(int choice)
{
    return share_of(choice) * (double)looks[choice % N_LOOKS];
}

/* ---- paths ---- */

/* The tally of a cell among those from number `first` on. */
static Tally *tally_of(GuideLedger *ledger, size_t first, uint32_t cell)
{
    uint32_t last = ledger->last[cell];
    if (last >= first && last < ledger->n_tallies && ledger->tallies[last].cell == cell) return &ledger->tallies[last];
    if (ledger->n_tallies == UINT32_MAX ||
        !array_reserve(&ledger->tallies, &ledger->tallies_capacity, ledger->n_tallies + 1, sizeof *ledger->tallies)) {
        ledger->out_of_memory = true;
        return NULL;
    }
    ledger->last[cell] = (uint32_t)ledger->n_tallies;
    ledger->tallies[ledger->n_tallies] = (Tally){.cell = cell};
    return &ledger->tallies[ledger->n_tallies++];
}

static void tally_record(Tally *tally, const Record *record, double by_brightness)
{
    double amount = (double)record->amount, ratio = (double)record->ratio;
    switch (record->kind) {
    case GUIDE_VISIT:
        tally->visits++;
        tally->weight += amount;
        tally->carried += ratio * ratio * by_brightness;
        break;
    case GUIDE_LOOK:
        tally->visits++;
        tally->look_weight += amount;
        tally->lines += ratio;
        tally->lines_squared += ratio * ratio;
        break;
    case GUIDE_SENT:
        tally->sent++;
        tally->rays += amount;
        tally->returned += fmin(ratio * ratio, 1);
        break;
    case GUIDE_FOUND:
        if (!isfinite(amount) || !isfinite(ratio)) break;
        tally->n_found++;
        for (int k = N_LOOKS; k < N_CHOICES; k++) {
            double looked = (double)record->of_looks,
                   r = ratio * ((1 - looked) * share_of(k) / share_of(TRIED) + looked * looks_of(k) / looks_of(TRIED));
            tally->saved[k] += amount * amount * by_brightness * (1 + ratio) * r / (1 + r);
        }
        break;
    }
}

/* Three quarters of the spots are spread evenly, the others as photons are that land where the camera sees them: the focus of a
 * burning glass is few pixels of all. They are weighed as if all spots were of both kinds ([Veach97] 9.2.2, the balance
 * heuristic). */
static bool place_spots(Tryout *trial, const Photon *photons)
{
    const uint32_t width = trial->settings->width, height = trial->settings->height;
    const uint32_t n_photons = trial->guide->begins[trial->guide->n_cells];
    const SceneCamera *camera = &trial->world.camera;
    const uint64_t pixels = (uint64_t)width * height;
    uint32_t *landed = calloc(pixels, sizeof *landed), n_seen = 0, x, y;
    if (!landed) return false;
    for (uint32_t k = 0; k < n_photons; k++)
        if (camera_pixel(camera, vec3_from_f(photons[k].position), width, height, &x, &y))
            landed[(size_t)y * width + x]++, n_seen++;
    uint32_t n_led = n_seen ? trial->n_spots / LED_PART : 0, n_even = trial->n_spots - n_led, seen = 0, led = 0;
    for (uint32_t i = 0; i < n_even; i++) {
        uint64_t pixel = ((uint64_t)i * pixels + pixels / 2) / n_even;
        trial->spots[i] = (Spot){.x = (uint32_t)(pixel % width), .y = (uint32_t)(pixel / width)};
    }
    for (uint32_t k = 0; k < n_photons && led < n_led; k++) {
        if (!camera_pixel(camera, vec3_from_f(photons[k].position), width, height, &x, &y)) continue;
        for (seen++; led < n_led && ((uint64_t)led * n_seen + n_seen / 2) / n_led < seen; led++)
            trial->spots[n_even + led] = (Spot){.x = x, .y = y, .first_sample = (led + 1) * SPOT_PATHS};
    }
    for (uint32_t i = 0; i < trial->n_spots; i++) {
        Spot *spot = &trial->spots[i];
        double share = n_seen ? (double)landed[(size_t)spot->y * width + spot->x] * (double)pixels / n_seen : 0;
        spot->weight = trial->n_spots / (n_even + n_led * share);
    }
    free(landed);
    return true;
}

static void look_at_spot(void *context, uint32_t i, unsigned worker)
{
    Tryout *trial = context;
    const GuideSettings *settings = trial->settings;
    GuideLedger *ledger = &trial->ledgers[worker];
    Spot *spot = &trial->spots[i];
    Tracer *tracer = &trial->tracers[worker];
    uint64_t rays = tracer->counters.rays;
    double luminance[SPOT_PATHS], by_brightness[SPOT_PATHS], sum = 0;
    FilmSample sample = {spot->x, spot->y, settings->width, settings->height, ~settings->seed, spot->first_sample};
    ledger->n = 0;
    for (uint32_t k = 0; k < SPOT_PATHS; k++, sample.index++) {
        float rgb[3], alpha;
        ledger->path = k;
        trace_sample(tracer, &sample, rgb, &alpha);
        sum += luminance[k] = (double)color_luminance(rgb);
    }
    spot->worker = worker;
    spot->first = ledger->n_tallies;
    spot->rays = (double)(tracer->counters.rays - rays);
    for (uint32_t k = 0; k < SPOT_PATHS; k++) { /* each by the brightness that the others say */
        double mean = (sum - luminance[k]) / (SPOT_PATHS - 1), off = luminance[k] - mean;
        by_brightness[k] = 1 / (mean * mean + settings->dark * settings->dark);
        spot->variance += fmin(off * off * by_brightness[k], MOST_SQUARE) * (SPOT_PATHS - 1) / SPOT_PATHS;
    }
    for (size_t k = 0; k < ledger->n; k++) {
        const Record *record = &ledger->records[k];
        Tally *tally = tally_of(ledger, spot->first, record->cell);
        if (tally) tally_record(tally, record, by_brightness[record->path]);
    }
    spot->end = ledger->n_tallies;
}

/* ---- sums ---- */

/* Adds another tally so many times; what was found, and visits, are counted as they are. */
static void tally_add(Tally *sum, const Tally *more, double times)
{
    sum->n_found += more->n_found;
    sum->visits += more->visits;
    sum->weight += times * more->weight;
    sum->look_weight += times * more->look_weight;
    sum->lines += times * more->lines;
    sum->lines_squared += times * more->lines_squared;
    sum->sent += times * more->sent;
    sum->rays += times * more->rays;
    sum->carried += times * more->carried;
    sum->returned += times * more->returned;
    for (int k = 0; k < N_CHOICES; k++) sum->saved[k] += times * more->saved[k];
}

static void sum_spots(Tryout *trial)
{
    for (uint32_t i = 0; i < trial->n_spots; i++) {
        const Spot *spot = &trial->spots[i];
        trial->variance += spot->weight * spot->variance;
        trial->rays += spot->weight * spot->rays;
        for (size_t k = spot->first; k < spot->end; k++) {
            const Tally *tally = &trial->ledgers[spot->worker].tallies[k];
            tally_add(&trial->cells[i % HALVES][tally->cell], tally, spot->weight);
        }
    }
}

/* Sums the halves that are wanted up the tree. */
static Tally sum_node(Tryout *trial, uint32_t number, const bool wanted[HALVES])
{
    const GuideNode *node = &trial->guide->nodes[number];
    Tally sum = {.cell = 0};
    if (node->axis == GUIDE_LEAF) {
        for (int h = 0; h < HALVES; h++)
            if (wanted[h]) tally_add(&sum, &trial->cells[h][node->first], 1);
    } else {
        for (uint32_t child = 0; child < 2; child++) {
            Tally part = sum_node(trial, node->first + child, wanted);
            tally_add(&sum, &part, 1);
        }
    }
    return trial->nodes[number] = sum;
}

/* What a probe takes, in rays. */
static double probe_cost(const Tally *tally)
{
    return PROBE_COST + (tally->sent > 0 ? tally->rays / tally->sent : 0);
}

static void set_shares(GuideCell *cell, int choice)
{
    cell->share = (float)share_of(choice);
    cell->looks = (float)looks_of(choice);
}

/* What all would take that are sent from there. */
static double cost_of(const Tally *tally, double of_probe, int choice)
{
    return tally->weight * share_of(choice) * of_probe + tally->look_weight * looks_of(choice) * (of_probe + LOOK_COST);
}

/* ---- shares ---- */

/* How variance and work change for all. */
typedef struct Toll {
    double variance, work;
} Toll;

/* The share that makes the product of variance and work least, so far as they change by little. */
static int best_share(const Tally *tally, Toll toll)
{
    int best = 0;
    double most = 0;
    for (int k = N_LOOKS; k < N_CHOICES; k++) {
        double worth = tally->saved[k] / toll.variance - cost_of(tally, probe_cost(tally), k) / toll.work;
        if (worth > most) most = worth, best = k;
    }
    return best;
}

static void choose_below(Tryout *trial, uint32_t number, int share, Toll toll)
{
    const GuideNode *node = &trial->guide->nodes[number];
    if (trial->nodes[number].n_found >= LEAST_FOUND || number == 0) share = best_share(&trial->nodes[number], toll);
    if (node->axis == GUIDE_LEAF) {
        trial->chosen[node->first] = share;
        return;
    }
    choose_below(trial, node->first, share, toll);
    choose_below(trial, node->first + 1, share, toll);
}

/* What the chosen shares do to the paths of one half. */
static Toll change_of(const Tryout *trial, int half)
{
    Toll change = {0, 0};
    double cost = probe_cost(&trial->nodes[0]);
    for (uint32_t i = 0; i < trial->guide->n_cells; i++) {
        const Tally *tally = &trial->cells[half][i];
        change.variance -= tally->saved[trial->chosen[i]];
        change.work += cost_of(tally, cost, trial->chosen[i]) + VISIT_COST * tally->visits;
    }
    return change;
}

/* Without the guide, as the halves say that are wanted, scaled to all paths. */
static Toll balance_without(const Tryout *trial, const Tally *all, double scale)
{
    double variance = trial->variance + scale * all->saved[TRIED];
    return (Toll){fmax(variance, 1e-30), fmax(trial->rays - scale * all->rays, 1)};
}

/* Chooses by some of the paths. */
static void choose_shares(Tryout *trial, const bool wanted[HALVES])
{
    double scale = wanted[0] && wanted[1] ? 1 : HALVES;
    Tally all = sum_node(trial, 0, wanted);
    Toll without = balance_without(trial, &all, scale), toll = without;
    for (int round = 0; round < 6; round++) { /* changes are not small: the balance is that after them */
        choose_below(trial, 0, 0, (Toll){toll.variance / scale, toll.work / scale});
        toll = without;
        for (int h = 0; h < HALVES; h++) {
            if (!wanted[h]) continue;
            Toll change = change_of(trial, h);
            toll.variance = fmax(toll.variance + scale * change.variance, LEAST_LEFT * trial->variance);
            toll.work += scale * change.work;
        }
    }
}

/* The variance that photons promise to take away, roughly and at most: as if all surfaces were white, and each place in
 * a cell got as much as the others. *seen: the same for surfaces as they are. */
static double promised(const Tryout *trial, const Photon *photons, uint32_t followed, double *seen)
{
    double sum = 0;
    *seen = 0;
    for (uint32_t i = 0; i < trial->guide->n_cells; i++) {
        const GuideCell *cell = &trial->guide->cells[i];
        Vec3f size = vec3f_along(cell->high, -1, cell->low);
        float area = float_max(size.x * size.y, float_max(size.y * size.z, size.z * size.x));
        double square = 0;
        for (uint32_t k = trial->guide->begins[i]; k < trial->guide->begins[i + 1]; k++)
            square += (double)photons[k].flux * (double)photons[k].radiance;
        if (!(area > 0)) continue;
        const Tally *a = &trial->cells[0][i], *b = &trial->cells[1][i];
        double promise = square / ((double)followed * (double)(area * SAMPLING_PI)) * (a->carried + b->carried);
        sum += promise;
        *seen += promise * (a->returned + b->returned) / fmax(a->sent + b->sent, 1);
    }
    return sum;
}

/* ---- all of it ---- */

/* By how much the product of variance and work falls. */
static double gain_of(const Tryout *trial, Toll without, Toll first, Toll second)
{
    double variance = without.variance + first.variance + second.variance,
           work = without.work + first.work + second.work;
    return without.variance * without.work / (fmax(variance, LEAST_LEFT * trial->variance) * work);
}

/* A rainbow on a few hundred pixels is met by some ten of the trial's paths, and what photons tell of each of its colours is found
 * by one probe in twenty: then it is no wonder that nothing was found. Where photons promise so much all the same, of surfaces
 * as they are, they are taken at their word: probes cost little where there is a place in hundreds that they are sent from. (What
 * is left of a promise on a black table, where the sun shines through a ball, is 100; of rainbows, on a wall and in haze, it is
 * 5e3 to 5e7.) */
static void trust_photons(Tryout *trial, GuideWorth *worth)
{
    for (uint32_t i = 0; i < trial->guide->n_cells; i++) trial->chosen[i] = N_CHOICES - 1;
    worth->gain = fmax(worth->gain, EVEN_TRUST * worth->promise);
}

static double gain_of_even(Tryout *trial, int choice, Toll without)
{
    for (uint32_t i = 0; i < trial->guide->n_cells; i++) trial->chosen[i] = choice;
    return gain_of(trial, without, change_of(trial, 0), change_of(trial, 1));
}

static void conclude(Tryout *trial, const Photon *photons, uint32_t followed, GuideWorth *worth)
{
    const bool first[HALVES] = {true, false}, second[HALVES] = {false, true}, both[HALVES] = {true, true};
    Guide *guide = trial->guide;
    double seen;
    sum_spots(trial);
    /* one share for all takes no luck for a gain; but in part, where it is little that was found of great brightness */
    Tally all = sum_node(trial, 0, both);
    Toll without = balance_without(trial, &all, 1);
    double even = fmax(gain_of_even(trial, EVEN, without), gain_of_even(trial, EVEN_LOOKS, without));
    /* nor do shares of which one half chooses what the other one judges */
    choose_shares(trial, first);
    Toll change = change_of(trial, 1);
    choose_shares(trial, second);
    worth->gain = fmax(EVEN_TRUST * even, gain_of(trial, without, change_of(trial, 0), change));
    choose_shares(trial, both);
    worth->promise = promised(trial, photons, followed, &seen) / without.variance;
    if (all.n_found == 0 && seen > GUIDE_GREAT_PROMISE * without.variance) trust_photons(trial, worth);
    worth->rays_per_path = without.work / trial->paths;
    double not_dark = NOT_DARK * trial->settings->dark;
    worth->bright = all.lines > 0 ? fmin(BRIGHT_PART * all.lines_squared / all.lines, not_dark) : 0;
    for (uint32_t i = 0; i < guide->n_cells; i++) {
        set_shares(&guide->cells[i], trial->chosen[i]);
        guide->visits[i] = trial->cells[0][i].visits + trial->cells[1][i].visits;
    }
    guide_shares_are_set(guide);
}

static bool prepare(Tryout *trial, unsigned n_threads)
{
    Guide *guide = trial->guide;
    trial->spots = calloc(trial->n_spots, sizeof *trial->spots);
    trial->tracers = tracers_new(&trial->world, n_threads);
    trial->ledgers = calloc(n_threads, sizeof *trial->ledgers);
    trial->nodes = calloc(guide->n_nodes, sizeof *trial->nodes);
    trial->chosen = calloc(guide->n_cells, sizeof *trial->chosen);
    for (int h = 0; h < HALVES; h++) trial->cells[h] = calloc(guide->n_cells, sizeof *trial->cells[h]);
    if (!guide->visits) guide->visits = calloc(guide->n_cells, sizeof *guide->visits);
    if (!trial->spots || !trial->tracers || !trial->ledgers || !trial->nodes || !trial->chosen || !trial->cells[0] ||
        !trial->cells[1] || !guide->visits)
        return false;
    for (unsigned i = 0; i < n_threads; i++) {
        trial->ledgers[i].last = calloc(guide->n_cells, sizeof *trial->ledgers[i].last);
        if (!trial->ledgers[i].last) return false;
    }
    return true;
}

static void trial_clear(Tryout *trial, unsigned n_threads)
{
    for (unsigned i = 0; trial->ledgers && i < n_threads; i++) {
        free(trial->ledgers[i].records);
        free(trial->ledgers[i].tallies);
        free(trial->ledgers[i].last);
    }
    for (int h = 0; h < HALVES; h++) free(trial->cells[h]);
    free(trial->spots);
    tracers_free(trial->tracers, n_threads);
    free(trial->ledgers);
    free(trial->nodes);
    free(trial->chosen);
}

Status guide_try(Guide *guide, const GuideTrial *of, Pool *pool, GuideWorth *worth, Error *error)
{
    unsigned n_threads = pool_threads(pool);
    Tryout trial = {.world = *of->world, .settings = of->settings, .guide = guide};
    uint64_t pixels = (uint64_t)of->settings->width * of->settings->height, spots = of->paths / SPOT_PATHS + 1;
    trial.n_spots = (uint32_t)(spots < pixels ? spots : pixels);
    trial.paths = (double)trial.n_spots * SPOT_PATHS;
    *worth = (GuideWorth){.gain = 1};
    bool out_of_memory = !prepare(&trial, n_threads) || !place_spots(&trial, of->photons);
    if (!out_of_memory) {
        trial.world.guide = guide;
        for (uint32_t i = 0; i < guide->n_cells; i++) set_shares(&guide->cells[i], TRIED);
        guide_shares_are_set(guide);
        for (unsigned i = 0; i < n_threads; i++) trial.tracers[i].ledger = &trial.ledgers[i];
        pool_run(pool, trial.n_spots, look_at_spot, &trial);
        for (unsigned i = 0; i < n_threads; i++) {
            out_of_memory |= trial.ledgers[i].out_of_memory || trial.tracers[i].out_of_memory;
            worth->rays += trial.tracers[i].counters.rays;
        }
        if (!out_of_memory) conclude(&trial, of->photons, of->followed, worth);
    }
    trial_clear(&trial, n_threads);
    return out_of_memory ? fail(error, STATUS_NOMEM, "out of memory while trying what photons are worth") : STATUS_OK;
}
