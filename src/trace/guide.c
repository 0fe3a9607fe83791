/* guide.c - cells of photons that lie near each other, and which lobes are used where.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/guide.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "optics/sampling.h"
#include "trace/guide_fit.h"

/* Cells are halved as long as they hold more photons than this. */
enum { CELL_PHOTONS = 64 };
#define NODE_LEAF 3u

/* Of a binary tree: children stand side by side. */
typedef struct GuideNode {
    float split;
    uint32_t axis;  /* NODE_LEAF: of none */
    uint32_t first; /* child, or the cell of a leaf */
} GuideNode;

/* Lights are small when their radiance is above this many times what an even sky would have that gives the targets as much
 * light as they get; others are found well enough by chance. And less than this part of all light that comes to the
 * targets, landed behind them, is left to chance too. */
#define BRIGHTER 12.0f
#define LEAST_PART 0.002f
/* The expected ratio of variances without and with the guide that is worth its time. */
#define LEAST_GAIN 2.0f
enum { FIRST_ROUND = 1 << 14, ROUND = 1 << 17 };

struct Guide {
    GuideNode *nodes;
    GuideCell *cells;
    GuideLobe *lobes;
    uint32_t n_nodes, n_cells, n_lobes;
};

/* ---- cells ---- */

typedef struct Builder {
    Guide *guide;
    Photon *photons;
    uint32_t *begins;       /* of each cell's photons; the last is the end of all */
    GuideLobe *lobes;       /* GUIDE_CELL_LOBES for each cell */
    float threshold, scale; /* what the photons' flux is to be multiplied with */
    Tracer *tracers;        /* one per thread */
} Builder;

static Vec3f cell_origin(const GuideCell *cell)
{
    return vec3f_scale(vec3f_add(cell->low, cell->high), 0.5f);
}

