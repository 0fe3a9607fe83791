/* spread.c - which samples stand alone, and where they go.
 * First it is found for each row of pixels, by whichever thread, where its samples go; then each band of rows takes what is
 * for it, in the order of the rows that it comes from: the same sums for any number of threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/spread.h"

#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "render/around.h"
#include "render/thing_boxes.h"

/* Measured on the examples, by the error against pictures of many samples, by dots that are left (bench fireflies), and by
 * eye: what is spread too near makes discs of the same brightness; too little, dots. */

/* Samples are alike down to this part of the brightest. */
#define ALIKE 0.4f
/* A pixel that has so many that are alike has found what it shows; of few samples a part of them is enough. */
enum { FEW = 8, FEW_PART = 4 };
/* What a sample adds to its pixel, over what is there without, that is not to be seen yet. */
#define STANDS_OUT 0.2
/* Pixels around, for what is usual there. */
enum { AROUND = 2 };
/* A pixel is a hole by what it has less than this one of those next to it, counted from the darkest: holes may be two or three
 * in a row, and what is beside an edge is none. */
enum { HOLE_RANK = 3 };
/* Comparable samples that hold a neighbourhood up: next to a sample few, which are parts of one small bright thing; farther
 * away many, else their discs would be seen: of samples of one colour, as dispersion makes them, the more by how much sooner a
 * haze of that is seen. Without that a diamond had clouds of violet and green. */
enum { NEAR = 2, NEAR_ENOUGH = 20, FAR_ENOUGH = 256, FARTHEST = 209 };
/* Pixels around a sample, for what they have of comparable ones. */
enum { BESIDE = 2 };
/* What samples add to what is usual, spread, that is not seen; and what is a haze that is better than a dot. */
#define UNSEEN 0.1
#define FAINT 0.25
/* A haze of one colour is seen sooner than a grey one: how much sooner, for each unit of tint. */
#define TINTED 6.0
/* Of what a usual pixel gets, the part that a black one does. */
#define TO_BLACK (1 / 6.0)
/* Of a disc's reach: how far the middle of what it gives may be off its own where it counts as whole, the rest being seen less
 * than the texture that it is then found in, and how well an edge is found; and what an edge leaves of a disc at least. */
#define WHOLE 0.02
#define EDGE_FOUND 0.005
#define LEAST_LEFT 0.5
/* Rows that a thread gathers at a time. */
enum { BAND = 16 };

/* What is asked of pixels again and again, each kind together, so that rows of pixels are gone through fast. */
typedef struct Looks {
    uint32_t *things[BRIGHT_THINGS];
    float *shares[BRIGHT_THINGS]; /* of a pixel's samples, those that saw each; 0: no such thing */
    float *plain;                 /* its light, see bright_light, without the samples that have few like them there */
    float *around;                /* the mean of that around it */
    float *brightest;             /* of its samples, as far as they are kept */
} Looks;

/* Where a sample goes. */
typedef struct Way {
    uint32_t x;
    uint8_t kept, radius;   /* which of its pixel's it is */
    bool mirrored;          /* at an edge that cuts its disc: see find_image */
    float image[2];         /* from the sample to its image behind that edge, in columns and rows */
    double part;            /* of the sample, what goes */
    double crowding, usual; /* see find_crowding */
    double weights;         /* of all pixels together */
    double black, slope;    /* see Lone */
} Way;

/* A row of pixels: what is found of it. */
typedef struct Row {
    Way *ways;
    size_t n, capacity;
    int farthest; /* of their radii */
    double light; /* of the picture, in sum, */
    double moved; /* and of these samples */
    bool out_of_memory;
} Row;

/* Of an area of the film: by its rows. */
typedef struct Maps {
    const Film *film;
    const BrightFilm *bright;
    const uint32_t *area;
    uint32_t width, height;
    Looks looks;
    ThingBoxes boxes; /* of what is seen in the area */
    Row *rows;
    SpreadPixel *pixels;
} Maps;

static size_t place_in(const uint32_t area[4], uint32_t x, uint32_t y)
{
    return (size_t)(y - area[1]) * (area[2] - area[0]) + (x - area[0]);
}

static const BrightPixel *bright_at(const Maps *maps, uint32_t x, uint32_t y)
{
    return &maps->bright->pixels[(size_t)y * maps->bright->width + x];
}

