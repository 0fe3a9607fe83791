/* spread_far.c - samples that are spread far over things that are large: by cells of four times four pixels, as what comes of
 * them hardly differs from one cell to the next. They are most of the work otherwise, as a disc has the square of its radius.
 * Each cell has a point at its middle. What a pixel gets is between what is found for the points around it, which makes it
 * smooth (bilinear interpolation); and what counts for a point is what pixels add to it by these same parts, so that all that a
 * sample gives is what pixels get together, to rounding.
 * How pixels share in a sample depends on how much light is usual where it is: that is taken to be the nearest power of the square root
 * of two, its level, so that those of one level and thing have the same weights for all cells.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "render/spread_density.h"
#include "render/spread_maps.h"

enum { SIDE = 4, CHUNK = 16 /* samples that a thread takes at once */, BAND = 4 /* rows of cells */, LEVELS = 200 };

/* What comes of samples of one level, at a cell's point. */
typedef struct Gift {
    double even[3], usual[3]; /* for each share, and for each share times usual(): see below */
    double squares[3];        /* of the square of the standard error, for the square of a share, by powers of usual() */
} Gift;

/* Of the box around a thing. */
typedef struct Cells {
    const Maps *maps;
    uint32_t thing;
    ThingBox box;
    uint32_t width, height;   /* in cells */
    double scale;             /* of light, by the level */
    const FarSample *samples; /* of the level */
    size_t n_samples;
    /* Of each cell: its pixels' shares in the thing; these times usual(), and times the fourth root of what is plain */
    double *even, *usual, *light;
    /* Those samples that the thing's pixels keep, the brightest first: of cell i from first[i] up to but without first[i + 1] */
    size_t *first;
    float *lights;
    Densities densities; /* of these samples */
    Gift *gifts;
} Cells;

/* Which points a row or column of pixels is between: one + part * (other - one). */
typedef struct Between {
    uint32_t one, other;
    double part;
} Between;

static Between between(uint32_t offset, uint32_t n)
{
    uint32_t other = (offset + SIDE / 2) / SIDE, one = other > 0 ? other - 1 : 0;
    return (Between){one, other < n ? other : n - 1, ((offset + SIDE / 2) % SIDE + 0.5) / SIDE};
}

static double usual(const Cells *cells, double lit)
{
    double light = lit * cells->scale;
    return light < 1 ? light : 1;
}

static double share_of(const Cells *cells, size_t pixel)
{
    const Looks *looks = &cells->maps->looks;
    uint32_t which = find_thing(looks, pixel, cells->thing);
    return which < BRIGHT_THINGS ? (double)looks->shares[which][pixel] : 0;
}

/* ---- what cells have ---- */

static void add_pixels(const Cells *cells, uint32_t y, double part, uint32_t row)
{
    const ThingBox *box = &cells->box;
    size_t pixel = place_in(cells->maps, box->x0, y), first = (size_t)row * cells->width;
    for (uint32_t x = 0; x < box->x1 - box->x0; x++, pixel++) {
        double share = part * share_of(cells, pixel), root = (double)cells->maps->looks.plain_root[pixel];
        if (!(share > 0)) continue;
        Between columns = between(x, cells->width);
        const size_t at[2] = {first + columns.one, first + columns.other};
        const double parts[2] = {share * (1 - columns.part), share * columns.part};
        double by_usual = usual(cells, (double)cells->maps->looks.lit[pixel]);
        for (int k = 0; k < 2; k++) {
            cells->even[at[k]] += parts[k];
            cells->usual[at[k]] += parts[k] * by_usual;
            cells->light[at[k]] += parts[k] * root;
        }
    }
}

