/* guide_build.c - cells of photons that lie near each other, and which lobes are used where.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "optics/sampling.h"
#include "trace/guide_parts.h"

/* A leaf of the tree. */
typedef struct Leaf {
    Vec3f low, high; /* where it ends, as far as others are beside it */
    uint32_t first;  /* of its known photons */
} Leaf;

typedef struct Builder {
    Guide *guide;
    Photon *photons;  /* sorted by cell */
    Photon *known;    /* those that lobes are made of, sorted by cell */
    Leaf *leaves;     /* of all cells, and one that begins where the last one's photons end */
    GuideFour *fours; /* GUIDE_CELL_FOURS for each cell */
    float scale;      /* what the photons' flux is to be multiplied with */
    uint32_t n_apart; /* cells that are not of boundaries, or all: they come first */
} Builder;

/* ---- the tree ---- */

static void swap_photons(Photon *a, Photon *b)
{
    Photon swap = *a;
    *a = *b;
    *b = swap;
}

/* Reorders photons so that number `middle` along an axis stands at its place (C. A. R. Hoare's selection). */
static void select_middle(Photon *photons, uint32_t n, uint32_t middle, uint32_t axis)
{
    uint32_t low = 0, high = n - 1;
    while (low < high) {
        float pivot = guide_coordinate(photons[low + (high - low) / 2].position, axis);
        uint32_t i = low, j = high;
        for (;;) {
            while (guide_coordinate(photons[i].position, axis) < pivot) i++;
            while (guide_coordinate(photons[j].position, axis) > pivot) j--;
            if (i >= j) break;
            swap_photons(&photons[i++], &photons[j--]);
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

/* Along an axis of the tree; GUIDE_KIND: 1 on boundaries, else 0. */
static float coordinate_of(const Photon *photon, uint32_t axis)
{
    return axis == GUIDE_KIND ? (float)photon->at_boundary : guide_coordinate(photon->position, axis);
}

/* Puts photons below a split first; returns how many they are. */
static uint32_t put_below_first(Photon *photons, uint32_t n, float split, uint32_t axis)
{
    uint32_t below = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!(coordinate_of(&photons[i], axis) < split)) continue;
        swap_photons(&photons[i], &photons[below++]);
    }
    return below;
}

/* Splits photons near their middle along an axis; returns how many come first, 1 .. n - 1. All that have one coordinate, as those
 * on a floor do, stay on one side: guide_leaf leads all of them there. */
static uint32_t split_photons(Photon *photons, uint32_t n, uint32_t axis, float *split)
{
    uint32_t below = 0, level = 0;
    select_middle(photons, n, n / 2, axis);
    float middle = guide_coordinate(photons[n / 2].position, axis), above = INFINITY;
    for (uint32_t i = 0; i < n; i++) {
        float coordinate = guide_coordinate(photons[i].position, axis);
        below += coordinate < middle;
        level += coordinate == middle;
        if (coordinate > middle) above = float_min(above, coordinate);
    }
    *split = middle;
    if (level == n) return n / 2; /* all at one place: half of them are not found again */
    if (below == 0 || (below + level < n && below + level - n / 2 < n / 2 - below)) *split = above;
    return put_below_first(photons, n, *split, axis);
}

static void set_coordinate(Vec3f *p, uint32_t axis, float to)
{
    *(axis == 0 ? &p->x : axis == 1 ? &p->y : &p->z) = to;
}

static void make_node(Builder *b, uint32_t node, uint32_t begin, uint32_t end, Leaf region)
{
    Guide *guide = b->guide;
    uint32_t n = end - begin;
    Vec3f low, high;
    bounds_of(b->known + begin, n, &low, &high);
    Vec3f size = vec3f_along(high, -1, low);
    uint32_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (n <= GUIDE_CELL_KNOWN) {
        region.first = begin;
        b->leaves[guide->n_cells] = region;
        guide->nodes[node] = (GuideNode){.axis = GUIDE_LEAF, .first = guide->n_cells++};
        return;
    }
    float split;
    uint32_t middle = begin + split_photons(b->known + begin, n, axis, &split), child = guide->n_nodes;
    guide->n_nodes += 2;
    guide->nodes[node] = (GuideNode){split, axis, child};
    Leaf below = region, above = region;
    set_coordinate(&below.high, axis, split);
    set_coordinate(&above.low, axis, split);
    make_node(b, child, begin, middle, below);
    make_node(b, child + 1, middle, end, above);
}

static void make_root(Builder *b, uint32_t n)
{
    Guide *guide = b->guide;
    uint32_t others = put_below_first(b->known, n, 0.5f, GUIDE_KIND);
    const Leaf all = {.low = {-INFINITY, -INFINITY, -INFINITY}, .high = {INFINITY, INFINITY, INFINITY}};
    guide->n_nodes = 1;
    if (others == 0 || others == n) {
        make_node(b, 0, 0, n, all);
        b->n_apart = guide->n_cells;
        return;
    }
    guide->nodes[0] = (GuideNode){.axis = GUIDE_KIND, .first = 1};
    guide->n_nodes += 2;
    make_node(b, 1, 0, others, all);
    b->n_apart = guide->n_cells;
    make_node(b, 2, others, n, all);
}

/* Sorts all photons by the cell that they are in. */
static Status sort_by_cell(Builder *b, uint32_t n, Error *error)
{
    uint32_t n_cells = b->guide->n_cells, *cell_of = malloc(n * sizeof *cell_of);
    Photon *sorted = malloc(n * sizeof *sorted);
    b->guide->begins = calloc((size_t)n_cells + 2, sizeof *b->guide->begins);
    Status status = STATUS_OK;
    if (cell_of && sorted && b->guide->begins) {
        for (uint32_t i = 0; i < n; i++)
            b->guide
                ->begins[(cell_of[i] = guide_leaf(b->guide, b->photons[i].position, b->photons[i].at_boundary)) + 2]++;
        for (uint32_t i = 1; i <= n_cells; i++) b->guide->begins[i + 1] += b->guide->begins[i];
        for (uint32_t i = 0; i < n; i++) sorted[b->guide->begins[cell_of[i] + 1]++] = b->photons[i];
        memcpy(b->photons, sorted, n * sizeof *sorted);
    } else {
        status = fail_memory(error, n * sizeof *sorted, "photons");
    }
    free(cell_of);
    free(sorted);
    return status;
}

static Status make_tree(Builder *b, uint32_t n, Error *error)
{
    Guide *guide = b->guide;
    size_t n_known = 0;
    for (uint32_t i = 0; i < n; i++) n_known += b->photons[i].lobe;
    guide->nodes = malloc(2 * n_known * sizeof *guide->nodes); /* each cell has at least one */
    b->known = malloc(n_known * sizeof *b->known);
    b->leaves = malloc((n_known + 1) * sizeof *b->leaves);
    if (!guide->nodes || !b->known || !b->leaves) return fail_memory(error, n_known * sizeof *b->known, "caustics");
    n_known = 0;
    for (uint32_t i = 0; i < n; i++)
        if (b->photons[i].lobe) b->known[n_known++] = b->photons[i];
    make_root(b, (uint32_t)n_known);
    b->leaves[guide->n_cells] = (Leaf){.first = (uint32_t)n_known};
    TRY(sort_by_cell(b, n, error));
    guide->cells = calloc(guide->n_cells, sizeof *guide->cells);
    b->fours = malloc((size_t)guide->n_cells * GUIDE_CELL_FOURS * sizeof *b->fours);
    if (!guide->cells || !b->fours)
        return fail_memory(error, (size_t)guide->n_cells * GUIDE_CELL_FOURS * sizeof *b->fours, "caustics");
    return STATUS_OK;
}

/* ---- cells ---- */

/* The area that a cell's photons are spread over; 0 of one, or of a row. */
static float cell_area(const Photon *photons, uint32_t n)
{
    Vec3f low, high;
    bounds_of(photons, n, &low, &high);
    Vec3f size = vec3f_along(high, -1, low);
    return float_max(size.x * size.y, float_max(size.y * size.z, size.z * size.x));
}

/* What lands in the cells before and behind one in the tree, which mostly are beside it. Of many lamps, or of many ways, few photons
 * say too little of each. */
static void look_near(const Builder *b, uint32_t i, GuidePhotons *photons)
{
    enum { NEAR_CELLS = 4 };
    const uint32_t *begins = b->guide->begins;
    uint32_t least = i < b->n_apart ? 0 : b->n_apart, end = i < b->n_apart ? b->n_apart : b->guide->n_cells;
    uint32_t first = i - least > NEAR_CELLS ? i - NEAR_CELLS : least,
             last = end - i > NEAR_CELLS ? i + NEAR_CELLS : end - 1;
    photons->near[0].photons = b->photons + begins[first];
    photons->near[0].n = begins[i] - begins[first];
    photons->near[1].photons = b->photons + begins[i + 1];
    photons->near[1].n = begins[last + 1] - begins[i + 1];
    photons->near_part = last > first ? 1.0f / (float)(last - first) : 0;
}

/* Lobes of a cell, by what is known there and in cells near by, which the tree has near by, too. */
static void fit_lobes(const Builder *b, uint32_t i, GuidePhotons *photons)
{
    enum { FARTHEST_LENDER = 512 };
    look_near(b, i, photons);
    GuideCell *cell = &b->guide->cells[i];
    uint32_t begin = b->leaves[i].first, end = b->leaves[i + 1].first, n_all = b->leaves[b->guide->n_cells].first;
    for (uint32_t k = begin; k < end; k++) photons->known[photons->n_known++].photon = &b->known[k];
    begin = begin > FARTHEST_LENDER ? begin - FARTHEST_LENDER : 0;
    end = n_all - end > FARTHEST_LENDER ? end + FARTHEST_LENDER : n_all;
    guide_borrow(photons, b->known + begin, end - begin);
    for (uint32_t k = 0; k < photons->n_known; k++) {
        const Photon *known = photons->known[k].photon;
        if (known->hue[0] != 0 || known->hue[1] != 0) cell->parts_colors = 1;
    }
    GuideLobe lobes[GUIDE_CELL_LOBES];
    cell->n_lobes = guide_fit(photons, lobes);
    guide_lay_in_fours(lobes, cell->n_lobes, b->fours + (size_t)i * GUIDE_CELL_FOURS);
}

/* How far from its photons, which end at `end`, a cell is known along an axis: as far as these are from each other; or up to where
 * another cell begins, for between them there is light as well, if that is not far. (Few photons leave gaps: the wall behind a lamp in
 * frosted glass had narrow dark rectangles, where no probes were sent.) margin: the first of these; outwards: -1 or 1. */
static float known_up_to(float end, float leaf, float outwards, float margin)
{
    const float not_far = 4; /* margins */
    float gap = outwards * (leaf - end);
    return end + outwards * (gap <= not_far * margin ? float_max(gap, margin) : margin);
}

static void set_bounds(const Leaf *leaf, const Photon *photons, uint32_t n, GuideCell *cell)
{
    Vec3f low, high;
    bounds_of(photons, n, &low, &high);
    Vec3f size = vec3f_along(high, -1, low);
    float margin = 0.15f * float_max(size.x, float_max(size.y, size.z));
    for (uint32_t axis = 0; axis < 3; axis++) {
        float below = guide_coordinate(low, axis), above = guide_coordinate(high, axis);
        set_coordinate(&cell->low, axis, known_up_to(below, guide_coordinate(leaf->low, axis), -1, margin));
        set_coordinate(&cell->high, axis, known_up_to(above, guide_coordinate(leaf->high, axis), 1, margin));
    }
}

/* What media scatter in the cell, and its colour. */
static void find_scattered(GuideCell *cell, const Photon *photons, uint32_t n, float scale)
{
    const float at_least = 0.05f; /* that few photons do not say that there are no others */
    Vec3f size = vec3f_along(cell->high, -1, cell->low);
    float volume = size.x * size.y * size.z, sum = 0, of_color = 0, of_square = 0;
    for (uint32_t k = 0; k < n; k++) {
        const Photon *photon = &photons[k];
        if (vec3f_dot(photon->normal, photon->normal) > 0) continue;
        float flux = photon_flux_there(photon);
        sum += flux;
        of_color += flux * photon->color;
        of_square += flux * photon->color * photon->color;
    }
    cell->scattered = volume > 0 && isfinite(sum * scale / volume) ? sum * scale / volume : 0;
    if (!(cell->scattered > 0)) return;
    cell->color = of_color / sum;
    cell->color_spread = sqrtf(float_max(of_square / sum - cell->color * cell->color, 0)) + at_least;
}

static void fit_cell(void *context, uint32_t i, unsigned worker)
{
    (void)worker;
    Builder *b = context;
    GuideCell *cell = &b->guide->cells[i];
    const Photon *photons = b->photons + b->guide->begins[i];
    uint32_t n = b->guide->begins[i + 1] - b->guide->begins[i];
    if (n == 0) { /* all that it was made for stand on its border */
        cell->low = vec3f(INFINITY, INFINITY, INFINITY);
        return;
    }
    float flux = 0;
    set_bounds(&b->leaves[i], photons, n, cell);
    cell->share = cell->looks = 0.5f;
    for (uint32_t k = 0; k < n; k++) flux += photon_flux_there(&photons[k]) * b->scale;
    find_scattered(cell, photons, n, b->scale);
    float area = cell_area(photons, n);
    cell->radiance = area > 0 ? flux / area / SAMPLING_PI : 0;
    fit_lobes(b, i, &(GuidePhotons){.photons = photons, .n = n, .origin = guide_cell_origin(cell)});
}

static GuidePlace place_in(const GuideCell *cell, const Photon *photon)
{
    return (GuidePlace){vec3f_along(photon->position, -1, guide_cell_origin(cell)), photon->color};
}

/* How well the lobes foresee other photons: the geometric mean of what they say of the directions of those that are on surfaces. Where
 * light comes from rough glass, what each photon says of its neighbourhood is true of one way through the facets only, and others
 * come in other directions. */
static void find_keenness(void *context, uint32_t i, unsigned worker)
{
    enum { MOST = 32 };
    (void)worker;
    const Builder *b = context;
    GuideCell *cell = &b->guide->cells[i];
    double sum = 0;
    uint32_t n = 0;
    for (uint32_t k = b->guide->begins[i]; k < b->guide->begins[i + 1] && n < MOST; k++) {
        const Photon *photon = &b->photons[k];
        if (photon->lobe || vec3f_dot(photon->normal, photon->normal) == 0) continue;
        const GuideFour *fours = b->guide->fours + cell->first_four;
        sum += log((double)guide_lobes_pdf(fours, cell->n_lobes, place_in(cell, photon), photon->from));
        n++;
    }
    cell->keenness = n > 0 ? (float)exp(sum / n) : 0;
}

/* Moves the cells' lobes together. */
static void gather_lobes(Builder *b)
{
    Guide *guide = b->guide;
    for (uint32_t i = 0; i < guide->n_cells; i++) {
        GuideCell *cell = &guide->cells[i];
        uint32_t n = guide_fours_of(cell->n_lobes);
        cell->first_four = guide->n_fours;
        memmove(b->fours + guide->n_fours, b->fours + (size_t)i * GUIDE_CELL_FOURS, n * sizeof *b->fours);
        guide->n_fours += n;
        guide->n_lobes += cell->n_lobes;
    }
    GuideFour *fewer = realloc(b->fours, guide->n_fours * sizeof *fewer);
    guide->fours = fewer ? fewer : b->fours;
    b->fours = NULL;
    GuideNode *nodes = realloc(guide->nodes, guide->n_nodes * sizeof *nodes);
    guide->nodes = nodes ? nodes : guide->nodes;
}

Status guide_build(Photon *photons, uint32_t n, uint32_t followed, Pool *pool, Guide **out, Error *error)
{
    *out = NULL;
    Guide *guide = calloc(1, sizeof *guide);
    if (!guide) return fail_memory(error, sizeof *guide, "caustics");
    Builder b = {.guide = guide, .photons = photons, .scale = 1 / (float)followed};
    Status status = make_tree(&b, n, error);
    if (status == STATUS_OK) {
        pool_run(pool, guide->n_cells, fit_cell, &b);
        gather_lobes(&b);
        pool_run(pool, guide->n_cells, find_keenness, &b);
        guide_shares_are_set(guide);
        status = guide_set_boxes(guide, error);
    }
    if (status == STATUS_OK) {
        *out = guide;
    } else {
        free(b.fours);
        guide_free(guide);
    }
    free(b.known);
    free(b.leaves);
    return status;
}

/* ---- what is foreseen ---- */

static float surface_pdf(const Photon *photon)
{
    if (vec3f_dot(photon->normal, photon->normal) == 0) return 1 / (4 * SAMPLING_PI);
    return float_max(vec3f_dot(photon->normal, photon->from), 0.01f) / SAMPLING_PI;
}

float guide_sample_of(const Guide *guide, uint32_t number, float share, const Photon *photon)
{
    const GuideCell *cell = &guide->cells[number];
    const Turns turns = {photon->turns, TURNS_TOLD, lanes_all(photon->chance)};
    Leads leads;
    guide_lobes_leads(guide->fours + cell->first_four, cell->n_lobes, place_in(cell, photon), photon->from, &leads);
    float surface = surface_pdf(photon);
    return photon->radiance * surface / (share * leads_lift(&leads, &turns) + surface);
}