/* A sample on its way. */
typedef struct Lone {
    uint32_t x, y, thing;
    double light, rgb[3]; /* as parts of its pixel's mean */
    double seen;          /* its light, as a haze of it is seen */
    double
        reference; /* what is usual there: the most of what is plain: the brightest pixel next to it, the mean around */
    double black, slope; /* what a pixel gets by its own light: black + slope * light, but 1 at most */
    float least;         /* of comparable samples */
    ThingBox box;        /* where the thing is seen: nothing is to be found beyond it */
} Lone;

/* Which of a pixel's things one is; BRIGHT_THINGS: none. */
static uint32_t find_thing(const BrightPixel *pixel, uint32_t thing)
{
    uint32_t i = 0;
    while (i < BRIGHT_THINGS && !(pixel->counts[i] && pixel->things[i] == thing)) i++;
    return i;
}

/* The pixel's samples of its seen-th thing that are as bright, as far as they are kept. */
static uint32_t count_comparable(const BrightPixel *pixel, uint32_t seen, float least)
{
    uint32_t n = 0;
    if (seen == BRIGHT_THINGS) return 0;
    for (int i = 0; i < BRIGHT_KEPT && bright_light(pixel->rgb[i]) >= least; i++) n += bright_seen(pixel, i) == seen;
    return n;
}

static uint32_t few_of(uint32_t n_samples)
{
    return n_samples / FEW_PART < FEW ? n_samples / FEW_PART : FEW;
}

static bool has_few_alike(const BrightPixel *pixel, int i, uint32_t n_samples)
{
    float light = bright_light(pixel->rgb[i]);
    uint32_t seen = bright_seen(pixel, i);
    return light > 0 && seen < BRIGHT_THINGS && count_comparable(pixel, seen, light * ALIKE) < few_of(n_samples);
}

/* Whether no sample of a pixel has few alike, by a quick look: false where a close one is needed. */
static bool is_plain(const BrightPixel *pixel, uint32_t n_samples)
{
    uint32_t few = few_of(n_samples);
    return few == 0 || (!pixel->counts[1] && pixel->counts[0] >= few &&
                        bright_light(pixel->rgb[few - 1]) >= bright_light(pixel->rgb[0]) * ALIKE);
}

/* What a pixel's mean is without the samples that have few like them, or with them. */
static double light_of(const FilmPixel *pixel, const BrightPixel *without)
{
    double rgb[3];
    int n_without = 0;
    for (int c = 0; c < 3; c++) rgb[c] = (double)pixel->rgb[c] * FILM_UNIT;
    for (int i = 0; without && !is_plain(without, pixel->n) && i < BRIGHT_KEPT; i++)
        if (has_few_alike(without, i, pixel->n)) {
            for (int c = 0; c < 3; c++) rgb[c] -= (double)without->rgb[i][c];
            n_without++;
        }
    for (int c = 0; c < 3; c++)
        if (fabs(rgb[c]) <= n_without * FILM_UNIT) rgb[c] = 0; /* by how much the film rounded these */
    return pixel->n ? (fabs(rgb[0]) + fabs(rgb[1]) + fabs(rgb[2])) / (3.0 * pixel->n) : 0;
}

static double reference_at(const Maps *maps, uint32_t x, uint32_t y)
{
    const uint32_t *area = maps->area;
    float most = maps->looks.around[place_in(area, x, y)];
    for (uint32_t v = y > area[1] ? y - 1 : y; v <= y + 1 && v < area[3]; v++)
        for (uint32_t u = x > area[0] ? x - 1 : x; u <= x + 1 && u < area[2]; u++)
            most = fmaxf(most, maps->looks.plain[place_in(area, u, v)]);
    return (double)most;
}

/* By how much a pixel would be darker than those next to it, were all its samples that have few alike to go. Where light is
 * folded or a shadow ends, neighbours may have found by many samples what a pixel has found by one. */
static double hole_at(const Maps *maps, uint32_t x, uint32_t y)
{
    const uint32_t *area = maps->area;
    float darkest[HOLE_RANK];
    uint32_t n = 0;
    for (uint32_t v = y > area[1] ? y - 1 : y; v <= y + 1 && v < area[3]; v++)
        for (uint32_t u = x > area[0] ? x - 1 : x; u <= x + 1 && u < area[2]; u++) {
            float light = maps->looks.plain[place_in(area, u, v)];
            if ((u == x && v == y) || (n == HOLE_RANK && light >= darkest[n - 1])) continue;
            uint32_t k = n < HOLE_RANK ? n++ : HOLE_RANK - 1;
            for (; k > 0 && darkest[k - 1] > light; k--) darkest[k] = darkest[k - 1];
            darkest[k] = light;
        }
    if (n < HOLE_RANK) return 0;
    return fmax((double)darkest[HOLE_RANK - 1] - (double)maps->looks.plain[place_in(area, x, y)], 0);
}

