/* spread_maps.h - what is known of pixels, and of samples on their way; private to src/render/spread*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SPREAD_MAPS_H
#define MEN_SPREAD_MAPS_H

#include <math.h>

#include "base/luminance.h"
#include "render/spread.h"
#include "render/thing_boxes.h"

/* Samples are alike down to this part of the brightest. */
#define ALIKE 0.4f
/* A pixel that has so many that are alike has found what it shows; of few samples a part of them is enough. */
enum { FEW = 8, FEW_PART = 4 };
/* Pixels from a sample to the last that get of it, at most. */
enum { SPREAD_FARTHEST = 472 };
/* Up to which radius a sample is spread by pixels, where its thing is seen in so many or more; in less always. */
enum { SPREAD_NEAR = 26, SPREAD_CELLS_FROM = 6400 };

/* What is asked of pixels again and again, each kind together, so that rows of pixels are gone through fast. */
typedef struct Looks {
    uint32_t *things[BRIGHT_THINGS];
    float *shares[BRIGHT_THINGS]; /* of its samples, those that saw each, times its reflectance; 0: none */
    float *plain;                 /* its light, see bright_light, without the samples that have few like them there */
    float
        *plain_root;  /* the fourth root of that: the fourth power of its mean is hardly raised by few bright pixels; */
    float *around;    /* the mean of what is plain around it */
    float *colors[3]; /* the mean of all light around it, in each channel; */
    float *lit;       /* what is plain, over its reflectance: how much light there is; */
    float *lit_around;            /* and the mean of that around it; */
    float *found;                 /* likewise all its light, with these samples: what there is of that next to it */
    float *reflectance;           /* see find_reflectances; */
    float *told;                  /* and how far what its samples say of it is believed */
    float *brightest;             /* of its samples, as far as they are kept; */
    float (*lights)[BRIGHT_KEPT]; /* all of these, the brightest first, */
    uint32_t *seen;               /* and what they saw, as bright_seen() has it; */
    uint8_t *few;                 /* a bit for each of them, from the lowest: few of its pixel's are like it */
} Looks;

/* How close together comparable samples lie, in what a disc holds of the thing, and in pixels. */
typedef struct Density {
    float by_share, by_pixel;
} Density;

/* Where they lie closer together than farther away, as in the spot of a lens: found from disc to disc. */
enum { CLUMP_SIZES = 7, CLUMP_SMALL = 5 /* the first ones: samples go no farther than these */ };
typedef struct Clump {
    uint16_t radius[CLUMP_SIZES]; /* of the least disc that has so many; 0: none has, so far */
    uint8_t known;  /* the small one that what is farther away has shown to be a clump, else the last of them */
    bool is_larger; /* and it has shown one that is not small to be one */
    Density density[CLUMP_SIZES], densest; /* of those, and the most of any that has a few */
} Clump;

/* Where a sample goes. */
typedef struct Way {
    uint32_t x;
    uint8_t kept;           /* which of its pixel's it is */
    uint16_t radius;        /* 0: it stays */
    bool mirrored;          /* at an edge that cuts its disc: see find_image */
    bool far;               /* it goes by cells: see spread_far.c */
    bool by_found;          /* see Lone */
    float image[2];         /* from the sample to its image behind that edge, in columns and rows */
    double light, seen;     /* see Lone */
    double part;            /* of the sample, what goes */
    double crowding, usual; /* see find_crowding */
    double weights;         /* of all pixels together */
    double black, slope;    /* see Lone */
    Clump clump;
} Way;

/* A row of pixels: what is found of it. */
typedef struct Row {
    Way *ways;
    size_t n, capacity;
    int farthest;              /* of the radii of those that do not go by cells */
    double light;              /* of the picture, in sum, */
    double moved;              /* of these samples; */
    double one_colored[3];     /* and of those of one colour, by the channel that has most */
    double taken[3], given[3]; /* in each channel what goes, and what comes; */
    double given_size[3];      /* and the sum of the sizes of what comes */
    size_t n_going;            /* of them */
    bool out_of_memory;
} Row;

/* Of the film: by its rows. */
typedef struct Maps {
    const Film *film;
    const BrightFilm *bright;
    uint32_t width, height;
    Looks looks;
    double typical;   /* of all light around pixels, by the mean of its fourth root */
    ThingBoxes boxes; /* of what is seen in it */
    Row *rows;
    SpreadPixel *pixels;
    Pool *pool;
} Maps;