static void add_up_row(void *context, uint32_t row, unsigned worker)
{
    const Cells *cells = context;
    double *const sums[] = {cells->even, cells->usual, cells->light};
    uint32_t height = cells->box.y1 - cells->box.y0;
    (void)worker;
    for (size_t k = 0; k < COUNT_OF(sums); k++)
        for (uint32_t i = 0; i < cells->width; i++) sums[k][(size_t)row * cells->width + i] = 0;
    for (uint32_t y = row > 0 ? row * SIDE - SIDE / 2 : 0; y < height && y < row * SIDE + SIDE + SIDE / 2; y++) {
        Between rows = between(y, cells->height);
        double part = (rows.one == row ? 1 - rows.part : 0) + (rows.other == row ? rows.part : 0);
        add_pixels(cells, cells->box.y0 + y, part, row);
    }
}

/* The lights of a pixel's samples of the thing that have few alike there; how many. lights: NULL, or room for them. */
static uint32_t lights_of_pixel(const Cells *cells, uint32_t x, uint32_t y, float *lights)
{
    const Looks *looks = &cells->maps->looks;
    size_t pixel = place_in(cells->maps, x, y);
    uint32_t thing = find_thing(looks, pixel, cells->thing), seen = looks->seen[pixel], n = 0;
    for (int i = 0; thing < BRIGHT_THINGS && i < BRIGHT_KEPT && looks->lights[pixel][i] > 0; i++) {
        if (bright_seen_of(seen, i) != thing || !(looks->few[pixel] >> i & 1)) continue;
        if (lights) lights[n] = looks->lights[pixel][i];
        n++;
    }
    return n;
}

static int brighter_first(const void *left, const void *right)
{
    const float *a = left, *b = right;
    return (*a < *b) - (*a > *b);
}

static size_t lights_of_cell(const Cells *cells, uint32_t column, uint32_t row, float *lights)
{
    const ThingBox *box = &cells->box;
    uint32_t x0 = box->x0 + column * SIDE, y0 = box->y0 + row * SIDE;
    size_t n = 0;
    for (uint32_t y = y0; y < y0 + SIDE && y < box->y1; y++)
        for (uint32_t x = x0; x < x0 + SIDE && x < box->x1; x++)
            n += lights_of_pixel(cells, x, y, lights ? lights + n : NULL);
    if (lights) qsort(lights, n, sizeof *lights, brighter_first);
    return n;
}

static void count_lights_of_row(void *context, uint32_t row, unsigned worker)
{
    const Cells *cells = context;
    (void)worker;
    for (uint32_t i = 0; i < cells->width; i++)
        cells->first[(size_t)row * cells->width + i + 1] = lights_of_cell(cells, i, row, NULL);
}

static void list_lights_of_row(void *context, uint32_t row, unsigned worker)
{
    const Cells *cells = context;
    (void)worker;
    for (uint32_t i = 0; i < cells->width; i++)
        (void)lights_of_cell(cells, i, row, cells->lights + cells->first[(size_t)row * cells->width + i]);
}

/* Of a cell. */
static uint32_t count_brighter(const Cells *cells, size_t cell, float least)
{
    const float *lights = cells->lights + cells->first[cell];
    size_t low = 0, high = cells->first[cell + 1] - cells->first[cell];
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (lights[middle] >= least)
            low = middle + 1;
        else
            high = middle;
    }
    return (uint32_t)low;
}

/* ---- how far samples go ---- */

static double point_x(const Cells *cells, uint32_t column)
{
    return cells->box.x0 + column * SIDE + (SIDE - 1) / 2.0;
}

static double point_y(const Cells *cells, uint32_t row)
{
    return cells->box.y0 + row * SIDE + (SIDE - 1) / 2.0;
}

/* The cells of one axis whose points are within a reach of a place: counted from where the box begins. */
static Columns points_within(double place, double reach, uint32_t box_begins, uint32_t n)
{
    double first = box_begins + (SIDE - 1) / 2.0;
    double from = ceil((place - reach - first) / SIDE), to = floor((place + reach - first) / SIDE) + 1;
    return (Columns){(uint32_t)fmin(fmax(from, 0), n), (uint32_t)fmin(fmax(to, 0), n)};
}