static void look_at_row(void *context, uint32_t index, unsigned worker)
{
    Maps *maps = context;
    uint32_t y = maps->area[1] + index;
    (void)worker;
    for (uint32_t x = maps->area[0]; x < maps->area[2]; x++) {
        size_t i = place_in(maps->area, x, y);
        Looks *looks = &maps->looks;
        const FilmPixel *pixel = film_pixel(maps->film, x, y);
        const BrightPixel *bright = bright_at(maps, x, y);
        looks->plain[i] = (float)light_of(pixel, bright);
        looks->brightest[i] = bright_light(bright->rgb[0]);
        for (int k = 0; k < BRIGHT_THINGS && bright->counts[k] && pixel->n; k++) {
            looks->things[k][i] = bright->things[k];
            looks->shares[k][i] = (float)bright->counts[k] / (float)pixel->n;
        }
        maps->rows[index].light += light_of(pixel, NULL);
    }
}

/* How much of a sample each of n pixels from `first` on gets, in relation to others, were it beside it. */
static void weights_of(const Looks *looks, const Lone *lone, size_t first, uint32_t n, double *restrict weights)
{
    const uint32_t *t0 = looks->things[0] + first, *t1 = looks->things[1] + first, *t2 = looks->things[2] + first;
    const float *s0 = looks->shares[0] + first, *s1 = looks->shares[1] + first, *s2 = looks->shares[2] + first;
    const float *plain = looks->plain + first;
    const uint32_t thing = lone->thing;
    const double black = lone->black, slope = lone->slope;
    for (uint32_t i = 0; i < n; i++) {
        float first_share = s0[i], second_share = s1[i], third_share = s2[i]; /* read in any case: no jumps */
        float share = t2[i] == thing ? third_share : 0;
        share = t1[i] == thing ? second_share : share;
        share = t0[i] == thing ? first_share : share;
        double light = black + slope * (double)plain[i];
        weights[i] = (double)share * (light < 1 ? light : 1);
    }
}
_Static_assert(BRIGHT_THINGS == 3, "the things that are asked for");

static double weight_of(const Looks *looks, const Lone *lone, size_t pixel)
{
    double weight;
    weights_of(looks, lone, pixel, 1, &weight);
    return weight;
}

/* By how much that is less farther away: of the way to where nothing is left, which is half a pixel beyond the radius. */
static double nearness(double distance_squared, int radius)
{
    double reach = radius + 0.5;
    return 1 - distance_squared / (reach * reach);
}

/* The pixel's samples that are comparable to it, as far as they are kept. */
static uint32_t count_alike(const Maps *maps, const Lone *lone, uint32_t x, uint32_t y)
{
    if (maps->looks.brightest[place_in(maps->area, x, y)] < lone->least) return 0;
    const BrightPixel *bright = bright_at(maps, x, y);
    return count_comparable(bright, find_thing(bright, lone->thing), lone->least);
}

/* Columns of a row of pixels: from x0 up to but without x1. */
typedef struct Span {
    uint32_t x0, x1;
} Span;

/* The same of pixels of a row, until they are enough. */
static uint32_t count_alike_of(const Maps *maps, const Lone *lone, const Span *span, uint32_t y, uint32_t enough)
{
    const float *brightest = maps->looks.brightest + place_in(maps->area, span->x0, y);
    uint32_t alike = 0;
    for (uint32_t x = span->x0; x < span->x1 && alike < enough; x++, brightest++)
        if (UNLIKELY(*brightest >= lone->least)) alike += count_alike(maps, lone, x, y);
    return alike;
}

/* A part of the thing's box: from x0, y0 up to but without x1, y1. */
typedef struct Square {
    uint32_t x0, y0, x1, y1;
} Square;

static Square square_around(const Lone *lone, int radius)
{
    uint32_t r = (uint32_t)radius;
    const ThingBox *box = &lone->box;
    return (Square){lone->x > box->x0 + r ? lone->x - r : box->x0, lone->y > box->y0 + r ? lone->y - r : box->y0,
                    lone->x + r < box->x1 ? lone->x + r + 1 : box->x1,
                    lone->y + r < box->y1 ? lone->y + r + 1 : box->y1};
}

