/* smooth.h - smooth curves through points: Catmull and Rom's with centripetal parameters (C. Yuksel, S. Schaefer, J. Keyser,
 * "Parameterization and applications of Catmull-Rom curves", Computer-Aided Design 43, 2011), which have no loops or cusps within
 * a piece, however unevenly the points lie. Private to src/shape.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SMOOTH_H
#define MEN_SMOOTH_H

#include <math.h>

/* What a curve takes from a point to the next, by how far they are apart. */
static inline double smooth_time(double distance)
{
    return sqrt(distance);
}

/* The velocity at `here`, in one coordinate, of the curve through three points, for a piece to `after` that takes time 1. since,
 * until: times from `before` and to `after`. */
static inline double smooth_velocity(double before, double here, double after, double since, double until)
{
    if (!(until > 0)) return 0;
    if (!(since > 0)) since = until; /* a point that stands there twice */
    return until * ((here - before) / since - (after - before) / (since + until)) + (after - here);
}

#endif