/* Cells of a row, to both sides of a sample: within the outer reach, and not within the inner; < 0: there is none. */
static void find_columns(const Cells *cells, const Lone *lone, double inner, double outer, Columns spans[2])
{
    Columns all = points_within(lone->x, outer, cells->box.x0, cells->width), within = {0, 0};
    if (inner >= 0) within = points_within(lone->x, inner, cells->box.x0, cells->width);
    bool split = within.x0 < within.x1;
    spans[0] = (Columns){all.x0, split ? within.x0 : all.x1};
    spans[1] = (Columns){split ? within.x1 : all.x1, all.x1};
}

static double weight_of_cell(const Cells *cells, const Lone *lone, size_t cell)
{
    return lone->black * cells->even[cell] + (1 - lone->black) * cells->usual[cell];
}

static void sum_cells(const Cells *cells, const Lone *lone, uint32_t row, Columns span, Around *sums)
{
    double dy = point_y(cells, row) - lone->y, dx = point_x(cells, span.x0) - lone->x;
    size_t cell = (size_t)row * cells->width + span.x0;
    for (uint32_t i = span.x0; i < span.x1; i++, cell++, dx += SIDE) {
        double weight = weight_of_cell(cells, lone, cell), distance = dx * dx + dy * dy;
        double share = cells->even[cell], light = cells->light[cell];
        sums->weights += weight;
        sums->shares += share;
        sums->shares_by_distance += share * distance;
        sums->light += light;
        sums->weights_by_distance += weight * distance;
        sums->light_by_distance += light * distance;
        sums->middle[0] += weight * dx;
        sums->middle[1] += weight * dy;
        sums->middle_by_distance[0] += weight * distance * dx;
        sums->middle_by_distance[1] += weight * distance * dy;
    }
}

static double half_of_row(double dy, double reach)
{
    double left = reach * reach - dy * dy;
    return left < 0 ? -1 : sqrt(left);
}

/* From one disc, and its square, to a larger one. inner < 0: there is none. */
static void look_farther(const Cells *cells, const Lone *lone, double inner, double outer, Around *sums)
{
    Columns rows = points_within(lone->y, outer, cells->box.y0, cells->height);
    for (uint32_t row = rows.x0; row < rows.x1; row++) {
        double dy = point_y(cells, row) - lone->y;
        Columns discs[2], squares[2];
        find_columns(cells, lone, inner < 0 ? -1 : half_of_row(dy, inner), half_of_row(dy, outer), discs);
        find_columns(cells, lone, fabs(dy) > inner ? -1 : inner, outer, squares);
        for (int side = 0; side < 2; side++) {
            sum_cells(cells, lone, row, discs[side], sums);
            for (uint32_t i = squares[side].x0; i < squares[side].x1; i++)
                around_add_alike(sums, count_brighter(cells, (size_t)row * cells->width + i, lone->least),
                                 point_x(cells, i) - lone->x, dy);
        }
    }
}

/* What a point has of a sample's disc. */
static double nearness_of_point(const Way *way, double dx, double dy)
{
    double near = nearness(dx * dx + dy * dy, way->radius);
    return way->mirrored ? near + nearness_of_image(way, dx, dy) : near;
}

/* Cells of a row that a sample's disc holds. */
static Columns columns_of(const Cells *cells, const Lone *lone, const Way *way, uint32_t row)
{
    double half = half_of_row(point_y(cells, row) - lone->y, way->radius + 0.5);
    return half < 0 ? (Columns){0, 0} : points_within(lone->x, half, cells->box.x0, cells->width);
}

static Columns rows_of(const Cells *cells, const Lone *lone, const Way *way)
{
    return points_within(lone->y, way->radius + 0.5, cells->box.y0, cells->height);
}

/* What is comparable to a sample, and how close that lies in its disc. */
typedef struct Closeness {
    int kind;
    double of_disc, any_of_disc; /* the latter: of all that brought light */
} Closeness;