/* What is found around a sample: sums over the pixels of a disc, such that they grow with it. */
typedef struct Around {
    double weights, light;                         /* of weights, and by these of what pixels have without it */
    double weights_by_distance, light_by_distance; /* the same, times the distance squared */
    double middle[2], middle_by_distance[2];       /* weights times columns and rows from the sample, and times both */
    uint32_t alike;                                /* comparable samples in the square */
} Around;

/* The square of the distance where nearness ends; none before the first disc. */
static double end_of(int radius)
{
    return radius < 0 ? -1 : (radius + 0.5) * (radius + 0.5);
}

/* Columns to both sides of a sample that a disc and its square hold in a row of pixels; < 0: none. */
static int half_width(int dy, int radius)
{
    double left = end_of(radius) - (double)dy * dy;
    return left < 0 ? -1 : (int)sqrt(left);
}

/* What of a row is within `outer` columns of a sample, and not within `inner`, on either side; inner -1: all on the first. */
static void find_spans(const Square *square, const Lone *lone, int inner, int outer, Span spans[2])
{
    uint32_t x = lone->x, reach = (uint32_t)outer, done = (uint32_t)(inner + 1);
    uint32_t x0 = x > square->x0 + reach ? x - reach : square->x0;
    uint32_t x1 = square->x1 - x > reach ? x + reach + 1 : square->x1;
    spans[0] = (Span){x0, inner < 0 ? x1 : x - x0 >= done ? x - done + 1 : x0};
    spans[1] = (Span){inner >= 0 && x1 - x > done ? x + done : x1, x1};
}

static void sum_span(const Maps *maps, const Lone *lone, const Span *span, uint32_t y, Around *sums)
{
    double weights[2 * FARTHEST + 1], dy = (double)y - lone->y;
    if (span->x0 >= span->x1) return;
    size_t first = place_in(maps->area, span->x0, y);
    weights_of(&maps->looks, lone, first, span->x1 - span->x0, weights);
    Around sum = {0};
    double dx = (double)span->x0 - lone->x;
    for (uint32_t i = 0; i < span->x1 - span->x0; i++, dx++) {
        double distance = dx * dx + dy * dy, weight = weights[i];
        double light = weight * (double)maps->looks.plain[first + i];
        sum.weights += weight;
        sum.light += light;
        sum.weights_by_distance += weight * distance;
        sum.light_by_distance += light * distance;
        sum.middle[0] += weight * dx;
        sum.middle_by_distance[0] += weight * distance * dx;
    }
    sums->weights += sum.weights;
    sums->light += sum.light;
    sums->weights_by_distance += sum.weights_by_distance;
    sums->light_by_distance += sum.light_by_distance;
    sums->middle[0] += sum.middle[0];
    sums->middle_by_distance[0] += sum.middle_by_distance[0];
    sums->middle[1] += sum.weights * dy;
    sums->middle_by_distance[1] += sum.weights_by_distance * dy;
}

/* From one disc, and its square, to a larger one. inner -1: there is none. What is alike is counted until it is enough. */
static void look_farther(const Maps *maps, const Lone *lone, int inner, int outer, uint32_t enough, Around *sums)
{
    Square square = square_around(lone, outer);
    for (uint32_t y = square.y0; y < square.y1; y++) {
        int dy = abs((int)y - (int)lone->y);
        Span discs[2], squares[2];
        find_spans(&square, lone, half_width(dy, inner), half_width(dy, outer), discs);
        find_spans(&square, lone, dy > inner ? -1 : inner, outer, squares);
        for (int side = 0; side < 2; side++) {
            sum_span(maps, lone, &discs[side], y, sums);
            if (sums->alike < enough)
                sums->alike += count_alike_of(maps, lone, &squares[side], y, enough - sums->alike);
        }
    }
}

/* A disc of radius 1, weighted by nearness, of which an edge cuts all beyond a distance from its middle, 0 to 1: what is left, and
 * how far the middle of that is from the disc's. */
static double left_of_edge(double distance, double *middle)
{
    double squared = 1 - distance * distance, root = sqrt(squared);
    double left = asin(1) / 2 + distance * squared * root / 3 + (distance * root + asin(distance)) / 2;
    *middle = 4 / 15.0 * squared * squared * root / left;
    return left / asin(1);
}

/* Where a thing or the picture ends within a disc, pixels there would get less than others: they are in fewer discs, though each
 * of those that are cut gives more to what is left of it. So a disc is folded at the edge, as if the sample had an image behind
 * it: what is even stays so, to a straight edge. The edge is where it has to be for the middle of what the disc gives to be where
 * it is; through the sample itself, where that is not enough: nothing is folded then, as in the middle of what is small.
 * The part of the disc that is left. */
