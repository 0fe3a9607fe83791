/* spread_disc.c - how far a sample is spread by pixels, and what each of these gets.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/spread_maps.h"

#include <stdlib.h>

/* Measured on the examples, by the error against pictures of many samples, by dots that are left (bench fireflies), and by
 * eye: what is spread too near makes discs of the same brightness; too little, dots. */

/* Comparable samples that hold a neighbourhood up: next to a sample few, which are parts of one small bright thing; farther
 * away more, so many for each pixel of the radius, and in the end many, else their discs would be seen: of samples of another
 * colour than what is around, as dispersion makes them, the more by how much sooner a haze of that is seen. Without that a diamond
 * had clouds of violet and green. */
enum { NEAR = 2, NEAR_ENOUGH = 20, FAR_ENOUGH = 256 };
/* So many that lie together, where so many times fewer are as far as a larger disc reaches, are something small and bright, as the
 * glint of the sun, the spot of a lens or a line is; by chance one sample in a thousand would have as many so near. */
static const struct {
    uint32_t together;
    float fewer;
} clumps[CLUMP_SIZES] = {{2, 1000}, {3, 150}, {4, 32}, {6, 10}, {10, 4}, {40, 2}, {120, 1.5f}};
/* Of those that go as far as there is something, where hardly any are alike: so many tell whether these lie together; and so many
 * are no chance: a haze of them is what is there, however dark it is without. Of samples of another colour than what is around it takes
 * the more by how much sooner a haze of that is seen: velvet behind glass that disperses got the colour of the few that were found. */
enum { A_FEW = 4, NO_CHANCE = 8 };
/* Pixels around a sample, for what they have of comparable ones. */
enum { BESIDE = 2 };
/* What samples add to what is usual, spread, that is not seen; and what is a haze that is better than a dot. */
#define UNSEEN 0.1
#define FAINT 0.25
/* What is so bright that where it ends is seen sharply; and, of samples that lie apart in their clump, what is seen as a cloud. */
#define GLARING 10.0
#define CLOUDY 1.0
/* Samples to a pixel that are so close that what is found around pixels is not by chance. */
#define CLOSE 0.16f
/* So many are so sparse that a disc of them says little of what is there: kept, they are dots; spread, they are a cloud that is as
 * much by chance. Where there are more and their clump is but a part of a glow, as in frosted glass before a flame, dots all over are
 * more of a blemish. */
#define SPARSE (CLOSE / 10)
/* A haze of another colour is seen sooner than one of the same: how much sooner, for each unit of tint. */
#define TINTED 6.0
/* Of what a usual pixel gets, the part that a black one does. */
#define TO_BLACK (1 / 6.0)
/* Of a disc's reach: how far the middle of what it gives may be off its own where it counts as whole, the rest being seen less
 * than the texture that it is then found in, and how well an edge is found; and what an edge leaves of a disc at least. */
#define WHOLE 0.02
#define EDGE_FOUND 0.005
#define LEAST_LEFT 0.5

/* Of each of n pixels from `first` on: its share in the thing, and how much of a sample it gets, in relation to others, were it
 * beside it. */
static void weights_of(const Looks *looks, const Lone *lone, size_t first, uint32_t n, double *restrict shares,
                       double *restrict weights)
{
    const uint32_t *things[BRIGHT_THINGS];
    const float *of_things[BRIGHT_THINGS], *lit = (lone->by_found ? looks->found : looks->lit) + first;
    const uint32_t thing = lone->thing;
    const double black = lone->black, slope = lone->slope;
    for (int k = 0; k < BRIGHT_THINGS; k++) {
        things[k] = looks->things[k] + first;
        of_things[k] = looks->shares[k] + first;
    }
    for (uint32_t i = 0; i < n; i++) {
        float share = 0;
        for (int k = BRIGHT_THINGS - 1; k >= 0; k--) {
            float own = of_things[k][i]; /* read in any case: no jumps */
            share = things[k][i] == thing ? own : share;
        }
        double light = black + slope * (double)lit[i];
        shares[i] = (double)share;
        weights[i] = (double)share * (light < 1 ? light : 1);
    }
}

static double weight_of(const Looks *looks, const Lone *lone, size_t pixel)
{
    double share, weight;
    weights_of(looks, lone, pixel, 1, &share, &weight);
    return weight;
}

