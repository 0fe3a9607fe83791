/* direction_grid.h - a table over the directions on one side of a surface that is alike across x and across y, with the
 * knots where facets make the most of a change: about grazing angles, about the critical one, and about the azimuth that
 * stretched facets are smooth along.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_DIRECTION_GRID_H
#define MEN_DIRECTION_GRID_H

#include "base/lanes.h"
#include "base/vec3.h"

enum { DIRECTION_AZIMUTHS = 37, DIRECTION_COSINES = 57, DIRECTION_EDGES = 2 }; /* at most */

/* azimuths: |y| / (|x| + |y|), ascending; cosines: ascending, of each azimuth its own */
typedef struct DirectionGrid {
    int n_azimuths, n_cosines;
    float azimuths[DIRECTION_AZIMUTHS];
    float cosines[DIRECTION_AZIMUTHS][DIRECTION_COSINES], values[DIRECTION_AZIMUTHS][DIRECTION_COSINES];
} DirectionGrid;

/* Where what facets do changes fast: at the critical angle of that cosine, in the width of their tilt; below 0: nowhere. */
typedef struct DirectionEdge {
    float critical, alpha_x, alpha_y;
} DirectionEdge;

/* That width, about, at the azimuth of w: what tilts along it, and what tilts across it makes of angles. */
static inline float direction_edge_width(float alpha_x, float alpha_y, Vec3f w)
{
    float x = w.x * w.x, y = w.y * w.y, a = alpha_x * alpha_x, b = alpha_y * alpha_y;
    return 0.005f + 0.7f * sqrtf((a * x + b * y) / (x + y + 1e-12f)) + 0.05f * (a + b);
}

/* All values are 0 then. At most that many knots each way; fewer azimuths where the ratio is about 1, fewer cosines where there
 * are no edges. */
void direction_grid_init(DirectionGrid *grid, const DirectionEdge edges[DIRECTION_EDGES], float ratio,
                         int most_azimuths, int most_cosines);
/* Of knot 0 .. n - 1; z > 0. */
Vec3f direction_grid_knot(const DirectionGrid *grid, int knot);
static inline int direction_grid_knots(const DirectionGrid *grid)
{
    return grid->n_azimuths * grid->n_cosines;
}
static inline float *direction_grid_value(DirectionGrid *grid, int knot)
{
    return &grid->values[knot / grid->n_cosines][knot % grid->n_cosines];
}
/* Where a direction, w.z of either sign, is between the knots. Between azimuths the knots' cosines go over into each other,
 * and so what is at an edge does as it widens. */
typedef struct DirectionPlace {
    int azimuth, cosine;
    float past_azimuth, past_cosine;
} DirectionPlace;
DirectionPlace direction_grid_place(const DirectionGrid *grid, Vec3f w);
float direction_grid_at(const DirectionGrid *grid, Vec3f w);

#endif