static double find_image(const Around *sums, int radius, Way *way)
{
    double end = end_of(radius), reach = sqrt(end), middle[2], near = 0, far = 1, beside;
    for (int i = 0; i < 2; i++) middle[i] = (sums->middle[i] - sums->middle_by_distance[i] / end) / way->weights;
    double away = sqrt(middle[0] * middle[0] + middle[1] * middle[1]) / reach;
    left_of_edge(0, &beside);
    way->mirrored = away > WHOLE && away < beside;
    if (!way->mirrored) return away > WHOLE ? LEAST_LEFT : 1;
    while (far - near > EDGE_FOUND) {
        double distance = (near + far) / 2;
        left_of_edge(distance, &beside);
        *(beside > away ? &near : &far) = distance;
    }
    for (int i = 0; i < 2; i++) way->image[i] = (float)(-2 * near * middle[i] / away);
    return left_of_edge(near, &beside);
}

/* How far a sample is spread, and what pixels get together. One that would be more than faint wherever it goes, alone, is less of
 * a blemish where it is: 0. */
static int find_radius(const Maps *maps, const Lone *lone, Way *way)
{
    Around sums = {0};
    int radius = -1;
    const double far_enough = FAR_ENOUGH * lone->seen / lone->light;
    double alone = 0, own = weight_of(&maps->looks, lone, place_in(maps->area, lone->x, lone->y));
    for (int next = 1; next <= FARTHEST; next += 1 + next / 2) {
        uint32_t enough = (uint32_t)(next <= NEAR ? next * NEAR_ENOUGH : far_enough);
        look_farther(maps, lone, radius, next, enough, &sums);
        radius = next;
        double end = end_of(radius);
        way->weights = sums.weights - sums.weights_by_distance / end;
        double plain = (sums.light - sums.light_by_distance / end) / way->weights;
        alone = lone->seen * own / (way->weights * fmin(lone->reference, plain)); /* what the sample adds where it is */
        bool unseen = sums.alike * alone <= UNSEEN;
        if (!unseen && sums.alike < LEAST_LEFT * enough) continue;
        double left = find_image(&sums, radius, way);
        if (unseen || sums.alike >= left * enough) return radius;
    }
    if (alone > FAINT) return 0;
    (void)find_image(&sums, radius, way);
    return radius;
}

/* By how much what pixels have of comparable samples differs beyond chance: the variance of the rates behind these counts, over
 * their squared mean, which is the usual rate. Each pixel's rate is then to be taken for the mean of a gamma distribution given
 * its count, see crowd: a thin line or a point stays as sharp as it was found, and what is scattered evenly becomes even.
 * Farther away other things than chance make counts differ.
 * Samples that nearly are enough, and differ in number so little that it is not seen, as where strata find a reflection equally
 * often, stay: from half to three quarters of enough, and from twice to once what is not seen, less and less of them goes. Else
 * pixels beside one that has enough would keep theirs and get those of others: what is even would get uneven. */
static void find_crowding(const Maps *maps, const Lone *lone, Way *way)
{
    double n = 0, n_squared = 0, found = 0, products = 0, squares = 0, pixels = 0;
    Square square = square_around(lone, way->radius);
    for (uint32_t y = square.y0; y < square.y1; y++)
        for (uint32_t x = square.x0; x < square.x1; x++) {
            if (!(weight_of(&maps->looks, lone, place_in(maps->area, x, y)) > 0)) continue;
            double samples = film_pixel(maps->film, x, y)->n, alike = count_alike(maps, lone, x, y);
            pixels++;
            n += samples;
            n_squared += samples * samples;
            found += alike;
            products += samples * alike;
            squares += alike * alike;
        }
    /* of (alike - usual * samples)^2 over pixels, what is beyond the variance of chance, usual * samples */
    way->usual = found / n;
    double apart = squares - 2 * way->usual * products + way->usual * way->usual * n_squared;
    way->crowding = fmax(apart - found, 0) / (way->usual * way->usual * n_squared);
    double enough = found / pixels / few_of((uint32_t)(n / pixels));
    double seen = sqrt(fmax(apart, 0) / pixels) * lone->light / (lone->reference + found / pixels * lone->light);
    way->part = 1 - fmin(fmax(4 * enough - 2, 0), 1) * fmin(fmax(2 - seen / UNSEEN, 0), 1);
}