/* The most of a map at the pixels next to one, and of its mean around. */
static double most_beside(const Maps *maps, const float *map, const float *around, uint32_t x, uint32_t y)
{
    float most = around[place_in(maps, x, y)];
    for (uint32_t v = y > 0 ? y - 1 : y; v <= y + 1 && v < maps->height; v++)
        for (uint32_t u = x > 0 ? x - 1 : x; u <= x + 1 && u < maps->width; u++)
            most = fmaxf(most, map[place_in(maps, u, v)]);
    return (double)most;
}

double spread_reference(const Maps *maps, uint32_t x, uint32_t y)
{
    return most_beside(maps, maps->looks.plain, maps->looks.around, x, y);
}

double spread_usual_light(const Maps *maps, uint32_t x, uint32_t y)
{
    return most_beside(maps, maps->looks.lit, maps->looks.lit_around, x, y);
}

/* The pixel's samples that are comparable to it, as far as they are kept, and of these those that `kept` has: see Looks.few. */
static uint32_t count_kept(const Maps *maps, const Lone *lone, size_t pixel, uint32_t kept)
{
    const Looks *looks = &maps->looks;
    const float *lights = looks->lights[pixel];
    uint32_t seen = looks->seen[pixel], alike = 0;
    if (looks->brightest[pixel] < lone->least) return 0;
    uint32_t thing = find_thing(looks, pixel, lone->thing);
    if (thing == BRIGHT_THINGS) return 0;
    for (int i = 0; i < BRIGHT_KEPT && lights[i] >= lone->least; i++, kept >>= 1)
        alike += bright_seen_of(seen, i) == thing && (kept & 1);
    return alike;
}

static uint32_t count_alike(const Maps *maps, const Lone *lone, size_t pixel)
{
    return count_kept(maps, lone, pixel, UINT32_MAX);
}

/* The same of pixels of a row, and where they are; few: of those that have few alike in their pixel. */
static void add_alike_of(const Maps *maps, const Lone *lone, const Columns *span, uint32_t y, bool few, Around *sums)
{
    size_t pixel = place_in(maps, span->x0, y);
    for (uint32_t x = span->x0; x < span->x1; x++, pixel++)
        if (UNLIKELY(maps->looks.brightest[pixel] >= lone->least))
            around_add_alike(sums, count_kept(maps, lone, pixel, few ? maps->looks.few[pixel] : UINT32_MAX),
                             (double)x - lone->x, (double)y - lone->y);
}

/* How far a sample's colour is from that of all light around: 0 is the same, 1.4 the light of one primary in grey; more is that
 * of one wavelength. What all around is lit by has no tint. */
static double tint_of(const Maps *maps, const Lone *lone)
{
    size_t pixel = place_in(maps, lone->x, lone->y);
    double around[3], sum = 0, apart = 0;
    for (int c = 0; c < 3; c++) sum += around[c] = fmax((double)maps->looks.colors[c][pixel], 0);
    for (int c = 0; c < 3; c++) {
        double usual = sum > 0 ? 3 * around[c] / sum : 1, off = lone->rgb[c] / lone->light - usual;
        apart += off * off;
    }
    return sqrt(apart / 3);
}

/* What near pixels have of samples that are comparable to one, besides itself: the light of each, in their mean. Where all have
 * some, as of a faint reflection, it counts with what is plain for how dark a pixel is: that alone may be next to nothing, in
 * places, and what a pixel has more of that than others says nothing. */
static double usual_beside(const Maps *maps, const Lone *lone)
{
    Square square = square_around(lone, BESIDE);
    Columns span = {square.x0, square.x1};
    Around sums = {0};
    uint32_t pixels = (square.x1 - square.x0) * (square.y1 - square.y0);
    for (uint32_t y = square.y0; y < square.y1; y++) add_alike_of(maps, lone, &span, y, false, &sums);
    return sums.alike > 1 ? lone->light * (sums.alike - 1) / (pixels - 1) : 0;
}