static inline size_t place_in(const Maps *maps, uint32_t x, uint32_t y)
{
    return (size_t)y * maps->width + x;
}

static inline const BrightPixel *bright_at(const Maps *maps, uint32_t x, uint32_t y)
{
    return &maps->bright->pixels[place_in(maps, x, y)];
}

/* A part of the light that comes to a pixel that is reflected at least, as it is taken here: what is black has some skin. */
#define LEAST_REFLECTED 0.02f

/* And in each channel, of the mean. */
#define LEAST_TINT 0.05f

static inline float reflectance_at(const Maps *maps, uint32_t x, uint32_t y)
{
    return maps->looks.reflectance[place_in(maps, x, y)];
}

static inline void tint_at(const Maps *maps, uint32_t x, uint32_t y, float tint[3])
{
    const float told = maps->looks.told[place_in(maps, x, y)];
    bright_tint(bright_at(maps, x, y), tint);
    for (int c = 0; c < 3; c++) {
        float own = 1 + told * (tint[c] - 1);
        tint[c] = own > LEAST_TINT ? own : LEAST_TINT;
    }
}

/* A sample on its way. */
typedef struct Lone {
    uint32_t x, y, thing;
    double light, rgb[3]; /* as parts of its pixel's mean, */
    double untinted[3];   /* and if what is reflected there had no colour */
    double seen;          /* its light, as a haze of it is seen */
    double reference;     /* what is usual there: the most of the brightest plain pixel next to it, the mean around */
    double lit;           /* how much light is: the same of that */
    double black, slope;  /* what a pixel gets by how much light it has: black + slope * lit, but 1 at most; */
    bool by_found;        /* or slope * found, see Looks: in a clump */
    float least;          /* of comparable samples */
    ThingBox box;         /* where the thing is seen: nothing is to be found beyond it */
} Lone;

/* Columns of a row of pixels: from x0 up to but without x1. */
typedef struct Columns {
    uint32_t x0, x1;
} Columns;

/* A part of the thing's box: from x0, y0 up to but without x1, y1. */
typedef struct Square {
    uint32_t x0, y0, x1, y1;
} Square;

static inline Square square_around(const Lone *lone, int radius)
{
    uint32_t r = (uint32_t)radius;
    const ThingBox *box = &lone->box;
    return (Square){lone->x > box->x0 + r ? lone->x - r : box->x0, lone->y > box->y0 + r ? lone->y - r : box->y0,
                    lone->x + r < box->x1 ? lone->x + r + 1 : box->x1,
                    lone->y + r < box->y1 ? lone->y + r + 1 : box->y1};
}

/* What is found around a sample: sums over the pixels of a disc, such that they grow with it. */
typedef struct Around {
    double weights, shares,
        light; /* of weights, of shares, and by these of the fourth root of what pixels have without it */
    double weights_by_distance, shares_by_distance, light_by_distance; /* the same, times the distance squared */
    double middle[2], middle_by_distance[2]; /* weights times columns and rows from the sample, and times both */
    uint32_t alike;                          /* comparable samples in the square, */
    double alike_middle[2];                  /* and columns and rows to these */
} Around;

static inline void around_add_alike(Around *sums, uint32_t alike, double dx, double dy)
{
    sums->alike += alike;
    sums->alike_middle[0] += alike * dx;
    sums->alike_middle[1] += alike * dy;
}

/* Which of a pixel's things one is; BRIGHT_THINGS: none. */
static inline uint32_t find_thing(const Looks *looks, size_t pixel, uint32_t thing)
{
    uint32_t i = 0;
    while (i < BRIGHT_THINGS && !(looks->things[i][pixel] == thing && looks->shares[i][pixel] > 0)) i++;
    return i;
}

static inline uint32_t few_of(uint32_t n_samples)
{
    return n_samples / FEW_PART < FEW ? n_samples / FEW_PART : FEW;
}

/* The square of the distance where nearness ends; none before the first disc. */
static inline double end_of(int radius)
{
    return radius < 0 ? -1 : (radius + 0.5) * (radius + 0.5);
}