/* The rate of a pixel in relation to the usual one. */
static double crowd(const Maps *maps, const Lone *lone, const Way *way, uint32_t x, uint32_t y)
{
    double expected = way->usual * film_pixel(maps->film, x, y)->n;
    return (1 + way->crowding * count_alike(maps, lone, x, y)) / (1 + way->crowding * expected);
}

/* What of a sample's image behind an edge reaches to beside the sample. */
static double nearness_of_image(const Way *way, double dx, double dy)
{
    double x = dx - (double)way->image[0], y = dy - (double)way->image[1];
    double near = nearness(x * x + y * y, way->radius);
    return near > 0 ? near : 0;
}

/* What pixels of a row, as far as the sample's disc holds them, get of it. */
static Span weights_of_row(const Maps *maps, const Lone *lone, const Way *way, uint32_t y, double *weights)
{
    Square square = square_around(lone, way->radius);
    Span spans[2];
    double dy = (double)y - lone->y;
    find_spans(&square, lone, -1, half_width(abs((int)y - (int)lone->y), way->radius), spans);
    uint32_t x0 = spans[0].x0, n = spans[0].x1 - x0;
    weights_of(&maps->looks, lone, place_in(maps->area, x0, y), n, weights);
    double dx = (double)x0 - lone->x;
    if (way->mirrored)
        for (uint32_t i = 0; i < n; i++, dx++)
            weights[i] *= nearness(dx * dx + dy * dy, way->radius) + nearness_of_image(way, dx, dy);
    else
        for (uint32_t i = 0; i < n; i++, dx++) weights[i] *= nearness(dx * dx + dy * dy, way->radius);
    for (uint32_t i = 0; way->crowding > 0 && i < n; i++)
        if (weights[i] > 0) weights[i] *= crowd(maps, lone, way, x0 + i, y);
    return spans[0];
}

/* How far from grey: 0 is grey, 1.4 the light of one primary; more is that of one wavelength. */
static double tint_of(const double rgb[3], double light)
{
    double mean = (rgb[0] + rgb[1] + rgb[2]) / 3, apart = 0;
    for (int c = 0; c < 3; c++) apart += (rgb[c] - mean) * (rgb[c] - mean);
    return sqrt(apart / 3) / light;
}

/* What near pixels have of samples that are comparable to one, besides itself: the light of each, in their mean. Where all have
 * some, as of a faint reflection, it counts with what is plain for how dark a pixel is: that alone may be next to nothing, in
 * places, and what a pixel has more of that than others says nothing. */
static double usual_beside(const Maps *maps, const Lone *lone)
{
    Square square = square_around(lone, BESIDE);
    Span span = {square.x0, square.x1};
    uint32_t alike = 0, pixels = (square.x1 - square.x0) * (square.y1 - square.y0);
    for (uint32_t y = square.y0; y < square.y1; y++) alike += count_alike_of(maps, lone, &span, y, UINT32_MAX);
    return alike > 1 ? lone->light * (alike - 1) / (pixels - 1) : 0;
}

/* But for how pixels share in it: see find_shares. */
static Lone lone_at(const Maps *maps, uint32_t x, uint32_t y, int kept)
{
    const BrightPixel *pixel = bright_at(maps, x, y);
    double n = film_pixel(maps->film, x, y)->n, reference = reference_at(maps, x, y);
    float light = bright_light(pixel->rgb[kept]);
    Lone lone = {.x = x,
                 .y = y,
                 .thing = pixel->things[bright_seen(pixel, kept)],
                 .light = (double)light / n,
                 .reference = reference,
                 .least = light * ALIKE};
    const ThingBox *box = thing_boxes_find(&maps->boxes, lone.thing);
    if (box) lone.box = *box;
    for (int c = 0; c < 3; c++) lone.rgb[c] = (double)pixel->rgb[kept][c] / n;
    lone.seen = lone.light * (1 + TINTED * tint_of(lone.rgb, lone.light));
    return lone;
}

/* How pixels share in a sample. */
static void find_shares(const Maps *maps, Lone *lone)
{
    double beside = usual_beside(maps, lone), together = lone->reference + beside;
    lone->black = together > 0 ? TO_BLACK + (1 - TO_BLACK) * beside / together : 1;
    lone->slope = together > 0 ? (1 - TO_BLACK) / together : 0;
}