Lone spread_lone(const Maps *maps, uint32_t x, uint32_t y, int kept)
{
    const BrightPixel *pixel = bright_at(maps, x, y);
    double n = film_pixel(maps->film, x, y)->n;
    float light = bright_light(pixel->rgb[kept]);
    Lone lone = {.x = x,
                 .y = y,
                 .thing = pixel->things[bright_seen(pixel, kept)],
                 .light = (double)light / n,
                 .reference = spread_reference(maps, x, y),
                 .lit = spread_usual_light(maps, x, y),
                 .least = light * ALIKE};
    const ThingBox *box = thing_boxes_find(&maps->boxes, lone.thing);
    if (box) lone.box = *box;
    float tint[3];
    tint_at(maps, x, y, tint);
    for (int c = 0; c < 3; c++) {
        lone.rgb[c] = (double)pixel->rgb[kept][c] / n;
        lone.untinted[c] = lone.rgb[c] / (double)tint[c];
    }
    lone.seen = lone.light * (1 + TINTED * tint_of(maps, &lone));
    return lone;
}

void spread_find_shares(const Maps *maps, Lone *lone)
{
    double reflectance = (double)reflectance_at(maps, lone->x, lone->y);
    double beside = usual_beside(maps, lone) / reflectance, together = lone->lit + beside;
    lone->black = together > 0 ? TO_BLACK + (1 - TO_BLACK) * beside / together : 1;
    lone->slope = together > 0 ? (1 - TO_BLACK) / together : 0;
}

/* Columns to both sides of a sample that a disc and its square hold in a row of pixels; < 0: none. */
static int half_width(int dy, int radius)
{
    double left = end_of(radius) - (double)dy * dy;
    return left < 0 ? -1 : (int)sqrt(left);
}

/* What of a row is within `outer` columns of a sample, and not within `inner`, on either side; inner -1: all on the first. */
static void find_spans(const Square *square, const Lone *lone, int inner, int outer, Columns spans[2])
{
    uint32_t x = lone->x, reach = (uint32_t)outer, done = (uint32_t)(inner + 1);
    uint32_t x0 = x > square->x0 + reach ? x - reach : square->x0;
    uint32_t x1 = square->x1 - x > reach ? x + reach + 1 : square->x1;
    spans[0] = (Columns){x0, inner < 0 ? x1 : x - x0 >= done ? x - done + 1 : x0};
    spans[1] = (Columns){inner >= 0 && x1 - x > done ? x + done : x1, x1};
}

static void sum_span(const Maps *maps, const Lone *lone, const Columns *span, uint32_t y, Around *sums)
{
    double weights[2 * SPREAD_FARTHEST + 1], shares[2 * SPREAD_FARTHEST + 1], dy = (double)y - lone->y;
    if (span->x0 >= span->x1) return;
    size_t first = place_in(maps, span->x0, y);
    weights_of(&maps->looks, lone, first, span->x1 - span->x0, shares, weights);
    Around sum = {0};
    double dx = (double)span->x0 - lone->x;
    for (uint32_t i = 0; i < span->x1 - span->x0; i++, dx++) {
        double distance = dx * dx + dy * dy, weight = weights[i];
        double light = shares[i] * (double)maps->looks.plain_root[first + i];
        sum.weights += weight;
        sum.shares += shares[i];
        sum.shares_by_distance += shares[i] * distance;
        sum.light += light;
        sum.weights_by_distance += weight * distance;
        sum.light_by_distance += light * distance;
        sum.middle[0] += weight * dx;
        sum.middle_by_distance[0] += weight * distance * dx;
    }
    sums->weights += sum.weights;
    sums->shares += sum.shares;
    sums->shares_by_distance += sum.shares_by_distance;
    sums->light += sum.light;
    sums->weights_by_distance += sum.weights_by_distance;
    sums->light_by_distance += sum.light_by_distance;
    sums->middle[0] += sum.middle[0];
    sums->middle_by_distance[0] += sum.middle_by_distance[0];
    sums->middle[1] += sum.weights * dy;
    sums->middle_by_distance[1] += sum.weights_by_distance * dy;
}

/* From one disc, and its square, to a larger one. inner -1: there is none. Farther away, and then anew, only what has few alike
 * where it is counts. A lamp that is seen there, in bright pixels, does not hold up what is dark. */