static float coordinate(Vec3f p, uint32_t axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* Reorders photons so that number `middle` along an axis stands at its place (C. A. R. Hoare's selection). */
static void select_middle(Photon *photons, uint32_t n, uint32_t middle, uint32_t axis)
{
    uint32_t low = 0, high = n - 1;
    while (low < high) {
        float pivot = coordinate(photons[low + (high - low) / 2].position, axis);
        uint32_t i = low, j = high;
        for (;;) {
            while (coordinate(photons[i].position, axis) < pivot) i++;
            while (coordinate(photons[j].position, axis) > pivot) j--;
            if (i >= j) break;
            Photon swap = photons[i];
            photons[i++] = photons[j];
            photons[j--] = swap;
        }
        if (middle <= j)
            high = j;
        else
            low = j + 1;
    }
}

static void bounds_of(const Photon *photons, uint32_t n, Vec3f *low, Vec3f *high)
{
    *low = *high = photons[0].position;
    for (uint32_t i = 1; i < n; i++) {
        Vec3f p = photons[i].position;
        *low = vec3f(float_min(low->x, p.x), float_min(low->y, p.y), float_min(low->z, p.z));
        *high = vec3f(float_max(high->x, p.x), float_max(high->y, p.y), float_max(high->z, p.z));
    }
}

static void make_cell(Builder *b, uint32_t node, uint32_t begin, Vec3f low, Vec3f high)
{
    Guide *guide = b->guide;
    Vec3f size = vec3f_along(high, -1, low);
    /* beyond its photons a cell is known as far as these are from each other */
    float margin = 0.15f * float_max(size.x, float_max(size.y, size.z));
    Vec3f more = vec3f(margin, margin, margin);
    b->begins[guide->n_cells] = begin;
    guide->cells[guide->n_cells] = (GuideCell){
        .low = vec3f_along(low, -1, more),
        .high = vec3f_add(high, more),
    };
    guide->nodes[node] = (GuideNode){.axis = NODE_LEAF, .first = guide->n_cells++};
}

static void make_node(Builder *b, uint32_t node, uint32_t begin, uint32_t end)
{
    Guide *guide = b->guide;
    uint32_t n = end - begin;
    Vec3f low, high;
    bounds_of(b->photons + begin, n, &low, &high);
    Vec3f size = vec3f_along(high, -1, low);
    uint32_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (n <= CELL_PHOTONS || !(coordinate(size, axis) > 0)) {
        make_cell(b, node, begin, low, high);
        return;
    }
    uint32_t half = n / 2, child = guide->n_nodes;
    select_middle(b->photons + begin, n, half, axis);
    guide->n_nodes += 2;
    guide->nodes[node] = (GuideNode){coordinate(b->photons[begin + half].position, axis), axis, child};
    make_node(b, child, begin, begin + half);
    make_node(b, child + 1, begin + half, end);
}

/* What the cell's place gets from other lights than those that the guide is for, as irradiance. */
static float other_light(const Builder *b, Tracer *tracer, const Photon *photons, uint32_t n, uint32_t number)
{
    enum { LOOKS = 8 };
    float sum = 0;
    for (uint32_t i = 0; i < LOOKS; i++) {
        const Photon *photon = &photons[(size_t)n * i / LOOKS];
        sum += photon_other_light(tracer, photon->position, photon->normal, b->threshold, LOOKS * number + i);
    }
    return sum / LOOKS;
}

/* Photons that the lobes are not made of are described worse than those that they are; and of other light part is found by
 * looking for it, whatever the directions are. */
#define OTHERS 0.3f
#define REST 0.3f
/* Of the guide's light, what comes from things near by that it lights. */
#define AROUND 0.25f

/* How many of the directions should be the guide's: so many that the noise is least. A sample's square has the expectation
 * of the photons' radiance times the flux of all of them, by the density with which their directions are chosen, beside
 * that of other light, of which the surface's own directions are taken to find all alike. */
static void choose_share(const Builder *b, Tracer *tracer, GuideCell *cell, const GuideLobe *lobes,
                         const Photon *photons, uint32_t n, uint32_t number)
{
    const float shares[] = {0, 0.05f, 0.1f, 0.2f, 0.35f, 0.5f, 0.65f, 0.75f};
    Vec3f low, high;
    bounds_of(photons, n, &low, &high);
    Vec3f size = vec3f_along(high, -1, low);
    float area = float_max(float_max(size.x * size.y, float_max(size.y * size.z, size.z * size.x)), 1e-30f);
    float sums[COUNT_OF(shares)] = {0}, flux = 0;
    bool in_medium = false;
    for (uint32_t i = 0; i < n; i++) {
        const Photon *photon = &photons[i];
        float surface = float_max(vec3f_dot(photon->normal, photon->from), 0.01f) / SAMPLING_PI, guide = 0;
        if (vec3f_dot(photon->normal, photon->normal) == 0) in_medium = true, surface = 1 / (4 * SAMPLING_PI);
        Vec3f offset = vec3f_along(photon->position, -1, cell_origin(cell));
        flux += photon->flux * b->scale;
        for (uint32_t k = 0; k < cell->n_lobes; k++)
            guide += lobes[k].weight * guide_lobe_pdf(&lobes[k], offset, photon->from);
        for (size_t k = 0; k < COUNT_OF(shares); k++)
            sums[k] += photon->flux * b->scale * photon->radiance * surface /
                       (shares[k] * OTHERS * guide + (1 - shares[k]) * surface);
    }
    float other = in_medium ? 0 : other_light(b, tracer, photons, n, number);
    float mean = (flux / area + other) / SAMPLING_PI, spread = (other + AROUND * flux / area) / SAMPLING_PI;
    cell->after = INFINITY;
    for (size_t k = 0; k < COUNT_OF(shares); k++) {
        float noise = (sums[k] / (area * SAMPLING_PI) + REST * spread * spread / (1 - shares[k])) /
                      float_max(mean * mean, 1e-30f);
        if (k == 0) cell->before = noise;
        if (k > 0 && noise < cell->after) cell->after = noise, cell->share = shares[k];
    }
    if (in_medium) cell->share = 0.5f; /* where little is known of the rest */
}

static void fit_cell(void *context, uint32_t i, unsigned worker)
{
    Builder *b = context;
    GuideCell *cell = &b->guide->cells[i];
    const Photon *photons = b->photons + b->begins[i];
    uint32_t n = b->begins[i + 1] - b->begins[i];
    GuideLobe *lobes = b->lobes + (size_t)i * GUIDE_CELL_LOBES;
    cell->n_lobes = guide_fit(photons, n, cell_origin(cell), lobes);
    choose_share(b, &b->tracers[worker], cell, lobes, photons, n, i);
}

/* Moves the cells' lobes together. */
static void gather_lobes(Builder *b)
{
    Guide *guide = b->guide;
    for (uint32_t i = 0; i < guide->n_cells; i++) {
        GuideCell *cell = &guide->cells[i];
        cell->first_lobe = guide->n_lobes;
        memmove(b->lobes + guide->n_lobes, b->lobes + (size_t)i * GUIDE_CELL_LOBES, cell->n_lobes * sizeof *b->lobes);
        guide->n_lobes += cell->n_lobes;
    }
    GuideLobe *fewer = realloc(b->lobes, guide->n_lobes * sizeof *fewer);
    guide->lobes = fewer ? fewer : b->lobes;
}

static Status alloc_cells(Builder *b, uint32_t n, Error *error)
{
    /* what is halved had more than CELL_PHOTONS, so that each cell has at least half as many */
    size_t most = 2 * ((size_t)n / CELL_PHOTONS) + 2;
    Guide *guide = b->guide;
    guide->nodes = malloc(2 * most * sizeof *guide->nodes);
    guide->cells = malloc(most * sizeof *guide->cells);
    b->begins = malloc((most + 1) * sizeof *b->begins);
    if (!guide->nodes || !guide->cells || !b->begins)
        return fail_memory(error, most * sizeof *guide->cells, "caustics");
    guide->n_nodes = 1;
    make_node(b, 0, 0, n);
    b->begins[guide->n_cells] = n;
    b->lobes = malloc((size_t)guide->n_cells * GUIDE_CELL_LOBES * sizeof *b->lobes);
    if (!b->lobes) return fail_memory(error, (size_t)guide->n_cells * GUIDE_CELL_LOBES * sizeof *b->lobes, "caustics");
    return STATUS_OK;
}

Status guide_from_photons(const World *world, float threshold, Photon *photons, uint32_t n, uint32_t followed,
                          Pool *pool, Guide **out, Error *error)
{
    *out = NULL;
    if (n == 0) return STATUS_OK;
    unsigned n_threads = pool_threads(pool);
    Guide *guide = calloc(1, sizeof *guide);
    Builder b = {guide, photons, NULL, NULL, threshold, 1 / (float)followed, calloc(n_threads, sizeof(Tracer))};
    Status status = guide && b.tracers ? alloc_cells(&b, n, error) : fail_memory(error, sizeof *guide, "caustics");
    if (status == STATUS_OK) {
        for (unsigned i = 0; i < n_threads; i++) tracer_init(&b.tracers[i], world);
        pool_run(pool, guide->n_cells, fit_cell, &b);
        for (unsigned i = 0; i < n_threads; i++) tracer_clear(&b.tracers[i]);
        gather_lobes(&b);
        *out = guide;
    } else {
        guide_free(guide);
    }
    free(b.tracers);
    free(b.begins);
    return status;
}

void guide_free(Guide *guide)
{
    if (!guide) return;
    free(guide->nodes);
    free(guide->cells);
    free(guide->lobes);
    free(guide);
}

/* Photons as they are followed, round by round. */
typedef struct Harvest {
    Photon *landed;
    size_t n, capacity;
    uint32_t followed;
    double flux; /* of all, times those followed */
} Harvest;

static Status follow_round(Harvest *harvest, const World *world, const PhotonTargets *targets, float threshold,
                           uint32_t seed, uint32_t n, Pool *pool, Error *error)
{
    if (!array_reserve(&harvest->landed, &harvest->capacity, harvest->n + n, sizeof *harvest->landed))
        return fail_memory(error, (harvest->n + n) * sizeof *harvest->landed, "photons");
    Photon *photons = harvest->landed + harvest->n;
    TRY(photons_trace(world, targets, threshold, seed, harvest->followed, n, pool, photons, error));
    harvest->followed += n;
    for (uint32_t i = 0; i < n; i++) {
        if (!(photons[i].flux > 0)) continue;
        harvest->flux += (double)photons[i].flux;
        harvest->landed[harvest->n++] = photons[i];
    }
    return STATUS_OK;
}

/* By how much less noise the guide is expected to make, as a ratio of variances. */
static float gain_of(const Guide *guide)
{
    double before = 0, after = 0;
    for (uint32_t i = 0; i < guide->n_cells; i++) {
        before += (double)guide->cells[i].before;
        after += (double)guide->cells[i].after;
    }
    return after > 0 ? (float)(before / after) : 0;
}

/* Whether the first photons promise anything. */
static Status is_worth_while(const Harvest *harvest, const World *world, float flux, float threshold, Pool *pool,
                             bool *worth, Error *error)
{
    *worth = harvest->flux > (double)(LEAST_PART * flux) * harvest->followed;
    if (!*worth) return STATUS_OK;
    Guide *guide;
    TRY(guide_from_photons(world, threshold, harvest->landed, (uint32_t)harvest->n, harvest->followed, pool, &guide,
                           error));
    *worth = guide && gain_of(guide) > LEAST_GAIN;
    guide_free(guide);
    return STATUS_OK;
}

static Status follow_photons(Harvest *harvest, const World *world, const GuideSettings *settings, float *threshold,
                             Pool *pool, Error *error)
{
    PhotonTargets targets;
    photon_targets(world, &targets);
    if (targets.n == 0 || world->n_choices == 0) return STATUS_OK;
    float flux = photon_flux(world, &targets), area = (float)targets.cumulative[targets.n - 1];
    if (!(flux > 0) || !(area > 0)) return STATUS_OK;
    *threshold = (settings->always ? 1 : BRIGHTER) * flux / (area * SAMPLING_PI);
    bool worth = true;
    while (worth && harvest->n < settings->photons && harvest->followed < settings->most_photons) {
        bool first = !harvest->followed;
        uint32_t n = first ? FIRST_ROUND : ROUND;
        if (n > settings->most_photons - harvest->followed) n = settings->most_photons - harvest->followed;
        TRY(follow_round(harvest, world, &targets, *threshold, settings->seed, n, pool, error));
        if (first && !settings->always) TRY(is_worth_while(harvest, world, flux, *threshold, pool, &worth, error));
        if (settings->stop && *settings->stop) worth = false;
    }
    if (!worth) harvest->n = 0;
    return STATUS_OK;
}

Status guide_new(const World *world, const GuideSettings *settings, Pool *pool, Guide **guide, GuideStats *stats,
                 Error *error)
{
    *guide = NULL;
    *stats = (GuideStats){0};
    Harvest harvest = {0};
    float threshold = 0;
    Status status = follow_photons(&harvest, world, settings, &threshold, pool, error);
    if (status == STATUS_OK)
        status = guide_from_photons(world, threshold, harvest.landed, (uint32_t)harvest.n, harvest.followed, pool,
                                    guide, error);
    free(harvest.landed);
    stats->followed = harvest.followed;
    if (!*guide) return status;
    stats->landed = harvest.n;
    stats->lobes = (*guide)->n_lobes;
    stats->bytes = (*guide)->n_nodes * sizeof(GuideNode) + (*guide)->n_cells * sizeof(GuideCell) +
                   (*guide)->n_lobes * sizeof(GuideLobe);
    return status;
}

/* ---- use ---- */

GuideAt guide_find(const Guide *guide, Vec3 place)
{
    Vec3f p = vec3f_from(place);
    const GuideNode *node = guide->nodes;
    while (node->axis != NODE_LEAF) node = guide->nodes + node->first + (coordinate(p, node->axis) >= node->split);
    const GuideCell *cell = &guide->cells[node->first];
    if (p.x < cell->low.x || p.y < cell->low.y || p.z < cell->low.z || p.x > cell->high.x || p.y > cell->high.y ||
        p.z > cell->high.z)
        return (GuideAt){.share = 0};
    return (GuideAt){guide, cell, vec3f_along(p, -1, cell_origin(cell)), cell->share};
}

Vec3f guide_sample(const GuideAt *at, float u, const float v[2])
{
    const GuideLobe *lobes = at->guide->lobes + at->cell->first_lobe;
    uint32_t i = 0;
    while (i + 1 < at->cell->n_lobes && u >= lobes[i].cumulative) i++;
    return guide_lobe_sample(&lobes[i], at->offset, v);
}

float guide_pdf(const GuideAt *at, Vec3f direction)
{
    const GuideLobe *lobes = at->guide->lobes + at->cell->first_lobe;
    float sum = 0;
    for (uint32_t i = 0; i < at->cell->n_lobes; i++)
        sum += lobes[i].weight * guide_lobe_pdf(&lobes[i], at->offset, direction);
    return sum;
}