/* Where a sample goes, if it does. */
static bool find_way(const Maps *maps, const Lone *lone, Way *way)
{
    int radius = find_radius(maps, lone, way);
    way->radius = (uint8_t)radius;
    if (radius > 0 && radius <= NEAR) find_crowding(maps, lone, way);
    if (radius == 0 || (!(way->crowding > 0) && !way->mirrored)) return radius > 0;
    way->weights = 0;
    Square square = square_around(lone, radius);
    for (uint32_t y = square.y0; y < square.y1; y++) {
        double weights[2 * FARTHEST + 1];
        Span span = weights_of_row(maps, lone, way, y, weights);
        for (uint32_t i = 0; i < span.x1 - span.x0; i++) way->weights += weights[i];
    }
    return true;
}

static void find_ways_of_pixel(const Maps *maps, uint32_t x, uint32_t y, Row *row)
{
    const BrightPixel *bright = bright_at(maps, x, y);
    uint32_t n = film_pixel(maps->film, x, y)->n;
    if (n < SPREAD_LEAST_SAMPLES || is_plain(bright, n)) return;
    double much = STANDS_OUT * n * reference_at(maps, x, y), hole = hole_at(maps, x, y);
    for (int i = 0; i < BRIGHT_KEPT && (double)bright_light(bright->rgb[i]) > much; i++) {
        if (!has_few_alike(bright, i, n)) continue;
        Lone lone = lone_at(maps, x, y, i);
        find_shares(maps, &lone);
        Way way = {.x = x, .kept = (uint8_t)i, .part = 1, .black = lone.black, .slope = lone.slope};
        bool goes = find_way(maps, &lone, &way);
        /* what fills a hole stays */
        way.part = goes ? fmin(way.part, 1 - fmin(hole / lone.seen, 1)) : 0;
        hole = fmax(hole - (1 - way.part) * lone.light, 0);
        if (way.part == 0) continue;
        if (!ARRAY_ROOM(row->ways, row->capacity, row->n)) {
            row->out_of_memory = true;
            return;
        }
        row->ways[row->n++] = way;
        row->moved += way.part * lone.light;
        if (way.radius > row->farthest) row->farthest = way.radius;
    }
}

static void find_ways_of_row(void *context, uint32_t index, unsigned worker)
{
    const Maps *maps = context;
    (void)worker;
    for (uint32_t x = maps->area[0]; x < maps->area[2]; x++)
        find_ways_of_pixel(maps, x, maps->area[1] + index, &maps->rows[index]);
}

static double square_of_luminance(const double rgb[3])
{
    double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    return luminance * luminance;
}

static void take_from(const Maps *maps, const Lone *lone, double squared)
{
    SpreadPixel *from = &maps->pixels[place_in(maps->area, lone->x, lone->y)];
    for (int c = 0; c < 3; c++) from->rgb[c] -= lone->rgb[c];
    double mean, standard_error;
    film_luminance(film_pixel(maps->film, lone->x, lone->y), &mean, &standard_error);
    if (standard_error > 0) from->taken += squared / (standard_error * standard_error);
}

/* What a sample that is taken from row y brings to rows from y0 up to but without y1. */
static void go_way(const Maps *maps, uint32_t y, const Way *way, uint32_t y0, uint32_t y1)
{
    Lone lone = lone_at(maps, way->x, y, way->kept);
    lone.black = way->black;
    lone.slope = way->slope;
    for (int c = 0; c < 3; c++) lone.rgb[c] *= way->part;
    double squared = square_of_luminance(lone.rgb);
    Square square = square_around(&lone, way->radius);
    for (uint32_t v = square.y0 > y0 ? square.y0 : y0; v < square.y1 && v < y1; v++) {
        double weights[2 * FARTHEST + 1];
        Span span = weights_of_row(maps, &lone, way, v, weights);
        SpreadPixel *to = &maps->pixels[place_in(maps->area, span.x0, v)];
        for (uint32_t i = 0; i < span.x1 - span.x0; i++, to++) {
            double part = weights[i] / way->weights;
            for (int c = 0; c < 3; c++) to->rgb[c] += part * lone.rgb[c];
            to->given += part * part * squared;
        }
    }
    if (y >= y0 && y < y1) take_from(maps, &lone, squared);
}

/* Some rows of what samples bring, from all rows around. */
static void gather_band(void *context, uint32_t index, unsigned worker)
{
    const Maps *maps = context;
    uint32_t y0 = index * BAND, y1 = y0 + BAND < maps->height ? y0 + BAND : maps->height;
    (void)worker;
    for (uint32_t y = y0 > FARTHEST ? y0 - FARTHEST : 0; y < y1 + FARTHEST && y < maps->height; y++) {
        const Row *row = &maps->rows[y];
        uint32_t farthest = (uint32_t)row->farthest, top = maps->area[1];
        if (y + farthest < y0 || y >= y1 + farthest) continue;
        for (size_t i = 0; i < row->n; i++) go_way(maps, top + y, &row->ways[i], top + y0, top + y1);
    }
}