static Closeness closeness_of(const Cells *cells, const Lone *lone, const Way *way)
{
    double reach = way->radius + 0.5;
    Columns rows = points_within(lone->y, reach, cells->box.y0, cells->height),
            columns = points_within(lone->x, reach, cells->box.x0, cells->width);
    const CellSquare square = {columns.x0, rows.x0, columns.x1, rows.x1};
    int kind = density_kind(lone->least);
    return (Closeness){kind, density_within(&cells->densities, kind, square),
                       density_within(&cells->densities, DENSITY_ANY, square)};
}

/* The part of what a cell would get by its light that it gets by how close samples lie there. */
static double part_by_closeness(const Cells *cells, const Closeness *close, size_t cell)
{
    return density_part(&cells->densities, close->kind, cell, close->of_disc) *
           density_part(&cells->densities, DENSITY_ANY, cell, close->any_of_disc);
}

static double weights_of_disc(const Cells *cells, const Lone *lone, const Way *way)
{
    Columns rows = rows_of(cells, lone, way);
    const Closeness close = closeness_of(cells, lone, way);
    double weights = 0;
    for (uint32_t row = rows.x0; row < rows.x1; row++) {
        Columns columns = columns_of(cells, lone, way, row);
        double dy = point_y(cells, row) - lone->y, dx = point_x(cells, columns.x0) - lone->x;
        size_t cell = (size_t)row * cells->width + columns.x0;
        for (uint32_t i = columns.x0; i < columns.x1; i++, cell++, dx += SIDE)
            weights += weight_of_cell(cells, lone, cell) * nearness_of_point(way, dx, dy) *
                       part_by_closeness(cells, &close, cell);
    }
    return weights;
}

static Way *way_of(const Maps *maps, const FarSample *sample)
{
    return &maps->rows[sample->row].ways[sample->way];
}

static void find_radius(const Cells *cells, Lone *lone, Way *way)
{
    Around sums = {0};
    double alone = 0, inner = -1, own = spread_own_weight(cells->maps, lone);
    bool ends = false;
    for (int next = spread_next_radius(SPREAD_NEAR); next <= SPREAD_FARTHEST && !ends;
         next = spread_next_radius(next)) {
        look_farther(cells, lone, inner, next + 0.5, &sums);
        inner = next + 0.5;
        way->radius = (uint16_t)next;
        if (spread_is_in_clump(lone, &sums, next, &way->clump)) {
            spread_in_clump(cells->maps, lone, true, way);
            return;
        }
        ends = spread_ends(lone, &sums, next, own, way, &alone);
    }
    if (spread_is_uneven(cells->maps, lone, &sums, way->radius, &way->clump))
        spread_in_clump(cells->maps, lone, false, way);
    else if (!ends)
        way->radius = (uint16_t)spread_farthest(lone, &sums, way->radius, alone, way);
}

static void find_way(const Cells *cells, const FarSample *sample)
{
    Way *way = way_of(cells->maps, sample);
    Lone lone = spread_lone_on_way(cells->maps, sample->row, way);
    find_radius(cells, &lone, way);
    if (way->far && way->radius > 0) way->weights = weights_of_disc(cells, &lone, way);
}

static void find_ways_of_chunk(void *context, uint32_t index, unsigned worker)
{
    const Cells *cells = context;
    size_t first = (size_t)index * CHUNK;
    (void)worker;
    for (size_t i = first; i < first + CHUNK && i < cells->n_samples; i++) find_way(cells, &cells->samples[i]);
}

/* ---- what comes of them ---- */

