/* smooth.h - smooth curves through points, with centripetal parameters: what a curve takes from a point to the next goes with the
 * root of their distance (C. Yuksel, S. Schaefer, J. Keyser, "Parameterization and applications of Catmull-Rom curves",
 * Computer-Aided Design 43, 2011), so that long and short steps may lie beside each other. Of two kinds: Catmull and Rom's, which
 * keeps to the points before and behind and has no loops or cusps within a piece; and natural ones, whose bending does not jump.
 * Private to src/shape.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SMOOTH_H
#define MEN_SMOOTH_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/attr.h"

/* What a curve takes from a point to the next, by how far they are apart. */
static inline double smooth_time(double distance)
{
    return sqrt(distance);
}

/* ---- Catmull and Rom's ---- */

/* The velocity at `here`, in one coordinate, of the curve through three points, for a piece to `after` that takes time 1. since,
 * until: times from `before` and to `after`. */
static inline double smooth_velocity(double before, double here, double after, double since, double until)
{
    if (!(until > 0)) return 0;
    if (!(since > 0)) since = until; /* a point that stands there twice */
    return until * ((here - before) / since - (after - before) / (since + until)) + (after - here);
}

/* ---- natural ones: C. de Boor, "A Practical Guide to Splines" (1978), ch. IV ---- */

/* What such a curve does at a point. */
typedef enum NaturalAt {
    NATURAL_PASSES, /* goes on, with one direction and one curvature */
    NATURAL_CORNER, /* ends from both sides, without bending there */
    NATURAL_MIRRORED /* ends from both sides, as if it went on into its mirror image: the first coordinate has the other sign */
} NaturalAt;

typedef struct NaturalPoints {
    const double *values; /* n times width: the coordinates of a point, and what else varies with it */
    /* from each point to the next one, and of a closed curve from the last to the first; above 0 */
    const double *times;
    const NaturalAt *at; /* of each point; NULL: the curve passes all, and the ends of an open one are corners */
    size_t n;            /* at least 2; of a closed curve that passes all: at least 3 */
    unsigned width;
    bool closed;
} NaturalPoints;

/* velocities: 2 * width numbers for each piece, those at its begin and those at its end, as if the piece took time 1; what is
 * between is Hermite's cubic. O(n). False when memory ends. */
ATTR_NODISCARD bool natural_velocities(const NaturalPoints *points, double *velocities);

#endif