static bool maps_init(Maps *maps)
{
    size_t n = (size_t)maps->width * maps->height;
    Looks *looks = &maps->looks;
    float **floats[] = {&looks->shares[0], &looks->shares[1], &looks->shares[2],
                        &looks->plain,     &looks->around,    &looks->brightest};
    bool ready = (maps->rows = calloc(maps->height, sizeof *maps->rows)) != NULL;
    for (size_t i = 0; i < COUNT_OF(floats); i++) ready = (*floats[i] = calloc(n, sizeof(float))) != NULL && ready;
    for (int k = 0; k < BRIGHT_THINGS; k++)
        ready = (looks->things[k] = calloc(n, sizeof *looks->things[k])) != NULL && ready;
    return ready;
}

static void maps_clear(Maps *maps)
{
    Looks *looks = &maps->looks;
    for (uint32_t y = 0; maps->rows && y < maps->height; y++) free(maps->rows[y].ways);
    for (int k = 0; k < BRIGHT_THINGS; k++) {
        free(looks->things[k]);
        free(looks->shares[k]);
    }
    free(looks->plain);
    free(looks->around);
    free(looks->brightest);
    thing_boxes_clear(&maps->boxes);
    free(maps->rows);
}

static bool find_boxes(Maps *maps)
{
    const Looks *looks = &maps->looks;
    for (uint32_t y = maps->area[1]; y < maps->area[3]; y++)
        for (uint32_t x = maps->area[0]; x < maps->area[2]; x++)
            for (size_t i = place_in(maps->area, x, y), k = 0; k < BRIGHT_THINGS && looks->shares[k][i] > 0; k++)
                if (!thing_boxes_add(&maps->boxes, looks->things[k][i], x, y)) return false;
    return true;
}

/* false when memory ends. */
static bool find_and_go(Maps *maps, Pool *pool, Spread *spread)
{
    size_t n = (size_t)maps->width * maps->height;
    float *scratch = calloc(n, sizeof *scratch);
    if (!scratch) return false;
    pool_run(pool, maps->height, look_at_row, maps);
    if (!find_boxes(maps)) {
        free(scratch);
        return false;
    }
    mean_around(maps->looks.plain, maps->width, maps->height, AROUND, scratch, maps->looks.around, pool);
    free(scratch);
    pool_run(pool, maps->height, find_ways_of_row, maps);
    double light = 0, moved = 0;
    for (uint32_t y = 0; y < maps->height; y++) {
        const Row *row = &maps->rows[y];
        if (row->out_of_memory) return false;
        spread->samples += row->n;
        light += row->light;
        moved += row->moved;
    }
    if (spread->samples) pool_run(pool, (maps->height + BAND - 1) / BAND, gather_band, maps);
    spread->light = light > 0 ? moved / light : 0;
    return true;
}

Status spread_init(Spread *spread, const Film *film, const BrightFilm *bright, const uint32_t area[4], Pool *pool,
                   Error *error)
{
    *spread = (Spread){.area = {area[0], area[1], area[2], area[3]}};
    uint32_t width = area[2] - area[0], height = area[3] - area[1];
    size_t n = (size_t)width * height;
    spread->pixels = calloc(n, sizeof *spread->pixels);
    Maps maps = {
        .film = film, .bright = bright, .area = area, .width = width, .height = height, .pixels = spread->pixels};
    bool good = spread->pixels && maps_init(&maps) && find_and_go(&maps, pool, spread);
    maps_clear(&maps);
    if (good) return STATUS_OK;
    spread_clear(spread);
    return fail_memory(error, n * (sizeof *spread->pixels + (2 * BRIGHT_THINGS + 4) * sizeof(float)),
                       "single bright samples");
}

void spread_clear(Spread *spread)
{
    free(spread->pixels);
    *spread = (Spread){0};
}

void spread_apply(const Spread *spread, Image *image)
{
    const uint32_t *area = spread->area;
    for (uint32_t y = area[1]; y < area[3]; y++)
        for (uint32_t x = area[0]; x < area[2]; x++) {
            const SpreadPixel *from = spread_pixel(spread, x, y);
            float *pixel = image_at(image, x, y);
            for (int c = 0; c < 3; c++)
                if (from->rgb[c] != 0) pixel[c] = (float)((double)pixel[c] + from->rgb[c]);
        }
}