static void give_to_row(const Cells *cells, const Lone *lone, const Way *way, const Closeness *close, uint32_t row)
{
    Columns columns = columns_of(cells, lone, way, row);
    double dy = point_y(cells, row) - lone->y, dx = point_x(cells, columns.x0) - lone->x;
    double black = lone->black, rest = 1 - black, squared = spread_squared_luminance(lone->untinted);
    size_t cell = (size_t)row * cells->width + columns.x0;
    Gift *gift = &cells->gifts[cell];
    for (uint32_t i = columns.x0; i < columns.x1; i++, cell++, gift++, dx += SIDE) {
        double part = nearness_of_point(way, dx, dy) / way->weights * part_by_closeness(cells, close, cell),
               square = part * part * squared;
        for (int c = 0; c < 3; c++) {
            gift->even[c] += black * part * lone->untinted[c];
            gift->usual[c] += rest * part * lone->untinted[c];
        }
        gift->squares[0] += black * black * square;
        gift->squares[1] += 2 * black * rest * square;
        gift->squares[2] += rest * rest * square;
    }
}

static void give_to_band(void *context, uint32_t index, unsigned worker)
{
    const Cells *cells = context;
    const Maps *maps = cells->maps;
    uint32_t from = index * BAND, to = from + BAND < cells->height ? from + BAND : cells->height;
    (void)worker;
    for (size_t i = (size_t)from * cells->width; i < (size_t)to * cells->width; i++) cells->gifts[i] = (Gift){0};
    for (size_t i = 0; i < cells->n_samples; i++) {
        const FarSample *sample = &cells->samples[i];
        const Way *way = way_of(maps, sample);
        if (!(way->part > 0) || !way->far) continue;
        Lone lone = spread_lone_on_way(maps, sample->row, way);
        Columns rows = rows_of(cells, &lone, way);
        const Closeness close = closeness_of(cells, &lone, way);
        for (uint32_t row = rows.x0 > from ? rows.x0 : from; row < rows.x1 && row < to; row++)
            give_to_row(cells, &lone, way, &close, row);
    }
}

static double mixed(double a, double b, double part)
{
    return a + (b - a) * part;
}

static Gift gift_between(const Gift *a, const Gift *b, double part)
{
    Gift gift;
    for (int c = 0; c < 3; c++) {
        gift.even[c] = mixed(a->even[c], b->even[c], part);
        gift.usual[c] = mixed(a->usual[c], b->usual[c], part);
        gift.squares[c] = mixed(a->squares[c], b->squares[c], part);
    }
    return gift;
}

static void take_gifts(void *context, uint32_t index, unsigned worker)
{
    const Cells *cells = context;
    const Maps *maps = cells->maps;
    const ThingBox *box = &cells->box;
    Between rows = between(index, cells->height);
    const Gift *one = cells->gifts + (size_t)rows.one * cells->width,
               *other = cells->gifts + (size_t)rows.other * cells->width;
    size_t pixel = place_in(maps, box->x0, box->y0 + index);
    (void)worker;
    for (uint32_t x = 0; x < box->x1 - box->x0; x++, pixel++) {
        double share = share_of(cells, pixel), by_usual = usual(cells, (double)maps->looks.lit[pixel]);
        if (!(share > 0)) continue;
        Between columns = between(x, cells->width);
        Gift left = gift_between(&one[columns.one], &other[columns.one], rows.part);
        Gift right = gift_between(&one[columns.other], &other[columns.other], rows.part);
        Gift gift = gift_between(&left, &right, columns.part);
        SpreadPixel *to = &maps->pixels[pixel];
        for (int c = 0; c < 3; c++) to->rgb[c] += share * (gift.even[c] + by_usual * gift.usual[c]);
        to->given += share * share * (gift.squares[0] + by_usual * (gift.squares[1] + by_usual * gift.squares[2]));
    }
}

/* ---- by things and levels ---- */

static int order(const void *left, const void *right)
{
    const FarSample *a = left, *b = right;
    if (a->thing != b->thing) return a->thing < b->thing ? -1 : 1;
    if (a->level != b->level) return a->level < b->level ? -1 : 1;
    if (a->row != b->row) return a->row < b->row ? -1 : 1;
    return a->way < b->way ? -1 : a->way > b->way;
}