static void look_farther(const Maps *maps, const Lone *lone, int inner, int outer, Around *sums)
{
    Square square = square_around(lone, outer);
    bool few = outer > NEAR;
    int counted = few && inner <= NEAR ? -1 : inner;
    if (counted < 0) sums->alike = 0, sums->alike_middle[0] = sums->alike_middle[1] = 0;
    for (uint32_t y = square.y0; y < square.y1; y++) {
        int dy = abs((int)y - (int)lone->y);
        Columns discs[2], squares[2];
        find_spans(&square, lone, half_width(dy, inner), half_width(dy, outer), discs);
        find_spans(&square, lone, dy > counted ? -1 : counted, outer, squares);
        for (int side = 0; side < 2; side++) {
            sum_span(maps, lone, &discs[side], y, sums);
            add_alike_of(maps, lone, &squares[side], y, few, sums);
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

double spread_own_weight(const Maps *maps, const Lone *lone)
{
    return weight_of(&maps->looks, lone, place_in(maps, lone->x, lone->y));
}

int spread_next_radius(int radius)
{
    return radius + 1 + radius / 2;
}

uint32_t spread_enough(const Lone *lone, int radius)
{
    int enough = radius * NEAR_ENOUGH;
    if (radius <= NEAR) return (uint32_t)enough;
    return (uint32_t)((enough < FAR_ENOUGH ? enough : FAR_ENOUGH) * lone->seen / lone->light);
}

/* What pixels of a disc get together, where there is no image. */
static double weights_within(const Around *sums, int radius)
{
    return sums->weights - sums->weights_by_distance / end_of(radius);
}

bool spread_ends(const Lone *lone, const Around *sums, int radius, double own, Way *way, double *alone)
{
    double end = end_of(radius);
    uint32_t enough = spread_enough(lone, radius);
    way->weights = weights_within(sums, radius);
    double root = (sums->light - sums->light_by_distance / end) / (sums->shares - sums->shares_by_distance / end);
    *alone = lone->seen * own / (way->weights * fmin(lone->reference, root * root * root * root));
    bool unseen = sums->alike * *alone <= UNSEEN;
    if (!unseen && sums->alike < LEAST_LEFT * enough) return false;
    double left = find_image(sums, radius, way);
    return unseen || sums->alike >= left * enough;
}

static float pixels_within(const Lone *lone, int radius)
{
    Square square = square_around(lone, radius);
    return (float)(square.x1 - square.x0) * (float)(square.y1 - square.y0);
}

static Density density_in(const Lone *lone, const Around *sums, int radius)
{
    return (Density){(float)(sums->alike / sums->shares), (float)sums->alike / pixels_within(lone, radius)};
}

/* In both ways: where a thing is seen in a few pixels only, or by few of their samples, one of them says nothing. */
static bool is_thin(Density here, Density there, float fewer)
{
    return here.by_share * fewer < there.by_share && here.by_pixel * fewer < there.by_pixel;
}

/* The largest small one that what is farther away shows to be a clump; -1: none. */
static int known_clump(const Clump *clump, Density density)
{
    int i = CLUMP_SMALL - 1;
    while (i >= 0 && !(clump->radius[i] > 0 && is_thin(density, clump->density[i], clumps[i].fewer))) i--;
    return i;
}

bool spread_is_in_clump(const Lone *lone, const Around *sums, int radius, Clump *clump)
{
    Density density = density_in(lone, sums, radius);
    if (sums->alike >= A_FEW) {
        clump->densest.by_share = fmaxf(clump->densest.by_share, density.by_share);
        clump->densest.by_pixel = fmaxf(clump->densest.by_pixel, density.by_pixel);
    }
    for (int i = 0; i < CLUMP_SIZES && sums->alike >= clumps[i].together; i++) {
        if (clump->radius[i] == 0) {
            clump->radius[i] = (uint16_t)radius;
            clump->density[i] = density;
        }
    }
    for (int i = CLUMP_SMALL; i < CLUMP_SIZES && clump->radius[i] > 0; i++)
        clump->is_larger = clump->is_larger || is_thin(density, clump->density[i], clumps[i].fewer);
    int known = known_clump(clump, density);
    clump->known = (uint8_t)(known < 0 ? CLUMP_SMALL - 1 : known);
    return known >= 0;
}

/* Fewer comparable samples than so many, of another colour the more. */
static bool are_fewer(const Lone *lone, const Around *sums, int n)
{
    return sums->alike * lone->light < n * lone->seen;
}

int spread_farthest(const Lone *lone, const Around *sums, int radius, double alone, Way *way)
{
    bool even = !is_thin(density_in(lone, sums, radius), way->clump.densest, clumps[CLUMP_SMALL - 1].fewer);
    /* those that lie together make a haze together, in which colours make up for each other */
    double haze = even ? alone : alone * sums->alike * lone->light / lone->seen;
    if (haze > FAINT && (!even || are_fewer(lone, sums, NO_CHANCE))) return 0;
    (void)find_image(sums, radius, way);
    return radius;
}

/* Whether comparable samples lie to one side, more than chance would have it in one disc of a hundred: there is an edge of light. */
static bool is_aside(const Around *sums, int radius)
{
    double off = 0, apart = (2.0 * radius + 1) * (2.0 * radius + 1) / 12; /* along each axis, squared */
    for (int i = 0; i < 2; i++) {
        double away = sums->alike_middle[i] / sums->alike - sums->middle[i] / sums->weights;
        off += away * away;
    }
    return off * sums->alike > 9.2 * apart;
}

/* How bright a disc of as many alike would be, beside what is usual there and in the picture. */
static double brightness_of_disc(const Maps *maps, const Lone *lone, const Around *sums, double weights)
{
    double haze = lone->light * spread_own_weight(maps, lone) * sums->alike / weights;
    return haze / fmax(lone->reference, maps->typical);
}

bool spread_is_uneven(const Maps *maps, const Lone *lone, const Around *sums, int radius, const Clump *clump)
{
    return clump->radius[CLUMP_SMALL - 1] > 0 && (clump->is_larger || is_aside(sums, radius)) &&
           brightness_of_disc(maps, lone, sums, weights_within(sums, radius)) > GLARING;
}

/* Spreads a sample over its clump, which is no disc: where samples lie close, pixels get by what light is found around them. Where
 * they do not, a glaring disc is more of a blemish than dots are; so is a bright cloud where they are sparse, or known to end there, as
 * glints do. The radius, or 0. */
static int stay_in_clump(const Maps *maps, Lone *lone, bool known, Way *way)
{
    Around sums = {0};
    int radius = way->clump.radius[way->clump.known];
    float density = way->clump.density[way->clump.known].by_pixel;
    bool close = density > CLOSE, apart = radius > NEAR;
    if (apart && close) {
        lone->by_found = way->by_found = true;
        lone->black = way->black = 0;
        lone->slope = way->slope = 1e-3 / (double)maps->looks.found[place_in(maps, lone->x, lone->y)];
    }
    look_farther(maps, lone, -1, radius, &sums);
    way->weights = weights_within(&sums, radius);
    if (apart && !close &&
        brightness_of_disc(maps, lone, &sums, way->weights) > (known || density < SPARSE ? CLOUDY : GLARING))
        return 0;
    /* nor do a few of one colour each make a small disc of theirs */
    if (!apart && are_fewer(lone, &sums, NEAR) && brightness_of_disc(maps, lone, &sums, way->weights) > GLARING)
        return 0;
    (void)find_image(&sums, radius, way);
    return radius;
}

/* How far a sample is spread, and what pixels get together. */
static int find_radius(const Maps *maps, Lone *lone, Way *way)
{
    Around sums = {0};
    int radius = -1, most = spread_by_cells(&lone->box) ? SPREAD_NEAR : SPREAD_FARTHEST;
    double alone = 0, own = spread_own_weight(maps, lone);
    bool ends = false;
    for (int next = 1; next <= most && !ends; next = spread_next_radius(next)) {
        look_farther(maps, lone, radius, next, &sums);
        radius = next;
        if (spread_is_in_clump(lone, &sums, radius, &way->clump)) return stay_in_clump(maps, lone, true, way);
        ends = spread_ends(lone, &sums, radius, own, way, &alone);
    }
    way->far = !ends && most < SPREAD_FARTHEST;
    if (way->far) return radius;
    if (spread_is_uneven(maps, lone, &sums, radius, &way->clump)) return stay_in_clump(maps, lone, false, way);
    return ends ? radius : spread_farthest(lone, &sums, radius, alone, way);
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
            if (!(weight_of(&maps->looks, lone, place_in(maps, x, y)) > 0)) continue;
            double samples = film_pixel(maps->film, x, y)->n, alike = count_alike(maps, lone, place_in(maps, x, y));
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
    return (1 + way->crowding * count_alike(maps, lone, place_in(maps, x, y))) / (1 + way->crowding * expected);
}

Columns spread_weights_of_row(const Maps *maps, const Lone *lone, const Way *way, uint32_t y, double *weights)
{
    Square square = square_around(lone, way->radius);
    Columns spans[2];
    double dy = (double)y - lone->y;
    find_spans(&square, lone, -1, half_width(abs((int)y - (int)lone->y), way->radius), spans);
    uint32_t x0 = spans[0].x0, n = spans[0].x1 - x0;
    double shares[2 * SPREAD_FARTHEST + 1];
    weights_of(&maps->looks, lone, place_in(maps, x0, y), n, shares, weights);
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

Lone spread_lone_on_way(const Maps *maps, uint32_t y, const Way *way)
{
    Lone lone = spread_lone(maps, way->x, y, way->kept);
    lone.black = way->black;
    lone.slope = way->slope;
    lone.by_found = way->by_found;
    for (int c = 0; c < 3; c++) lone.untinted[c] *= way->part;
    return lone;
}

/* Whether comparable samples lie where light is, as chance would not have it if black pixels had their part of them: by the likelihood
 * of where they lie, with that part and without. In an icicle that shows the sun at its tip and dark land elsewhere, the dark stays. */
static bool shuns_the_dark(const Maps *maps, const Lone *lone, int radius)
{
    const double least = 0.01; /* of what pixels without light get as it is: there may be some by chance */
    const double surely = 3;
    Square square = square_around(lone, radius);
    Lone by_light = *lone;
    by_light.black = 0;
    by_light.slope = lone->slope / (1 - TO_BLACK);
    double sums[2] = {0}, likelier = 0; /* the logarithm of by how much */
    uint32_t n = 0, columns = square.x1 - square.x0;
    for (uint32_t y = square.y0; y < square.y1; y++) {
        double shares[2 * SPREAD_FARTHEST + 1], weights[2 * SPREAD_FARTHEST + 1], lit[2 * SPREAD_FARTHEST + 1];
        size_t pixel = place_in(maps, square.x0, y);
        weights_of(&maps->looks, lone, pixel, columns, shares, weights);
        weights_of(&maps->looks, &by_light, pixel, columns, shares, lit);
        for (uint32_t i = 0; i < columns; i++) {
            lit[i] = lit[i] > least * weights[i] ? lit[i] : least * weights[i];
            sums[0] += weights[i];
            sums[1] += lit[i];
        }
        for (uint32_t i = 0; i < columns; i++) {
            if (LIKELY(maps->looks.brightest[pixel + i] < lone->least) || !(weights[i] > 0)) continue;
            uint32_t alike = count_kept(maps, lone, pixel + i, maps->looks.few[pixel + i]);
            n += alike;
            if (alike > 0) likelier += alike * log(lit[i] / weights[i]);
        }
    }
    return n > 0 && likelier - n * log(sums[1] / sums[0]) > surely;
}

/* The rest of a way by pixels, when its radius is known. */
static void finish_way(const Maps *maps, Lone *lone, int radius, Way *way)
{
    way->radius = (uint16_t)radius;
    if (radius > NEAR && !way->by_found && shuns_the_dark(maps, lone, radius)) {
        lone->black = way->black = 0;
        lone->slope = way->slope = lone->slope / (1 - TO_BLACK);
        way->weights = 0;
    }
    if (radius > 0 && radius <= NEAR) find_crowding(maps, lone, way);
    if (radius == 0 || (!(way->crowding > 0) && !way->mirrored && way->weights > 0)) return;
    way->weights = 0;
    Square square = square_around(lone, radius);
    for (uint32_t y = square.y0; y < square.y1; y++) {
        double weights[2 * SPREAD_FARTHEST + 1];
        Columns span = spread_weights_of_row(maps, lone, way, y, weights);
        for (uint32_t i = 0; i < span.x1 - span.x0; i++) way->weights += weights[i];
    }
    if (!(way->weights > 0)) way->radius = 0;
}

void spread_in_clump(const Maps *maps, Lone *lone, bool known, Way *way)
{
    way->far = false;
    finish_way(maps, lone, stay_in_clump(maps, lone, known, way), way);
}

void spread_find_way(const Maps *maps, Lone *lone, Way *way)
{
    int radius = find_radius(maps, lone, way);
    if (!way->far) finish_way(maps, lone, radius, way);
}