/* By how much that is less farther away: of the way to where nothing is left, which is half a pixel beyond the radius. */
static inline double nearness(double distance_squared, int radius)
{
    double reach = radius + 0.5;
    return 1 - distance_squared / (reach * reach);
}

/* What of a sample's image behind an edge reaches to beside the sample. */
static inline double nearness_of_image(const Way *way, double dx, double dy)
{
    double x = dx - (double)way->image[0], y = dy - (double)way->image[1];
    double near = nearness(x * x + y * y, way->radius);
    return near > 0 ? near : 0;
}

static inline double spread_squared_luminance(const double rgb[3])
{
    double luminance = luminance_of(rgb[0], rgb[1], rgb[2]);
    return luminance * luminance;
}

/* ---- spread_disc.c ---- */

/* What is usual at a pixel, see Lone: of what is plain, and of how much light there is. */
double spread_reference(const Maps *maps, uint32_t x, uint32_t y);
double spread_usual_light(const Maps *maps, uint32_t x, uint32_t y);
/* A sample, but for how pixels share in it. */
Lone spread_lone(const Maps *maps, uint32_t x, uint32_t y, int kept);
void spread_find_shares(const Maps *maps, Lone *lone);
double spread_own_weight(const Maps *maps, const Lone *lone); /* what its own pixel gets, in relation to others */
/* Radii that are tried: 1, and after each a half more. */
int spread_next_radius(int radius);
/* How many comparable samples the square around the disc must hold. */
uint32_t spread_enough(const Lone *lone, int radius);
/* Whether the sample is to be spread so far and no farther, by what is there. Then it is known where its image is; what all pixels
 * get is, if there is none. *alone: what the sample adds where it is, over what is usual there. */
bool spread_ends(const Lone *lone, const Around *sums, int radius, double own, Way *way, double *alone);
/* What is around up to a radius tells of clumps, too: whether the least is known to be one, and the sample is to be spread over that. */
bool spread_is_in_clump(const Lone *lone, const Around *sums, int radius, Clump *clump);
/* Whether what is around is so bright, and lies so unevenly, that a disc of that radius would be seen: the sample is in a clump. */
bool spread_is_uneven(const Maps *maps, const Lone *lone, const Around *sums, int radius, const Clump *clump);
/* Of one that does not end up to the last radius that there is: that one, or 0. One that would be more than faint wherever it goes,
 * alone or with few others, is less of a blemish where it is. */
int spread_farthest(const Lone *lone, const Around *sums, int radius, double alone, Way *way);
/* Spreads a sample that was to go by cells over its clump, by pixels. known: the clump ends there, by what is farther away. */
void spread_in_clump(const Maps *maps, Lone *lone, bool known, Way *way);
/* Where a sample goes, by its radius. far: that is to be found by cells. */
void spread_find_way(const Maps *maps, Lone *lone, Way *way);
/* What of a sample in row y goes its way. */
Lone spread_lone_on_way(const Maps *maps, uint32_t y, const Way *way);
/* What pixels of a row, as far as the sample's disc holds them, get of it. weights: 2 * SPREAD_FARTHEST + 1 of them. */
Columns spread_weights_of_row(const Maps *maps, const Lone *lone, const Way *way, uint32_t y, double *weights);

/* ---- spread_far.c ---- */

/* One that goes by cells. */
typedef struct FarSample {
    uint32_t thing;
    int level;         /* by how much light is usual where it is */
    uint32_t row, way; /* of the maps, and of the row */
} FarSample;

typedef struct FarSamples {
    FarSample *samples; /* by things and levels; then by rows */
    size_t n;
} FarSamples;

/* Where samples that go far do so by cells. */
static inline bool spread_by_cells(const ThingBox *box)
{
    return (uint64_t)(box->x1 - box->x0) * (box->y1 - box->y0) >= SPREAD_CELLS_FROM;
}

/* Takes the samples that are far from the rows, and finds their ways. Cleared by the caller, in any case. false when memory
 * ends. */
ATTR_NODISCARD bool spread_far_find(const Maps *maps, FarSamples *far);
/* What pixels get of those; not what is taken from the samples' own. */
ATTR_NODISCARD bool spread_far_give(const Maps *maps, const FarSamples *far);
void spread_far_clear(FarSamples *far);

#endif