/* The power of the square root of two that is nearest to what light is usual where a sample is. */
static int level_of(double usual_light)
{
    return usual_light > 0 ? (int)fmin(fmax(rint(2 * log2(usual_light)), -LEVELS), LEVELS) : -LEVELS;
}

static bool list_samples(const Maps *maps, FarSamples *far)
{
    size_t n = 0;
    for (uint32_t y = 0; y < maps->height; y++)
        for (size_t i = 0; i < maps->rows[y].n; i++) n += maps->rows[y].ways[i].far;
    if (n == 0) return true;
    far->samples = malloc(n * sizeof *far->samples);
    if (!far->samples) return false;
    for (uint32_t y = 0; y < maps->height; y++)
        for (size_t i = 0; i < maps->rows[y].n; i++) {
            const Way *way = &maps->rows[y].ways[i];
            if (!way->far) continue;
            const BrightPixel *pixel = bright_at(maps, way->x, y);
            double usual_light = spread_usual_light(maps, way->x, y);
            far->samples[far->n++] = (FarSample){.thing = pixel->things[bright_seen(pixel, way->kept)],
                                                 .level = level_of(usual_light),
                                                 .row = y,
                                                 .way = (uint32_t)i};
        }
    qsort(far->samples, far->n, sizeof *far->samples, order);
    return true;
}

static void clear_cells(Cells *cells)
{
    free(cells->even);
    free(cells->usual);
    free(cells->light);
    free(cells->first);
    free(cells->lights);
    free(cells->gifts);
    density_clear(&cells->densities);
    *cells = (Cells){0};
}

static bool list_lights(Cells *cells)
{
    size_t n = (size_t)cells->width * cells->height;
    cells->first = calloc(n + 1, sizeof *cells->first);
    if (!cells->first) return false;
    pool_run(cells->maps->pool, cells->height, count_lights_of_row, cells);
    for (size_t i = 0; i < n; i++) cells->first[i + 1] += cells->first[i];
    cells->lights = malloc((cells->first[n] + 1) * sizeof *cells->lights);
    if (!cells->lights) return false;
    pool_run(cells->maps->pool, cells->height, list_lights_of_row, cells);
    return true;
}

/* Of the thing's samples that a pixel keeps, alone or not. */
static uint32_t count_any(const Cells *cells, uint32_t x, uint32_t y)
{
    const Looks *looks = &cells->maps->looks;
    size_t pixel = place_in(cells->maps, x, y);
    uint32_t thing = find_thing(looks, pixel, cells->thing), seen = looks->seen[pixel], n = 0;
    for (int i = 0; thing < BRIGHT_THINGS && i < BRIGHT_KEPT && looks->lights[pixel][i] > 0; i++)
        n += bright_seen_of(seen, i) == thing;
    return n;
}

static uint32_t count_for_density(const void *context, size_t cell, float least)
{
    const Cells *cells = context;
    if (least > 0) return count_brighter(cells, cell, least);
    const ThingBox *box = &cells->box;
    uint32_t x0 = box->x0 + (uint32_t)(cell % cells->width) * SIDE,
             y0 = box->y0 + (uint32_t)(cell / cells->width) * SIDE, n = 0;
    for (uint32_t y = y0; y < y0 + SIDE && y < box->y1; y++)
        for (uint32_t x = x0; x < x0 + SIDE && x < box->x1; x++) n += count_any(cells, x, y);
    return n;
}

static double shares_of_cell(const Cells *cells, uint32_t column, uint32_t row)
{
    const ThingBox *box = &cells->box;
    uint32_t x0 = box->x0 + column * SIDE, y0 = box->y0 + row * SIDE;
    double shares = 0;
    for (uint32_t y = y0; y < y0 + SIDE && y < box->y1; y++)
        for (uint32_t x = x0; x < x0 + SIDE && x < box->x1; x++) shares += share_of(cells, place_in(cells->maps, x, y));
    return shares;
}

