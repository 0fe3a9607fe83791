/* guide_lobes.h - lobes of directions about means that depend on the place; private to src/trace/guide*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_LOBES_H
#define MEN_GUIDE_LOBES_H

#include "base/attr.h"
#include "base/lanes.h"
#include "base/vec3.h"
#include "trace/turns.h"

/* A place, from the cell's origin, and the colour by which light was bent that comes there, see guide_color. */
typedef struct GuidePlace {
    Vec3f offset;
    float color;
} GuidePlace;

/* Directions about a mean that depends linearly on the place and the colour. Directions near the axis are points of a plane by
 * Lambert's azimuthal projection, which keeps areas, so that densities per area are densities per steradian. The lobe is the
 * wider, and counts the less, the further away its place is. */
typedef struct GuideLobe {
    float cumulative;          /* share of the cell's light, of this lobe's sheet and those before */
    float weight;              /* of its sheet */
    uint32_t n_sheet;          /* how many lobes the sheet has, from its first on */
    float bend;                /* how wrong it is for places away from its own: angle by the square of the distance */
    Vec3f place;               /* where it was found, from the cell's origin; the nearest lobe of a sheet knows best */
    Vec3f axis, x, y;          /* a right-handed frame */
    Vec3f slope_x, slope_y;    /* of the mean in the plane, by the place */
    float mean_x, mean_y;      /* at the cell's origin, of colour 0 */
    float xx, xy, yy;          /* spread about the mean, at its place */
    float color, hue_x, hue_y; /* of its light; slope of the mean by the colour */
    float hue_bend;            /* how wrong it is for other colours: angle by the square of the difference */
    uint32_t turns;            /* what its light did on its way, see Turns; TURNS_UNTOLD: one thing or another */
} GuideLobe;

enum {
    GUIDE_CELL_KNOWN = 32, /* of its own, */
    GUIDE_CELL_LENT = 16,  /* those that others lend it, */
    GUIDE_CELL_WAYS = 3,   /* each around all of what comes by one way, */
    GUIDE_CELL_LOBES = GUIDE_CELL_KNOWN + GUIDE_CELL_LENT + GUIDE_CELL_WAYS + 1, /* and one for all */
    GUIDE_CELL_FOURS = GUIDE_CELL_LOBES / LANES + 1
};

typedef struct LanesVec3 {
    Lanes x, y, z;
} LanesVec3;

/* Four of a cell's lobes, one after another, in a lane each: so they are asked for directions and densities. */
typedef struct GuideFour {
    LanesVec3 place, axis, x, y, slope_x, slope_y;
    Lanes mean_x, mean_y, xx, xy, yy, bend, color, hue_x, hue_y, hue_bend;
    float weight[LANES], cumulative[LANES];
    uint32_t n_sheet[LANES], turns[LANES];
} GuideFour;

/* How many of these n lobes take. */
static inline uint32_t guide_fours_of(uint32_t n)
{
    return (n + LANES - 1) / LANES;
}
/* Lays n lobes of a cell into as many. */
void guide_lay_in_fours(const GuideLobe *lobes, uint32_t n, GuideFour *fours);
/* How far a direction is from the means of four lobes at a place: squared, in the planes of theirs. */
Lanes guide_lobes_apart_squared(const GuideFour *four, GuidePlace place, Vec3f direction);

/* The mean direction of one of a cell's lobes at a place. */
Vec3f guide_lobe_mean(const GuideFour *fours, uint32_t lobe, GuidePlace place);

/* A direction of a cell's n <= GUIDE_CELL_LOBES lobes at a place, and the density of that per steradian. u: uniform in [0, 1);
 * v: in [0, 1)^2. */
Vec3f guide_sample_lobes(const GuideFour *fours, uint32_t n, GuidePlace place, float u, const float v[2]);
float guide_lobes_pdf(const GuideFour *fours, uint32_t n, GuidePlace place, Vec3f direction);
/* The same apart for what the lobes' light did. */
void guide_lobes_leads(const GuideFour *fours, uint32_t n, GuidePlace place, Vec3f direction, Leads *leads);

#endif