static bool make_densities(Cells *cells)
{
    double *shares = malloc((size_t)cells->width * cells->height * sizeof *shares);
    if (!shares) return false;
    for (uint32_t row = 0; row < cells->height; row++)
        for (uint32_t i = 0; i < cells->width; i++)
            shares[(size_t)row * cells->width + i] = shares_of_cell(cells, i, row);
    bool made = density_init(&cells->densities, cells->width, cells->height, shares);
    free(shares);
    return made;
}

/* Of all kinds of samples of the level. */
static bool find_densities(Cells *cells)
{
    Pool *pool = cells->maps->pool;
    if (!density_find(&cells->densities, DENSITY_ANY, count_for_density, cells, pool)) return false;
    for (size_t i = 0; i < cells->n_samples; i++) {
        const Way *way = way_of(cells->maps, &cells->samples[i]);
        const BrightPixel *pixel = bright_at(cells->maps, way->x, cells->samples[i].row);
        int kind = density_kind(bright_light(pixel->rgb[way->kept]) * ALIKE); /* as Lone.least */
        if (!density_find(&cells->densities, kind, count_for_density, cells, pool)) return false;
    }
    return true;
}

/* What is needed to find ways, or to give. */
static bool make_cells(Cells *cells, const Maps *maps, uint32_t thing, bool to_find)
{
    const ThingBox *box = thing_boxes_find(&maps->boxes, thing);
    if (!box) return false;
    *cells = (Cells){.maps = maps,
                     .thing = thing,
                     .box = *box,
                     .width = (box->x1 - box->x0 + SIDE - 1) / SIDE,
                     .height = (box->y1 - box->y0 + SIDE - 1) / SIDE};
    size_t n = (size_t)cells->width * cells->height;
    if (!list_lights(cells) || !make_densities(cells)) return false;
    if (!to_find) return (cells->gifts = malloc(n * sizeof *cells->gifts)) != NULL;
    double **sums[] = {&cells->even, &cells->usual, &cells->light};
    bool ready = true;
    for (size_t k = 0; k < COUNT_OF(sums); k++) ready = (*sums[k] = malloc(n * sizeof(double))) != NULL && ready;
    return ready;
}

static void find_ways_of_level(Cells *cells)
{
    Pool *pool = cells->maps->pool;
    pool_run(pool, cells->height, add_up_row, cells);
    pool_run(pool, (uint32_t)((cells->n_samples + CHUNK - 1) / CHUNK), find_ways_of_chunk, cells);
}

static void give_of_level(Cells *cells)
{
    Pool *pool = cells->maps->pool;
    pool_run(pool, (cells->height + BAND - 1) / BAND, give_to_band, cells);
    pool_run(pool, cells->box.y1 - cells->box.y0, take_gifts, cells);
}

static bool for_levels(const Maps *maps, const FarSamples *far, bool to_find, void (*use)(Cells *cells))
{
    Cells cells = {0};
    bool good = true;
    for (size_t i = 0, end; i < far->n && good; i = end) {
        const FarSample *sample = &far->samples[i];
        for (end = i;
             end < far->n && far->samples[end].thing == sample->thing && far->samples[end].level == sample->level;)
            end++;
        if (i == 0 || sample->thing != sample[-1].thing) {
            clear_cells(&cells);
            good = make_cells(&cells, maps, sample->thing, to_find);
        }
        cells.scale = exp2(-sample->level / 2.0);
        cells.samples = sample;
        cells.n_samples = end - i;
        good = good && find_densities(&cells);
        if (good) use(&cells);
    }
    clear_cells(&cells);
    return good;
}

bool spread_far_find(const Maps *maps, FarSamples *far)
{
    return list_samples(maps, far) && for_levels(maps, far, true, find_ways_of_level);
}

bool spread_far_give(const Maps *maps, const FarSamples *far)
{
    return for_levels(maps, far, false, give_of_level);
}

void spread_far_clear(FarSamples *far)
{
    free(far->samples);
    *far = (FarSamples){0};
}
